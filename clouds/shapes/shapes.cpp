#include "clouds/shapes/shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "clouds/shapes/grid_mesh.h"

namespace rfsmooth::clouds {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;

double Shape::edge_distance(const Vector3d&) const {
  return std::numeric_limits<double>::infinity();
}

namespace {

class Sphere : public Shape {
 public:
  explicit Sphere(double density_ratio) : ratio_(density_ratio) {}
  double signed_distance(const Vector3d& p) const override { return p.norm() - 1; }
  Vector3d normal(const Vector3d& p) const override {
    return p.squaredNorm() > 0 ? p.normalized() : Vector3d(Vector3d::UnitZ());
  }
  double density(const Vector3d& p) const override { return p[2] < 0 ? 1 / ratio_ : 1; }
  Vector3d surface_point(Random& random) const override {
    for (;;) {
      Vector3d p = random.direction();
      if (random.uniform() < density(p)) return p;
    }
  }
  double area() const override { return 4 * kPi; }
  std::optional<double> volume() const override { return 4 * kPi / 3; }
  double radius() const override { return 1; }

  /// An octahedron, its faces divided evenly and blown up.
  Mesh mesh(double edge) const override {
    const int steps = std::max(2, int(std::ceil(0.5 * kPi / edge)));
    GridMesh grid;
    for (const double sx : {-1.0, 1.0})
      for (const double sy : {-1.0, 1.0})
        for (const double sz : {-1.0, 1.0}) {
          const auto at = [&](int i, int j) {
            return grid.vertex(Vector3d(sx * i, sy * j, sz * (steps - i - j)).normalized());
          };
          const bool flip = sx * sy * sz < 0;
          for (int i = 0; i < steps; ++i)
            for (int j = 0; i + j < steps; ++j) {
              grid.triangle(at(i, j), at(i + 1, j), at(i, j + 1), flip);
              if (i + j + 1 < steps) grid.triangle(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1), flip);
            }
        }
    return grid.take();
  }

 private:
  double ratio_;
};

class Torus : public Shape {
 public:
  Torus(double ring, double tube) : ring_(ring), tube_(tube) {}
  double signed_distance(const Vector3d& p) const override {
    return std::hypot(std::hypot(p[0], p[1]) - ring_, p[2]) - tube_;
  }
  Vector3d normal(const Vector3d& p) const override {
    const double across = std::hypot(p[0], p[1]);
    const Vector2d outward = across > 0 ? Vector2d(p[0] / across, p[1] / across) : Vector2d(1, 0);
    const Vector2d section(across - ring_, p[2]);
    const Vector2d n = section.squaredNorm() > 0 ? section.normalized() : Vector2d(0, 1);
    return {n[0] * outward[0], n[0] * outward[1], n[1]};
  }
  Vector3d surface_point(Random& random) const override {
    for (;;) {
      const Vector2d section = random.circle();  // (cos v, sin v)
      const double across = ring_ + tube_ * section[0];
      if (random.uniform() * (ring_ + tube_) > across) continue;  // area element ~ across
      const Vector2d around = random.circle();
      return {across * around[0], across * around[1], tube_ * section[1]};
    }
  }
  double area() const override { return 4 * kPi * kPi * ring_ * tube_; }
  std::optional<double> volume() const override { return 2 * kPi * kPi * ring_ * tube_ * tube_; }
  double radius() const override { return ring_ + tube_; }
  Mesh mesh(double edge) const override {
    const int around = std::max(3, int(std::ceil(2 * kPi * (ring_ + tube_) / edge)));
    const int across = std::max(3, int(std::ceil(2 * kPi * tube_ / edge)));
    GridMesh grid;
    const auto at = [&](int i, int j) {
      const double u = 2 * kPi * (i % around) / around, v = 2 * kPi * (j % across) / across;
      const double r = ring_ + tube_ * std::cos(v);
      return grid.vertex({r * std::cos(u), r * std::sin(u), tube_ * std::sin(v)});
    };
    for (int i = 0; i < around; ++i)
      for (int j = 0; j < across; ++j) grid.quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    return grid.take();
  }

