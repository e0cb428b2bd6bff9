#include "smoothing/automatic/along_surface/slide_back.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/raw_array.h"
#include "rfs_mesh/levels.h"
#include "smoothing/automatic/along_surface/tangent_frames.h"

namespace rfsmooth::smoothing {

namespace {

using rfs_mesh::kNeighbourhood;
using rfs_mesh::Neighbor;

/// The points nearest to a place that moves a little: the nearest and its ring, with half a ring more to be
/// sure of them at the next place.
class RingAround {
 public:
  static constexpr std::size_t kCount = rfs_mesh::kRing + 1;

  explicit RingAround(const rfs_mesh::SpatialIndex& index) : index_(index) {}

  /// Finds those of `place`: as SpatialIndex::nearest.
  void find(const Eigen::Vector3d& place) {
    if (found_.size() >= kCount && are_of(place)) return;
    index_.nearest(place, int(kCount + rfs_mesh::kRing / 2), found_);
    searched_ = place;
    reach_ = std::sqrt(found_.back().squared_distance);
  }

  /// For the next point: nothing is found.
  void clear() { found_.clear(); }

  const Neighbor* begin() const { return found_.data(); }
  const Neighbor* end() const { return begin() + std::min(kCount, found_.size()); }
  const Neighbor& front() const { return *begin(); }
  const Neighbor& back() const { return *(end() - 1); }

 private:
  /// Sees the found from `place`. Whether none of the others is nearer: they are beyond `reach_`.
  bool are_of(const Eigen::Vector3d& place) {
    for (Neighbor& q : found_)
      q.squared_distance = rfs_mesh::squared_distance(index_.points()[q.index], place);
    std::sort(found_.begin(), found_.end());
    constexpr double kRounding = 1 - 1e-9;
    return std::sqrt(back().squared_distance) < kRounding * reach_ - (place - searched_).norm();
  }

  const rfs_mesh::SpatialIndex& index_;
  std::vector<Neighbor> found_;
  Eigen::Vector3d searched_ = Eigen::Vector3d::Zero();
  double reach_ = 0;  ///< of the farthest found from there
};

/// A smoothed cloud to find feet on.
class SmoothSurface {
 public:
  SmoothSurface(const Positions& points, rfs_mesh::NeighborTable table, const Context& context)
      : points_(points),
        rows_(std::move(table), points, context),
        frames_(points.size()),
        index_(points, context) {
    for_each_index(context, points.size(), [&](std::size_t i) {
      TangentNeighbors around;
      frames_[i] = tangent_frame(points, rows_, i, around);
    });
  }

  const rfs_mesh::SpatialIndex& index() const { return index_; }

  /// Where p goes, that was smoothed to point i. \param near room
  Eigen::Vector3d foot(std::size_t i, const Eigen::Vector3d& p, RingAround& near) const {
    near.clear();
    // A third time would hardly move it.
    const Eigen::Vector3d first = foot_around(foot_by(i, p), i, p, near), at = foot_around(first, i, p, near);
    near.find(at);
    const double reach = double(frames_[near.front().index].reach);
    return near.front().squared_distance <= reach * reach ? at : points_[i];
  }

 private:
  /// What the quadrics of the points nearest to `at` say together; `at` if none faces as point i does.
  Eigen::Vector3d foot_around(const Eigen::Vector3d& at, std::size_t i, const Eigen::Vector3d& p,
                              RingAround& near) const {
    near.find(at);
    const double farthest = near.back().squared_distance;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double total = 0;
    for (const Neighbor& q : near) {
      if (!faces_as(q.index, i)) continue;
      const double nearness = farthest > 0 ? 1 - q.squared_distance / farthest : 1,
                   weight = nearness * nearness;
      sum += weight * foot_by(q.index, p);
      total += weight;
    }
    return total > 0 ? Eigen::Vector3d(sum / total) : at;
  }
  bool faces_as(std::size_t j, std::size_t i) const {
    return std::abs(rows_.normals()[j].dot(rows_.normals()[i])) >= kSameNormal;
  }
  /// What the quadric of point j says.
  Eigen::Vector3d foot_by(std::size_t j, const Eigen::Vector3d& p) const {
    return frames_[j].slide(points_[j], frames_[j].offset((p - points_[j]).cast<float>()));
  }

  const Positions& points_;
  NearestRows rows_;
  RawArray<TangentFrame> frames_;
  rfs_mesh::SpatialIndex index_;
};

}  // namespace

void slide_back(Positions& points, const Positions& before, rfs_mesh::NeighborTable near,
                const Context& context) {
  if (points.size() <= kNeighbourhood) return;
  const SmoothSurface surface(points, std::move(near), context);
  Positions back(points.size());
  for_blocks(context, points.size(), 256, [&](std::size_t begin, std::size_t end) {
    RingAround around(surface.index());
    for (std::size_t i = begin; i < end; ++i)
      back[i] = points[i] == before[i] ? points[i] : surface.foot(i, before[i], around);
  });
  points = std::move(back);
}

}  // namespace rfsmooth::smoothing
