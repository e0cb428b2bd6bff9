#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <rfsmooth/denoise.h>

#include "pipeline/outliers.h"
#include "tests/support/awkward_clouds.h"
#include "tests/support/threads.h"

namespace rfsmooth::pipeline {
namespace {

using Flat = std::vector<double>;

Flat flat(const Positions& points, const Eigen::Vector3d& origin = Eigen::Vector3d::Zero()) {
  Flat xyz;
  for (const auto& p : points)
    for (int axis = 0; axis < 3; ++axis) xyz.push_back(p[axis] + origin[axis]);
  return xyz;
}

Flat sphere(std::size_t n = 1500) {
  return flat(test::noisy_sphere(n, 0.01, 3));
}

DenoiseOptions hc(int steps = 5) {
  DenoiseOptions options;
  options.flow.flow = HcOptions();
  iterations(options.flow.flow) = steps;
  return options;
}

DenoiseReport run(Flat& xyz, const DenoiseOptions& options, const Context& context = {}) {
  auto result = denoise(xyz.data(), xyz.size() / 3, options, context);
  EXPECT_TRUE(result.ok()) << result.error().message;
  return std::move(result).value();
}

bool same_bits(const Flat& a, const Flat& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

double mean_square_off_sphere(const Flat& xyz) {
  double sum = 0;
  for (std::size_t i = 0; i < xyz.size(); i += 3) {
    const double off = std::hypot(xyz[i], xyz[i + 1], xyz[i + 2]) - 1;
    sum += off * off;
  }
  return sum / double(xyz.size() / 3);
}

double largest_difference(const Flat& a, const Flat& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

TEST(Denoise, TakesNoiseOffASphere) {
  Flat xyz = sphere();
  const double before = mean_square_off_sphere(xyz);
  run(xyz, hc(10));
  EXPECT_LT(mean_square_off_sphere(xyz), 0.5 * before);
}

TEST(Denoise, ZeroStepsChangeNothing) {
  const Flat original = sphere();
  Flat xyz = original;
  const DenoiseReport report = run(xyz, hc(0));
  EXPECT_TRUE(same_bits(xyz, original));
  EXPECT_EQ(report.moved, 0u);
  EXPECT_EQ(report.largest_move, 0);
}

TEST(Denoise, NonFiniteRowsStayAndInfluenceNothing) {
  const Flat clean = sphere();
  Flat alone = clean;
  run(alone, hc());
  const double nan = std::nan("7");
  Flat mixed = {nan, 1, 2, 0.5, -INFINITY, nan};
  mixed.insert(mixed.end(), clean.begin(), clean.end());
  mixed.insert(mixed.end(), {INFINITY, nan, -0.0});
  const Flat before = mixed;
  const DenoiseReport report = run(mixed, hc());
  EXPECT_EQ(report.finite, clean.size() / 3);
  EXPECT_EQ(std::memcmp(mixed.data(), before.data(), 6 * sizeof(double)), 0);
  EXPECT_EQ(std::memcmp(&mixed[mixed.size() - 3], &before[before.size() - 3], 3 * sizeof(double)), 0);
  EXPECT_EQ(std::memcmp(&mixed[6], alone.data(), alone.size() * sizeof(double)), 0);
}

TEST(Denoise, RowsThatShareAPositionMoveTogether) {
  const Flat once = sphere(800);
  Flat twice = once;
  twice.insert(twice.end(), once.begin(), once.end());
  const DenoiseReport report = run(twice, hc());
  EXPECT_EQ(report.distinct, 800u);
  for (std::size_t i = 0; i < once.size(); ++i) EXPECT_EQ(twice[i], twice[i + once.size()]);
}

TEST(Denoise, OrderOfRowsDoesNotMatter) {
  const Flat xyz = sphere();
  const std::size_t n = xyz.size() / 3;
  std::vector<std::size_t> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937_64(5));
  Flat straight = xyz, shuffled(xyz.size());
  for (std::size_t i = 0; i < n; ++i) std::copy_n(&xyz[3 * order[i]], 3, &shuffled[3 * i]);
  run(straight, hc());
  run(shuffled, hc());
  for (std::size_t i = 0; i < n; ++i)
    EXPECT_EQ(std::memcmp(&shuffled[3 * i], &straight[3 * order[i]], 3 * sizeof(double)), 0);
}

TEST(Denoise, SameBytesForAnyNumberOfThreads) {
  Flat one = sphere(10000);
  const Flat original = one;
  Context context;
  context.threads = 1;
  run(one, hc(), context);
  for (const int threads : test::several_threads()) {
    Flat other = original;
    context.threads = threads;
    run(other, hc(), context);
    EXPECT_TRUE(same_bits(one, other)) << threads << " threads";
  }
}

TEST(Denoise, FarFromTheOriginTheSameDisplacements) {
  const Eigen::Vector3d utm(500000, 4649776, 130);
  const Positions points = test::noisy_sphere(2000, 0.01, 3);
  Flat near = flat(points), far = flat(points, utm);
  run(near, hc());
  run(far, hc());
  // One ulp at 4.6e6 is 1e-9: the input is rounded to it, the output once more.
  for (std::size_t i = 0; i < near.size(); ++i) EXPECT_NEAR(far[i] - utm[int(i % 3)], near[i], 1e-7);
}

TEST(Denoise, CancelledAtAnyReportLeavesTheCloudAsItWas) {
  const Flat original = sphere(500);
  int reports = 0;
  Context counting;
  counting.progress = [&](std::string_view, double) { return ++reports > 0; };
  Flat all = original;
  run(all, hc(3), counting);
  ASSERT_GT(reports, 3);
  for (int stop_at = 1; stop_at <= reports; ++stop_at) {
    Flat xyz = original;
    int seen = 0;
    Context context;
    context.progress = [&](std::string_view, double) { return ++seen < stop_at; };
    const auto result = denoise(xyz.data(), xyz.size() / 3, hc(3), context);
    ASSERT_FALSE(result.ok()) << stop_at;
    EXPECT_EQ(result.error().code, ErrorCode::cancelled);
    EXPECT_TRUE(same_bits(xyz, original));
  }
}

TEST(Denoise, StopFlagIsSeen) {
  const Flat original = sphere(500);
  Flat xyz = original;
  const std::atomic<bool> stop{true};
  Context context;
  context.stop = &stop;
  const auto result = denoise(xyz.data(), xyz.size() / 3, hc(), context);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::cancelled);
  EXPECT_TRUE(same_bits(xyz, original));
}

TEST(Denoise, ProgressNeverFallsWithinAStageAndIsInRange) {
  Flat xyz = sphere(500);
  std::string stage;
  double last = 0;
  Context context;
  context.progress = [&](std::string_view name, double fraction) {
    if (name != stage) last = 0;
    stage = name;
    EXPECT_GE(fraction, last);
    EXPECT_LE(fraction, 1);
    last = fraction;
    return true;
  };
  run(xyz, hc(), context);
}

TEST(Denoise, WrongOptionsAreNamed) {
  Flat xyz = sphere(10);
  DenoiseOptions options = hc();
  std::get<HcOptions>(options.flow.flow).alpha = 2;
  const auto result = denoise(xyz.data(), 10, options, {});
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::usage);
  EXPECT_THAT(result.error().message, ::testing::HasSubstr("alpha"));
}

TEST(Denoise, MorePointsThanItCanCountAreRefusedBeforeTheyAreRead) {
  const auto result = denoise(nullptr, 300'000'001, {}, {});
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::usage);
  EXPECT_THAT(result.error().message, ::testing::HasSubstr("at most 300000000"));
}