 private:
  double ring_, tube_;
};

/// A height field; distances by Newton steps from the best of a few starts.
class WavySheet : public Shape {
 public:
  WavySheet() {
    // Midpoint rule: the integrand is smooth, 400 x 400 cells give 1e-6.
    constexpr int kCells = 400;
    for (int i = 0; i < kCells; ++i)
      for (int j = 0; j < kCells; ++j)
        area_ += stretch(-1 + (2 * i + 1.0) / kCells, -1 + (2 * j + 1.0) / kCells) * 4 / (kCells * kCells);
  }
  double signed_distance(const Vector3d& p) const override {
    const Vector3d on = nearest(p);
    return std::copysign((p - on).norm(), surface_normal(on).dot(p - on));
  }
  Vector3d normal(const Vector3d& p) const override { return surface_normal(nearest(p)); }
  double edge_distance(const Vector3d& p) const override {
    double squared = std::numeric_limits<double>::infinity();
    constexpr int kSteps = 400;
    for (int side = 0; side < 4; ++side)
      for (int k = 0; k < kSteps; ++k) {
        const Vector3d a = rim(side, -1 + 2.0 * k / kSteps), b = rim(side, -1 + 2.0 * (k + 1) / kSteps);
        const double t = std::min(1.0, std::max(0.0, (p - a).dot(b - a) / (b - a).squaredNorm()));
        squared = std::min(squared, (a + t * (b - a) - p).squaredNorm());
      }
    return std::sqrt(squared);
  }
  double clearance(const Vector3d& p) const override {
    const double gap = std::abs(p[2] - height(p[0], p[1])) / std::sqrt(1 + kSlope * kSlope);
    const Vector3d outside = (p.cwiseAbs() - Vector3d(1, 1, kHeight)).cwiseMax(0.0);
    return std::max(gap, outside.norm());
  }
  Vector3d surface_point(Random& random) const override {
    for (;;) {
      const double x = random.uniform(-1, 1);
      const double y = random.uniform(-1, 1);
      if (random.uniform() * std::sqrt(1 + kSlope * kSlope) < stretch(x, y)) return {x, y, height(x, y)};
    }
  }
  double area() const override { return area_; }
  std::optional<double> volume() const override { return std::nullopt; }
  double radius() const override { return std::sqrt(2 + kHeight * kHeight); }
  Mesh mesh(double edge) const override {
    const int steps = std::max(2, int(std::ceil(2 / edge)));
    GridMesh grid;
    const auto at = [&](int i, int j) {
      const double x = -1 + 2.0 * i / steps, y = -1 + 2.0 * j / steps;
      return grid.vertex({x, y, height(x, y)});
    };
    for (int i = 0; i < steps; ++i)
      for (int j = 0; j < steps; ++j) grid.quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    return grid.take();
  }

 private:
  static constexpr double kHeight = 0.15, kWaveX = 4, kWaveY = 3;
  static constexpr double kSlope = kHeight * kWaveX + kHeight * kWaveY;  // no slope is steeper

  static double height(double x, double y) { return kHeight * std::sin(kWaveX * x) * std::cos(kWaveY * y); }
  static Vector2d slope(double x, double y) {
    return {kHeight * kWaveX * std::cos(kWaveX * x) * std::cos(kWaveY * y),
            -kHeight * kWaveY * std::sin(kWaveX * x) * std::sin(kWaveY * y)};
  }
  static double stretch(double x, double y) { return std::sqrt(1 + slope(x, y).squaredNorm()); }
  static Vector3d surface_normal(const Vector3d& on) {
    const Vector2d g = slope(on[0], on[1]);
    return Vector3d(-g[0], -g[1], 1).normalized();
  }
  static Vector3d rim(int side, double t) {
    const double x = side == 0 ? -1 : side == 1 ? 1 : t, y = side == 2 ? -1 : side == 3 ? 1 : t;
    return {x, y, height(x, y)};
  }

