/// An oracle for the EMST of any number of points, made of nothing but grids: Kruskal over all pairs within a
/// reach that doubles until one component is left. Fast where few pairs of different components meet in one
/// cell.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "rfs_mesh/points.h"

namespace rfsmooth::test {

/// Which of n vertices are joined.
class Components {
 public:
  explicit Components(std::size_t n) : parent_(n), count_(n) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  bool join(std::size_t a, std::size_t b) {
    const std::size_t x = find(a), y = find(b);
    parent_[x] = y;
    count_ -= x != y;
    return x != y;
  }
  std::size_t count() const { return count_; }

 private:
  std::vector<std::size_t> parent_;
  std::size_t count_;
};

/// Total length of the EMST.
inline double kruskal_length(Positions points) {
  using Eigen::Vector3d;
  const auto less = [](const Vector3d& p, const Vector3d& q) {
    return std::tie(p[0], p[1], p[2]) < std::tie(q[0], q[1], q[2]);
  };
  std::sort(points.begin(), points.end(), less);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 2) return 0;
  Vector3d low = points[0], high = points[0];
  for (const Vector3d& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }

  // Cells are packed into one number, 21 bits an axis, with room for a neighbour on every side.
  const auto cell_of = [](const Vector3d& at) {
    std::uint64_t cell = 0;
    for (int axis = 0; axis < 3; ++axis) cell = cell << 21 | (std::uint64_t(at[axis]) + 1);
    return cell;
  };
  struct Pair {
    double length;
    std::size_t a, b;
  };
  Components components(points.size());
  double total = 0;
  for (double reach = std::ldexp((high - low).maxCoeff(), -20); components.count() > 1; reach *= 2) {
    std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells;
    for (std::size_t i = 0; i < points.size(); ++i) cells[cell_of((points[i] - low) / reach)].push_back(i);
    std::vector<std::size_t> root(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) root[i] = components.find(i);
    const auto all_of_root = [&](std::size_t wanted, const std::vector<std::size_t>& in) {
      return std::all_of(in.begin(), in.end(), [&](std::size_t i) { return root[i] == wanted; });
    };
    double longest = reach;
    std::vector<Pair> pairs;
    for (const auto& [cell, inside] : cells)
      for (int step = 13; step < 27; ++step) {  // half of the neighbours, the cell itself among them
        const std::int64_t x = step / 9 - 1, y = step / 3 % 3 - 1, z = step % 3 - 1;
        const auto other = cells.find(cell + std::uint64_t((x * (1 << 21) + y) * (1 << 21) + z));
        if (other == cells.end()) continue;
        const std::size_t first = root[inside[0]];
        if (all_of_root(first, inside) && all_of_root(first, other->second)) continue;
        for (const std::size_t a : inside)
          for (const std::size_t b : other->second) {
            if (root[a] == root[b]) continue;
            const double length = (points[a] - points[b]).norm();
            if (length > longest) continue;
            pairs.push_back({length, a, b});
            if (components.count() == 2) longest = length;  // one link is missing: only a shorter one counts
          }
      }
    std::sort(pairs.begin(), pairs.end(), [](const Pair& x, const Pair& y) { return x.length < y.length; });
    for (const Pair& p : pairs)
      if (components.join(p.a, p.b)) total += p.length;
  }
  return total;
}

}  // namespace rfsmooth::test
