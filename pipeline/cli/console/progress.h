/// Combines the stages that the library reports into one figure from 0 to 100 %.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

namespace rfsmooth::cli {

/// A stage of a sub-command and its share of the time, in any unit; measured on real scans, accurate enough
/// for a bar.
struct StageShare {
  std::string_view stage;
  double share;
};

/// The stages from reading to the rough mesh.
std::vector<StageShare> connecting_stages();
/// The same stages, outliers, smoothing and, if asked for, normals.
std::vector<StageShare> denoising_stages(bool normals);

/// The progress of a run over all its stages and files.
class Progress {
 public:
  /// Sets the stages, in order; "write" is added at the end. Other stages take no share: the bar stands at
  /// the end of the stage before them.
  void plan(std::vector<StageShare> stages);
  /// From now on stages belong to file `job` of `jobs`.
  void start_job(std::size_t job, std::size_t jobs);
  /// Takes a report of the library: a stage, and a fraction of it that need not begin at 0.
  void note(std::string_view stage, double fraction);

  const std::string& stage() const { return stage_; }
  double done() const { return done_; }          ///< share of the run; never decreases
  double in_stage() const { return in_stage_; }  ///< share of the stage
  double stage_seconds() const;                  ///< since the stage began
  double seconds_left() const;                   ///< estimate for this file; 0 if unknown

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<StageShare> stages_;
  std::size_t job_ = 0, jobs_ = 1;
  std::string stage_;
  double before_ = 0, share_ = 0, total_ = 0;  // shares of the stages before, of this one, of all
  double first_ = 0, in_stage_ = 0, done_ = 0;
  Clock::time_point job_start_ = Clock::now(), stage_start_ = Clock::now();
};

}  // namespace rfsmooth::cli
