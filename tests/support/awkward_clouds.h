/// Clouds that break spatial code: ties, duplicates, flat and far-apart ones, extreme scales. Small and
/// seeded.
#pragma once

#include <cmath>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rfs_mesh/points.h"

namespace rfsmooth::test {

struct AwkwardCloud {
  std::string name;
  Positions points;
  friend std::ostream& operator<<(std::ostream& out, const AwkwardCloud& c) { return out << c.name; }
};

inline std::string name_of_cloud(const testing::TestParamInfo<AwkwardCloud>& info) {
  return info.param.name;
}

/// n points of the unit sphere, uniformly random, moved by isotropic Gaussian noise.
inline Positions noisy_sphere(std::size_t n, double sigma, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  Positions points(n);
  for (auto& p : points) {
    p = Eigen::Vector3d(normal(engine), normal(engine), normal(engine)).normalized();
    p += sigma * Eigen::Vector3d(normal(engine), normal(engine), normal(engine));
  }
  return points;
}

/// Each of about n points (or fewer, where the name says so).
inline std::vector<AwkwardCloud> awkward_clouds(std::size_t n) {
  using Eigen::Vector3d;
  std::mt19937_64 engine(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal;
  const auto in_cube = [&] { return Vector3d(uniform(engine), uniform(engine), uniform(engine)); };
  const auto gauss = [&] { return Vector3d(normal(engine), normal(engine), normal(engine)); };
  const auto make = [&](auto&& point) {
    Positions points;
    for (std::size_t i = 0; i < n; ++i) points.push_back(point(i));
    return points;
  };
  const auto side = std::size_t(std::ceil(std::cbrt(double(n))));
  const auto scaled = [&](double scale) {
    return make([&](std::size_t) -> Vector3d { return Vector3d(scale * in_cube()); });
  };

  std::vector<AwkwardCloud> clouds;
  clouds.push_back({"random", make([&](std::size_t) -> Vector3d { return in_cube(); })});
  clouds.push_back({"surface", noisy_sphere(n, 0.02, 12)});
  clouds.push_back({"clustered", make([&](std::size_t i) -> Vector3d {
                      return Vector3d(10.0 * double(i % 7), double(i % 3), 0) + 0.01 * gauss();
                    })});
  clouds.push_back({"grid", make([&](std::size_t i) -> Vector3d {
                      return Vector3d(double(i % side), double(i / side % side), double(i / side / side));
                    })});
  Positions shuffled = clouds.back().points;
  std::shuffle(shuffled.begin(), shuffled.end(), engine);
  clouds.push_back({"shuffled_grid", shuffled});
  clouds.push_back({"duplicates", make([&](std::size_t i) -> Vector3d {
                      return Vector3d(double(i * i % 53), double(i % 5), 0);
                    })});
  clouds.push_back({"identical", make([&](std::size_t) -> Vector3d { return Vector3d(1, 2, 3); })});
  clouds.push_back({"collinear", make([&](std::size_t) -> Vector3d {
                      return Vector3d(uniform(engine) * Vector3d(1, 2, -3));
                    })});
  clouds.push_back(
      {"growing_gaps", make([&](std::size_t i) -> Vector3d { return Vector3d(double(i * i), 0, 0); })});
  clouds.push_back({"coplanar", make([&](std::size_t) -> Vector3d {
                      return Vector3d(uniform(engine), uniform(engine), 0.25);
                    })});
  clouds.push_back({"two_far_clusters", make([&](std::size_t i) -> Vector3d {
                      return Vector3d(i % 2 == 0 ? 0 : 1e6 / std::cbrt(double(n)), 0, 0) + in_cube();
                    })});
  clouds.push_back({"density_1000_to_1", make([&](std::size_t i) -> Vector3d {
                      return Vector3d((i % 2 == 0 ? 0.001 : 1.0) * in_cube());
                    })});
  clouds.push_back({"tiny_scale", scaled(1e-12)});
  clouds.push_back({"huge_scale", scaled(1e12)});
  for (std::size_t few = 0; few <= 3; ++few)
    clouds.push_back(
        {"points_" + std::to_string(few),
         Positions(clouds.front().points.begin(), clouds.front().points.begin() + std::ptrdiff_t(few))});
  return clouds;
}

}  // namespace rfsmooth::test
