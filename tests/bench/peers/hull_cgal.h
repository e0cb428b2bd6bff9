/// The convex hull of points by CGAL: for points of a sphere, their Delaunay triangulation.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace rfsmooth::bench::peers {

/// The hull's edges {a < b}, ascending. `xyz` is n x 3, pairwise distinct.
std::vector<std::array<std::uint32_t, 2>> hull_edges_cgal(const double* xyz, std::size_t n);

}  // namespace rfsmooth::bench::peers
