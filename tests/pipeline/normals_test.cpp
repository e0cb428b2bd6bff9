#include "rfsmooth/pipeline/normals.h"

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace rfsmooth::pipeline {
namespace {

using Eigen::Vector3d;
using Flat = std::vector<double>;

Flat flat(const Positions& points) {
  Flat xyz;
  for (const auto& p : points) xyz.insert(xyz.end(), p.data(), p.data() + 3);
  return xyz;
}

Flat normals_of(const Flat& xyz, const NormalsOptions& options = {}, const Context& context = {}) {
  Flat normals(xyz.size(), 7);
  const auto report = estimate_normals(xyz.data(), xyz.size() / 3, options, context, normals.data());
  EXPECT_TRUE(report.ok()) << report.error().message;
  return normals;
}

Vector3d row(const Flat& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

TEST(Normals, PointOutwardOnASphere) {
  const Positions points = test::poisson_points(test::unit_sphere(), 3000, 1);
  const Flat normals = normals_of(flat(points));
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(row(normals, i).norm(), 1, 1e-12);
    EXPECT_GT(row(normals, i).dot(points[i]), 0.99);
  }
}

TEST(Normals, RowsThatAreNotFiniteGetNaN) {
  const double nan = std::nan("");
  Flat xyz = flat(test::poisson_points(test::unit_sphere(), 500, 1));
  const Flat alone = normals_of(xyz);
  xyz.insert(xyz.begin(), {nan, 0, 0});
  const Flat normals = normals_of(xyz);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(std::isnan(normals[k]));
  EXPECT_EQ(std::memcmp(normals.data() + 3, alone.data(), alone.size() * sizeof(double)), 0);
}

TEST(Normals, AreTheSameBytesForAnyNumberOfThreads) {
  const Flat xyz = flat(test::poisson_points(test::torus(), 5000, 1));
  Context one, four;
  one.threads = 1;
  four.threads = 4;
  EXPECT_EQ(normals_of(xyz, {}, one), normals_of(xyz, {}, four));
}

}  // namespace
}  // namespace rfsmooth::pipeline
