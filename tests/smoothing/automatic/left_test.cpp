#include "smoothing/automatic/left.h"

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/near.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;

namespace {

constexpr int kAcross = 100;
constexpr float kOwn = 0.03F;

/// A plane whose left half has noise of 1 and whose right half of 0.1, smoothed so that each point keeps
/// `kOwn` of its own height. `stated`: what the noise is said to be, over what it is.
struct Halves {
  explicit Halves(double stated_left, double stated_right) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    Positions guide, data;
    for (int i = 0; i < kAcross; ++i)
      for (int j = 0; j < kAcross; ++j) {
        guide.emplace_back(i + 0.3 * std::sin(5.0 * j), j + 0.3 * std::cos(3.0 * i), 0);
        const bool left = i < kAcross / 2;
        const double sigma = left ? 1 : 0.1, z = sigma * normal(random);
        data.push_back(guide.back() + Eigen::Vector3d(0, 0, z));
        // The others' noise is as large as the point's own part of it, once it is weighed alike.
        const double of_others = std::sqrt(kOwn * (1 - kOwn)) * sigma * normal(random);
        error.push_back(kOwn * z + of_others);
        noise.local.push_back((left ? stated_left : stated_right) * sigma);
      }
    noise.sigma = stated_left;
    field = std::make_unique<HeightField>(guide, rfs_mesh::KdTree(guide, {}), support::near_on(guide), data,
                                          NoiseModel(), Context{});
    for (std::size_t i = 0; i < guide.size(); ++i) height.push_back(float(error[i] * field->normal(i).z()));
  }

  double left() const {
    return noise_left(*field, height, std::vector<float>(height.size(), kOwn), noise, {});
  }

  double truth() const {
    double squares = 0;
    for (const double e : error) squares += e * e;
    return std::sqrt(squares / double(error.size()));
  }

  std::unique_ptr<HeightField> field;
  std::vector<double> error;
  std::vector<float> height;
  rfs_mesh::NoiseField noise;
};

TEST(NoiseLeft, IsTheErrorOfWhatWasSmoothed) {
  const Halves halves(1, 1);
  EXPECT_NEAR(halves.left(), halves.truth(), 0.2 * halves.truth());
}

// The residuals tell how far off the measure is, of loud and calm places each.
TEST(NoiseLeft, DoesNotHangOnHowWellTheNoiseWasMeasured) {
  for (const double left : {0.8, 1.25})
    for (const double right : {0.8, 1.25}) {
      const Halves halves(left, right);
      EXPECT_NEAR(halves.left(), halves.truth(), 0.2 * halves.truth()) << left << ' ' << right;
    }
}

TEST(NoiseLeft, StraysDoNotCount) {
  Halves halves(1, 1);
  const double without = halves.left();
  halves.height[5] = 40;
  EXPECT_NEAR(halves.left(), without, 0.1 * without);  // 3 times, if it did
}

}  // namespace
