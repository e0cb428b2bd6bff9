#include "rfsmooth/smoothing/stranded.h"

#include <algorithm>

#include <Eigen/Eigenvalues>

#include "rfsmooth/rfs_mesh/neighbors.h"
#include "rfsmooth/rfs_mesh/parallel.h"

namespace rfsmooth::smoothing {

namespace {

constexpr int kNear = 48;             // neighbours that say what is usual
constexpr std::size_t kTenth = 9;     // the neighbour whose distance measures density
constexpr double kThin = 1.7;         // times the usual: 1.4 takes points at edges, 2 leaves small islands
constexpr int kPlane = 24;            // points of the plane
constexpr std::size_t kTooFew = 100;  // points: below, nothing is usual

std::vector<Index> find_stranded(const rfs_mesh::Mesh& mesh, const Positions& guide, const Context& context) {
  const rfs_mesh::SpatialIndex index(guide, context);
  const rfs_mesh::NeighborTable near = index.nearest(kNear, context);
  std::vector<char> stranded(guide.size());
  for_each_index(context, guide.size(), [&](std::size_t i) { stranded[i] = mesh.one_ring.degree(i) == 0; });
  std::vector<double> distance(guide.size());
  for (const std::size_t rank : {kTenth, std::size_t(kNear) - 1}) {
    for_each_index(context, guide.size(),
                   [&](std::size_t i) { distance[i] = (guide[near[i][rank]] - guide[i]).norm(); });
    for_blocks(context, guide.size(), 4096, [&](std::size_t begin, std::size_t end) {
      std::vector<double> around;
      for (std::size_t i = begin; i < end; ++i) {
        around.clear();
        for (const Index j : near[i]) around.push_back(distance[j]);
        const auto quartile = around.begin() + std::ptrdiff_t(around.size() / 4);
        std::nth_element(around.begin(), quartile, around.end());
        if (distance[i] > kThin * *quartile) stranded[i] = 1;
      }
    });
  }
  std::vector<Index> found;
  for (std::size_t i = 0; i < guide.size(); ++i)
    if (stranded[i]) found.push_back(Index(i));
  return found;
}

/// p projected onto the plane through the points nearest to `at`.
Eigen::Vector3d project(const rfs_mesh::SpatialIndex& surface, const Eigen::Vector3d& at,
                        const Eigen::Vector3d& p, std::vector<rfs_mesh::Neighbor>& near) {
  surface.nearest(at, kPlane, near);
  const double square = 1.05 * near.back().squared_distance;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double weights = 0;
  for (const auto& q : near) {
    const double w = square > 0 ? 1 - q.squared_distance / square : 1;
    centre += w * surface.points()[q.index];
    weights += w;
  }
  centre /= weights;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& q : near) {
    const Eigen::Vector3d d = surface.points()[q.index] - centre;
    spread += (square > 0 ? 1 - q.squared_distance / square : 1) * d * d.transpose();
  }
  const Eigen::Vector3d normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  return p - normal * normal.dot(p - centre);
}

}  // namespace

std::size_t land_stranded(const rfs_mesh::Mesh& mesh, double most, Positions& guide, const Context& context) {
  if (guide.size() < kTooFew) return 0;
  const std::vector<Index> stranded = find_stranded(mesh, guide, context);
  if (stranded.empty() || guide.size() - stranded.size() < kTooFew) return stranded.size();
  Positions rest;
  rest.reserve(guide.size() - stranded.size());
  for (std::size_t i = 0, next = 0; i < guide.size(); ++i) {
    if (next < stranded.size() && stranded[next] == i)
      ++next;
    else
      rest.push_back(guide[i]);
  }
  const rfs_mesh::SpatialIndex surface(rest, context);
  for_blocks(context, stranded.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<rfs_mesh::Neighbor> near;
    for (std::size_t k = begin; k < end; ++k) {
      const Eigen::Vector3d& p = mesh.positions[stranded[k]];
      surface.nearest(p, 1, near);
      const Eigen::Vector3d from = rest[near[0].index];
      const Eigen::Vector3d landed = project(surface, project(surface, from, p, near), p, near);
      if (landed.allFinite() && (landed - p).norm() < most) guide[stranded[k]] = landed;
    }
  });
  return stranded.size();
}

}  // namespace rfsmooth::smoothing
