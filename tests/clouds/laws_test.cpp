#include "clouds/scanner/laws.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "clouds/shapes/sampling.h"
#include "clouds/shapes/shapes.h"
#include "rfs_mesh/search/neighbors.h"

using namespace rfsmooth;
using namespace rfsmooth::clouds;
using Eigen::Vector3d;

namespace {

constexpr std::uint64_t kSeed = 7;

/// Even points of a sphere, once for all tests.
const Spots& sphere_spots() {
  static const Spots spots = {sample(*make_sphere(), 4000, kSeed), {}};
  return spots;
}

Positions noise_of(const Law& law, double spacing) {
  Positions noise = add_noise(law, sphere_spots(), spacing, kSeed).measured;
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] -= sphere_spots().points[i];
  return noise;
}

double per_coordinate(const Positions& noise) {
  double squares = 0;
  for (const Vector3d& d : noise) squares += d.squaredNorm();
  return std::sqrt(squares / (3 * double(noise.size())));
}

Law law_with(double sigma) {
  Law law;
  law.sigma = sigma;
  return law;
}

TEST(Laws, HaveNamesOfTheirOwnAndAreFoundByThem) {
  std::set<std::string> names;
  for (const Law& law : laws()) {
    EXPECT_EQ(find_law(law.name), &law);
    EXPECT_TRUE(names.insert(std::string(law.name)).second) << law.name;
  }
  EXPECT_EQ(find_law("pink"), nullptr);
}

TEST(Laws, SameSeedSameBytesOtherSeedOthers) {
  const Mesh mesh = make_cube()->mesh(2);
  for (const Law& law : laws()) {
    const Spots spots = spread(law, mesh, 500, kSeed);
    EXPECT_EQ(spots.points, spread(law, mesh, 500, kSeed).points) << law.name;
    const double spacing = mean_spacing(spots.points);
    const Positions measured = add_noise(law, spots, spacing, kSeed).measured;
    EXPECT_EQ(measured, add_noise(law, spots, spacing, kSeed).measured) << law.name;
    if (law.sigma == 0) continue;  // nothing random about it
    EXPECT_NE(measured, add_noise(law, spots, spacing, kSeed + 1).measured) << law.name;
  }
}

// Bounds of the statistics below: five standard errors, 12,000 numbers.
constexpr double kFive = 5 / 109.0;

TEST(Laws, WhiteNoiseHasItsStandardDeviation) {
  EXPECT_NEAR(per_coordinate(noise_of(law_with(0.5), 0.02)) / 0.01, 1, kFive);
}

TEST(Laws, OfHeavyTailsTheShareAndTheSizeAreAsStated) {
  Law law = law_with(1);
  law.loud_share = 0.2;
  law.loud_times = 1000;  // so far off that a loud point cannot be taken for a calm one
  std::size_t loud = 0;
  Positions calm;
  for (const Vector3d& d : noise_of(law, 1)) {
    loud += d.norm() > 10;
    if (d.norm() <= 10) calm.push_back(d);
  }
  const auto n = double(sphere_spots().points.size());
  EXPECT_NEAR(double(loud) / n, 0.2, 5 * std::sqrt(0.2 * 0.8 / n));
  EXPECT_NEAR(per_coordinate(calm), 1, kFive * 1.2);
}

TEST(Laws, CorrelatedNoiseHasItsStandardDeviationAndCorrelation) {
  constexpr int kOver = 7;
  Law law = law_with(1);
  law.correlated = kOver;
  const Positions noise = noise_of(law, 1);
  EXPECT_NEAR(per_coordinate(noise), 1, kFive * std::sqrt(double(kOver)));
  // Two points share some of the seven whose draws they sum; their correlation is that share of seven.
  const Positions& points = sphere_spots().points;
  const rfs_mesh::SpatialIndex index(points, {});
  const auto near = index.nearest(kOver - 1, {});
  const auto summed = [&](std::size_t i) {
    std::set<Index> of(near[i].begin(), near[i].end());
    of.insert(Index(i));
    return of;
  };
  double measured = 0, stated = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Index j = *near[i].begin();
    measured += noise[i].dot(noise[j]) / 3;
    std::size_t shared = 0;
    for (const Index k : summed(j)) shared += summed(i).count(k);
    stated += double(shared) / kOver;
  }
  const auto n = double(points.size());
  EXPECT_GT(stated / n, 0.4);
  EXPECT_NEAR(measured / n, stated / n, kFive * std::sqrt(2.0 * kOver));
}

