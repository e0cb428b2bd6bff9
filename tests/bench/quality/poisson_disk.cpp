#include "poisson_disk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <stdexcept>
#include <unordered_map>

#include <Eigen/Geometry>

#include "random.h"

namespace rfsmooth::bench {
namespace {

Positions uniform_samples(const rfs_mesh::Mesh& mesh, std::size_t n, double* area, std::uint64_t seed) {
  std::vector<double> cumulative;
  double total = 0;
  for (const auto& f : mesh.faces) {
    const auto &a = mesh.positions[f[0]], &b = mesh.positions[f[1]], &c = mesh.positions[f[2]];
    total += (b - a).cross(c - a).norm() / 2;
    cumulative.push_back(total);
  }
  if (!(total > 0)) throw std::invalid_argument("a mesh without area cannot be sampled");
  *area = total;
  Random random(seed);
  Positions points(n);
  for (auto& p : points) {
    const double at = random.uniform() * total;
    const auto face = std::min<std::size_t>(
        std::size_t(std::upper_bound(cumulative.begin(), cumulative.end(), at) - cumulative.begin()),
        cumulative.size() - 1);
    const auto& f = mesh.faces[face];
    const double s = std::sqrt(random.uniform()), t = random.uniform();
    p = (1 - s) * mesh.positions[f[0]] + s * (1 - t) * mesh.positions[f[1]] + s * t * mesh.positions[f[2]];
  }
  return points;
}

/// Points by cell of a cubic grid.
class Grid {
 public:
  Grid(const Positions& points, double cell) : points_(points), cell_(cell) {
    for (std::size_t i = 0; i < points.size(); ++i) cells_[key(coordinates(points[i]))].push_back(Index(i));
  }

  template <class Visit>
  void within(Index i, double radius, Visit&& visit) const {
    const auto at = coordinates(points_[i]);
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const auto found = cells_.find(key({at[0] + x, at[1] + y, at[2] + z}));
          if (found == cells_.end()) continue;
          for (const Index j : found->second) {
            const double d = (points_[j] - points_[i]).norm();
            if (j != i && d < radius) visit(j, d);
          }
        }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell coordinates(const Eigen::Vector3d& p) const {
    return {std::int64_t(std::floor(p[0] / cell_)), std::int64_t(std::floor(p[1] / cell_)),
            std::int64_t(std::floor(p[2] / cell_))};
  }
  static std::int64_t key(const Cell& c) {
    constexpr std::int64_t kOffset = 1 << 20;  // 21 bits an axis: cells are far fewer
    return ((c[0] + kOffset) << 42) ^ ((c[1] + kOffset) << 21) ^ (c[2] + kOffset);
  }

  const Positions& points_;
  double cell_;
  std::unordered_map<std::int64_t, std::vector<Index>> cells_;
};

}  // namespace

Positions poisson_disk(const rfs_mesh::Mesh& mesh, std::size_t n, std::uint64_t seed) {
  constexpr std::size_t kOversampling = 5;
  double area = 0;
  const Positions all = uniform_samples(mesh, kOversampling * n, &area, seed);
  const double radius = std::sqrt(area / (2 * std::sqrt(3.0) * double(n)));
  const double reach = 2 * radius;
  const double limit = reach * (1 - std::pow(1.0 / double(kOversampling), 1.5)) * 0.65;
  const Grid grid(all, reach);
  const auto crowding = [&](double d) { return std::pow(1 - std::max(d, limit) / reach, 8); };

  std::vector<double> weight(all.size(), 0.0);
  for (std::size_t i = 0; i < all.size(); ++i)
    grid.within(Index(i), reach, [&](Index, double d) { weight[i] += crowding(d); });

  // A heap with lazy decrease: an entry whose weight is stale is looked at again with the current one.
  std::priority_queue<std::pair<double, Index>> heap;
  for (std::size_t i = 0; i < all.size(); ++i) heap.emplace(weight[i], Index(i));
  std::vector<char> gone(all.size(), 0);
  for (std::size_t left = all.size(); left > n;) {
    const auto [w, i] = heap.top();
    heap.pop();
    if (w != weight[i]) {
      heap.emplace(weight[i], i);
      continue;
    }
    gone[i] = 1;
    --left;
    grid.within(i, reach, [&](Index j, double d) {
      if (!gone[j]) weight[j] -= crowding(d);
    });
  }
  Positions kept;
  kept.reserve(n);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (!gone[i]) kept.push_back(all[i]);
  return kept;
}

}  // namespace rfsmooth::bench
