#include "rfs_mesh/search/cells.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "base/morton.h"
#include "base/parallel.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// A point and the code of its cube.
struct InCube {
  std::uint64_t cell;
  Index point;
  friend bool operator<(const InCube& a, const InCube& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.point < b.point;
  }
};

/// The cube of a place, from the corner. Cubes beyond a million of the corner count as the last.
std::uint64_t cube_of(const Eigen::Vector3d& p, double edge) {
  constexpr double kMost = (kMortonCells - 1) / 2;
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double at = edge > 0 ? std::clamp(std::floor(p[axis] / edge), -kMost, kMost) : 0;
    code |= spread_bits(std::uint64_t(at + kMost)) << axis;
  }
  return code;
}

/// Halves [first, last) until it is small; appends where each group ends.
void halve(const Positions& points, Index* begin, Index* first, Index* last, std::size_t members,
           std::vector<Index>& ends) {
  const auto count = std::size_t(last - first);
  if (2 * count <= 3 * members) {
    ends.push_back(Index(last - begin));
    return;
  }
  Eigen::AlignedBox3d box;
  for (const Index* i = first; i < last; ++i) box.extend(points[*i]);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  Index* const middle = first + count / 2;
  std::nth_element(first, middle, last, [&](Index a, Index b) {
    return points[a][axis] != points[b][axis] ? points[a][axis] < points[b][axis] : a < b;
  });
  halve(points, begin, first, middle, members, ends);
  halve(points, begin, middle, last, members, ends);
}

}  // namespace

Groups group_in_cells(const Positions& points, const Eigen::Vector3d& corner, double edge,
                      std::size_t members, const Context& context) {
  const std::size_t n = points.size();
  std::vector<InCube> in_cube(n);
  for_each_index(context, n, [&](std::size_t i) {
    in_cube[i] = {cube_of(points[i] - corner, edge), Index(i)};
  });
  parallel_sort(context, in_cube, std::less<InCube>());
  Groups groups;
  groups.member.resize(n);
  for_each_index(context, n, [&](std::size_t i) { groups.member[i] = in_cube[i].point; });
  std::vector<std::size_t> cells;  // first points
  for (std::size_t i = 0; i < n; ++i)
    if (i == 0 || in_cube[i].cell != in_cube[i - 1].cell) cells.push_back(i);
  cells.push_back(n);
  std::vector<std::vector<Index>> ends(cells.size() - 1);
  Index* const begin = groups.member.data();
  for_each_index(
      context, ends.size(),
      [&](std::size_t c) { halve(points, begin, begin + cells[c], begin + cells[c + 1], members, ends[c]); },
      1);
  groups.start.push_back(0);
  for (const std::vector<Index>& of_cell : ends)
    groups.start.insert(groups.start.end(), of_cell.begin(), of_cell.end());
  return groups;
}

}  // namespace rfsmooth::rfs_mesh
