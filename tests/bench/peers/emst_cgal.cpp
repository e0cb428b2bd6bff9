#include "tests/bench/peers/emst_cgal.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <tbb/parallel_sort.h>

#ifndef CGAL_LINKED_WITH_TBB
#error "without its TBB support target CGAL silently runs on one core"
#endif

namespace rfsmooth::bench::peers {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_3<std::uint32_t, Kernel>;
using Cell = CGAL::Delaunay_triangulation_cell_base_3<Kernel>;
template <class Tag>
using Delaunay =
    CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<Vertex, Cell, Tag>>;

struct Edge {
  double squared_length;
  std::uint32_t a, b;
  bool operator<(const Edge& other) const { return squared_length < other.squared_length; }
};

template <class Triangulation>
std::vector<Edge> numbered_edges(Triangulation& triangulation) {
  std::uint32_t count = 0;
  for (auto v : triangulation.finite_vertex_handles()) v->info() = count++;
  std::vector<Edge> edges;
  edges.reserve(std::size_t(count) * 8);  // about 7.8 a point in space
  for (const auto& e : triangulation.finite_edges()) {
    const auto u = e.first->vertex(e.second), v = e.first->vertex(e.third);
    edges.push_back({CGAL::squared_distance(u->point(), v->point()), u->info(), v->info()});
  }
  return edges;
}

double kruskal_length(const std::vector<Edge>& sorted, std::size_t vertices) {
  std::vector<std::uint32_t> parent(vertices);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto find = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  double total = 0;
  std::size_t left = vertices;
  for (const Edge& e : sorted) {
    const std::uint32_t a = find(e.a), b = find(e.b);
    if (a == b) continue;
    parent[a] = b;
    total += std::sqrt(e.squared_length);
    if (--left == 1) break;
  }
  return total;
}

}  // namespace

double emst_length_cgal(const double* xyz, std::size_t n, bool parallel) {
  std::vector<Kernel::Point_3> points(n);
  for (std::size_t i = 0; i < n; ++i) points[i] = {xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]};
  if (!parallel) {
    Delaunay<CGAL::Sequential_tag> triangulation(points.begin(), points.end());
    std::vector<Edge> edges = numbered_edges(triangulation);
    std::sort(edges.begin(), edges.end());
    return kruskal_length(edges, triangulation.number_of_vertices());
  }
  CGAL::Bbox_3 box;
  for (const auto& p : points) box += p.bbox();
  Delaunay<CGAL::Parallel_tag>::Lock_data_structure locks(box,
                                                          50);  // cells an axis, as in CGAL's own example
  Delaunay<CGAL::Parallel_tag> triangulation(points.begin(), points.end(), &locks);
  std::vector<Edge> edges = numbered_edges(triangulation);
  tbb::parallel_sort(edges.begin(), edges.end());
  return kruskal_length(edges, triangulation.number_of_vertices());
}

}  // namespace rfsmooth::bench::peers
