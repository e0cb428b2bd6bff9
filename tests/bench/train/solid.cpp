#include "tests/bench/train/solid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Dense>

namespace rfsmooth::bench {

using Eigen::Vector3d;
using Eigen::Vector3i;

namespace {

/// The values at the corners of a grid and the surface between them.
class Contour {
 public:
  Contour(const Solid& solid, const Vector3d& low, const Vector3d& high, double cell)
      : solid_(solid), low_(low), cell_(cell) {
    for (int axis = 0; axis < 3; ++axis) size_[axis] = 2 + int(std::ceil((high[axis] - low[axis]) / cell));
    value_.resize(std::size_t(size_[0]) * std::size_t(size_[1]) * std::size_t(size_[2]));
    vertex_.assign(value_.size(), kNone);
    each([&](const Vector3i& at) { value_[row(at)] = float(solid_(place(at))); });
  }

  Mesh mesh() {
    each([&](const Vector3i& at) {
      if ((at.array() + 1 < size_.array()).all()) put_vertex(at);
    });
    each([&](const Vector3i& at) {
      for (int axis = 0; axis < 3; ++axis) put_face(at, axis);
    });
    return std::move(mesh_);
  }

 private:
  template <class Visit>
  void each(Visit&& visit) const {
    for (int x = 0; x < size_[0]; ++x)
      for (int y = 0; y < size_[1]; ++y)
        for (int z = 0; z < size_[2]; ++z) visit(Vector3i(x, y, z));
  }

  std::size_t row(const Vector3i& at) const {
    return (std::size_t(at[0]) * std::size_t(size_[1]) + std::size_t(at[1])) * std::size_t(size_[2]) +
           std::size_t(at[2]);
  }
  Vector3d place(const Vector3i& at) const { return low_ + cell_ * at.cast<double>(); }
  bool inside(const Vector3i& at) const { return value_[row(at)] < 0; }

  Vector3d gradient(const Vector3d& p) const {
    const double step = 1e-4 * cell_;
    Vector3d g;
    for (int axis = 0; axis < 3; ++axis)
      g[axis] = solid_(p + step * Vector3d::Unit(axis)) - solid_(p - step * Vector3d::Unit(axis));
    return g.stableNormalized();
  }

  /// Where the surface meets the edge between two corners.
  Vector3d crossing(Vector3d a, Vector3d b) const {
    const bool inside_a = solid_(a) < 0;
    constexpr int kHalvings = 12;
    for (int k = 0; k < kHalvings; ++k) {
      const Vector3d middle = (a + b) / 2;
      ((solid_(middle) < 0) == inside_a ? a : b) = middle;
    }
    return (a + b) / 2;
  }

  void put_vertex(const Vector3i& at) {
    std::array<Vector3d, 12> points;
    std::size_t count = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 4; ++side) {
        Vector3i from = at;
        from[(axis + 1) % 3] += side % 2;
        from[(axis + 2) % 3] += side / 2;
        const Vector3i to = from + Vector3i::Unit(axis);
        if (inside(from) != inside(to)) points[count++] = crossing(place(from), place(to));
      }
    if (count == 0) return;
    Vector3d mean = Vector3d::Zero();
    for (std::size_t k = 0; k < count; ++k) mean += points[k] / double(count);
    constexpr double kTowardsMean = 0.02;
    Eigen::Matrix3d normal = kTowardsMean * Eigen::Matrix3d::Identity();
    Vector3d right = Vector3d::Zero();
    for (std::size_t k = 0; k < count; ++k) {
      const Vector3d g = gradient(points[k]);
      normal += g * g.transpose();
      right += g * g.dot(points[k] - mean);
    }
    const Vector3d corner = place(at), best = mean + normal.ldlt().solve(right);
    vertex_[row(at)] = Index(mesh_.positions.size());
    mesh_.positions.push_back(best.cwiseMax(corner).cwiseMin(corner + Vector3d::Constant(cell_)));
  }

