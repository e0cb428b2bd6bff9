// Clouds that break spatial code, at full size, through the connection stage and through denoise with its
// defaults: each gives a correct small result or one clear error. Every case prints its processor time.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <functional>
#include <limits>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include <rfsmooth/denoise.h>

#include "tests/support/awkward_clouds.h"
#include "tests/support/connection.h"
#include "tests/support/kruskal.h"
#include "tests/support/sanitized.h"

namespace rfsmooth::pipeline {
namespace {

using Eigen::Vector3d;
using Distance = std::function<double(const Vector3d&)>;

constexpr std::size_t kMany = test::kSanitized ? 2000 : 50000;

/// A cloud and what must come out of it.
struct Hard {
  Positions rows;             ///< as a file would give them: some may not be finite
  bool clean = false;         ///< no noise: no row moves
  Distance off_surface = {};  ///< distance to the true surface; denoise must take some of it away
};

struct HardCloud {
  const char* name;
  Hard (*make)();
  friend std::ostream& operator<<(std::ostream& out, const HardCloud& c) { return out << c.name; }
};

Positions generated(std::size_t n, const std::function<Vector3d(double, double)>& at) {
  std::mt19937_64 engine(21);
  std::uniform_real_distribution<double> uniform;
  Positions points(n);
  for (Vector3d& p : points) {
    const double u = uniform(engine), v = uniform(engine);
    p = at(u, v);
  }
  return points;
}

/// A unit sphere with noise of half a spacing, scaled and moved.
Hard ball(std::size_t n, double scale = 1, const Vector3d& centre = Vector3d::Zero()) {
  const double spacing = std::sqrt(4 * M_PI / double(n));
  Hard cloud;
  cloud.rows = test::noisy_sphere(n, spacing / 2, 31);
  for (Vector3d& p : cloud.rows) p = scale * p + centre;
  cloud.off_surface = [=](const Vector3d& p) { return (p - centre).norm() - scale; };
  return cloud;
}

template <std::size_t n>
Hard few() {
  const Positions three{{0.1, 0.2, 0.3}, {1.5, -0.4, 0.2}, {0.7, 2.1, -1.3}};
  return {{three.begin(), three.begin() + n}, true};
}

/// A large ball and a small one, both with the same noise.
Hard two_clusters() {
  const double spacing = std::sqrt(4 * M_PI / double(kMany));
  const Vector3d far(1e6 * spacing, 0, 0);
  Hard cloud{test::noisy_sphere(kMany - kMany / 50, spacing / 2, 31)};
  for (const Vector3d& p : test::noisy_sphere(kMany / 50, spacing / 2, 32)) cloud.rows.push_back(far + p);
  cloud.off_surface = [=](const Vector3d& p) { return std::min(p.norm(), (p - far).norm()) - 1; };
  return cloud;
}

Hard duplicates() {
  Hard cloud = ball(kMany / 2);
  const Positions once = cloud.rows;
  cloud.rows.insert(cloud.rows.end(), once.begin(), once.end());
  std::shuffle(cloud.rows.begin(), cloud.rows.end(), std::mt19937_64(5));
  return cloud;
}

Hard grid() {
  Hard cloud{{}, true};
  const auto side = std::size_t(std::sqrt(double(kMany)));
  for (std::size_t i = 0; i < side * side; ++i)
    cloud.rows.emplace_back(double(i % side), double(i / side), 2);
  return cloud;
}

Hard solid_grid() {
  Hard cloud;
  const auto side = std::size_t(std::cbrt(double(kMany)));
  for (std::size_t i = 0; i < side * side * side; ++i)
    cloud.rows.emplace_back(double(i % side), double(i / side % side), double(i / side / side));
  return cloud;
}

/// A sheet whose density falls as 1 / x from x = 1 to x = 1000, with the noise of a scanner: the same
/// everywhere, one spacing of the dense end.
Hard falling_density() {
  const double width = 40, spacing = std::sqrt(width * std::log(1000) / double(kMany));
  Hard cloud{generated(kMany, [=](double u, double v) { return Vector3d(std::pow(1000, u), width * v, 0); })};
  std::mt19937_64 engine(22);
  std::normal_distribution<double> normal(0, spacing);
  for (Vector3d& p : cloud.rows) p[2] = normal(engine);
  cloud.off_surface = [](const Vector3d& p) { return p[2]; };
  return cloud;
}

Hard some_not_finite() {
  Hard cloud = ball(kMany);
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                        -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < kMany; i += 7) cloud.rows[i][i % 3] = bad[i / 7 % 3];
  return cloud;
}

const HardCloud kHardClouds[] = {
    {"no_points", few<0>},
    {"one_point", few<1>},
    {"two_points", few<2>},
    {"three_points", few<3>},
    {"three_identical",
     [] {
       return Hard{Positions(3, Vector3d(1, 2, 3)), true};
     }},
    {"many_identical",
     [] {
       return Hard{Positions(test::kSanitized ? 50000 : 500000, Vector3d(1, 2, 3)), true};
     }},
    {"collinear",
     [] {
       return Hard{generated(kMany, [](double u, double) -> Vector3d { return u * Vector3d(1, 2, -3); }),
                   true};
     }},
    {"coplanar",
     [] {
       const auto at = [](double u, double v) -> Vector3d {
         return u * Vector3d(1, 2, -3) + v * Vector3d(3, -1, 0.5);
       };
       return Hard{generated(kMany, at), true};
     }},
    {"two_far_clusters", two_clusters},
    {"duplicates", duplicates},
    {"grid", grid},
    {"solid_grid", solid_grid},
    {"falling_density", falling_density},
    {"tiny", [] { return ball(kMany, 1e-12); }},
    {"huge", [] { return ball(kMany, 1e12); }},
    {"far_away",
     [] {
       return ball(kMany, 1000, {1e12, -1e12, 1e12});
     }},
    {"some_not_finite", some_not_finite},
    {"none_finite",
     [] {
       return Hard{Positions(kMany, Vector3d(0, std::nan(""), 0)), true};
     }},
};

class Robustness : public testing::TestWithParam<HardCloud> {
 protected:
  template <class Body>
  auto timed(const char* what, Body&& body) {
    const std::clock_t start = std::clock();
    auto result = body();
    std::printf("%-16s %-8s %7.3f s of processor time\n", GetParam().name, what,
                double(std::clock() - start) / CLOCKS_PER_SEC);
    return result;
  }
};

INSTANTIATE_TEST_SUITE_P(Clouds, Robustness, testing::ValuesIn(kHardClouds),
                         [](const auto& cloud) { return std::string(cloud.param.name); });

TEST_P(Robustness, Connects) {
  Positions points;
  for (const Vector3d& p : GetParam().make().rows)
    if (p.allFinite()) points.push_back(p);
  const auto made = timed("connect", [&] { return rfsmooth::connect(points, {}, {}); });
  ASSERT_TRUE(made.ok()) << made.error().message;
  const Connection& c = made.value();
  test::expect_sound(c, points.size());
  EXPECT_TRUE(test::joins_all(points.size(), c.emst));
  EXPECT_TRUE(test::joins_all(points.size(), c.sdg, c.bridges));
  const double least = test::kruskal_length(points);
  EXPECT_NEAR(test::total_length(points, c.emst), least, 1e-10 * least);
}

double rms(const Positions& rows, const Distance& off_surface) {
  double sum = 0;
  std::size_t n = 0;
  for (const Vector3d& p : rows)
    if (p.allFinite()) {
      const double d = off_surface(p);
      sum += d * d;
      ++n;
    }
  return std::sqrt(sum / double(n));
}

TEST_P(Robustness, IsDenoised) {
  const Hard cloud = GetParam().make();
  std::vector<double> xyz(3 * cloud.rows.size());
  if (!xyz.empty()) std::memcpy(xyz.data(), cloud.rows.data(), xyz.size() * sizeof(double));
  const std::vector<double> before = xyz;
  const auto result = timed("denoise", [&] { return denoise(xyz.data(), xyz.size() / 3, {}, {}); });

  using Row = std::array<double, 3>;
  std::map<Row, Row> goes_to;
  std::size_t finite = 0;
  Positions after;
  for (std::size_t i = 0; i < xyz.size(); i += 3) {
    const Row from{before[i], before[i + 1], before[i + 2]}, to{xyz[i], xyz[i + 1], xyz[i + 2]};
    after.emplace_back(to[0], to[1], to[2]);
    if (!cloud.rows[i / 3].allFinite()) {
      ASSERT_EQ(std::memcmp(&from, &to, sizeof from), 0) << "row " << i / 3 << " is not finite and changed";
      continue;
    }
    ++finite;
    ASSERT_TRUE(after.back().allFinite()) << i / 3;
    ASSERT_EQ(goes_to.emplace(from, to).first->second, to) << "rows at one place went apart";
  }
  if (finite == 0) {
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, ErrorCode::no_usable_points);
    EXPECT_FALSE(result.error().message.empty());
    return;
  }
  ASSERT_TRUE(result.ok()) << result.error().message;
  const DenoiseReport& report = result.value();
  EXPECT_EQ(report.points, cloud.rows.size());
  EXPECT_EQ(report.finite, finite);
  EXPECT_EQ(report.distinct, goes_to.size());
  EXPECT_TRUE(std::isfinite(report.noise) && std::isfinite(report.spacing) && std::isfinite(report.rms_move));
  EXPECT_LE(report.largest_move, 5 * report.noise + report.spacing);
  if (cloud.clean) {
    EXPECT_EQ(report.moved, 0u);
  }
  if (cloud.off_surface) {
    EXPECT_LT(rms(after, cloud.off_surface), 0.7 * rms(cloud.rows, cloud.off_surface));
  }
}

