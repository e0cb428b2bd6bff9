/// Solids on a plan of square cells: cube, plate, L-part, or any other block with right angles.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "clouds/shapes/grid_mesh.h"
#include "clouds/shapes/shapes.h"

namespace rfsmooth::clouds {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// The nearest point of the segment ab to q.
template <class V>
V on_segment(const V& q, const V& a, const V& b) {
  const V ab = b - a;
  return a + std::min(1.0, std::max(0.0, ab.dot(q - a) / ab.squaredNorm())) * ab;
}

class Prism : public Shape {
 public:
  Prism(const std::vector<std::string_view>& plan, double cell, double height)
      : cell_(cell), half_(height / 2), rows_(int(plan.size())), columns_(int(plan.front().size())) {
    for (const std::string_view row : plan) plan_.emplace_back(row);
    for (int r = 0; r < rows_; ++r)
      for (int c = 0; c < columns_; ++c) {
        if (!solid(r, c)) continue;
        cells_.push_back({r, c});
        // Walls run so that the material is on their left, seen from above.
        if (!solid(r - 1, c)) walls_.push_back({corner(r, c), corner(r, c + 1)});
        if (!solid(r, c + 1)) walls_.push_back({corner(r, c + 1), corner(r + 1, c + 1)});
        if (!solid(r + 1, c)) walls_.push_back({corner(r + 1, c + 1), corner(r + 1, c)});
        if (!solid(r, c - 1)) walls_.push_back({corner(r + 1, c), corner(r, c)});
      }
    for (int r = 0; r <= rows_; ++r)
      for (int c = 0; c <= columns_; ++c) {
        const int around =
            int(solid(r - 1, c - 1)) + int(solid(r - 1, c)) + int(solid(r, c - 1)) + int(solid(r, c));
        if (around % 2 == 1) pillars_.push_back(corner(r, c));
      }
  }

  double signed_distance(const Vector3d& p) const override {
    const double side = nearest_wall(flat(p)).signed_distance, cap = std::abs(p[2]) - half_;
    return std::min(std::max(side, cap), 0.0) + std::hypot(std::max(side, 0.0), std::max(cap, 0.0));
  }

  Vector3d normal(const Vector3d& p) const override {
    const Side side = nearest_wall(flat(p));
    const double cap = std::abs(p[2]) - half_;
    const Vector3d up(0, 0, p[2] < 0 ? -1 : 1), outward(side.normal[0], side.normal[1], 0);
    return cap > side.signed_distance ? up : outward;  // beyond an edge: the face it lies further in front of
  }

  double edge_distance(const Vector3d& p) const override {
    double squared = std::numeric_limits<double>::infinity();
    const auto to_segment = [&](const Vector2d& a, double za, const Vector2d& b, double zb) {
      const Vector3d from(a[0], a[1], za), to(b[0], b[1], zb);
      squared = std::min(squared, (on_segment<Vector3d>(p, from, to) - p).squaredNorm());
    };
    for (const Wall& wall : walls_)
      for (const double z : {-half_, half_}) to_segment(wall.a, z, wall.b, z);
    for (const Vector2d& at : pillars_) to_segment(at, -half_, at, half_);
    return std::sqrt(squared);
  }

  Vector3d surface_point(Random& random) const override {
    const double caps = 2 * double(cells_.size()) * cell_ * cell_;
    const double where = random.uniform() * area();
    const double u = random.uniform();
    const double v = random.uniform();
    if (where < caps) {
      const auto index = std::min(std::size_t(where / (cell_ * cell_)), 2 * cells_.size() - 1);
      const auto [r, c] = cells_[index / 2];
      const Vector2d low = corner(r, c);
      return {low[0] + u * cell_, low[1] + v * cell_, index % 2 == 0 ? half_ : -half_};
    }
    const auto index = std::min(std::size_t((where - caps) / (cell_ * 2 * half_)), walls_.size() - 1);
    const Vector2d at = walls_[index].a + u * (walls_[index].b - walls_[index].a);
    return {at[0], at[1], -half_ + 2 * half_ * v};
  }

