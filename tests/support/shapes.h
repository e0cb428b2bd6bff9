/// Clean clouds of shapes with known surface, sampled uniformly at random or Poisson-disk-like (dart
/// throwing). Seeded.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "rfs_mesh/points.h"

namespace rfsmooth::test {

struct Shape {
  std::string name;
  double area;
  std::function<Eigen::Vector3d(std::mt19937_64&)> sample;  ///< uniform by area
  friend std::ostream& operator<<(std::ostream& out, const Shape& s) { return out << s.name; }
};

inline Shape unit_sphere() {
  return {"sphere", 4 * M_PI, [](std::mt19937_64& engine) {
            std::normal_distribution<double> normal;
            const double x = normal(engine), y = normal(engine), z = normal(engine);
            return Eigen::Vector3d(Eigen::Vector3d(x, y, z).normalized());
          }};
}

/// Radii 1 and 0.4, around z.
inline Shape torus() {
  return {"torus", 4 * M_PI * M_PI * 0.4, [](std::mt19937_64& engine) {
            std::uniform_real_distribution<double> uniform;
            for (;;) {
              const double u = 2 * M_PI * uniform(engine), v = 2 * M_PI * uniform(engine);
              const double r = 1 + 0.4 * std::cos(v);
              if (uniform(engine) * 1.4 < r)
                return Eigen::Vector3d(r * std::cos(u), r * std::sin(u), 0.4 * std::sin(v));
            }
          }};
}

/// [0, 1]^2 at z = 0: open, with a rim.
inline Shape plane() {
  return {"plane", 1, [](std::mt19937_64& engine) {
            std::uniform_real_distribution<double> uniform;
            const double x = uniform(engine), y = uniform(engine);
            return Eigen::Vector3d(x, y, 0);
          }};
}

/// The surface of [-1, 1]^3: sharp edges and corners.
inline Shape cube() {
  return {"cube", 24, [](std::mt19937_64& engine) {
            std::uniform_real_distribution<double> uniform(-1, 1);
            const int side = std::uniform_int_distribution<int>(0, 5)(engine);
            const double u = uniform(engine), v = uniform(engine);
            Eigen::Vector3d p;
            p[side % 3] = side < 3 ? -1 : 1;
            p[(side + 1) % 3] = u;
            p[(side + 2) % 3] = v;
            return p;
          }};
}

/// Names the instances of a test that runs on every shape.
struct NameOfShape {
  template <class Info>
  std::string operator()(const Info& info) const {
    return info.param.name;
  }
};

inline std::vector<Shape> clean_shapes() {
  return {unit_sphere(), torus(), plane(), cube()};
}

inline Positions random_points(const Shape& shape, std::size_t n, unsigned seed) {
  std::mt19937_64 engine(seed);
  Positions points(n);
  for (auto& p : points) p = shape.sample(engine);
  return points;
}

/// About n points no two of which are nearer than 0.8 sqrt(area / n).
inline Positions poisson_points(const Shape& shape, std::size_t n, unsigned seed) {
  std::mt19937_64 engine(seed);
  const double r = 0.8 * std::sqrt(shape.area / double(n));
  using Cell = std::array<int, 3>;
  std::map<Cell, std::vector<Eigen::Vector3d>> grid;
  const auto cell_of = [r](const Eigen::Vector3d& p) {
    return Cell{int(std::floor(p[0] / r)), int(std::floor(p[1] / r)), int(std::floor(p[2] / r))};
  };
  const auto is_free = [&](const Eigen::Vector3d& p) {
    const Cell c = cell_of(p);
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const auto found = grid.find({c[0] + x, c[1] + y, c[2] + z});
          if (found == grid.end()) continue;
          for (const Eigen::Vector3d& q : found->second)
            if ((p - q).norm() < r) return false;
        }
    return true;
  };
  Positions points;
  for (std::size_t dart = 0; dart < 15 * n; ++dart) {
    const Eigen::Vector3d p = shape.sample(engine);
    if (!is_free(p)) continue;
    grid[cell_of(p)].push_back(p);
    points.push_back(p);
  }
  return points;
}

}  // namespace rfsmooth::test