/// The ball, a power of ten or two times as large.
struct Sized {
  std::vector<double> xyz;  ///< over the size
  DenoiseReport report;
};

constexpr std::size_t kOfBall = 1500;

Sized sized_ball(double size, const DenoiseOptions& options) {
  Sized sized;
  for (const Vector3d& p : ball(kOfBall, size).rows) sized.xyz.insert(sized.xyz.end(), p.begin(), p.end());
  auto result = denoise(sized.xyz.data(), sized.xyz.size() / 3, options, {});
  EXPECT_TRUE(result.ok()) << result.error().message;
  sized.report = std::move(result).value();
  for (double& x : sized.xyz) x /= size;
  return sized;
}

/// Root mean square distance between the points of two.
double apart(const Sized& one, const Sized& other) {
  double sum = 0;
  for (std::size_t i = 0; i < one.xyz.size(); ++i) sum += std::pow(other.xyz[i] - one.xyz[i], 2);
  return std::sqrt(sum / (double(one.xyz.size()) / 3));
}

TEST(AnySize, TheSameShapeComesOutTheSame) {
  const Sized usual = sized_ball(1, {});
  EXPECT_GT(double(usual.report.moved), 0.85 * kOfBall);
  for (const double size : {1e-99, 1e-60, 1e-45, 1e-38, 1e-20, 1e20, 1e60, 1e99}) {
    if (test::kSanitized && size > 1e-99 && size < 1e99) continue;
    SCOPED_TRACE(size);
    const Sized other = sized_ball(size, {});
    EXPECT_NEAR(double(other.report.moved), double(usual.report.moved), 5);
    EXPECT_NEAR(other.report.noise / size, usual.report.noise, 1e-6);
    EXPECT_NEAR(other.report.spacing / size, usual.report.spacing, 1e-9);
    EXPECT_NEAR(other.report.rms_move / size, usual.report.rms_move, 0.01 * usual.report.noise);
    // Coordinates that are rounded differently make another mesh here and there.
    EXPECT_LT(apart(usual, other), 0.2 * usual.report.noise);
  }
}

