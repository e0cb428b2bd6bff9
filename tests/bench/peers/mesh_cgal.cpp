#include <chrono>

#include <CGAL/Polygon_mesh_processing/smooth_shape.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#include "tests/bench/peers/mesh_smoothing.h"

namespace rfsmooth::bench::peers {

SmoothedMesh cgal_smooth_shape(const double* xyz, std::size_t n, const std::uint32_t* faces, std::size_t m,
                               double time) {
  using Point = CGAL::Simple_cartesian<double>::Point_3;
  using Mesh = CGAL::Surface_mesh<Point>;
  Mesh mesh;
  for (std::size_t i = 0; i < n; ++i) mesh.add_vertex(Point(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]));
  for (std::size_t f = 0; f < m; ++f)
    mesh.add_face(Mesh::Vertex_index(faces[3 * f]), Mesh::Vertex_index(faces[3 * f + 1]),
                  Mesh::Vertex_index(faces[3 * f + 2]));
  const auto start = std::chrono::steady_clock::now();
  CGAL::Polygon_mesh_processing::smooth_shape(mesh, time);
  SmoothedMesh out;
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (const auto v : mesh.vertices()) {
    const Point& p = mesh.point(v);
    out.xyz.insert(out.xyz.end(), {p.x(), p.y(), p.z()});
  }
  return out;
}

}  // namespace rfsmooth::bench::peers
