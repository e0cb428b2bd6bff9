#include "rfsmooth/cgal/advancing_front.h"

#include <algorithm>
#include <array>
#include <iterator>

#include <CGAL/Advancing_front_surface_reconstruction.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace rfsmooth::cgal {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// The front's next triangle: the smallest circumradius first, never across an edge longer than the limit.
struct Perimeter {
  double longest_edge;
  template <typename Front, typename Cell>
  double operator()(const Front& front, Cell& cell, const int& index) const {
    if (longest_edge > 0) {
      const double limit = longest_edge * longest_edge;
      for (int a = 0; a < 3; ++a) {
        const auto& p = cell->vertex((index + 1 + a) % 4)->point();
        const auto& q = cell->vertex((index + 1 + (a + 1) % 3) % 4)->point();
        if (CGAL::squared_distance(p, q) > limit) return front.infinity();
      }
    }
    return front.smallest_radius_delaunay_sphere(cell, index);
  }
};

/// The same face, turned so that its least corner comes first.
rfs_mesh::Face least_first(const rfs_mesh::Face& f) {
  if (f[0] < f[1] && f[0] < f[2]) return f;
  return f[1] < f[2] ? rfs_mesh::Face{f[1], f[2], f[0]} : rfs_mesh::Face{f[2], f[0], f[1]};
}

}  // namespace

Result<rfs_mesh::Mesh> advancing_front(const Positions& points, double longest_edge, const Context& context) {
  context.report("advancing front", 0);
  std::vector<Kernel::Point_3> input;
  input.reserve(points.size());
  for (const Eigen::Vector3d& p : points) input.emplace_back(p.x(), p.y(), p.z());
  std::vector<std::array<std::size_t, 3>> triangles;
  CGAL::advancing_front_surface_reconstruction(input.begin(), input.end(), std::back_inserter(triangles),
                                               Perimeter{longest_edge});
  if (triangles.empty())
    return Error{ErrorCode::no_usable_points, "the advancing front finds no surface in these points"};
  rfs_mesh::Mesh mesh;
  mesh.positions = points;
  for (const auto& t : triangles) mesh.faces.push_back(least_first({Index(t[0]), Index(t[1]), Index(t[2])}));
  // CGAL's order depends on where its nodes lie in memory; which faces there are does not.
  std::sort(mesh.faces.begin(), mesh.faces.end());
  rebuild_adjacency(mesh, context);
  return mesh;
}

pipeline::SurfaceMethod advancing_front_method() {
  return {"advancing-front", [](const pipeline::SurfaceInput& input, const Context& context) {
            return advancing_front(input.points, 0, context);
          }};
}

}  // namespace rfsmooth::cgal
