#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>

#include "clouds/scanner/laws.h"
#include "clouds/shapes/random.h"
#include "clouds/shapes/sampling.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::clouds {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

/// A scanner on the z axis that looks down at the mesh: a ray is where it meets the plane one unit before it.
struct Eye {
  Vector3d place;

  Vector2d ray(const Vector3d& p) const { return (p - place).head<2>() / (place[2] - p[2]); }
};

using Corners = std::array<Vector3d, 3>;

double cross(const Vector2d& a, const Vector2d& b) {
  return a[0] * b[1] - a[1] * b[0];
}

/// Where the ray meets the triangle, appended to `hits`. Barycentric weights over depth are straight in the
/// picture, so the point is exact.
void meet_triangle(const Eye& eye, const Corners& at, const std::array<Vector2d, 3>& seen,
                   const Vector2d& ray, Positions& hits) {
  std::array<double, 3> weight{};
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector2d &a = seen[(k + 1) % 3], &b = seen[(k + 2) % 3];
    weight[k] = cross(b - a, ray - a);
    if (k > 0 && (weight[k] > 0) != (weight[0] > 0)) return;
    weight[k] /= eye.place[2] - at[k][2];
    sum += weight[k];
  }
  if (sum != 0) hits.push_back((weight[0] * at[0] + weight[1] * at[1] + weight[2] * at[2]) / sum);
}

/// Rays, `steps` apart within a row and from row to row, all that meet the triangle. They are off the axis,
/// for the edges of many shapes are on it.
void meet_rays(const Eye& eye, const Corners& at, const Vector2d& steps, Positions& hits) {
  constexpr double kOffAxis = 0.37;
  const std::array<Vector2d, 3> seen = {eye.ray(at[0]), eye.ray(at[1]), eye.ray(at[2])};
  const Vector2d low = seen[0].cwiseMin(seen[1]).cwiseMin(seen[2]).cwiseQuotient(steps);
  const Vector2d high = seen[0].cwiseMax(seen[1]).cwiseMax(seen[2]).cwiseQuotient(steps);
  for (double row = std::ceil(low[1] - kOffAxis); row + kOffAxis <= high[1]; ++row)
    for (double column = std::ceil(low[0] - kOffAxis); column + kOffAxis <= high[0]; ++column)
      meet_triangle(eye, at, seen, steps.cwiseProduct(Vector2d(column + kOffAxis, row + kOffAxis)), hits);
}

Positions rings(const Mesh& mesh, std::size_t n, double gap) {
  const Eye eye{frame_of(mesh.positions).eye};
  const auto corners = [&](const Face& f) -> Corners {
    return {mesh.positions[f[0]], mesh.positions[f[1]], mesh.positions[f[2]]};
  };
  double picture = 0;  // area, of all sheets
  for (const Face& face : mesh.faces) {
    const Corners at = corners(face);
    const Vector2d a = eye.ray(at[0]);
    picture += std::abs(cross(eye.ray(at[1]) - a, eye.ray(at[2]) - a)) / 2;
  }
  const double step = std::sqrt(picture / (gap * double(n)));
  Positions hits;
  for (const Face& face : mesh.faces) meet_rays(eye, corners(face), {step, gap * step}, hits);
  return hits;
}

/// Of four times as many random points those that a weighted draw without replacement (Efraimidis and
/// Spirakis 2006) takes, with weights that fall off from the centre of the clump that is nearest.
Spots clumped(const Mesh& mesh, std::size_t n, std::uint64_t seed) {
  const Positions drawn = sample(mesh, 4 * n, seed, Sampling::uniform);
  const Positions centres =
      sample(mesh, std::max<std::size_t>(2, n / std::size_t(kPerClump)), seed + 1, Sampling::uniform);
  const rfs_mesh::SpatialIndex index(centres, {});
  const double reach = mean_spacing(centres);
  struct Key {
    double key = 0;
    Index row = 0, clump = 0;
    bool operator<(const Key& other) const { return key != other.key ? key < other.key : row < other.row; }
  };
  Random random(seed + 2);
  std::vector<Key> keys;
  std::vector<rfs_mesh::Neighbor> near;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    index.nearest(drawn[i], 1, near);
    const double weight = std::exp(-2 * near[0].squared_distance / (reach * reach));
    keys.push_back({-std::log(random.uniform()) / std::max(weight, 1e-12), Index(i), near[0].index});
  }
  std::sort(keys.begin(), keys.end());
  Spots spots;
  for (std::size_t i = 0; i < n; ++i) {
    spots.points.push_back(drawn[keys[i].row]);
    spots.clump.push_back(keys[i].clump);
  }
  return spots;
}

}  // namespace

Spots spread(const Law& law, const Mesh& mesh, std::size_t n, std::uint64_t seed) {
  if (mesh.faces.empty()) throw std::invalid_argument("a mesh without faces has no surface to scan");
  switch (law.spread) {
    case Spread::rings:
      return {rings(mesh, n, law.ring_gap), {}};
    case Spread::clumps:
      return clumped(mesh, n, seed);
    case Spread::even:
      break;
  }
  return {sample(mesh, n, seed), {}};
}

}  // namespace rfsmooth::clouds
