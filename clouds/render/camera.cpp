#include "clouds/render/camera.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "pipeline/viewpoint.h"

namespace rfsmooth::render {

using Eigen::Vector3d;

namespace {

std::pair<double, double> range_without_strays(std::vector<double> values) {
  const auto cut = std::ptrdiff_t(values.size() / 66);
  const auto low = values.begin() + cut, high = values.end() - 1 - cut;
  std::nth_element(values.begin(), low, values.end());
  const double least = *low;
  std::nth_element(values.begin(), high, values.end());
  return {least, *high};
}

}  // namespace

Camera::Camera(const Positions& points, const CameraOptions& options, int width, int height)
    : middle_(0.5 * width, 0.5 * height) {
  toward_ = -options.direction.value_or(points.empty() ? Vector3d(0, 1, 0) : pipeline::broadside(points))
                 .normalized();
  Vector3d up = options.up.value_or(std::abs(toward_[2]) > 0.98 ? Vector3d::UnitY() : Vector3d::UnitZ());
  if (up.cross(toward_).norm() < 1e-6 * up.norm()) up = toward_.unitOrthogonal();
  right_ = up.cross(toward_).normalized();
  up_ = toward_.cross(right_);
  if (points.empty()) return;
  const auto range = [&](const Vector3d& axis) {
    std::vector<double> along(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) along[i] = axis.dot(points[i]);
    return range_without_strays(std::move(along));
  };
  const auto [left, right] = range(right_);
  const auto [bottom, top] = range(up_);
  const auto [back, front] = range(toward_);
  constexpr double kMargin = 1.15;  // also for what was cut off the ends
  const double wide = std::max(right - left, 1e-12), tall = std::max(top - bottom, 1e-12);
  const double full = std::min(width / (kMargin * wide), height / (kMargin * tall));
  scale_ = full * options.zoom;
  const double x = 0.5 * (left + right) + (options.centre_x - 0.5) * width / full;
  const double y = 0.5 * (bottom + top) - (options.centre_y - 0.5) * height / full;
  centre_ = x * right_ + y * up_ + 0.5 * (back + front) * toward_;
}

}  // namespace rfsmooth::render
