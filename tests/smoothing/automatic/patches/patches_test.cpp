#include "smoothing/automatic/patches/patches.h"

#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "rfs_mesh/search/thinning.h"
#include "tests/support/meshes.h"
#include "tests/support/near.h"
#include "tests/support/threads.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;

namespace {

/// Seeds of patches: a thinning of all n points.
std::vector<Index> seeds_of(const Positions& points) {
  std::vector<Index> all(points.size());
  std::iota(all.begin(), all.end(), Index{0});
  return rfs_mesh::thin(points, all, {});
}

TEST(Patches, PredictAQuadricExactlyWhateverTheSharesOfThePointsAre) {
  Positions guide, data;
  for (int i = 0; i < 30; ++i)
    for (int j = 0; j < 30; ++j) {
      const double x = i + 0.3 * std::sin(7.0 * j), y = j + 0.3 * std::cos(5.0 * i);
      guide.emplace_back(x, y, 0);
      data.emplace_back(x, y, 0.01 * x * x - 0.02 * x * y + 0.3 * y - 1);
    }
  const HeightField field(guide, rfs_mesh::KdTree(guide, {}), support::near_on(guide), data, {}, {});
  for (const std::size_t m : {16, 100}) {
    std::vector<Index> seeds = seeds_of(guide);
    PatchMembers memory;
    Patches patches(field, m, seeds, std::vector<double>(guide.size(), 1), memory, {});
    const Prediction p = patches.take_prediction();
    for (std::size_t i = 0; i < guide.size(); ++i) {
      ASSERT_TRUE(p.covered[i]);
      EXPECT_NEAR(double(p.height[i]), field.height(i), 1e-4) << m;
      EXPECT_GT(p.own[i], 0);
      EXPECT_LT(p.own[i], 1);
    }
  }
}

TEST(Patches, OwnIsTheDerivativeOfAPredictionByThePointsHeight) {
  Positions guide, data;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) {
      guide.emplace_back(i + 0.2 * std::sin(3.0 * j), j + 0.2 * std::cos(4.0 * i), 0);
      data.push_back(guide.back() + Eigen::Vector3d(0, 0, 0.01 * std::sin(1.7 * i * j)));
    }
  // Noise so large that no patch has residuals above it: the weights of the patches stay as they are.
  const std::vector<Index> seeds = seeds_of(guide);
  const std::size_t i = 207;
  const double step = 0.5;
  const std::vector<double> sigma(guide.size(), 10);
  const HeightField field(guide, rfs_mesh::KdTree(guide, {}), support::near_on(guide), data, {}, {});
  PatchMembers memory;
  const Prediction before = Patches(field, 24, seeds, sigma, memory, {}).take_prediction();
  data[i].z() += step;
  const HeightField lifted(guide, rfs_mesh::KdTree(guide, {}), support::near_on(guide), data, {}, {});
  const Prediction after = Patches(lifted, 24, seeds, sigma, memory, {}).take_prediction();
  const double side = field.normal(i).z();
  EXPECT_NEAR(double(after.height[i] - before.height[i]) / (side * step), double(before.own[i]), 1e-4);
}

TEST(Patches, MeanOfAConstantIsTheConstant) {
  const Mesh mesh = support::icosphere(3);
  HeightField field(mesh.positions, rfs_mesh::KdTree(mesh.positions, {}), support::near_on(mesh.positions),
                    mesh.positions, {}, {});
  const std::vector<float> seven(field.size(), 7);
  PatchMembers memory;
  const Patches patches(field, 40, seeds_of(mesh.positions), std::vector<double>(field.size(), 1), memory,
                        {});
  field.ready_for_means({});
  std::vector<float> of_patches = seven, beside(field.size(), 1);
  patches.average<2>({&of_patches, &beside}, {});
  for (const std::vector<float>& means : {of_patches, field.local_mean(seven, {})}) {
    ASSERT_EQ(means.size(), seven.size());
    for (const float v : means) EXPECT_NEAR(v, 7, 1e-5);
  }
}

