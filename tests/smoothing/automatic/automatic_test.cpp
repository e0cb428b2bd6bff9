#include "smoothing/automatic/automatic.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "rfs_mesh/fit/local_surface.h"
#include "rfs_mesh/search/neighbors.h"
#include "smoothing/automatic/flow_auto.h"
#include "tests/support/meshes.h"
#include "tests/support/near.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;

namespace {

double spacing(const Positions& points) {
  const rfs_mesh::SpatialIndex index(points, {});
  const auto near = index.nearest(1, {});
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) sum += (points[near[i][0]] - points[i]).norm();
  return sum / double(points.size());
}

Mesh noisy_sphere(double share, double& sigma) {
  Mesh mesh = support::icosphere(4);
  sigma = share * spacing(mesh.positions);
  support::add_noise(mesh, sigma, 11);
  return mesh;
}

/// The same noise everywhere.
rfs_mesh::NoiseField even(double sigma, std::size_t n) {
  rfs_mesh::NoiseField noise;
  noise.sigma = sigma;
  noise.local.assign(n, sigma);
  return noise;
}

Positions smoothed(Mesh mesh, rfs_mesh::NoiseField noise, AutomaticFindings& found) {
  Statistics whole;
  noise.spacing = spacing(mesh.positions);
  return automatic_smoothing({mesh, std::move(noise)}, found, whole, {}).points;
}

Positions smoothed(const Mesh& mesh, double sigma, AutomaticFindings& found) {
  return smoothed(mesh, even(sigma, mesh.positions.size()), found);
}

TEST(Automatic, LeavesATenthOfTheErrorOfANoisySphereAndKnowsWhatIsLeft) {
  for (const double share : {0.2, 0.5, 1.0}) {
    double sigma = 0;
    const Mesh mesh = noisy_sphere(share, sigma);
    AutomaticFindings found;
    const Positions smooth = smoothed(mesh, sigma, found);
    const double left = support::rms_off_unit_sphere(smooth);
    EXPECT_LT(left, 0.33 * support::rms_off_unit_sphere(mesh.positions)) << share;  // of the square: a tenth
    EXPECT_LT(found.left, 0.5 * sigma) << share;
    EXPECT_GT(found.guide_strength, 0);
  }
}

TEST(Automatic, WhatIsLeftIsNearTheTruthAndStraysAreNotPartOfIt) {
  double sigma = 0;
  Mesh mesh = noisy_sphere(0.5, sigma);
  AutomaticFindings found;
  for (const double stated : {0.9, 1.0, 1.1}) {  // as well as noise is measured
    const double truth = support::rms_off_unit_sphere(smoothed(mesh, stated * sigma, found));
    EXPECT_GT(found.left, 0.8 * truth) << stated;
    EXPECT_LT(found.left, 1.5 * truth) << stated;
  }
  // One point in five hundred thirty sigma off.
  for (std::size_t i = 0; i < mesh.positions.size(); i += 500) mesh.positions[i] *= 1 + 30 * sigma;
  const Positions smooth = smoothed(mesh, sigma, found);
  Positions others;
  for (std::size_t i = 0; i < smooth.size(); ++i)
    if (i % 500 != 0) others.push_back(smooth[i]);
  EXPECT_LT(found.left, 1.5 * support::rms_off_unit_sphere(others));
}

TEST(Automatic, NoiseThatVariesIsSmoothedAwayWhereItIsLoud) {
  // Four times the noise on one half of a sphere: with one figure for both it would stay, taken for shape.
  Mesh mesh = support::icosphere(5), noise = mesh;
  const double quiet = 0.15 * spacing(mesh.positions);
  support::add_noise(noise, quiet, 5);
  rfs_mesh::NoiseField field = even(quiet, mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const bool loud = mesh.positions[i].z() > 0;
    mesh.positions[i] += (loud ? 4 : 1) * (noise.positions[i] - mesh.positions[i]);
    if (loud) field.local[i] *= 4;
  }
  AutomaticFindings found;
  const auto loud_half = [&](const Positions& points) {
    Positions half;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (field.local[i] > quiet) half.push_back(points[i]);
    return support::rms_off_unit_sphere(half);
  };
  const double with_field = loud_half(smoothed(mesh, field, found));
  EXPECT_LT(with_field, 0.3 * loud_half(mesh.positions));
  EXPECT_LT(with_field, 0.7 * loud_half(smoothed(mesh, quiet, found)));
}

