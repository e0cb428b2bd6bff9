// What HC is for, in numbers: the noise goes, the size stays (Vollmer et al. section 4; truth the flow never
// sees).
#include <gtest/gtest.h>

#include <rfsmooth/denoise.h>

#include "clouds/shapes/sampling.h"
#include "clouds/shapes/shapes.h"

using namespace rfsmooth;

namespace {

struct Errors {
  double mean_square = 0;    ///< of the distance to the true surface
  double volume_change = 0;  ///< mean signed distance x area / volume
};

Errors errors(const clouds::Shape& shape, const std::vector<double>& xyz) {
  Errors sum;
  const double n = double(xyz.size() / 3);
  for (std::size_t i = 0; i + 2 < xyz.size(); i += 3) {
    const double d = shape.signed_distance({xyz[i], xyz[i + 1], xyz[i + 2]});
    sum.mean_square += d * d / n;
    sum.volume_change += d / n * shape.area() / *shape.volume();
  }
  return sum;
}

class DenoiseQuality : public ::testing::TestWithParam<const char*> {
 protected:
  /// Points with isotropic noise of half a spacing.
  std::vector<double> noisy() const {
    Positions points = clouds::sample(*shape_, 20000, 21);
    clouds::add_noise(points, 0.5 * clouds::mean_spacing(points), 22);
    std::vector<double> xyz;
    for (const auto& p : points) xyz.insert(xyz.end(), {p.x(), p.y(), p.z()});
    return xyz;
  }
  Errors after(const AnyFlow& flow) const {
    std::vector<double> xyz = noisy();
    DenoiseOptions options;
    options.flow.flow = flow;
    const auto report = rfsmooth::denoise(xyz.data(), xyz.size() / 3, options, {});
    EXPECT_TRUE(report.ok());
    return errors(*shape_, xyz);
  }
  std::unique_ptr<clouds::Shape> shape_ = clouds::make_shape(GetParam());
};

TEST_P(DenoiseQuality, HcTakesTheNoiseAndKeepsTheVolume) {
  const Errors before = errors(*shape_, noisy()), hc = after(HcOptions());
  EXPECT_LT(hc.mean_square, 0.4 * before.mean_square);
  EXPECT_LT(std::abs(hc.volume_change), 0.01);
}

TEST_P(DenoiseQuality, TheAutomaticFlowLeavesLessThanHalfOfWhatHcLeaves) {
  const Errors automatic = after(AutomaticOptions());
  EXPECT_LT(automatic.mean_square, 0.5 * after(HcOptions()).mean_square);
  EXPECT_LT(std::abs(automatic.volume_change), 0.01);
}

TEST_P(DenoiseQuality, TheLaplacianShrinksVisiblyMore) {
  LaplacianOptions ten;
  ten.iterations = HcOptions().iterations;
  const double start = errors(*shape_, noisy()).volume_change;
  const double hc = start - after(HcOptions()).volume_change, laplacian = start - after(ten).volume_change;
  EXPECT_GT(laplacian, 0.005) << "half a per cent of the volume can be seen";
  EXPECT_GT(laplacian, 5 * std::abs(hc));
}

INSTANTIATE_TEST_SUITE_P(Shapes, DenoiseQuality, ::testing::Values("sphere", "torus", "cube"));

// Each sheet has its own noise to average, not the other's: the wall keeps its thickness and its flatness.
TEST(DenoiseQuality, TheSheetsOfAThinWallStayApart) {
  for (const double share : {0.3, 0.5}) {
    const double thickness = 0.06;
    const Positions clean = clouds::sample(*clouds::make_plate(thickness), 12000, 1);
    const double spacing = clouds::mean_spacing(clean);
    ASSERT_NEAR(thickness / spacing, 3.5, 0.5);
    Positions points = clean;
    clouds::add_noise(points, share * spacing, 2);
    ASSERT_TRUE(rfsmooth::denoise(points[0].data(), points.size(), {}, {}).ok());
    double height[2] = {0, 0}, count[2] = {0, 0}, squares = 0;
    for (std::size_t i = 0; i < clean.size(); ++i) {
      if (std::abs(clean[i].x()) > 1 - 4 * spacing || std::abs(clean[i].y()) > 0.8 - 4 * spacing) continue;
      const std::size_t side = clean[i].z() > 0 ? 1 : 0;
      height[side] += points[i].z();
      count[side] += 1;
      squares += (points[i] - clean[i]).z() * (points[i] - clean[i]).z();
    }
    EXPECT_NEAR((height[1] / count[1] - height[0] / count[0]) / thickness, 1, 0.03) << share;
    EXPECT_LT(std::sqrt(squares / (count[0] + count[1])), 0.6 * share * spacing) << share;
  }
}

// The noise of either sheet reaches past the middle: points go to the nearer sheet, few stay between. A cube
// beside the wall says how much noise there is; a wall alone would be a louder sheet as well.
TEST(DenoiseQuality, AWallOfLessThanFourSigmaKeepsTwoFlatSheets) {
  const double thickness = 0.06, sigma = thickness / 3.6;
  const auto plate = clouds::make_plate(thickness), cube = clouds::make_shape("cube");
  constexpr std::size_t kOfWall = 12000;
  Positions points = clouds::sample(*plate, kOfWall, 1);
  const double inside = 1 - 4 * clouds::mean_spacing(points);
  for (const auto& p : clouds::sample(*cube, std::size_t(kOfWall * cube->area() / plate->area()), 3))
    points.emplace_back(p + Eigen::Vector3d(4, 0, 0));
  clouds::add_noise(points, sigma, 2);
  const Positions noisy = points;
  ASSERT_TRUE(rfsmooth::denoise(points[0].data(), points.size(), {}, {}).ok());
  double squares = 0, between = 0, count = 0;
  for (std::size_t i = 0; i < kOfWall; ++i) {
    if (std::abs(noisy[i].x()) > inside || std::abs(noisy[i].y()) > 0.8 * inside) continue;
    const double beside = std::abs(points[i].z()) - thickness / 2;
    squares += beside * beside;
    between += beside < -thickness / 4 ? 1 : 0;
    count += 1;
  }
  EXPECT_LT(squares / count, 0.3 * sigma * sigma);  // 0.55 and 0.22 by patches of one sheet
  EXPECT_LT(between / count, 0.08);
}

TEST(DenoiseQuality, TheRimOfAnOpenSheetStaysWithinAThirdOfASpacing) {
  const Positions clean = clouds::sample(*clouds::make_wavy_sheet(), 10000, 1);
  const double spacing = clouds::mean_spacing(clean);
  for (const double share : {0.5, 1.0}) {
    Positions points = clean;
    clouds::add_noise(points, share * spacing, 2);
    ASSERT_TRUE(rfsmooth::denoise(points[0].data(), points.size(), {}, {}).ok());
    double inward = 0, squares = 0, count = 0;
    for (std::size_t i = 0; i < clean.size(); ++i) {
      for (int axis = 0; axis < 2; ++axis) {
        if (std::abs(clean[i][axis]) < 1 - spacing / 2) continue;
        const double in = std::copysign(1, clean[i][axis]) * (clean[i] - points[i])[axis];
        inward += in;
        squares += in * in;
        count += 1;
      }
    }
    ASSERT_GT(count, 200);
    EXPECT_LT(std::abs(inward / count), 0.3 * spacing) << share;
    // 0.9 and more of the noise: points go along the normal, and what lies in the surface stays.
    EXPECT_LT(std::sqrt(squares / count), share * spacing) << share;
  }
}

}  // namespace
