/// Surfaces, rods and stacks of sheets with isotropic noise.
#pragma once

#include <cmath>
#include <functional>
#include <random>

#include <Eigen/Core>

#include <rfsmooth/mesh.h>

namespace rfsmooth::test {

inline constexpr double kNoiseInSlab = 0.03;

/// So many points of a surface, given by two uniform numbers, with isotropic noise.
inline Positions noisy(std::size_t n, const std::function<Eigen::Vector3d(double, double)>& surface) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal(0, kNoiseInSlab);
  std::uniform_real_distribution<double> uniform;
  Positions points(n);
  for (Eigen::Vector3d& p : points) {
    const double u = uniform(engine), v = uniform(engine);
    const double x = normal(engine), y = normal(engine), z = normal(engine);
    p = surface(u, v) + Eigen::Vector3d(x, y, z);
  }
  return points;
}

/// Along z, of length 2.
inline Eigen::Vector3d rod(double radius, double u, double v) {
  const double angle = 2 * M_PI * u;
  return {radius * std::cos(angle), radius * std::sin(angle), 2 * v};
}

/// So many sheets of 1 x 1, so far apart.
inline Eigen::Vector3d stack(int sheets, double apart, double u, double v) {
  const double of_all = sheets * u, sheet = std::floor(of_all);
  return {of_all - sheet, v, apart * sheet};
}

}  // namespace rfsmooth::test
