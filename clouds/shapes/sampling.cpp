#include "clouds/shapes/sampling.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/parallel.h"
#include "rfs_mesh/fit/local_surface.h"
#include "rfs_mesh/measure.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::clouds {

using Eigen::Vector3d;

namespace {

constexpr std::size_t kCandidatesPerPoint = 5;  // Yuksel's advice; more gains little

double square(double x) {
  return x * x;
}

/// Draws candidates with `draw`, and thins them if asked to.
template <class Draw, class Density>
Positions sample_with(std::size_t n, Sampling sampling, double area, Draw&& draw, Density&& density) {
  const bool thin = sampling == Sampling::poisson_disk;
  Positions points(thin ? kCandidatesPerPoint * n : n);
  for (Vector3d& p : points) p = draw();
  if (!thin) return points;
  std::vector<double> densities(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) densities[i] = density(points[i]);
  Positions kept;
  for (const Index i : eliminate(points, densities, area, n)) kept.push_back(points[i]);
  return kept;
}

}  // namespace

Positions sample(const Shape& shape, std::size_t n, std::uint64_t seed, Sampling sampling) {
  Random random(seed);
  return sample_with(
      n, sampling, shape.area(), [&] { return shape.surface_point(random); },
      [&](const Vector3d& p) { return shape.density(p); });
}

Positions sample(const Mesh& mesh, std::size_t n, std::uint64_t seed, Sampling sampling) {
  if (mesh.faces.empty()) throw std::invalid_argument("a mesh without faces has no surface to sample");
  std::vector<double> until;  // area up to and including each face
  double area = 0;
  for (const Face& face : mesh.faces) {
    area += 0.5 * rfs_mesh::face_cross(mesh.positions, face).norm();
    until.push_back(area);
  }
  Random random(seed);
  const auto draw = [&]() -> Vector3d {
    const auto at = std::lower_bound(until.begin(), until.end(), random.uniform() * area);
    const Face& face = mesh.faces[std::size_t(std::min(at, until.end() - 1) - until.begin())];
    double u = random.uniform();
    double v = random.uniform();
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const Vector3d& a = mesh.positions[face[0]];
    return a + u * (mesh.positions[face[1]] - a) + v * (mesh.positions[face[2]] - a);
  };
  return sample_with(n, sampling, area, draw, [](const Vector3d&) { return 1.0; });
}

std::vector<Index> eliminate(const Positions& candidates, const std::vector<double>& density, double area,
                             std::size_t n) {
  const std::size_t total = candidates.size();
  if (n > total) throw std::invalid_argument("fewer candidates than points asked for");
  const auto density_of = [&](std::size_t i) { return density.empty() ? 1.0 : density[i]; };
  // Candidates are drawn in proportion to the density, so the integral of the density is area / mean(1 /
  // density).
  double inverse = 0;
  for (std::size_t i = 0; i < total; ++i) inverse += 1 / density_of(i);
  const double dense_area = area * double(total) / inverse;
  const double disk = std::sqrt(dense_area / (2 * std::sqrt(3.0) * double(n)));  // hexagonal packing
  std::vector<double> radius(total);
  for (std::size_t i = 0; i < total; ++i) radius[i] = disk / std::sqrt(density_of(i));

  const rfs_mesh::SpatialIndex index(candidates, {});
  std::vector<std::vector<std::pair<Index, double>>> overlaps(total);  // with whom, and how much
  const double widest = *std::max_element(radius.begin(), radius.end());
  for_each_index({}, total, [&](std::size_t i) {
    std::vector<rfs_mesh::Neighbor> near;
    index.within(candidates[i], radius[i] + widest, near);
    for (const rfs_mesh::Neighbor& other : near) {
      const double reach = radius[i] + radius[other.index],
                   gap = 1 - std::sqrt(other.squared_distance) / reach;
      if (other.index != i && gap > 0) overlaps[i].emplace_back(other.index, square(square(square(gap))));
    }
  });
  std::vector<double> weight(total, 0);
  std::vector<std::pair<double, Index>> heap;
  for (Index i = 0; i < total; ++i) {
    for (const auto& [j, w] : overlaps[i]) weight[i] += w;
    heap.emplace_back(weight[i], i);
  }
  std::make_heap(heap.begin(), heap.end());
  std::vector<char> alive(total, 1);
  for (std::size_t left = total; left > n;) {
    std::pop_heap(heap.begin(), heap.end());
    const auto [w, i] = heap.back();
    heap.pop_back();
    if (alive[i] == 0) continue;
    if (w != weight[i]) {  // lowered since it was pushed
      heap.emplace_back(weight[i], i);
      std::push_heap(heap.begin(), heap.end());
      continue;
    }
    alive[i] = 0;
    --left;
    for (const auto& [j, share] : overlaps[i]) weight[j] = std::max(0.0, weight[j] - share);
  }
  std::vector<Index> kept;
  for (Index i = 0; i < total; ++i)
    if (alive[i] != 0) kept.push_back(i);
  return kept;
}

double mean_spacing(const Positions& points) {
  const rfs_mesh::SpatialIndex index(points, {});
  return rfs_mesh::mean_spacing(points, index.nearest(1, {}), {});
}

void add_noise(Positions& points, double sigma, std::uint64_t seed) {
  Random random(seed);
  for (Vector3d& p : points) p += sigma * random.normal3();
}

}  // namespace rfsmooth::clouds
