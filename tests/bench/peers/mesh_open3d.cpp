#include <chrono>

#include <open3d/geometry/TriangleMesh.h>

#include "tests/bench/peers/mesh_smoothing.h"

namespace rfsmooth::bench::peers {

namespace {

template <class Filter>
SmoothedMesh filtered(const double* xyz, std::size_t n, const std::uint32_t* faces, std::size_t m,
                      Filter&& filter) {
  open3d::geometry::TriangleMesh mesh;
  for (std::size_t i = 0; i < n; ++i) mesh.vertices_.emplace_back(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]);
  for (std::size_t f = 0; f < m; ++f)
    mesh.triangles_.emplace_back(int(faces[3 * f]), int(faces[3 * f + 1]), int(faces[3 * f + 2]));
  const auto start = std::chrono::steady_clock::now();
  const auto result = filter(mesh);
  SmoothedMesh out;
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (const auto& p : result->vertices_) out.xyz.insert(out.xyz.end(), {p.x(), p.y(), p.z()});
  return out;
}

}  // namespace

SmoothedMesh open3d_taubin(const double* xyz, std::size_t n, const std::uint32_t* faces, std::size_t m,
                           int iterations) {
  return filtered(xyz, n, faces, m, [&](const open3d::geometry::TriangleMesh& mesh) {
    return mesh.FilterSmoothTaubin(iterations);
  });
}

SmoothedMesh open3d_laplacian(const double* xyz, std::size_t n, const std::uint32_t* faces, std::size_t m,
                              int iterations) {
  return filtered(xyz, n, faces, m, [&](const open3d::geometry::TriangleMesh& mesh) {
    return mesh.FilterSmoothLaplacian(iterations, 0.5);
  });
}

}  // namespace rfsmooth::bench::peers