  /// Of the four cells around the edge from `at` along the axis.
  void put_face(const Vector3i& at, int axis) {
    const Vector3i to = at + Vector3i::Unit(axis), u = Vector3i::Unit((axis + 1) % 3),
                   v = Vector3i::Unit((axis + 2) % 3);
    if (to[axis] >= size_[axis] || inside(at) == inside(to) || (at - u - v).minCoeff() < 0) return;
    std::array<Index, 4> corner = {vertex_[row(at)], vertex_[row(at - u)], vertex_[row(at - u - v)],
                                   vertex_[row(at - v)]};
    if (std::find(corner.begin(), corner.end(), kNone) != corner.end()) return;
    if (!inside(at)) std::reverse(corner.begin(), corner.end());
    mesh_.faces.push_back({corner[0], corner[1], corner[2]});
    mesh_.faces.push_back({corner[0], corner[2], corner[3]});
  }

  const Solid& solid_;
  Vector3d low_;
  double cell_;
  Vector3i size_;
  std::vector<float> value_;
  std::vector<Index> vertex_;  ///< of the cell above each corner
  Mesh mesh_;
};

}  // namespace

Solid box(const Vector3d& low, const Vector3d& high, double rounding) {
  const Vector3d middle = (low + high) / 2, half = (high - low) / 2 - Vector3d::Constant(rounding);
  return [=](const Vector3d& p) {
    const Vector3d q = (p - middle).cwiseAbs() - half;
    return q.cwiseMax(0).norm() + std::min(0.0, q.maxCoeff()) - rounding;
  };
}

Solid limb(const Vector3d& a, const Vector3d& b, double radius_a, double radius_b) {
  const Vector3d along = b - a;
  const double square = along.squaredNorm();
  return [=](const Vector3d& p) {
    const double t = std::clamp((p - a).dot(along) / square, 0.0, 1.0);
    return (p - a - t * along).norm() - (radius_a + t * (radius_b - radius_a));
  };
}

Solid cylinder(const Vector3d& a, const Vector3d& b, double radius) {
  const double length = (b - a).norm();
  const Vector3d along = (b - a) / length;
  return [=](const Vector3d& p) {
    const double t = (p - a).dot(along);
    return std::max({(p - a - t * along).norm() - radius, -t, t - length});
  };
}

Solid half_space(const Vector3d& outward, double offset) {
  return [=](const Vector3d& p) { return outward.dot(p) - offset; };
}

Solid united(Solid a, Solid b) {
  if (!a) return b;
  return [a = std::move(a), b = std::move(b)](const Vector3d& p) { return std::min(a(p), b(p)); };
}

Solid blended(Solid a, Solid b, double width) {
  if (!a) return b;
  return [a = std::move(a), b = std::move(b), width](const Vector3d& p) {
    const double x = a(p), y = b(p), near = std::max(0.0, width - std::abs(x - y));
    return std::min(x, y) - near * near / (4 * width);
  };
}

Solid without(Solid a, Solid b) {
  return [a = std::move(a), b = std::move(b)](const Vector3d& p) { return std::max(a(p), -b(p)); };
}

Solid placed(Solid a, const Eigen::Isometry3d& motion) {
  return [a = std::move(a), back = motion.inverse()](const Vector3d& p) { return a(back * p); };
}

Solid rippled(Solid a, double height, double wavelength, const Eigen::Matrix3d& directions, bool creased) {
  constexpr double kTurn = 6.283185307179586;
  return [a = std::move(a), height, waves = Eigen::Matrix3d(kTurn / wavelength * directions),
          creased](const Vector3d& p) {
    const Vector3d phase = waves * p;
    const double wave = (std::sin(phase[0]) + std::sin(phase[1]) + std::sin(phase[2])) / 3;
    return a(p) - height * (creased ? 1 - 2 * std::abs(wave) : wave);
  };
}

Solid shell(Solid a, double thickness) {
  return [a = std::move(a), thickness](const Vector3d& p) { return std::abs(a(p)) - thickness / 2; };
}

Mesh surface_of(const Solid& solid, const Vector3d& low, const Vector3d& high, double cell) {
  const Vector3d room = Vector3d::Constant(1.5 * cell);
  return Contour(solid, low - room, high + room, cell).mesh();
}

}  // namespace rfsmooth::bench
