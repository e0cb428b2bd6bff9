#include "tests/bench/peers/hull_cgal.h"

#include <algorithm>
#include <map>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

namespace rfsmooth::bench::peers {

std::vector<std::array<std::uint32_t, 2>> hull_edges_cgal(const double* xyz, std::size_t n) {
  using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
  std::vector<Point> points;
  std::map<Point, std::uint32_t> index;
  for (std::size_t i = 0; i < n; ++i) {
    points.emplace_back(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]);
    index[points.back()] = std::uint32_t(i);
  }
  CGAL::Surface_mesh<Point> hull;
  CGAL::convex_hull_3(points.begin(), points.end(), hull);
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (const auto e : hull.edges()) {
    const std::uint32_t a = index[hull.point(hull.vertex(e, 0))], b = index[hull.point(hull.vertex(e, 1))];
    edges.push_back({std::min(a, b), std::max(a, b)});
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

}  // namespace rfsmooth::bench::peers