  /// Projected Newton on |p - (x, y, f)|^2 over the square, from the nearest node of a coarse grid around p.
  static Vector3d nearest(const Vector3d& p) {
    const auto clamp = [](double v) { return std::min(1.0, std::max(-1.0, v)); };
    Vector2d best(clamp(p[0]), clamp(p[1]));
    const auto squared = [&](const Vector2d& u) {
      return (p - Vector3d(u[0], u[1], height(u[0], u[1]))).squaredNorm();
    };
    const Vector2d centre = best;
    const double reach = std::sqrt(squared(best));  // no nearer point lies further away than this
    constexpr int kGrid = 12;
    for (int i = -kGrid; i <= kGrid; ++i)
      for (int j = -kGrid; j <= kGrid; ++j) {
        const Vector2d u(clamp(centre[0] + reach * i / kGrid), clamp(centre[1] + reach * j / kGrid));
        if (squared(u) < squared(best)) best = u;
      }
    for (int step = 0; step < 60; ++step) {
      const double x = best[0], y = best[1], f = height(x, y);
      const Vector2d g = slope(x, y);
      const double gap = p[2] - f;
      const Vector2d gradient(x - p[0] - gap * g[0], y - p[1] - gap * g[1]);
      // Gauss-Newton plus curvature where that keeps the matrix positive; a coordinate pressed against the
      // rim stays.
      const double fxx = -kWaveX * kWaveX * f, fyy = -kWaveY * kWaveY * f;
      const double fxy = -kHeight * kWaveX * kWaveY * std::cos(kWaveX * x) * std::sin(kWaveY * y);
      double hxx = 1 + g[0] * g[0] - gap * fxx, hyy = 1 + g[1] * g[1] - gap * fyy,
             hxy = g[0] * g[1] - gap * fxy;
      const bool stuck_x = (x <= -1 && gradient[0] > 0) || (x >= 1 && gradient[0] < 0);
      const bool stuck_y = (y <= -1 && gradient[1] > 0) || (y >= 1 && gradient[1] < 0);
      if (hxx <= 0 || hyy <= 0 || hxx * hyy - hxy * hxy <= 0) {
        hxx = hyy = 3;
        hxy = 0;
      }
      Vector2d move;
      if (stuck_x || stuck_y) {
        move = {stuck_x ? 0 : -gradient[0] / hxx, stuck_y ? 0 : -gradient[1] / hyy};
      } else {
        const double determinant = hxx * hyy - hxy * hxy;
        move = {-(hyy * gradient[0] - hxy * gradient[1]) / determinant,
                -(hxx * gradient[1] - hxy * gradient[0]) / determinant};
      }
      double length = 1;
      Vector2d next = best;
      for (int halving = 0; halving < 30; ++halving, length /= 2) {
        const Vector2d u(clamp(x + length * move[0]), clamp(y + length * move[1]));
        if (squared(u) < squared(best)) {
          next = u;
          break;
        }
      }
      if (next == best) break;
      best = next;
    }
    return {best[0], best[1], height(best[0], best[1])};
  }

  double area_ = 0;
};

}  // namespace

std::unique_ptr<Shape> make_sphere(double density_ratio) {
  return std::make_unique<Sphere>(density_ratio);
}

std::unique_ptr<Shape> make_torus(double ring, double tube) {
  return std::make_unique<Torus>(ring, tube);
}

std::unique_ptr<Shape> make_cube() {
  return make_prism({"#"}, 2, 2);
}

std::unique_ptr<Shape> make_l_part() {
  return make_prism({"##...", "##...", "##...", "#####", "#####"}, 0.4, 1);
}

std::unique_ptr<Shape> make_plate(double thickness) {
  return make_prism({"#####", "#####", "#####", "#####"}, 0.4, thickness);
}

std::unique_ptr<Shape> make_wavy_sheet() {
  return std::make_unique<WavySheet>();
}

const std::vector<std::string_view>& shape_names() {
  static const std::vector<std::string_view> names = {
      "sphere", "torus", "cube", "l_part", "plate", "wavy_sheet", "two_density_sphere"};
  return names;
}

std::unique_ptr<Shape> make_shape(std::string_view name) {
  if (name == "sphere") return make_sphere();
  if (name == "torus") return make_torus();
  if (name == "cube") return make_cube();
  if (name == "l_part") return make_l_part();
  if (name == "plate") return make_plate();
  if (name == "wavy_sheet") return make_wavy_sheet();
  if (name == "two_density_sphere") return make_sphere(9);
  return nullptr;
}

}  // namespace rfsmooth::clouds