TEST(Denoise, NothingUsableIsAnError) {
  EXPECT_EQ(denoise(nullptr, 0, hc(), {}).error().code, ErrorCode::no_usable_points);
  Flat xyz(6, std::nan(""));
  EXPECT_EQ(denoise(xyz.data(), 2, hc(), {}).error().code, ErrorCode::no_usable_points);
}

TEST(Denoise, EffectiveOptionsGiveTheSameBytesAgain) {
  const Flat original = sphere(1000);
  Flat first = original, second = original;
  DenoiseOptions automatic;
  automatic.flow.modifiers.push_back = true;
  const DenoiseReport report = run(first, automatic);
  EXPECT_FALSE(std::get<AutomaticOptions>(report.effective.flow.flow).noise) << "measured, not asked for";
  run(second, report.effective);
  EXPECT_TRUE(same_bits(first, second));
}

TEST(Denoise, FewPointsAndDegenerateOnesStayWhereTheyAre) {
  const std::vector<std::pair<const char*, Flat>> clouds = {
      {"one", {1, 2, 3}},
      {"two coincident", {1, 2, 3, 1, 2, 3}},
      {"a hundred coincident", Flat(300, 0.25)},
  };
  for (const auto& [name, original] : clouds) {
    SCOPED_TRACE(name);
    Flat xyz = original;
    const DenoiseReport report = run(xyz, hc(10));
    EXPECT_TRUE(same_bits(xyz, original));
    EXPECT_EQ(report.moved, 0u);
  }
}