  double area() const override {
    return 2 * double(cells_.size()) * cell_ * cell_ + double(walls_.size()) * cell_ * 2 * half_;
  }
  std::optional<double> volume() const override { return double(cells_.size()) * cell_ * cell_ * 2 * half_; }
  double radius() const override {
    return Vector3d(0.5 * columns_ * cell_, 0.5 * rows_ * cell_, half_).norm();
  }

  Mesh mesh(double edge) const override {
    const int across = std::max(1, int(std::ceil(cell_ / edge)));
    const int up = std::max(1, int(std::ceil(2 * half_ / edge)));
    GridMesh grid;
    // Lattice coordinates keep shared corners bit-equal.
    const auto at = [&](int x, int y, int z) {
      return grid.vertex({cell_ * (double(x) / across - 0.5 * columns_),
                          cell_ * (double(y) / across - 0.5 * rows_), half_ * (2.0 * z / up - 1)});
    };
    for (const auto& [r, c] : cells_)
      for (int i = c * across; i < (c + 1) * across; ++i)
        for (int j = r * across; j < (r + 1) * across; ++j)
          for (const int z : {0, up})
            grid.quad(at(i, j, z), at(i + 1, j, z), at(i + 1, j + 1, z), at(i, j + 1, z), z == 0);
    for (const Wall& wall : walls_) {
      const int xa = int(std::lround((wall.a[0] / cell_ + 0.5 * columns_) * across));
      const int ya = int(std::lround((wall.a[1] / cell_ + 0.5 * rows_) * across));
      const int dx = int(std::lround((wall.b - wall.a)[0] / cell_)),
                dy = int(std::lround((wall.b - wall.a)[1] / cell_));
      for (int k = 0; k < across; ++k)
        for (int z = 0; z < up; ++z) {
          const int x = xa + k * dx, y = ya + k * dy;
          grid.quad(at(x, y, z), at(x + dx, y + dy, z), at(x + dx, y + dy, z + 1), at(x, y, z + 1));
        }
    }
    return grid.take();
  }

 private:
  struct Wall {
    Vector2d a, b;
  };
  struct Side {
    double signed_distance = 0;
    Vector2d normal = Vector2d::Zero();
  };
  struct Cell {
    int row, column;
  };

  static Vector2d flat(const Vector3d& p) { return {p[0], p[1]}; }
  bool solid(int r, int c) const {
    return r >= 0 && c >= 0 && r < rows_ && c < columns_ && plan_[std::size_t(r)][std::size_t(c)] == '#';
  }
  Vector2d corner(int r, int c) const { return {cell_ * (c - 0.5 * columns_), cell_ * (r - 0.5 * rows_)}; }

  Side nearest_wall(const Vector2d& q) const {
    double squared = std::numeric_limits<double>::infinity();
    Side side;
    for (const Wall& wall : walls_) {
      const double d = (on_segment<Vector2d>(q, wall.a, wall.b) - q).squaredNorm();
      const Vector2d along = wall.b - wall.a, normal = Vector2d(along[1], -along[0]) / cell_;
      // Of two walls that meet at the nearest corner, the one that q is further in front of.
      const bool tie = d == squared && normal.dot(q - wall.a) > side.normal.dot(q - wall.a);
      if (d < squared || tie) {
        squared = d;
        side.normal = normal;
      }
    }
    const int r = int(std::floor(q[1] / cell_ + 0.5 * rows_)),
              c = int(std::floor(q[0] / cell_ + 0.5 * columns_));
    side.signed_distance = solid(r, c) ? -std::sqrt(squared) : std::sqrt(squared);
    return side;
  }

  double cell_, half_;
  int rows_, columns_;
  std::vector<std::string> plan_;
  std::vector<Cell> cells_;
  std::vector<Wall> walls_;
  std::vector<Vector2d> pillars_;  ///< where two walls meet at an angle
};

}  // namespace

std::unique_ptr<Shape> make_prism(const std::vector<std::string_view>& plan, double cell, double height) {
  return std::make_unique<Prism>(plan, cell, height);
}

}  // namespace rfsmooth::clouds
