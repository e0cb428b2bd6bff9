/// Places that many rows of a cloud share, as a scanner writes (0, 0, 0) for what it did not see. A working
/// cloud has one point for each (rfs_mesh/points.h), and so has a job: only the first row of such a place is
/// in a tile. The others, its repeats, are in a file of their own and get what the first becomes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/context.h>

#include "pipeline/tiles/files/records.h"
#include "pipeline/tiles/job.h"

namespace rfsmooth::pipeline::tiles {

/// Finds, in one pass and little memory, the places that many rows share: all that more than one of
/// kCounters + 1 rows is at, and maybe others (Misra and Gries, Finding repeated elements, 1982).
class SharedPlaces {
 public:
  static constexpr std::size_t kCounters = 32;
  void add(const Eigen::Vector3d& p);
  /// Those that were counted so many times or more; of their rows, at most one of kCounters + 1 is not
  /// counted.
  std::vector<Eigen::Vector3d> counted(std::uint64_t least) const;

 private:
  std::array<Eigen::Vector3d, kCounters> at_;
  std::array<std::uint64_t, kCounters> count_{};
};

/// Takes the repeats of some places out of the rows of a cloud, which come in order, once or more.
class RepeatsWriter {
 public:
  RepeatsWriter(const std::vector<Eigen::Vector3d>& shared, const Job& job, const Context& context);
  /// Whether the row is a repeat, which is written when it comes the first time.
  bool take(std::uint64_t row, const Eigen::Vector3d& p);
  /// Completes the file, if there are such places, and enters them into the job.
  void commit(Job& job);

 private:
  static constexpr std::uint64_t kNoRow = std::uint64_t(-1);
  std::vector<RepeatedPlace> places_;
  std::optional<RecordWriter> writer_;
  std::uint64_t next_ = 0;  ///< the row behind the last that is written
};

}  // namespace rfsmooth::pipeline::tiles