/// A flat guide of side x side points, one apart, jittered; heights by `z(x, y)`.
template <class Height>
HeightField flat_field(int side, Height&& z) {
  Positions guide, data;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      guide.emplace_back(i + 0.3 * std::sin(7.0 * j), j + 0.3 * std::cos(5.0 * i), 0);
      data.push_back(guide.back());
      data.back().z() = z(guide.back().x(), guide.back().y());
    }
  return HeightField(guide, rfs_mesh::KdTree(guide, {}), support::near_on(guide), data, {}, {});
}

TEST(Patches, WiderOnesTakeMoreOfWhiteNoiseAwayAndSayHowMuch) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise;
  const HeightField field = flat_field(40, [&](double, double) { return noise(random); });
  const std::vector<double> sigma(field.size(), 1);
  double before = 1;
  for (const std::size_t m : {12, 24, 48, 96, 192}) {
    PatchMembers memory;
    const Prediction p = Patches(field, m, seeds_of(field.guide()), sigma, memory, {}).take_prediction();
    double square = 0, own = 0;
    for (std::size_t i = 0; i < field.size(); ++i) {
      square += double(p.height[i]) * double(p.height[i]) / double(field.size());
      own += double(p.own[i]) / double(field.size());
    }
    EXPECT_LT(square, 0.8 * before) << m;
    // Of a linear smoother of white noise by symmetric weights the mean square is the mean of its diagonal,
    // and never above it by much.
    EXPECT_LT(square, 1.2 * own) << m;
    EXPECT_GT(square, 0.3 * own) << m;
    before = square;
  }
}

// What carries a point of a line off its height carries it across the line, too.
TEST(Patches, OnLinesDoNotFollowNoiseThatMovesPointsAcrossThem) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise;
  Positions guide, data;
  for (int line = 0; line < 12; ++line)
    for (int i = 0; i < 240; ++i) {
      const double off = noise(random);
      guide.emplace_back(i, 20 * line + 0.5 * off, 0);
      data.emplace_back(i, 20 * line + 0.5 * off, off);
    }
  const std::vector<double> sigma(guide.size(), 1);
  const auto left = [&](const NoiseModel& model) {
    const HeightField field(guide, rfs_mesh::KdTree(guide, {}), support::near_on(guide), data, model, {});
    PatchMembers memory;
    const Prediction p = Patches(field, 24, seeds_of(guide), sigma, memory, {}).take_prediction();
    double square = 0;
    for (std::size_t i = 0; i < field.size(); ++i) {
      const double off = (data[i] - guide[i]).dot(field.normal(i)) - field.height(i) + double(p.height[i]);
      square += off * off / double(field.size());
    }
    return square;
  };
  NoiseModel on_lines;
  on_lines.piece = 128;
  on_lines.on_lines = true;
  EXPECT_LT(left(on_lines), 0.25);
  EXPECT_LT(left(on_lines), 0.5 * left({}));
}

/// Heights of a flat field: white noise of one, and as much as `moved` says, along z.
HeightField noisy_field(const std::vector<double>& moved) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise;
  std::size_t at = 0;
  return flat_field(100, [&](double, double) { return noise(random) + moved[at++]; });
}