TEST(Denoise, SaysWhyNothingWasSmoothed) {
  const auto why_not = [](Flat xyz, const AnyFlow& flow) {
    const Flat before = xyz;
    DenoiseOptions options;
    options.flow.flow = flow;
    const auto why = run(xyz, options).not_smoothed;
    EXPECT_EQ(same_bits(xyz, before), why.has_value());
    return why;
  };
  const auto automatic = [](int iterations, double strength) {
    AutomaticOptions options;
    options.iterations = iterations;
    options.strength = strength;
    return options;
  };
  Flat plane;
  for (int i = 0; i < 400; ++i) plane.insert(plane.end(), {double(i / 20), double(i % 20), 0});
  EXPECT_EQ(why_not(sphere(500), automatic(1, 1)), std::nullopt);
  EXPECT_EQ(why_not(sphere(500), automatic(0, 1)), NotSmoothed::no_iterations);
  EXPECT_EQ(why_not(sphere(500), automatic(1, 0)), NotSmoothed::no_strength);
  EXPECT_EQ(why_not(plane, automatic(1, 1)), NotSmoothed::too_little_noise);
  EXPECT_EQ(why_not(Flat(plane.begin(), plane.begin() + 30), automatic(1, 1)), NotSmoothed::too_few_points);
  EXPECT_EQ(why_not({1, 2, 3}, automatic(1, 1)), NotSmoothed::too_few_points);
  EXPECT_EQ(why_not(sphere(500), hc(1).flow.flow), std::nullopt);
  EXPECT_EQ(why_not(sphere(500), hc(0).flow.flow), NotSmoothed::no_iterations);
}

TEST(Denoise, KnowsWhatIsLeftOfTheNoise) {
  const std::pair<double, int> strengths_and_steps[] = {{0.5, 3}, {1, 1}, {2, 3}};
  for (const auto& [strength, steps] : strengths_and_steps) {
    Flat xyz = sphere();
    AutomaticOptions automatic;
    automatic.strength = strength;
    automatic.iterations = steps;
    DenoiseOptions options;
    options.flow.flow = automatic;
    const double left = run(xyz, options).noise_left.value();
    EXPECT_NEAR(left, std::sqrt(mean_square_off_sphere(xyz)), 0.5 * left) << strength << ' ' << steps;
  }
}

