/// What `denoise` makes of trees before a spinning laser: leaves scatter about any quadric, and are no noise.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/pipeline/noise/noisy_sphere.h"

using namespace rfsmooth;
using namespace rfsmooth::noisy;

namespace {

constexpr double kLaserNoise = 0.02;   // of the ranges, metres
constexpr double kGroundLevel = -1.8;  // under the laser

/// Where rays from the origin are stopped: on the ground or by a leaf.
struct Forest {
  Positions ground, leaves;

  /// Each tree is eight bunches of leaves, in which a ray gets a third of a metre deep on the average.
  Forest(int rings, int trees, unsigned seed) {
    constexpr int kColumns = 1024, kBunches = 8;
    constexpr double kSteepest = 18 * M_PI / 180, kFarthest = 120;
    std::mt19937_64 engine(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal;
    std::exponential_distribution<double> depth(3);
    std::vector<Ball> bunches;
    for (int t = 0; t < trees; ++t) {
      const double turn = 2 * M_PI * uniform(engine), far = 6 + 54 * uniform(engine),
                   wide = (1 + 2 * uniform(engine)) * (1 + far / 60);
      const Eigen::Vector3d middle(far * std::cos(turn), far * std::sin(turn), 0.5 + 3.5 * uniform(engine));
      for (int b = 0; b < kBunches; ++b) {
        const Eigen::Vector3d off(normal(engine), normal(engine), normal(engine));
        bunches.push_back({middle + wide / 2 * off, wide * (0.25 + 0.25 * uniform(engine))});
      }
    }
    for (int ring = 0; ring < rings; ++ring) {
      const double up = kSteepest * (2.0 * ring / (rings - 1) - 1);
      for (int column = 0; column < kColumns; ++column) {
        const double turn = 2 * M_PI * column / kColumns;
        const Eigen::Vector3d ray(std::cos(up) * std::cos(turn), std::cos(up) * std::sin(turn), std::sin(up));
        const double to_ground = up < 0 ? kGroundLevel / ray.z() : kFarthest;
        double range = to_ground;
        for (const Ball& bunch : bunches) range = std::min(range, bunch.stops(ray, depth(engine)));
        if (!(range < kFarthest)) continue;
        (range < to_ground ? leaves : ground).push_back((range + kLaserNoise * normal(engine)) * ray);
      }
    }
  }

  Positions points() const {
    Positions all = ground;
    all.insert(all.end(), leaves.begin(), leaves.end());
    return all;
  }

 private:
  struct Ball {
    Eigen::Vector3d middle;
    double radius;
    /// Where it stops a ray that gets so deep; infinite if it does not.
    double stops(const Eigen::Vector3d& ray, double deep) const {
      constexpr double kNever = std::numeric_limits<double>::infinity();
      const double along = ray.dot(middle), square = along * along - middle.squaredNorm() + radius * radius;
      if (!(along > 0 && square > 0)) return kNever;
      const double half = std::sqrt(square);
      return along > half && deep < 2 * half ? along - half + deep : kNever;
    }
  };
};

class Trees : public ::testing::TestWithParam<int> {};

// Half of these points are leaves, which stay about where they were. The laser sees the ground at a slant, so
// that only a fifth of its noise is across it; what the leaves scatter would be fifty times that.
TEST_P(Trees, LendTheGroundNoNoise) {
  Positions ground, smooth_ground, leaves, smooth_leaves;
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Forest forest(GetParam(), 80, seed);
    const Positions smooth = denoised(forest.points());
    const auto first_leaf = smooth.begin() + std::ptrdiff_t(forest.ground.size());
    ground.insert(ground.end(), forest.ground.begin(), forest.ground.end());
    leaves.insert(leaves.end(), forest.leaves.begin(), forest.leaves.end());
    smooth_ground.insert(smooth_ground.end(), smooth.begin(), first_leaf);
    smooth_leaves.insert(smooth_leaves.end(), first_leaf, smooth.end());
  }
  ASSERT_GT(leaves.size(), ground.size() / 2);
  EXPECT_LT(rms_height(smooth_ground, kGroundLevel), 2 * rms_height(ground, kGroundLevel));
  EXPECT_LT(rms_move(leaves, smooth_leaves), 4 * kLaserNoise);
}

INSTANTIATE_TEST_SUITE_P(Rings, Trees, ::testing::Values(16, 32));

}  // namespace
