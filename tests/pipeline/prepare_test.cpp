#include "pipeline/prepare.h"

#include <random>

#include <gtest/gtest.h>

#include "tests/pipeline/noise/noisy_sphere.h"

namespace rfsmooth::pipeline {
namespace {

/// A noisy sphere with strays, and a twin of every point beside it.
std::vector<double> merged_sphere_with_strays(double unit) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal(0, 0.3 * noisy::spacing());
  Positions points = noisy::off_sphere([&](std::size_t) { return normal(engine); });
  for (std::size_t i = 0; i < points.size(); i += 500) points[i] *= 1.5;
  std::vector<double> xyz;
  for (const double off : {0.0, 1e-9})
    for (const Eigen::Vector3d& p : points)
      for (const double x : p) xyz.push_back(unit * (x + off));
  return xyz;
}

TEST(MeasurePoints, EntersWhatDenoiseEntersInAnyUnits) {
  for (const double unit : {1.0, 0x1p-100, 0x1p100}) {
    std::vector<double> xyz = merged_sphere_with_strays(unit);
    const Measured measured = measure_points(xyz, Outliers::keep, {}, {});
    const DenoiseReport report = denoise(xyz.data(), xyz.size() / 3, {}, {}).value();
    EXPECT_EQ(measured.finite, report.finite);
    EXPECT_EQ(measured.distinct, report.distinct);
    EXPECT_GT(report.outliers, 0u);
    EXPECT_TRUE(measured.outlier == report.outlier);
    EXPECT_EQ(measured.points.size(), *report.statistics.points);
    const Statistics &found = measured.statistics, &expected = report.statistics;
    EXPECT_GT(*found.spacing, 0);
    EXPECT_EQ(*found.spacing, report.spacing);
    EXPECT_EQ(found.noise->sigma, report.noise);
    EXPECT_TRUE(found.noise->at_sites == expected.noise->at_sites);
    EXPECT_EQ(*found.reach, *expected.reach);
    EXPECT_EQ(found.scale->sigma, expected.scale->sigma);
    EXPECT_EQ(found.scale->neighbours, expected.scale->neighbours);
    EXPECT_TRUE(found.box->low == expected.box->low && found.box->high == expected.box->high);
  }
}

}  // namespace
}  // namespace rfsmooth::pipeline