TEST(Patches, OwnIsInTheMeanTheDerivativeAlsoOfTheWeights) {
  // By Ramani et al. 2008: the mean of b_i (f_i(z + t b) - f_i(z)) / t, b of random signs. The weights of
  // patches follow the points, too, and more so where the noise is taken for less than it is.
  constexpr std::size_t kPoints = 100 * 100;
  constexpr double kStep = 0.05;
  std::mt19937 random(7);
  std::vector<double> signs(kPoints);
  for (double& b : signs) b = (random() & 1) != 0 ? kStep : -kStep;
  const HeightField still = noisy_field(std::vector<double>(kPoints, 0)), moved = noisy_field(signs);
  for (const double stated : {1.0, 0.83})
    for (const std::size_t m : {24, 96}) {
      const auto predict = [&](const HeightField& field) {
        PatchMembers memory;
        return Patches(field, m, seeds_of(field.guide()), std::vector<double>(kPoints, stated), memory, {})
            .take_prediction();
      };
      const Prediction before = predict(still), after = predict(moved);
      double derivative = 0, own = 0;
      for (std::size_t i = 0; i < kPoints; ++i) {
        derivative += still.normal(i).z() * signs[i] / (kStep * kStep) *
                      double(after.height[i] - before.height[i]) / double(kPoints);
        own += double(before.own[i]) / double(kPoints);
      }
      EXPECT_NEAR(derivative, own, 0.1 * own) << m << " points, noise of " << stated;
    }
}

TEST(Patches, DoNotBridgeAStepFarAboveTheNoise) {
  const HeightField field = flat_field(40, [](double x, double) { return x < 20 ? 0.0 : 50.0; });
  PatchMembers memory;
  const Prediction p =
      Patches(field, 24, seeds_of(field.guide()), std::vector<double>(field.size(), 0.1), memory, {})
          .take_prediction();
  const double side = field.normal(0).z();
  std::size_t far = 0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    const double x = field.guide()[i].x();
    if (std::abs(x - 20) < 3) continue;
    ++far;
    EXPECT_NEAR(side * double(p.height[i]), x < 20 ? 0 : 50, 0.5) << x;
  }
  EXPECT_GT(far, 1000u);
}

// Noise is stated larger than it is, so that none of it is a second sheet by chance.
TEST(Patches, SeveralSheetsAreSeenWhereTheyAre) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise;
  const HeightField field = flat_field(
      40, [&](double x, double) { return noise(random) + (x < 20 ? 0 : 8 * double(random() % 2)); });
  PatchMembers memory;
  const Patches patches(field, 48, seeds_of(field.guide()), std::vector<double>(field.size(), 1.4), memory,
                        {});
  const std::vector<Index>& several = patches.with_several_sheets();
  EXPECT_TRUE(std::is_sorted(several.begin(), several.end()));
  std::size_t there = 0;
  for (const Index i : several) {
    EXPECT_GT(field.guide()[i].x(), 15);
    there += std::size_t(field.guide()[i].x() > 24);
  }
  EXPECT_GT(there, 30u);
}

TEST(Patches, PlacesWithoutASeedGetOneOfTheirOwn) {
  const HeightField field = flat_field(30, [](double x, double y) { return 0.1 * x - 0.2 * y; });
  PatchMembers memory;
  const Prediction p =
      Patches(field, 16, {Index{0}}, std::vector<double>(field.size(), 1), memory, {}).take_prediction();
  for (std::size_t i = 0; i < field.size(); ++i) {
    ASSERT_TRUE(p.covered[i]);
    EXPECT_NEAR(double(p.height[i]), field.height(i), 1e-4);
  }
}

TEST(Patches, SameForAnyNumberOfThreads) {
  const HeightField field =
      flat_field(200, [](double x, double y) { return std::sin(3 * x) * std::cos(2 * y); });
  ASSERT_GT(field.size(), 2 * 16384u);  // several ranges of points that are added up side by side
  const std::vector<double> sigma(field.size(), 0.3);
  const auto predicted = [&](int threads) {
    Context context;
    context.threads = threads;
    Prediction p;
    in_arena(context, [&] {
      PatchMembers memory;
      p = Patches(field, 48, seeds_of(field.guide()), sigma, memory, context).take_prediction();
    });
    return p;
  };
  const Prediction one = predicted(1);
  for (const int threads : test::several_threads()) {
    const Prediction many = predicted(threads);
    EXPECT_EQ(one.height, many.height);
    EXPECT_EQ(one.own, many.own);
    EXPECT_EQ(one.covered, many.covered);
  }
}

}  // namespace