TEST(Automatic, ALoudPartOfACloudThatIsMostlyDetailIsSmoothed) {
  const Mesh clean = support::icosphere(5);
  const double h = spacing(clean.positions);
  Mesh noisy = clean;
  support::add_noise(noisy, 0.5 * h, 7);
  for (std::size_t i = 0; i < noisy.positions.size(); ++i)
    if (clean.positions[i].z() < 0.3) noisy.positions[i] = clean.positions[i];
  const auto moved = [&](double loud) {
    Statistics whole;
    whole.noise = NoiseModel();
    whole.noise->spacing = h;
    whole.noise->sigma = 0.08 * h;
    whole.noise->shape = 0.6;
    whole.noise->sites = clean.positions;
    for (const Eigen::Vector3d& p : clean.positions)
      whole.noise->at_sites.push_back((p.z() < 0.3 ? 0.08 : loud) * h);
    Mesh mesh = noisy;
    smooth_automatically(mesh, {}, {}, Connectivity::kept, &whole);
    return mesh.positions;
  };
  EXPECT_LT(support::rms_off_unit_sphere(moved(0.5)), 0.5 * support::rms_off_unit_sphere(noisy.positions));
  EXPECT_EQ(moved(0.1), noisy.positions);
}

TEST(Automatic, PointsWithoutNoiseBesideLoudOnesKeepTheirBits) {
  const Mesh clean = support::icosphere(5);
  const double h = spacing(clean.positions);
  Mesh noisy = clean;
  support::add_noise(noisy, 0.5 * h, 7);
  const auto calm = [&](std::size_t i) { return clean.positions[i].z() < 0.3; };
  for (std::size_t i = 0; i < noisy.positions.size(); ++i)
    if (calm(i)) noisy.positions[i] += 0.999 * (clean.positions[i] - noisy.positions[i]);
  Statistics whole;
  whole.noise = NoiseModel();
  whole.noise->spacing = h;
  whole.noise->sigma = 0.5 * h;
  whole.noise->sites = clean.positions;
  for (std::size_t i = 0; i < clean.positions.size(); ++i)
    whole.noise->at_sites.push_back((calm(i) ? rfs_mesh::kStays : 1) * 0.5 * h);
  Mesh mesh = noisy;
  smooth_automatically(mesh, {}, {}, Connectivity::kept, &whole);
  std::size_t moved = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (clean.positions[i].z() < 0.2) {
      ASSERT_EQ(mesh.positions[i], noisy.positions[i]) << i;
    }
    moved += mesh.positions[i] == noisy.positions[i] ? 0 : 1;
  }
  EXPECT_GT(moved, mesh.positions.size() / 4);
}

TEST(Automatic, NoNoiseIsTheIdentity) {
  const Mesh mesh = support::icosphere(4);
  Mesh smooth = mesh;
  AutomaticOptions options;
  options.noise = Length{0, false};
  const auto found = smooth_automatically(smooth, options, {});
  EXPECT_EQ(smooth.positions, mesh.positions);
  EXPECT_EQ(found->not_smoothed, NotSmoothed::too_little_noise);
}

TEST(Automatic, NoPointMovesFartherThanItsShareOfTheNoiseAroundIt) {
  // Four times the noise on one half of a sphere; on the other, points that are far for the noise there but
  // not for that of the cloud.
  Mesh mesh = support::icosphere(4), noise = mesh;
  const double quiet = 0.15 * spacing(mesh.positions);
  support::add_noise(noise, quiet, 5);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const bool loud = mesh.positions[i].z() > 0;
    mesh.positions[i] += (loud ? 4 : 1) * (noise.positions[i] - mesh.positions[i]);
    if (!loud && i % 40 == 0) mesh.positions[i] *= 1 + 7 * quiet;
  }
  const rfs_mesh::NoiseField field = rfs_mesh::spread_noise(
      rfs_mesh::measure_noise(rfs_mesh::SpatialIndex(mesh.positions, {}), {}), mesh.positions, {});
  for (const double strength : {0.5, 1.0, 2.0}) {
    AutomaticOptions options;
    options.strength = strength;
    Mesh smooth = mesh;
    const auto found = smooth_automatically(smooth, options, {});
    ASSERT_TRUE(found.has_value());
    const double most = rfs_mesh::kNoiseReach * std::max(1.0, strength) * found->tail_times;
    double largest = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
      largest = std::max(largest, (smooth.positions[i] - mesh.positions[i]).norm() / field.local[i]);
    EXPECT_LE(largest, most * (1 + 1e-9)) << strength;
    if (strength == 1) {
      EXPECT_GT(largest, 0.99 * rfs_mesh::kNoiseReach) << "nothing was there to limit";
    }
  }
}

}  // namespace
