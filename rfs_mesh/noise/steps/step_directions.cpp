#include "rfs_mesh/noise/steps/step_directions.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "base/linear/symmetric_eigen.h"
#include "base/quantile.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/sample.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// A point and one of its neighbours.
struct Pair {
  Eigen::Vector3d point, offset;
};

bool is_level(const Eigen::Vector3d& offset, const Eigen::Vector3d& direction, double same) {
  return std::abs(direction.dot(offset)) <= same;
}

std::size_t count_level(const std::vector<Pair>& pairs, const Eigen::Vector3d& direction, double same) {
  return std::size_t(std::count_if(pairs.begin(), pairs.end(),
                                   [&](const Pair& pair) { return is_level(pair.offset, direction, same); }));
}

/// Enters the normal of the plane through a point that holds the most of its neighbours, if so many are no
/// chance. \param pairs of the point.
void enter_plane(const std::vector<Pair>& pairs, double same, Positions& planes) {
  std::size_t most = kFewestOfQuadric - 2;  // and the point itself
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  for (std::size_t j = 0; j < pairs.size(); ++j)
    for (std::size_t k = 0; k < j; ++k) {
      if (!make_a_plane(pairs[j].offset, pairs[k].offset)) continue;
      const Eigen::Vector3d normal = pairs[j].offset.cross(pairs[k].offset).normalized();
      const std::size_t count = count_level(pairs, normal, same);
      if (count <= most) continue;
      most = count;
      best = normal;
    }
  if (!best.isZero()) planes.push_back(best);
}

/// What the least of all these offsets are along.
Eigen::Vector3d least_along(const Positions& offsets) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& d : offsets) spread += d * d.transpose();
  return symmetric_eigen(spread).vectors.col(0);
}

/// The direction, to more digits: from points that are far apart on one terrace. \param points on terraces.
/// \param within how far apart along it points that follow each other on a terrace are, world units.
Eigen::Vector3d refined(Positions points, const Eigen::Vector3d& direction, double within) {
  std::sort(points.begin(), points.end(), [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return direction.dot(a) < direction.dot(b);
  });
  Positions offsets;  // from the middle of each terrace
  for (std::size_t begin = 0, end = 0; begin < points.size(); begin = end) {
    Eigen::Vector3d sum = points[end++];
    while (end < points.size() && is_level(points[end] - points[end - 1], direction, within))
      sum += points[end++];
    for (std::size_t i = begin; i < end; ++i) offsets.push_back(points[i] - sum / double(end - begin));
  }
  return least_along(offsets);
}

/// The direction that these pairs are level along. \param within see refined().
Eigen::Vector3d direction_of(const std::vector<Pair>& level, double within) {
  Positions points, offsets;
  for (const Pair& pair : level) {
    offsets.push_back(pair.offset);
    points.push_back(pair.point);
    points.push_back(pair.point + pair.offset);
  }
  return refined(std::move(points), least_along(offsets), within);
}

}  // namespace

bool make_a_plane(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return 2 * a.cross(b).norm() > a.norm() * b.norm();
}

Positions step_directions(const SpatialIndex& index, double same) {
  Positions planes;
  std::vector<Pair> pairs, of_one;
  std::vector<Neighbor> near;
  for (const Eigen::Vector3d& p : sample(index.points(), kPlacesOfCloud)) {
    index.nearest(p, int(kNarrowestPatch), near);
    of_one.clear();
    for (const Neighbor& q : near)
      if (q.squared_distance > 0) of_one.push_back({p, index.points()[q.index] - p});
    enter_plane(of_one, same, planes);
    pairs.insert(pairs.end(), of_one.begin(), of_one.end());
  }
  // One scan of ten, a tenth of whose neighbours are level.
  const double fewest = kLeastPart * kLeastPart * double(pairs.size());
  Positions directions;
  while (true) {
    // Pairs only become fewer: a plane that too few are level with does not come back.
    std::size_t most = 0, kept = 0;
    Eigen::Vector3d rough = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& plane : Positions(planes)) {
      const std::size_t level = count_level(pairs, plane, same);
      if (!(double(level) > fewest)) continue;
      planes[kept++] = plane;
      if (level <= most) continue;
      most = level;
      rough = plane;
    }
    planes.resize(kept);
    if (planes.empty()) break;
    const auto others = std::partition(pairs.begin(), pairs.end(),
                                       [&](const Pair& pair) { return is_level(pair.offset, rough, same); });
    std::vector<double> offsets;
    for (auto pair = others; pair != pairs.end(); ++pair)
      offsets.push_back(std::abs(rough.dot(pair->offset)));
    const double step = offsets.empty() ? 0 : quantile(offsets, kLeastPart);
    directions.push_back(direction_of({pairs.begin(), others}, std::max(same, step / 4)));
    pairs.erase(pairs.begin(), others);
  }
  return directions;
}

}  // namespace rfsmooth::rfs_mesh
