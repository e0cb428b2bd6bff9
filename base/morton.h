/// Morton (Z-order) codes: points near in space mostly have near codes. Thread safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "base/parallel.h"

namespace rfsmooth {

/// Spreads the low 21 bits of v so that two zero bits stand between neighbours.
inline std::uint64_t spread_bits(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffff;
  v = (v | v << 16) & 0x1f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  v = (v | v << 2) & 0x1249249249249249;
  return v;
}

/// The largest cell coordinate on an axis: 2^21 - 1.
constexpr double kMortonCells = 2097151;

/// The code of p on a grid of 2^21 cells a side. \param low the lower corner of its box. \param to_cell cells
/// per world unit
inline std::uint64_t morton_code(const Eigen::Vector3d& p, const Eigen::Vector3d& low, double to_cell) {
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis)
    code |= spread_bits(std::uint64_t((p[axis] - low[axis]) * to_cell)) << axis;
  return code;
}

/// The numbers below n in the order of their points' codes, then of `compare`, then their own; those of
/// points that are not finite last. Parallel. \param side the longest of the box from `low` that holds the
/// finite ones, 0 or more. \param compare of two numbers: negative if the first comes first, 0 if that is
/// open
template <class Number, class Point, class Compare>
std::vector<Number> morton_order(std::size_t n, Point&& point, const Eigen::Vector3d& low, double side,
                                 Compare&& compare, const Context& context) {
  constexpr auto kLast = std::numeric_limits<std::uint64_t>::max();
  struct Coded {
    std::uint64_t code;
    Number number;
  };
  const double to_cell = side > 0 ? kMortonCells / side : 0;
  std::vector<Coded> coded(n);
  for_each_index(context, n, [&](std::size_t i) {
    const Eigen::Vector3d p = point(i);
    coded[i] = {p.allFinite() ? morton_code(p, low, to_cell) : kLast, Number(i)};
  });
  parallel_sort(context, coded, [&](const Coded& a, const Coded& b) {
    if (a.code != b.code) return a.code < b.code;
    const int order = a.code == kLast ? 0 : compare(a.number, b.number);
    return order != 0 ? order < 0 : a.number < b.number;
  });
  std::vector<Number> order(n);
  for_each_index(context, n, [&](std::size_t k) { order[k] = coded[k].number; });
  return order;
}

}  // namespace rfsmooth