TEST(Laws, HalfExactIsExactThereAndNoisyElsewhere) {
  const Law& law = *find_law("half");
  const NoisyCloud cloud = add_noise(law, sphere_spots(), 0.01, kSeed);
  Positions noisy;
  for (std::size_t i = 0; i < cloud.measured.size(); ++i) {
    const Vector3d off = cloud.measured[i] - sphere_spots().points[i];
    if (cloud.exact[i] == 0) noisy.push_back(off);
    EXPECT_EQ(off.norm() == 0, cloud.exact[i] != 0);
  }
  EXPECT_NEAR(double(noisy.size()) / double(cloud.measured.size()), 0.5, 0.03);
  EXPECT_NEAR(per_coordinate(noisy) / (law.sigma * 0.01), 1, kFive * 1.5);
}

TEST(Laws, HalfCalmHasAFifthOfTheOthersNoise) {
  const Law& law = *find_law("contrast");
  const NoisyCloud cloud = add_noise(law, sphere_spots(), 0.01, kSeed);
  const NoisyCloud half = add_noise(*find_law("half"), sphere_spots(), 0.01, kSeed);
  EXPECT_TRUE(cloud.exact.empty());
  Positions calm, loud;
  for (std::size_t i = 0; i < cloud.measured.size(); ++i)
    (half.exact[i] != 0 ? calm : loud).push_back(cloud.measured[i] - sphere_spots().points[i]);
  EXPECT_NEAR(per_coordinate(loud) / (law.sigma * 0.01), 1, kFive * 1.5);
  EXPECT_NEAR(per_coordinate(calm) / per_coordinate(loud), 0.2, 0.2 * kFive * 2);
}

TEST(Laws, DepthsAreWholeStepsAndPointsStayOnTheirRays) {
  constexpr double kStep = 0.125;
  Law law;
  law.step = kStep;
  const NoisyCloud cloud = add_noise(law, sphere_spots(), 1, kSeed);
  std::set<double> depths;
  for (std::size_t i = 0; i < cloud.measured.size(); ++i) {
    const double depth = cloud.eye[2] - cloud.measured[i][2];
    depths.insert(std::round(depth / kStep));
    EXPECT_NEAR(depth / kStep, std::round(depth / kStep), 1e-12);
    const Vector3d before = sphere_spots().points[i] - cloud.eye, after = cloud.measured[i] - cloud.eye;
    EXPECT_LE(std::abs(after[2] - before[2]), kStep / 2 + 1e-12);
    EXPECT_LT(before.normalized().cross(after.normalized()).norm(), 1e-12);
  }
  EXPECT_LE(depths.size(), std::size_t(2 / kStep) + 1);
}

TEST(Laws, ScansMoveRigidlyAndMissEachOther) {
  Law law;
  law.scans = 10;
  law.between = 0.3;
  constexpr double kSpacing = 0.05;
  const NoisyCloud cloud = add_noise(law, sphere_spots(), kSpacing, kSeed);
  std::map<Index, std::vector<std::size_t>> rows;
  for (std::size_t i = 0; i < cloud.scan.size(); ++i) rows[cloud.scan[i]].push_back(i);
  EXPECT_EQ(rows.size(), 10u);
  for (const auto& [scan, of] : rows)
    for (std::size_t k = 1; k < of.size(); ++k)
      EXPECT_NEAR((cloud.measured[of[k]] - cloud.measured[of[0]]).norm(),
                  (sphere_spots().points[of[k]] - sphere_spots().points[of[0]]).norm(), 1e-12);
  // Shifts alone are between / sqrt(2), with turns at most between; of thirty numbers a third is five errors.
  const double moved = per_coordinate(noise_of(law, kSpacing)) / kSpacing;
  EXPECT_GT(moved, 0.3 / std::sqrt(2.0) * 0.6);
  EXPECT_LT(moved, 0.3 * 1.4);
}

