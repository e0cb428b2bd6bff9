#include "clouds/render/rasterizer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rfsmooth::render {

using Eigen::Vector3d;

Rasterizer::Rasterizer(int width, int height, const Color& background)
    : image_(width, height, background),
      depth_(std::size_t(width) * std::size_t(height), -std::numeric_limits<float>::infinity()) {}

void Rasterizer::put(int x, int y, double depth, const Color& color) {
  if (x < 0 || y < 0 || x >= image_.width || y >= image_.height) return;
  float& there = depth_[std::size_t(y) * std::size_t(image_.width) + std::size_t(x)];
  if (float(depth) <= there) return;
  there = float(depth);
  image_.at(x, y) = color;
}

namespace {

/// First and last pixel whose centre lies in [low, high], within [0, size).
std::pair<int, int> pixels(double low, double high, int size) {
  low = std::clamp(low, -1.0, double(size) + 1);
  high = std::clamp(high, -1.0, double(size) + 1);
  return {std::max(0, int(std::ceil(low - 0.5))), std::min(size - 1, int(std::floor(high - 0.5)))};
}

}  // namespace

void Rasterizer::splat(const Vector3d& centre, const Vector3d& normal, double radius, const Color& color) {
  const Vector3d n = normal[2] < 0 ? Vector3d(-normal) : normal;
  const double facing = std::max(n[2], 0.2);  // edge-on discs keep some width
  const auto [x0, x1] = pixels(centre[0] - radius, centre[0] + radius, image_.width);
  const auto [y0, y1] = pixels(centre[1] - radius, centre[1] + radius, image_.height);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const double dx = x + 0.5 - centre[0], dy = y + 0.5 - centre[1];
      const double dz = -(n[0] * dx - n[1] * dy) / facing;  // y runs down
      if (dx * dx + dy * dy + dz * dz <= radius * radius) put(x, y, centre[2] + dz, color);
    }
  // Never less than a pixel.
  put(int(std::floor(centre[0])), int(std::floor(centre[1])), centre[2], color);
}

void Rasterizer::triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Color& color) {
  const double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  if (area == 0) return;
  const auto [x0, x1] = pixels(std::min({a[0], b[0], c[0]}), std::max({a[0], b[0], c[0]}), image_.width);
  const auto [y0, y1] = pixels(std::min({a[1], b[1], c[1]}), std::max({a[1], b[1], c[1]}), image_.height);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const double px = x + 0.5, py = y + 0.5;
      const double u = ((px - a[0]) * (c[1] - a[1]) - (py - a[1]) * (c[0] - a[0])) / area;
      const double v = ((b[0] - a[0]) * (py - a[1]) - (b[1] - a[1]) * (px - a[0])) / area;
      if (u < 0 || v < 0 || u + v > 1) continue;
      put(x, y, a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2]), color);
    }
}

void Rasterizer::line(const Vector3d& a, const Vector3d& b, int thickness, const Color& color) {
  const double reach = 10.0 * (image_.width + image_.height);
  for (const Vector3d& end : {a, b})
    if (!(std::abs(end[0]) < reach && std::abs(end[1]) < reach)) return;  // far outside the picture
  const int steps = std::max(1, int(std::ceil(2 * std::max(std::abs(b[0] - a[0]), std::abs(b[1] - a[1])))));
  const int half = thickness / 2;
  for (int k = 0; k <= steps; ++k) {
    const Vector3d p = a + (b - a) * (double(k) / steps);
    for (int dy = -half; dy <= half; ++dy)
      for (int dx = -half; dx <= half; ++dx)
        put(int(std::floor(p[0])) + dx, int(std::floor(p[1])) + dy, p[2] + 1.5, color);
  }
}

Color shade(const Color& color, const Vector3d& normal) {
  const Vector3d n = normal[2] < 0 ? Vector3d(-normal) : normal;
  static const Vector3d kKey = Vector3d(-0.62, 0.58, 0.53).normalized(),
                        kFill = Vector3d(0.75, -0.1, 0.65).normalized();
  const double light = 0.26 + 0.70 * std::max(0.0, n.dot(kKey)) + 0.30 * std::max(0.0, n.dot(kFill));
  return (color * float(std::min(light, 1.05))).cwiseMin(1.0F);
}

Color scale_color(double t) {
  // Five anchors of matplotlib's viridis, straight lines between them.
  static const std::array<Color, 5> kAnchors = {Color(0.267F, 0.005F, 0.329F), Color(0.229F, 0.322F, 0.546F),
                                                Color(0.128F, 0.567F, 0.551F), Color(0.369F, 0.789F, 0.383F),
                                                Color(0.993F, 0.906F, 0.144F)};
  if (!std::isfinite(t)) return Color::Constant(0.5F);
  const double at = 4 * std::clamp(t, 0.0, 1.0);
  const auto k = std::min<std::size_t>(3, std::size_t(at));
  return kAnchors[k] + float(at - double(k)) * (kAnchors[k + 1] - kAnchors[k]);
}

}  // namespace rfsmooth::render
