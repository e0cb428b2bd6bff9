/// From the stages that the library reports to one bar from 0 to 100 %.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

namespace rfsmooth::cli {

/// A stage of a sub-command and what share of its time it takes, in any unit: as measured on real scans, good
/// enough for a bar.
struct StageShare {
  std::string_view stage;
  double share;
};

/// The stages up to the rough mesh, reading among them.
std::vector<StageShare> connecting_stages();
/// The same, outliers, smoothing and normals, if they are made.
std::vector<StageShare> denoising_stages(bool normals);

/// How far a run is, over all its stages and files.
class Progress {
 public:
  /// The stages in the order in which they come, "write" behind them. Others that are reported change
  /// nothing.
  void plan(std::vector<StageShare> stages);
  /// From now on stages are those of file `job` of `jobs`.
  void start_job(std::size_t job, std::size_t jobs);
  /// Notes what the library reports: the stage and how far it is, by a count of its own that need not begin
  /// at 0.
  void note(std::string_view stage, double fraction);

  const std::string& stage() const { return stage_; }
  double done() const { return done_; }          ///< share of the run, never less than before
  double in_stage() const { return in_stage_; }  ///< share of the stage
  double stage_seconds() const;                  ///< since the stage began
  double seconds_left() const;                   ///< of this file; 0 if there is nothing to tell it by

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<StageShare> stages_;
  std::size_t job_ = 0, jobs_ = 1;
  std::string stage_;
  double before_ = 0, share_ = 0, total_ = 0;  // of the stages before, of this one, of all
  double first_ = 0, in_stage_ = 0, done_ = 0;
  Clock::time_point job_start_ = Clock::now(), stage_start_ = Clock::now();
};

}  // namespace rfsmooth::cli