TEST(Denoise, SaysNothingOfWhatIsLeftWhereItCannotTell) {
  std::vector<Modifiers> all(3);
  all[0].push_back = true;
  all[1].threshold = ThresholdKind::one_ring;
  all[2].preserve = Preserve::height_field;
  std::vector<DenoiseOptions> several(all.size(), DenoiseOptions());
  for (std::size_t i = 0; i < all.size(); ++i) several[i].flow.modifiers = all[i];
  several.push_back(hc());
  const Flat original = sphere(500);
  for (const DenoiseOptions& options : several) {
    Flat xyz = original;
    EXPECT_FALSE(run(xyz, options).noise_left);
  }
  Flat xyz = original;
  const auto half = denoise(xyz.data(), xyz.size() / 3, {}, {}, Flat(xyz.size() / 3, 0.5));
  EXPECT_FALSE(half.value().noise_left);
}

TEST(Denoise, NeverThrowsAPointFar) {
  auto clouds = test::awkward_clouds(150);
  clouds.push_back({"two", {{0, 0, 0}, {1, 0, 0}}});
  clouds.push_back({"three", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
  clouds.push_back({"four", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
  for (const auto& cloud : clouds)
    for (AnyFlow flow : {AnyFlow(HcOptions()), AnyFlow(LaplacianOptions())}) {
      SCOPED_TRACE(cloud.name + std::string(" ").append(name_of(flow)));
      const Flat original = flat(cloud.points);
      double low = INFINITY, high = -INFINITY;
      for (const double v : original) {
        low = std::min(low, v);
        high = std::max(high, v);
      }
      Flat xyz = original;
      DenoiseOptions options;
      iterations(flow) = 10;
      options.flow.flow = flow;
      const auto result = denoise(xyz.data(), xyz.size() / 3, options, {});
      EXPECT_EQ(result.ok(), !original.empty());
      if (!result.ok()) {
        EXPECT_EQ(result.error().code, ErrorCode::no_usable_points) << result.error().message;
        continue;
      }
      EXPECT_LE(largest_difference(xyz, original), high - low);
      for (const double v : xyz) EXPECT_TRUE(std::isfinite(v));
    }
}

TEST(Denoise, AStrayStaysAndDragsNobody) {
  const Positions points = test::noisy_sphere(3000, 0.005, 3);
  Flat alone = flat(points), with_stray = alone;
  with_stray.insert(with_stray.end(), {30, 0, 0});
  const DenoiseReport without = run(alone, hc(10)), with = run(with_stray, hc(10));
  EXPECT_EQ(with_stray[with_stray.size() - 3], 30);
  EXPECT_LE(with.largest_move, 2 * without.largest_move);
}

/// A plane in which one point in twenty has four times the noise of the others. Some of them stand so far off
/// that they look like outliers.
Positions plane_with_tails(unsigned seed, int n = 5000) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> place(0, std::sqrt(double(n)));
  Positions points;
  for (int i = 0; i < n; ++i)
    points.emplace_back(place(engine), place(engine), (i % 20 == 0 ? 4 : 1) * 0.35 * normal(engine));
  return points;
}

TEST(Denoise, FlagsOfOutliersAreThereIfAnyIs) {
  std::size_t without = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    Flat xyz = flat(plane_with_tails(seed, 1000));
    const DenoiseReport report = run(xyz, {});
    EXPECT_GT(report.tail_times, 1);
    EXPECT_EQ(report.outlier.empty(), report.outliers == 0);
    without += report.outliers == 0;
  }
  EXPECT_GT(without, 0u);
  EXPECT_LT(without, 6u);
}

// The four strays look like outliers, too, and are: also the one on the plane, beyond its rim.
TEST(Denoise, PointsOfTheTailsAreSmoothedAndStraysStay) {
  Positions points = plane_with_tails(5);
  const Positions strays = {{20, 20, 30}, {40, 30, -40}, {50, 60, 35}, {100, 35, 0}};
  points.insert(points.end(), strays.begin(), strays.end());
  const Flat before = flat(points);
  Flat after = before;
  const DenoiseReport report = run(after, {});
  EXPECT_GT(report.tail_times, 2);
  EXPECT_LE(report.outliers, 6u) << "of 250 normal deviates one or two go beyond what is believed of noise";
  for (std::size_t i = 0; i < 5000; ++i)
    if (report.outlier[i] == 0) {
      EXPECT_LT(std::abs(after[3 * i + 2]), 1.2) << i;
    }
  for (std::size_t i = 5000; i < points.size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(report.outlier[i], 1);
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(after[3 * i + axis], before[3 * i + axis]);
  }
}

// Even where it looks like an outlier and is put onto the smoothed surface.
TEST(Denoise, RowsOfOnePointMoveByTheLeastOfTheirStrengths) {
  constexpr double kHeight = 3;
  Positions points = plane_with_tails(5, 2000);
  points.emplace_back(20, 20, kHeight);
  EXPECT_EQ(find_outliers(points, {}).back(), 1);
  points.push_back(points.back());
  const Flat before = flat(points);
  for (const double least : {1.0, 0.5, 0.0}) {
    SCOPED_TRACE(least);
    std::vector<double> strength(points.size(), 1);
    strength.back() = least;
    Flat after = before;
    EXPECT_TRUE(denoise(after.data(), points.size(), {}, {}, strength).ok());
    EXPECT_EQ(after[after.size() - 4], after.back());
    EXPECT_NEAR(after.back(), kHeight * (1 - least), 0.6);
  }
}

TEST(Denoise, WithoutEqualizingPointsMoveAlongNormalsOnly) {
  const Flat before = sphere(4000);
  DenoiseOptions options;
  AutomaticOptions automatic;
  automatic.equalize = false;
  options.flow.flow = automatic;
  Flat after = before;
  const DenoiseReport report = run(after, options);
  EXPECT_EQ(report.equalized_largest, 0);
  double along = 0, across = 0;
  for (std::size_t i = 0; i < before.size(); i += 3) {
    const Eigen::Vector3d from(&before[i]), move = Eigen::Vector3d(&after[i]) - from, n = from.normalized();
    along += std::pow(move.dot(n), 2);
    across += (move - n * n.dot(move)).squaredNorm();
  }
  EXPECT_LT(std::sqrt(across), 0.1 * std::sqrt(along));
  after = before;
  EXPECT_GT(run(after, {}).equalized_rms, 0);
}

TEST(Denoise, NoPointLeavesItsRing) {
  // A sheet of spacing 1 whose last two rows are farther apart.
  Flat xyz;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) xyz.insert(xyz.end(), {double(i) * (i > 17 ? 2 : 1), double(j), 0});
  const Flat before = xyz;
  run(xyz, hc(50));
  EXPECT_LE(largest_difference(xyz, before), 4);
}

TEST(Denoise, StatisticsOfARunGiveItsBytesAgainAndThoseOfAnotherCloudOthers) {
  const Flat before = sphere();
  Flat first = before, again = before, other = before;
  const DenoiseReport report = run(first, {});
  DenoiseOptions same;
  same.statistics = report.statistics;
  run(again, same);
  EXPECT_TRUE(same_bits(first, again));
  DenoiseOptions louder = same;
  louder.statistics->noise->sigma *= 2;
  run(other, louder);
  EXPECT_FALSE(same_bits(first, other)) << "they are used";
  Flat outside = before;
  outside[0] += 10;
  const auto refused = denoise(outside.data(), outside.size() / 3, same, {});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
}

TEST(Denoise, StatisticsThatNoCloudHasAreRefused) {
  Flat xyz = sphere();
  const Statistics right = run(xyz, {}).statistics;
  ASSERT_TRUE(right.noise && right.box && !right.passes.empty() && !right.passes[0].scales.empty());
  EXPECT_THAT(check(right), ::testing::IsEmpty());
  const auto expect_refused = [&](const auto& change, const char* why) {
    DenoiseOptions options;
    options.statistics = right;
    change(*options.statistics);
    const auto refused = denoise(xyz.data(), xyz.size() / 3, options, {});
    ASSERT_FALSE(refused.ok()) << why;
    EXPECT_EQ(refused.error().code, ErrorCode::usage);
    EXPECT_THAT(refused.error().message, ::testing::HasSubstr(why));
  };
  expect_refused([](Statistics& s) { std::swap(s.box->low, s.box->high); }, "box");
  expect_refused([](Statistics& s) { s.noise->sites.emplace_back(0, 0, 0); }, "sites");
  expect_refused([](Statistics& s) { s.noise->spacing_at_sites.assign(s.noise->sites.size() + 1, 1); },
                 "sites");
  expect_refused([](Statistics& s) { s.noise->at_sites[0] = std::nan(""); }, "noise");
  expect_refused([](Statistics& s) { s.noise->shared = 0; }, "noise");
  expect_refused([](Statistics& s) { s.passes[0].scales[0].members = 0; }, "passes");
  expect_refused([](Statistics& s) { s.passes[0].scales[0].thinnings = std::size_t(-1); }, "passes");
  expect_refused([](Statistics& s) { s.passes[0].shares.pop_back(); }, "passes");
  expect_refused(
      [](Statistics& s) {
        for (double& share : s.passes[0].shares) share = 0;
      },
      "shares");
  expect_refused([](Statistics& s) { s.passes[0].shares[0] = -1; }, "shares");
  expect_refused(
      [](Statistics& s) {
        s.noise->sites.clear();
        s.noise->at_sites.clear();
        s.noise->spacing_at_sites.clear();
        s.noise->told_at_sites.clear();
        s.noise->shared_at_sites.clear();
      },
      "no site");
  expect_refused([](Statistics& s) { s.noise->spacing = 0; }, "spacing");
  expect_refused([](Statistics& s) { s.noise->sigma = 1e200; }, "no length");
  expect_refused([](Statistics& s) { s.noise->shape = 2; }, "shape");
  expect_refused([](Statistics& s) { s.noise->sites[0][1] = 1e308; }, "farther away");
  expect_refused([](Statistics& s) { s.noise->sites[0][2] = std::nan(""); }, "farther away");
  expect_refused([](Statistics& s) { s.noise->spacing_at_sites.assign(s.noise->sites.size(), 0); },
                 "the spacing none above 0");
  expect_refused([](Statistics& s) { s.noise->shared_at_sites.assign(s.noise->sites.size(), 0.5); },
                 "share it at a site");
  expect_refused([](Statistics& s) { s.tails = {0.5, 0, 1, 1}; }, "tails: times");
  expect_refused([](Statistics& s) { s.tails = {0.5, 1e9, 1, 1}; }, "tails: times");
  expect_refused([](Statistics& s) { s.tails = {0.5, 3, 0, 1}; }, "tails: narrow");
  expect_refused([](Statistics& s) { s.tails = {1, 3, 1, 1}; }, "tails: share");
  expect_refused([](Statistics& s) { s.tails = {0.5, 3, 1, -1}; }, "tails: together");
  expect_refused([](Statistics& s) { s.sheets = {8, 0}; }, "sheets: variance");
  expect_refused([&](Statistics& s) { s.parts = {{1, right}, {0, right}}; }, "the densest first");
  expect_refused([](Statistics& s) { s.parts = {{0, Statistics()}}; }, "parts: one has no noise");
  expect_refused(
      [&](Statistics& s) {
        s.parts = {{0, right}};
        s.parts[0].own.tails = {0.5, 0, 1, 1};
      },
      "parts: tails: times");
  expect_refused([](Statistics& s) { s.sheets = {std::nan(""), 1}; }, "sheets: evidence");
  expect_refused([](Statistics& s) { s.scale = {0.1, 0, 0.1}; }, "scale: neighbours");
  expect_refused([](Statistics& s) { s.scale = {0.1, 20, std::nan("")}; }, "scale: sigma or radius");
  expect_refused([](Statistics& s) { s.reach = -1; }, "reach");
  expect_refused([](Statistics& s) { s.spacing = std::numeric_limits<double>::infinity(); }, "spacing");
  expect_refused([](Statistics& s) { s.points = 0; }, "points");
  expect_refused(
      [](Statistics& s) {
        Statistics::Pass& pass = s.passes[0];
        pass.scales.resize(Statistics::Pass::kMostScales + 1, pass.scales[0]);
        pass.shares.clear();
      },
      "passes");
}

TEST(Denoise, WhatARunFindsAreStatisticsHoweverFewPointsThereAre) {
  std::mt19937_64 engine(6);
  std::normal_distribution<double> normal(0, 1);
  for (const double scale : {0.0, 1e-9, 1.0, 1e9})
    for (const std::size_t n : {1, 2, 3, 5, 9, 17, 40, 100, 300}) {
      SCOPED_TRACE(testing::Message() << n << " points, times " << scale);
      Flat xyz;
      for (std::size_t i = 0; i < 3 * n; ++i) xyz.push_back((i % 3 == 2 ? 0.05 : 1) * scale * normal(engine));
      EXPECT_THAT(check(run(xyz, {}).statistics), ::testing::IsEmpty());
    }
}

// Where far points stand together it is shape, not tails, and a part of a cloud is told so by the whole.
TEST(Denoise, HowFarPointsStandTogetherIsOfTheWholeCloud) {
  Flat before = sphere();
  for (std::size_t i = 0; i < before.size(); i += 30)  // a tenth is some sigma farther off
    for (std::size_t k = 0; k < 3; ++k) before[i + k] *= i % 60 == 0 ? 1.05 : 0.95;
  Flat first = before, told = before;
  const DenoiseReport report = run(first, {});
  ASSERT_TRUE(report.statistics.tails.has_value());
  EXPECT_GT(report.statistics.tails->share, 0);
  EXPECT_LT(report.statistics.tails->together, 1.6) << "each by itself";
  DenoiseOptions other;
  other.statistics = report.statistics;
  other.statistics->tails->together = 10;
  run(told, other);
  EXPECT_FALSE(same_bits(first, told));
}

TEST(Denoise, TheNoiseThatIsReportedIsTheOneThatTellsOutliers) {
  constexpr double kOff = 0.2, kTimes = 6;  // off the sphere: 20 sigma, and 3.3 of a noise six times as large
  Flat before = sphere(3000);
  for (const double side : {-1.0, 1.0})
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 0; k < 3; ++k) before.push_back(k == axis ? side * (1 + kOff) : 0);
  Flat xyz = before;
  const DenoiseReport report = run(xyz, {});
  ASSERT_TRUE(report.statistics.noise.has_value());
  EXPECT_EQ(report.noise, report.statistics.noise->sigma);
  EXPECT_LT(5 * report.noise, kOff);
  EXPECT_GT(5 * kTimes * report.noise, kOff);
  EXPECT_EQ(report.outliers, 6u);
  DenoiseOptions louder;
  louder.statistics.emplace();
  louder.statistics->box = report.statistics.box;
  louder.statistics->noise = report.statistics.noise;
  louder.statistics->noise->sigma *= kTimes;
  for (double& sigma : louder.statistics->noise->at_sites) sigma *= kTimes;
  xyz = before;
  const DenoiseReport other = run(xyz, louder);
  EXPECT_EQ(other.noise, kTimes * report.noise);
  EXPECT_EQ(other.outliers, 0u) << "within five sigma of what is reported";
}

}  // namespace
}  // namespace rfsmooth::pipeline
