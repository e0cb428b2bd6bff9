/// Morton (Z-order) codes: points near in space mostly have near codes. Thread safe.
#pragma once

#include <cstdint>

#include <Eigen/Core>

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

/// The code of p in a box with lower corner `low`. `to_cell` = kMortonCells / the box's longest side; 0 if
/// the box is a point.
inline std::uint64_t morton_code(const Eigen::Vector3d& p, const Eigen::Vector3d& low, double to_cell) {
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis)
    code |= spread_bits(std::uint64_t((p[axis] - low[axis]) * to_cell)) << axis;
  return code;
}

}  // namespace rfsmooth
