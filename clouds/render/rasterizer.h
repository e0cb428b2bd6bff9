/// Draws splats, triangles and lines into a picture with a depth buffer.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "clouds/render/image.h"

namespace rfsmooth::render {

/// Coordinates are the camera's: pixels, y down, depth toward the viewer. What is nearer hides what is
/// further.
class Rasterizer {
 public:
  Rasterizer(int width, int height, const Color& background);

  /// A disc of `radius` pixels that faces along `normal` (right, up, toward the viewer; turned to the viewer
  /// if need be).
  void splat(const Eigen::Vector3d& centre, const Eigen::Vector3d& normal, double radius, const Color& color);
  void triangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                const Color& color);
  /// `thickness` pixels wide; drawn a little in front of surfaces at the same depth.
  void line(const Eigen::Vector3d& a, const Eigen::Vector3d& b, int thickness, const Color& color);

  const Image& image() const { return image_; }

 private:
  void put(int x, int y, double depth, const Color& color);
  Image image_;
  std::vector<float> depth_;
};

/// A matte surface under a raking light from the upper left, so that small bumps show. `normal` as in splat.
Color shade(const Color& color, const Eigen::Vector3d& normal);

/// From dark blue over green to yellow for t in [0, 1]: even steps of t look even, also in grey. Grey where t
/// is not finite.
Color scale_color(double t);

}  // namespace rfsmooth::render