TEST(Laws, NoiseAlongTheRayGrowsWithThePowerOfTheRange) {
  Law law = law_with(0.01);
  law.along_ray = true;
  law.range_power = 2;
  const NoisyCloud cloud = add_noise(law, sphere_spots(), 1, kSeed);
  double near_squares = 0, far_squares = 0, near_count = 0, far_count = 0;
  for (std::size_t i = 0; i < cloud.measured.size(); ++i) {
    const Vector3d ray = sphere_spots().points[i] - cloud.eye, off = cloud.measured[i] - cloud.eye - ray;
    EXPECT_LT(off.cross(ray.normalized()).norm(), 1e-12);
    const double at_centre = off.norm() / std::pow(ray.norm() / kEyeDistance, 2);
    const bool is_near = ray.norm() < kEyeDistance;
    (is_near ? near_squares : far_squares) += at_centre * at_centre;
    (is_near ? near_count : far_count) += 1;
  }
  EXPECT_NEAR(std::sqrt(near_squares / near_count) / 0.01, 1, 0.15);
  EXPECT_NEAR(std::sqrt(far_squares / far_count) / 0.01, 1, 0.15);
}

TEST(Laws, RingsLieOnTheSurfaceFarApartAndPointsOfARingClose) {
  const auto cube = make_cube();
  Law law;
  law.spread = Spread::rings;
  const Positions points = spread(law, cube->mesh(0.5), 20000, kSeed).points;
  EXPECT_NEAR(double(points.size()) / 20000, 1, 0.02);
  const Frame frame = frame_of(cube->mesh(2).positions);
  std::map<double, std::vector<double>> rows;  // of the top face: y -> x
  for (const Vector3d& p : points) {
    EXPECT_NEAR(cube->signed_distance(p), 0, 1e-12);
    if (p[2] > 1 - 1e-12) rows[std::round(p[1] * 1e9)].push_back(p[0]);
  }
  ASSERT_GT(rows.size(), 3u);
  const double between = 1e-9 * (std::next(rows.begin(), 2)->first - std::next(rows.begin(), 1)->first);
  std::vector<double>& row = std::next(rows.begin())->second;
  std::sort(row.begin(), row.end());
  EXPECT_NEAR(between / (row[1] - row[0]), find_law("rings")->ring_gap, 1e-3);
  EXPECT_GT(frame.eye[2], 1) << "the scanner stands outside";
}

TEST(Laws, ClumpsAreDenserInsideAndMoveAsOne) {
  Law law;
  law.spread = Spread::clumps;
  law.clumps = 0.3;
  const auto torus = make_torus();
  const Spots spots = spread(law, torus->mesh(0.05), 3000, kSeed);
  ASSERT_EQ(spots.points.size(), 3000u);
  ASSERT_EQ(spots.clump.size(), 3000u);
  // Random points have a mean distance to the nearest of half the root of the area of each, to 1 % here.
  EXPECT_LT(mean_spacing(spots.points), 0.95 * 0.5 * std::sqrt(torus->area() / 3000));
  const NoisyCloud cloud = add_noise(law, spots, 0.05, kSeed);
  std::map<Index, Vector3d> moved;
  for (std::size_t i = 0; i < 3000; ++i) {
    const Vector3d by = cloud.measured[i] - spots.points[i];
    EXPECT_LT((moved.try_emplace(spots.clump[i], by).first->second - by).norm(), 1e-12);
  }
  Positions shifts;
  for (const auto& [clump, by] : moved) shifts.push_back(by);
  EXPECT_NEAR(per_coordinate(shifts) / (0.3 * 0.05), 1, 5 / std::sqrt(6.0 * double(shifts.size())));
}

}  // namespace