// Powers of two round nothing, so what is measured is the same to the last bit.
TEST(AnySize, StatedNoiseStatisticsAndTraceHaveTheUnitOfTheCloud) {
  const auto options_of = [](double size) {
    AutomaticOptions automatic;
    automatic.noise = Length{0.01 * size, false};
    DenoiseOptions options;
    options.flow.flow = automatic;
    options.flow.trace = true;
    return options;
  };
  const Sized usual = sized_ball(1, options_of(1));
  for (const double size : {0x1p-200, 0x1p-60, 0x1p60, 0x1p200}) {
    if (test::kSanitized && size > 0x1p-200 && size < 0x1p200) continue;
    SCOPED_TRACE(size);
    const Sized other = sized_ball(size, options_of(size));
    EXPECT_LT(apart(usual, other), 1e-6);
    EXPECT_EQ(other.report.noise, 0.01 * size);
    EXPECT_EQ(other.report.measured.typical, usual.report.measured.typical * size);
    EXPECT_EQ(other.report.statistics.box->high[0], usual.report.statistics.box->high[0] * size);
    EXPECT_EQ(other.report.statistics.noise->sigma, usual.report.statistics.noise->sigma * size);
    EXPECT_NEAR(other.report.trace[1].area / size / size, usual.report.trace[1].area, 1e-6);
    const Sized again = sized_ball(size, other.report.effective);
    EXPECT_EQ(again.xyz, other.xyz);
  }
}

TEST(AnySize, FlowsAndFarStraysToo) {
  DenoiseOptions options;
  options.flow.flow = HcOptions();
  EXPECT_EQ(sized_ball(0x1p150, options).xyz, sized_ball(1, options).xyz);
  Hard cloud = ball(kOfBall);
  cloud.rows.emplace_back(1e30, 0, 0);
  std::vector<double> xyz;
  for (const Vector3d& p : cloud.rows) xyz.insert(xyz.end(), p.begin(), p.end());
  const auto result = denoise(xyz.data(), xyz.size() / 3, {}, {});
  ASSERT_TRUE(result.ok()) << result.error().message;
  EXPECT_EQ(xyz[3 * kOfBall], 1e30);
}

// Coordinates of any order of magnitude side by side: patches of one place, and others that no number of
// standard deviations measures.
TEST(EveryOrderOfMagnitude, GivesFinitePoints) {
  for (const int most : {40, 60})
    for (unsigned seed = 1; seed <= 4; ++seed) {
      SCOPED_TRACE(testing::Message() << "up to 2^" << most << ", seed " << seed);
      std::mt19937_64 engine(seed);
      std::uniform_int_distribution<int> power(-most, most);
      std::vector<double> xyz(3 * 400);
      for (double& x : xyz) x = std::ldexp(1, power(engine));
      AutomaticOptions automatic;
      automatic.noise = Length{0.1, false};
      DenoiseOptions options;
      options.flow.flow = automatic;
      const auto result = denoise(xyz.data(), xyz.size() / 3, options, {});
      ASSERT_TRUE(result.ok()) << result.error().message;
      for (const double x : xyz) ASSERT_TRUE(std::isfinite(x));
    }
}

}  // namespace
}  // namespace rfsmooth::pipeline
