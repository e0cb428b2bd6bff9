#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <open3d/geometry/PointCloud.h>
#include <open3d/geometry/TriangleMesh.h>

#include <rfsmooth/open3d/surface.h>

#include "base/fail.h"

namespace rfsmooth::open3d {

namespace {

using ::open3d::geometry::PointCloud;
using ::open3d::geometry::TriangleMesh;

PointCloud to_open3d(const Positions& points, const Positions& normals, double spacing) {
  if (points.size() != normals.size()) throw std::invalid_argument("one normal per point is needed");
  if (!(spacing > 0)) throw std::invalid_argument("the spacing must be positive");
  PointCloud cloud(points);
  cloud.normals_ = normals;
  return cloud;
}

/// \throw Failure if the method found no surface.
Mesh from_open3d(const TriangleMesh& surface, const char* method, const Context& context) {
  if (surface.triangles_.empty())
    fail(ErrorCode::no_usable_points, "{} finds no surface in these points", method);
  Mesh mesh;
  mesh.positions = surface.vertices_;
  mesh.faces.reserve(surface.triangles_.size());
  for (const Eigen::Vector3i& t : surface.triangles_)
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
      mesh.faces.push_back({Index(t[0]), Index(t[1]), Index(t[2])});
  rebuild_adjacency(mesh, context);
  return mesh;
}

/// Poisson's octree depth at which a cell is about one spacing wide.
std::size_t depth_for(const PointCloud& cloud, double spacing) {
  const double extent = (cloud.GetMaxBound() - cloud.GetMinBound()).maxCoeff();
  constexpr double kShallowest = 4, kDeepest = 12;  // 16 cells across; memory beyond 4096 cells across
  return std::size_t(
      std::clamp(std::round(std::log2(std::max(extent / spacing, 1.0))), kShallowest, kDeepest));
}

}  // namespace

Result<Mesh> poisson(const Positions& points, const Positions& normals, double spacing,
                     const Context& context) {
  const PointCloud cloud = to_open3d(points, normals, spacing);
  return guarded([&] {
    context.report("poisson", 0);
    constexpr int kThreads = 1;  // with more its sums, and so the bytes, depend on who comes first
    const auto surface = std::get<0>(TriangleMesh::CreateFromPointCloudPoisson(
        cloud, depth_for(cloud, spacing), 0.0F, 1.1F, false, kThreads));
    return from_open3d(*surface, "Poisson reconstruction", context);
  });
}

Result<Mesh> ball_pivoting(const Positions& points, const Positions& normals, double spacing,
                           const Context& context) {
  const PointCloud cloud = to_open3d(points, normals, spacing);
  return guarded([&] {
    context.report("ball-pivoting", 0);
    const auto surface =
        TriangleMesh::CreateFromPointCloudBallPivoting(cloud, {spacing, 2 * spacing, 4 * spacing});
    return from_open3d(*surface, "ball pivoting", context);
  });
}

std::vector<SurfaceMethod> surface_methods() {
  const auto adapted = [](const auto& method) {
    return [method](const SurfaceInput& input, const Context& context) {
      return method(input.points, input.normals, input.spacing, context);
    };
  };
  return {{"poisson", true, adapted(poisson)}, {"ball-pivoting", false, adapted(ball_pivoting)}};
}

}  // namespace rfsmooth::open3d
