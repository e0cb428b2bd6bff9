/// Peers that smooth meshes: Open3D's filters and CGAL's smooth_shape. Plain arrays: their headers stay in
/// one .cpp each. The time returned is that of the library's call alone, in seconds; building its mesh is not
/// counted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rfsmooth::bench::peers {

struct SmoothedMesh {
  std::vector<double> xyz;  ///< n x 3
  double seconds = 0;
};

/// open3d::geometry::TriangleMesh::FilterSmoothTaubin, its default lambda 0.5 and mu -0.53.
SmoothedMesh open3d_taubin(const double* xyz, std::size_t n, const std::uint32_t* faces, std::size_t m,
                           int iterations);

/// open3d::geometry::TriangleMesh::FilterSmoothLaplacian, its default lambda 0.5.
SmoothedMesh open3d_laplacian(const double* xyz, std::size_t n, const std::uint32_t* faces, std::size_t m,
                              int iterations);

/// CGAL::Polygon_mesh_processing::smooth_shape, one implicit step of mean curvature flow with scaling back to
/// the input's volume (its default).
SmoothedMesh cgal_smooth_shape(const double* xyz, std::size_t n, const std::uint32_t* faces, std::size_t m,
                               double time);

}  // namespace rfsmooth::bench::peers
