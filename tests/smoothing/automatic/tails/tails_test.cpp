#include "smoothing/automatic/tails/tails.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

using namespace rfsmooth;
using namespace rfsmooth::smoothing;

namespace {

Statistics::Tails law_of(double share, double times, double narrow = 1) {
  Statistics::Tails law;
  law.share = share;
  law.times = times;
  law.narrow = narrow;
  return law;
}

/// Of the law, in units of the measured noise.
std::vector<double> drawn(const Statistics::Tails& law, std::size_t count) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> even;
  std::vector<double> values(count);
  for (double& v : values) v = law.narrow * (even(random) < law.share ? law.times : 1) * normal(random);
  return values;
}

const std::vector<Statistics::Tails>& laws() {
  static const std::vector<Statistics::Tails> all = {law_of(0.05, 4), law_of(0.2, 4, 0.65), law_of(0.2, 2.2),
                                                     law_of(0.35, 8)};
  return all;
}

TEST(Tails, AreFoundAsTheyWereDrawn) {
  for (const Statistics::Tails& law : {law_of(0.05, 4), law_of(0.2, 4), law_of(0.2, 3)}) {
    const std::vector<double> values = drawn(law, 100000);
    std::vector<float> residuals(values.begin(), values.end()), least(residuals);
    for (float& r : least) r = std::abs(r);
    const Statistics::Tails found = find_tails(residuals, least);
    EXPECT_NEAR(found.share, law.share, 0.02);
    EXPECT_NEAR(found.times, law.times, 0.05 * law.times);
    EXPECT_NEAR(found.narrow, law.narrow, 0.02);
  }
}

TEST(Tails, ANormalDistributionHasNone) {
  const std::vector<double> values = drawn(law_of(0, 1), 100000);
  std::vector<float> residuals(values.begin(), values.end()), least(residuals);
  for (float& r : least) r = std::abs(r);
  EXPECT_EQ(find_tails(residuals, least).share, 0);
}

// Beside recesses and on fins patches are narrow, and many points follow themselves: what is left of them
// says nothing, neither of the noise nor of tails.
TEST(Tails, PointsThatFollowThemselvesDoNotMakeTheOthersFar) {
  for (const double following : {0.3, 0.45}) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> even;
    const std::vector<double> values = drawn(law_of(0, 1), 100000);
    std::vector<float> residuals(values.begin(), values.end()), least(residuals);
    for (std::size_t i = 0; i < least.size(); ++i) {
      least[i] = std::abs(least[i]);
      if (even(random) < 0.05) residuals[i] *= 5;  // off the wide patch, beside an edge
      if (even(random) < following) least[i] *= 0.01F;
    }
    EXPECT_EQ(find_tails(residuals, least).share, 0) << following;
    // True ones are found all the same.
    const std::vector<double> wide = drawn(law_of(0.1, 4), 100000);
    std::vector<float> off(wide.begin(), wide.end());
    for (std::size_t i = 0; i < least.size(); ++i)
      least[i] = std::abs(off[i]) * (even(random) < following ? 0.01F : 1.0F);
    EXPECT_NEAR(find_tails(off, least).share, 0.1, 0.02) << following;
  }
}

TEST(Tails, WithoutThemAResidualIsItself) {
  const Tails none;
  for (const double r : {-7.0, -0.5, 0.0, 2.0, 30.0}) {
    EXPECT_EQ(none.weight(r), 1);
    EXPECT_EQ(none.normal_score(r), r);
  }
  EXPECT_EQ(none.noise(), 1);
  EXPECT_EQ(none.unit(), 1);
}

// What makes the mean of pseudo-observations follow the surface that the points show: taken from a surface
// that is a little off, they bring it back all the way, and no farther.
TEST(Tails, PseudoObservationsDoNotHangOnTheSurfaceThatTheyWereTakenFrom) {
  for (const Statistics::Tails& law : laws()) {
    const Tails tails(law);
    const std::vector<double> values = drawn(law, 400000);
    const double off = 0.1 * law.narrow;
    double sum = 0;
    for (const double r : values) sum += (r + off) * tails.weight(r + off);
    EXPECT_NEAR(sum / double(values.size()) / off, 1, 0.06) << law.share << ' ' << law.times;
  }
}

TEST(Tails, PseudoObservationsHaveTheNoiseThatIsStated) {
  for (const Statistics::Tails& law : laws()) {
    const Tails tails(law);
    const std::vector<double> values = drawn(law, 400000);
    double squares = 0;
    for (const double r : values) squares += std::pow(r * tails.weight(r), 2);
    const double stated = tails.noise();
    EXPECT_NEAR(std::sqrt(squares / double(values.size())), stated, 0.01 * stated);
    EXPECT_GE(stated, law.narrow);
    EXPECT_LE(stated, law.narrow * std::sqrt(1 + law.share * (law.times * law.times - 1)));
  }
}

TEST(Tails, NormalScoresAreNormal) {
  for (const Statistics::Tails& law : laws()) {
    const Tails tails(law);
    std::vector<double> values = drawn(law, 100000);
    for (double& v : values) v = tails.normal_score(v);
    double squares = 0, fourth = 0;
    for (const double v : values) {
      squares += v * v;
      fourth += v * v * v * v;
    }
    squares /= double(values.size());
    EXPECT_NEAR(squares, 1, 0.02);
    EXPECT_NEAR(fourth / double(values.size()) / (squares * squares), 3, 0.1);
  }
}

TEST(Tails, NormalScoresAreOddAndRiseWithTheResidual) {
  for (const Statistics::Tails& law : laws()) {
    const Tails tails(law);
    double before = 0;
    EXPECT_EQ(tails.normal_score(0), 0);
    EXPECT_NEAR(tails.normal_score(1e-4 * tails.unit()), 1e-4, 1e-8);
    for (double r = 0.01; r < 100; r *= 1.2) {
      const double score = tails.normal_score(r);
      EXPECT_EQ(tails.normal_score(-r), -score);
      EXPECT_GE(score, before);
      before = score;
    }
    EXPECT_LE(before, 8);
  }
}

}  // namespace
