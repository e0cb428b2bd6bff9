#include "pipeline/viewpoint.h"

#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "base/linear/symmetric_eigen.h"
#include "base/parallel.h"
#include "pipeline/io/table/text.h"
#include "rfs_mesh/levels.h"

namespace rfsmooth::pipeline {

using Eigen::Vector3d;

bool seen_from(const Vector3d& viewpoint, const double* xyz, std::size_t width, std::size_t height,
               const Context& context) {
  const auto ray = [&](std::size_t row, std::size_t column) {
    const double* p = xyz + 3 * (row * width + column);
    return Vector3d(p[0] - viewpoint[0], p[1] - viewpoint[1], p[2] - viewpoint[2]);
  };
  const auto of_row = [&](std::size_t row) {
    Eigen::Array2d sides(0, 0);  // triangles seen from one side, and from the other
    for (std::size_t column = 0; column + 1 < width; ++column) {
      const double volume = ray(row, column).dot(ray(row, column + 1).cross(ray(row + 1, column)));
      sides += Eigen::Array2d(volume > 0, volume < 0);
    }
    return sides;
  };
  const Eigen::Array2d sides = sum_over(context, height > 1 ? height - 1 : 0, Eigen::Array2d(0, 0), of_row);
  // Noise and edges of depth turn some triangles over.
  return sides.maxCoeff() > (1 - rfs_mesh::kLeastPart) * sides.sum();
}

std::optional<Vector3d> recorded_viewpoint(const io::Cloud& cloud, const double* xyz,
                                           const Context& context) {
  constexpr std::array<double, 7> kDefault = {0, 0, 0, 1, 0, 0, 0};
  std::array<double, 7> values{};
  std::string_view words = cloud.viewpoint;
  for (double& value : values) {
    const auto parsed = io::parse_real(io::next_word(words));
    if (!parsed || !std::isfinite(*parsed)) return std::nullopt;
    value = *parsed;
  }
  const Vector3d viewpoint(values[0], values[1], values[2]);
  if (values != kDefault) return viewpoint;
  if (cloud.organised() && seen_from(viewpoint, xyz, cloud.width, cloud.height, context)) return viewpoint;
  return std::nullopt;
}

Vector3d broadside(const Positions& points) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : points) mean += p / double(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3d& p : points) spread += (p - mean) * (p - mean).transpose() / double(points.size());
  const Eigen::Matrix3d axes = symmetric_eigen(spread).vectors;
  Vector3d thin = axes.col(0), middle = axes.col(1), wide = axes.col(2);
  // Eigenvectors have no sign: look from above and from the front (-y).
  const Vector3d preferred(0.2, -0.5, 1);
  for (Vector3d* axis : {&thin, &middle, &wide})
    if (axis->dot(preferred) < 0) *axis = -*axis;
  return -(thin + 0.45 * middle + 0.3 * wide).normalized();
}

}  // namespace rfsmooth::pipeline
