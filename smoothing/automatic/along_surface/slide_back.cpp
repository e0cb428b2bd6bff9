#include "smoothing/automatic/along_surface/slide_back.h"

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

  /// Where p goes, that was smoothed to point i. \param found room
  Eigen::Vector3d foot(std::size_t i, const Eigen::Vector3d& p, std::vector<Neighbor>& found) const {
    // A third search would hardly move it.
    const Eigen::Vector3d first = foot_around(foot_by(i, p), i, p, found),
                          at = foot_around(first, i, p, found);
    index_.nearest(at, 1, found);
    const double reach = double(frames_[found.front().index].reach);
    return found.front().squared_distance <= reach * reach ? at : points_[i];
  }

 private:
  /// What the quadrics of the points nearest to `at` say together; `at` if none faces as point i does.
  Eigen::Vector3d foot_around(const Eigen::Vector3d& at, std::size_t i, const Eigen::Vector3d& p,
                              std::vector<Neighbor>& found) const {
    index_.nearest(at, int(rfs_mesh::kRing) + 1, found);
    const double farthest = found.back().squared_distance;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double total = 0;
    for (const Neighbor& q : found) {
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
    std::vector<Neighbor> found;
    for (std::size_t i = begin; i < end; ++i)
      back[i] = points[i] == before[i] ? points[i] : surface.foot(i, before[i], found);
  });
  points = std::move(back);
}

}  // namespace rfsmooth::smoothing
