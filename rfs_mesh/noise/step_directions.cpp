#include "rfs_mesh/noise/step_directions.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "base/linear/symmetric_eigen.h"
#include "base/quantile.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/sample.h"

namespace rfsmooth::rfs_mesh {

namespace {

constexpr std::size_t kMostDirections = 3;
constexpr std::size_t kTried = 256;  // planes, of all places: the direction of one place in ten is among them
constexpr std::size_t kPairs = 20000;  // of points from all over the cloud

bool is_level(const Eigen::Vector3d& offset, const Eigen::Vector3d& direction, double same) {
  return std::abs(direction.dot(offset)) <= same;
}

std::size_t count_level(const Positions& offsets, const Eigen::Vector3d& direction, double same) {
  return std::size_t(std::count_if(offsets.begin(), offsets.end(),
                                   [&](const Eigen::Vector3d& d) { return is_level(d, direction, same); }));
}

/// Enters the normal of the plane through a point that holds the most of its neighbours, at these offsets, if
/// so many are no chance.
void enter_plane(const Positions& offsets, double same, Positions& planes) {
  std::size_t most = kFewestOfQuadric - 1;  // and the point itself
  Eigen::Vector3d best;
  bool found = false;
  for (std::size_t j = 0; j < offsets.size(); ++j)
    for (std::size_t k = 0; k < j; ++k) {
      const Eigen::Vector3d across = offsets[j].cross(offsets[k]);
      const double area = across.norm();
      // Of two in a line, or half in a line, rounding makes the plane.
      if (!(2 * area > offsets[j].norm() * offsets[k].norm())) continue;
      const Eigen::Vector3d normal = across / area;
      const std::size_t count = count_level(offsets, normal, same);
      if (count < most + (found ? 1 : 0)) continue;
      most = count;
      best = normal;
      found = true;
    }
  if (found) planes.push_back(best);
}

/// What the least of all these offsets are along.
Eigen::Vector3d least_along(const Positions& offsets) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& d : offsets) spread += d * d.transpose();
  return symmetric_eigen(spread).vectors.col(0);
}

/// The direction, to more digits: from points that are far apart on one terrace. \param step between two of
/// them, world units.
Eigen::Vector3d refined(Positions points, const Eigen::Vector3d& direction, double step) {
  std::sort(points.begin(), points.end(), [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return direction.dot(a) < direction.dot(b);
  });
  Positions offsets;  // from the middle of each terrace
  for (std::size_t begin = 0, end = 0; begin < points.size(); begin = end) {
    Eigen::Vector3d sum = points[end++];
    while (end < points.size() && is_level(points[end] - points[end - 1], direction, step / 4))
      sum += points[end++];
    for (std::size_t i = begin; i < end; ++i) offsets.push_back(points[i] - sum / double(end - begin));
  }
  return least_along(offsets);
}

}  // namespace

Positions step_directions(const SpatialIndex& index, double same) {
  Positions planes, offsets, of_one;
  std::vector<Neighbor> near;
  for (const Eigen::Vector3d& p : sample(index.points(), kPlacesOfCloud)) {
    index.nearest(p, int(kNarrowestPatch), near);
    of_one.clear();
    for (const Neighbor& q : near)
      if (q.squared_distance > 0) of_one.push_back(index.points()[q.index] - p);
    enter_plane(of_one, same, planes);
    offsets.insert(offsets.end(), of_one.begin(), of_one.end());
  }
  const double least = kLeastPart * double(offsets.size());
  planes = sample(planes, kTried);
  Positions directions;
  while (directions.size() < kMostDirections && !planes.empty()) {
    std::vector<std::size_t> level;
    for (const Eigen::Vector3d& plane : planes) level.push_back(count_level(offsets, plane, same));
    const auto best = std::max_element(level.begin(), level.end());
    if (!(double(*best) > least)) break;
    const Eigen::Vector3d rough = planes[std::size_t(best - level.begin())];
    const auto others = std::partition(offsets.begin(), offsets.end(),
                                       [&](const Eigen::Vector3d& d) { return is_level(d, rough, same); });
    std::vector<double> apart;
    for (auto d = others; d != offsets.end(); ++d) apart.push_back(std::abs(rough.dot(*d)));
    const Eigen::Vector3d near_by = least_along(Positions(offsets.begin(), others));
    directions.push_back(apart.empty()
                             ? near_by
                             : refined(sample(index.points(), kPairs), near_by, quantile(apart, kLeastPart)));
    offsets.erase(offsets.begin(), others);
  }
  return directions;
}

}  // namespace rfsmooth::rfs_mesh
