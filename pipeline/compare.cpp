#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include <Eigen/Geometry>

#include <rfsmooth/compare.h>

#include "base/fail.h"
#include "base/parallel.h"
#include "pipeline/true_surface.h"
#include "rfs_mesh/points.h"

namespace rfsmooth {

using namespace pipeline;

using Eigen::Vector3d;

namespace {

constexpr double kDegrees = 57.29577951308232;
constexpr std::size_t kGrain = 256;  // a query costs microseconds

struct Points {
  Positions positions, normals;  // normals: empty or as many
};

/// The finite rows, relative to `origin`.
Points finite_points(const CloudView& view, const Vector3d& origin) {
  Points out;
  for (std::size_t i = 0; i < view.n; ++i) {
    const Vector3d p = Eigen::Map<const Vector3d>(view.xyz + 3 * i);
    if (!p.allFinite()) continue;
    out.positions.push_back(p - origin);
    if (view.normals != nullptr) out.normals.emplace_back(Eigen::Map<const Vector3d>(view.normals + 3 * i));
  }
  return out;
}

/// Centre of the bounding box and the largest distance from it, over finite rows.
struct Sphere {
  Vector3d centre = Vector3d::Zero();
  double radius = 0;
};

Sphere bounding_sphere(const double* xyz, std::size_t n, const Context& context) {
  const auto box = rfs_mesh::finite_box(xyz, n, context);
  if (!box) fail(ErrorCode::no_usable_points, "the truth has no finite point to measure against");
  Sphere sphere{box->low + (box->high - box->low) / 2, 0};
  for (std::size_t i = 0; i < n; ++i)
    if (const Vector3d p = Eigen::Map<const Vector3d>(xyz + 3 * i); p.allFinite())
      sphere.radius = std::max(sphere.radius, (p - sphere.centre).norm());
  return sphere;
}

TrueSurface true_surface(const MeshView& mesh, const Vector3d& origin) {
  if (mesh.m == 0)
    fail(ErrorCode::no_usable_points, "the true mesh has no faces; give a mesh or compare with a cloud");
  Positions vertices(mesh.n);
  for (std::size_t v = 0; v < mesh.n; ++v)
    vertices[v] = Eigen::Map<const Vector3d>(mesh.xyz + 3 * v) - origin;
  std::vector<Face> faces(mesh.faces, mesh.faces + mesh.m);
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (const Index v : faces[f])
      if (v >= mesh.n || !vertices[v].allFinite())
        fail(ErrorCode::input_unreadable,
             "face {} of the true mesh has a corner that is missing or not finite", f);
  // Vertices of no face may be NaN in files; they must not reach the welding sort.
  for (Vector3d& v : vertices)
    if (!v.allFinite()) v.setZero();
  return {std::move(vertices), std::move(faces)};
}

/// Degrees between two directions; NaN if one of them is none.
double angle(const Vector3d& a, const Vector3d& b, bool with_side) {
  const double scale = a.norm() * b.norm();
  if (!(scale > 0)) return std::nan("");
  const double cosine = with_side ? a.dot(b) : std::abs(a.dot(b));
  return kDegrees * std::atan2(a.cross(b).norm(), cosine);
}

/// The mean of the angles that exist.
std::optional<double> mean_angle(const std::vector<double>& angles) {
  double sum = 0;
  std::size_t count = 0;
  for (const double a : angles) {
    if (std::isnan(a)) continue;
    sum += a;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / double(count);
}

double mean_of(const Context& context, std::size_t n, const std::function<double(std::size_t)>& term) {
  return sum_over(context, n, 0.0, term, kGrain) / double(n);
}

/// \return the squared distances of the points.
std::vector<double> measure_surface(const Points& cloud, const PointTree& cloud_tree,
                                    const TrueSurface& surface, const CompareOptions& options,
                                    const Context& context, Measures& out) {
  const std::size_t n = cloud.positions.size();
  std::vector<double> squared(n), side(surface.closed() ? n : 0), angles(cloud.normals.size());
  for_each_index(
      context, n,
      [&](std::size_t i) {
        const Vector3d& p = cloud.positions[i];
        const TrueSurface::Hit hit = surface.nearest(p);
        squared[i] = hit.squared;
        if (surface.closed()) side[i] = surface.signed_distance(p, hit);
        if (!angles.empty())
          angles[i] = angle(cloud.normals[i], surface.outward_normal(hit.face), options.signed_normals);
      },
      kGrain);
  out.p2s_mean_square = mean_of(context, n, [&](std::size_t i) { return squared[i]; });
  out.p2s_root = std::sqrt(*out.p2s_mean_square);
  out.p2s_max = std::sqrt(*std::max_element(squared.begin(), squared.end()));
  out.normal_error = mean_angle(angles);
  if (surface.closed() && surface.volume() > 0) {
    out.mean_signed_distance = mean_of(context, n, [&](std::size_t i) { return side[i]; });
    out.shrinkage = *out.mean_signed_distance * surface.area() / surface.volume();
  }
  out.faces_to_cloud = mean_of(context, surface.face_count(), [&](std::size_t f) {
    return cloud_tree.squared_distance_from(surface.corners(f));
  });
  out.p2m = *out.p2s_mean_square + *out.faces_to_cloud;
  return squared;
}

/// \return the squared distances of the points.
std::vector<double> measure_clean_cloud(const Points& cloud, const PointTree& cloud_tree, const Points& clean,
                                        const CompareOptions& options, const Context& context,
                                        Measures& out) {
  const PointTree clean_tree(clean.positions);
  const std::size_t n = cloud.positions.size();
  const bool normals = !cloud.normals.empty() && !clean.normals.empty();
  std::vector<double> squared(n), angles(normals ? n : 0);
  for_each_index(
      context, n,
      [&](std::size_t i) {
        const PointTree::Hit hit = clean_tree.nearest(cloud.positions[i]);
        squared[i] = hit.squared;
        if (normals) angles[i] = angle(cloud.normals[i], clean.normals[hit.point], options.signed_normals);
      },
      kGrain);
  out.to_clean = mean_of(context, n, [&](std::size_t i) { return squared[i]; });
  out.from_clean = mean_of(context, clean.positions.size(),
                           [&](std::size_t i) { return cloud_tree.nearest(clean.positions[i]).squared; });
  out.chamfer = *out.to_clean + *out.from_clean;
  if (!out.normal_error) out.normal_error = mean_angle(angles);
  return squared;
}

/// The roots of what was measured of the finite rows, at their rows.
std::vector<double> deviations(const CloudView& cloud, const std::vector<double>& squared) {
  std::vector<double> out(cloud.n, std::nan(""));
  std::size_t next = 0;
  for (std::size_t i = 0; i < cloud.n; ++i)
    if (Eigen::Map<const Vector3d>(cloud.xyz + 3 * i).allFinite()) out[i] = std::sqrt(squared[next++]);
  return out;
}

void measure_evenness(const PointTree& tree, const Context& context, Measures& out) {
  const std::size_t n = tree.points().size();
  if (n < 2) return;
  std::vector<double> distance(n);
  for_each_index(
      context, n,
      [&](std::size_t i) { distance[i] = std::sqrt(tree.nearest(tree.points()[i], Index(i)).squared); },
      kGrain);
  const double mean = mean_of(context, n, [&](std::size_t i) { return distance[i]; });
  out.spacing = mean;
  if (mean > 0)
    out.evenness = std::sqrt(mean_of(context, n,
                                     [&](std::size_t i) {
                                       const double off = distance[i] - mean;
                                       return off * off;
                                     })) /
                   mean;
}

}  // namespace

Measures on_unit_sphere(const Measures& own_units, double radius) {
  Measures out = own_units;
  Measures::describe(out, [&](const MeasureInfo& info, std::optional<double>& value) {
    if (info.length_power > 0 && !(radius > 0))
      value.reset();
    else if (value)
      *value /= std::pow(radius, info.length_power);
  });
  return out;
}

Result<CompareReport> compare(const CloudView& cloud, const Truth& truth, const CompareOptions& options,
                              const Context& context) {
  if (!truth.mesh && !truth.cloud) throw std::invalid_argument("compare needs a true mesh or a true cloud");
  return guarded([&] {
    CompareReport report;
    in_arena(context, [&] {
      const Sphere sphere = truth.cloud ? bounding_sphere(truth.cloud->xyz, truth.cloud->n, context)
                                        : bounding_sphere(truth.mesh->xyz, truth.mesh->n, context);
      const Points points = finite_points(cloud, sphere.centre);
      report.points = cloud.n;
      report.finite = points.positions.size();
      report.radius = sphere.radius;
      if (report.finite == 0) fail(ErrorCode::no_usable_points, "the cloud has no finite point to measure");
      const PointTree tree(points.positions);
      context.report("compare", 0);
      if (truth.mesh) {
        const TrueSurface surface = true_surface(*truth.mesh, sphere.centre);
        report.truth_faces = surface.face_count();
        report.truth_closed = surface.closed();
        const auto squared = measure_surface(points, tree, surface, options, context, report.own_units);
        report.deviation = deviations(cloud, squared);
        context.report("compare", 0.5);
      }
      if (truth.cloud) {
        const Points clean = finite_points(*truth.cloud, sphere.centre);
        report.truth_points = clean.positions.size();
        const auto squared = measure_clean_cloud(points, tree, clean, options, context, report.own_units);
        if (!truth.mesh) report.deviation = deviations(cloud, squared);
        context.report("compare", 0.8);
      }
      measure_evenness(tree, context, report.own_units);
      context.report("compare", 1);
    });
    return report;
  });
}

}  // namespace rfsmooth
