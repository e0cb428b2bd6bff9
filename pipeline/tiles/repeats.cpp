#include "pipeline/tiles/repeats.h"

#include <algorithm>

namespace rfsmooth::pipeline::tiles {

using Eigen::Vector3d;

void SharedPlaces::add(const Vector3d& p) {
  std::size_t unused = kCounters;
  for (std::size_t i = 0; i < kCounters; ++i) {
    if (count_[i] == 0) {
      unused = i;
    } else if (at_[i] == p) {
      ++count_[i];
      return;
    }
  }
  if (unused < kCounters) {
    at_[unused] = p;
    count_[unused] = 1;
  } else {
    for (std::uint64_t& count : count_) --count;
  }
}

std::vector<Vector3d> SharedPlaces::counted(std::uint64_t least) const {
  std::vector<Vector3d> places;
  for (std::size_t i = 0; i < kCounters; ++i)
    if (count_[i] >= least) places.push_back(at_[i]);
  return places;
}

RepeatsWriter::RepeatsWriter(const std::vector<Vector3d>& shared, const Job& job, const Context& context) {
  for (const Vector3d& p : shared) places_.push_back({p, kNoRow, 0});
  if (!shared.empty()) writer_.emplace(job.repeats(), context);
}

bool RepeatsWriter::take(std::uint64_t row, const Vector3d& p) {
  const auto there = std::find_if(places_.begin(), places_.end(),
                                  [&](const RepeatedPlace& repeated) { return repeated.at == p; });
  if (there == places_.end()) return false;
  if (there->first == kNoRow) there->first = row;
  if (there->first == row) return false;
  if (row >= next_) {
    writer_->add({row, p[0], p[1], p[2]});
    ++there->others;
    next_ = row + 1;
  }
  return true;
}

void RepeatsWriter::commit(Job& job) {
  if (!writer_) return;
  writer_->commit();
  job.repeated = places_;
}

}  // namespace rfsmooth::pipeline::tiles
