#include "rfs_mesh/noise/noise_field.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

using namespace rfsmooth;
using rfs_mesh::NoiseSites;
using rfs_mesh::relative_noise;

namespace {

constexpr std::size_t kSites = 1500;

/// Sites over the walls of a room of 2 x 2 x 2, with fits of six degrees of freedom.
NoiseSites room(
    const std::function<double(const Eigen::Vector3d& at, const Eigen::Vector3d& normal)>& sigma) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<double> place(-1, 1);
  std::chi_squared_distribution<double> chi(6);
  NoiseSites sites;
  for (std::size_t s = 0; s < kSites; ++s) {
    const auto axis = Eigen::Index(s % 3);
    Eigen::Vector3d at(place(engine), place(engine), place(engine));
    at[axis] = s % 2 == 0 ? 1 : -1;
    rfs_mesh::Scatter fit;
    fit.normal = (s % 5 == 0 ? -1 : 1) * Eigen::Vector3d::Unit(axis);  // of either sign
    fit.foot = at;
    fit.radius = 0.1;
    fit.freedom = 6;
    const double here = sigma(at, fit.normal);
    fit.variance = here * here * chi(engine) / 6;
    sites.at.push_back(at);
    sites.fits.push_back(fit);
    sites.sigma.push_back(here);
    sites.shape.push_back(0);
    sites.floor.push_back(0);
    sites.area.push_back(1);
    sites.speaks.push_back(1);
    sites.full.push_back(0);
    sites.most.push_back(std::numeric_limits<double>::infinity());
  }
  return sites;
}

/// Mean over the sites of |log(relative / truth)|.
template <class Truth>
double error(const NoiseSites& sites, double figure, const Truth& truth) {
  const std::vector<double> relative = relative_noise(sites, figure, Context());
  double sum = 0;
  for (std::size_t s = 0; s < relative.size(); ++s)
    sum += std::abs(std::log(relative[s] / truth(sites.at[s], sites.fits[s].normal)));
  return sum / double(relative.size());
}

TEST(NoiseField, OfEvenNoiseIsOne) {
  const auto even = [](const auto&, const auto&) { return 1.0; };
  EXPECT_LT(error(room(even), 1, even), 0.02);
}

TEST(NoiseField, WallsThatFaceTheSameWaySpeakForEachOther) {
  const auto sigma = [](const auto&, const auto& n) { return std::abs(n.x()) > 0.5 ? 2.0 : 1.0; };
  EXPECT_LT(error(room(sigma), 1, sigma), 0.08);  // 0.23 for a constant field
}

TEST(NoiseField, FollowsNoiseThatGrowsWithTheDistance) {
  const auto sigma = [](const auto& at, const auto&) { return std::exp(0.7 * at.x()); };
  EXPECT_LT(error(room(sigma), 1, sigma), 0.15);  // 0.47 for a constant field
}

TEST(NoiseField, IsRelativeToTheFigure) {
  // Half of the room three times as loud: which half the figure is of decides which half is 1.
  const auto sigma = [](const auto& at, const auto&) { return at.x() > 0 ? 3.0 : 1.0; };
  const auto third = [](const auto& at, const auto&) { return at.x() > 0 ? 1.0 : 1.0 / 3; };
  EXPECT_LT(error(room(sigma), 1, sigma), 0.25);
  EXPECT_LT(error(room(sigma), 3, third), 0.25);
}

TEST(NoiseField, DoesNotHearSitesThatDoNotSpeakNorThoseFarAbove) {
  const auto even = [](const auto&, const auto&) { return 1.0; };
  NoiseSites sites = room(even);
  for (std::size_t s = 0; s < kSites; s += 7) sites.fits[s].variance = 1e6;
  for (std::size_t s = 1; s < kSites; s += 7) {
    sites.fits[s].variance = 3;
    sites.speaks[s] = 0;
  }
  for (std::size_t s = 2; s < kSites; s += 7) sites.fits[s] = {};
  EXPECT_LT(error(sites, 1, even), 0.03);
}

TEST(NoiseField, OfFitsThatSayNothingHearsTheFloorAlone) {
  const auto even = [](const auto&, const auto&) { return 1.0; };
  NoiseSites sites = room(even);
  for (std::size_t s = 0; s < kSites; s += 2) {
    sites.fits[s].variance = 100;  // of what little its window kept
    sites.fits[s].freedom = 0;
    sites.floor[s] = 1;
  }
  EXPECT_LT(error(sites, 1, even), 0.03);
}

TEST(NoiseField, DoesNotHearSitesWhoseWindowIsTheirNeighbours) {
  const auto even = [](const auto&, const auto&) { return 1.0; };
  NoiseSites sites = room(even);
  for (std::size_t s = 0; s < kSites; s += 2) {
    sites.fits[s].variance = 0.1;
    sites.full[s] = 1;
  }
  EXPECT_LT(error(sites, 1, even), 0.03);
}

// One half is exact and its sites know: they are as calm as what is seen there, and the others as loud as
// ever up to the border.
TEST(NoiseField, CalmPlacesAreWhatIsSeenThereAndDoNotSpeakForLoudOnes) {
  const auto half = [](const auto& at, const auto&) { return at.x() > 0 ? 1.0 : 0.01; };
  NoiseSites sites = room(half);
  for (std::size_t s = 0; s < kSites; ++s)
    if (sites.at[s].x() <= 0) sites.most[s] = 0.01;
  const std::vector<double> relative = relative_noise(sites, 1, Context());
  std::size_t beside = 0;
  for (std::size_t s = 0; s < kSites; ++s) {
    if (sites.at[s].x() <= 0) {
      EXPECT_EQ(relative[s], 0.01) << s;
    } else if (sites.at[s].x() < 0.1) {
      ++beside;
      EXPECT_NEAR(relative[s], 1, 0.2) << s;
    }
  }
  EXPECT_GT(beside, 20U);
}

TEST(NoiseField, OfACrowdOnASmallObjectIsNotThatOfTheRoom) {
  // A quarter of the sites within a hundredth of the room, each over a ten-thousandth of the area, where all
  // depths are within one step.
  const auto even = [](const auto&, const auto&) { return 1.0; };
  NoiseSites sites = room(even);
  for (std::size_t s = 0; s < kSites; s += 4) {
    sites.at[s] *= 0.01;
    sites.area[s] = 0.0001;
    sites.fits[s].radius = 0.001;
    sites.fits[s].variance = 0;
  }
  EXPECT_LT(error(sites, 1, even), 0.03);
}

TEST(NoiseField, IsThatOfTheCloudWhereLittleOfTheSurfaceSpeaks) {
  // Twice as loud beyond x > 0, but next to nothing speaks there.
  NoiseSites sites = room([](const auto& at, const auto&) { return at.x() > 0 ? 2.0 : 1.0; });
  std::size_t loud = 0;
  for (std::size_t s = 0; s < kSites; ++s)
    if (sites.at[s].x() > 0 && ++loud % 300 != 0) sites.speaks[s] = 0;
  EXPECT_LT(error(sites, 1, [](const auto&, const auto&) { return 1.0; }), 0.1);
}

TEST(NoiseField, IsNearlyTheSameFromOtherSites) {
  // Calm and loud halves: neither may take over the other when a few sites change.
  const auto halves = [](const auto& at, const auto&) { return at.x() > 0 ? 3.0 : 1.0; };
  const NoiseSites sites = room(halves);
  const std::vector<double> all = relative_noise(sites, 1, Context());
  for (const std::size_t left_out : {1, 4, 7}) {
    NoiseSites some = sites;
    for (std::size_t s = left_out; s < kSites; s += 10) some.speaks[s] = 0;
    const std::vector<double> again = relative_noise(some, 1, Context());
    for (std::size_t s = 0; s < kSites; ++s) EXPECT_LT(std::abs(std::log(again[s] / all[s])), 0.25) << s;
  }
}

TEST(NoiseField, HearsDepthsInStepsWhereTheFitsLieWithinOne) {
  const auto even = [](const auto&, const auto&) { return 1.0; };
  NoiseSites sites = room(even);
  sites.floor.assign(kSites, 1);
  for (std::size_t s = 0; s < kSites; ++s) sites.fits[s].variance = s % 3 == 0 ? 0 : 0.01;
  for (std::size_t s = 0; s < kSites; s += 4) sites.fits[s].freedom = 0;
  EXPECT_LT(error(sites, 1, even), 0.02);
}

TEST(NoiseField, ScalesWithTheCloudAndStaysInItsRange) {
  const NoiseSites here = room([](const auto& at, const auto&) { return std::exp(4 * at.y()); });
  NoiseSites there = here;
  for (std::size_t s = 0; s < kSites; ++s) {
    there.at[s] *= 1024;
    there.fits[s].radius *= 1024;
    there.fits[s].variance *= 1024 * 1024;
    there.sigma[s] *= 1024;
  }
  const std::vector<double> a = relative_noise(here, 1, Context()),
                            b = relative_noise(there, 1024, Context());
  for (std::size_t s = 0; s < kSites; ++s) {
    EXPECT_NEAR(a[s], b[s], 1e-3) << s;
    EXPECT_GT(a[s], 0.02);
    EXPECT_LT(a[s], 50);
  }
}

TEST(NoiseField, IsOneWhereNothingIsHeard) {
  NoiseSites sites = room([](const auto&, const auto&) { return 1.0; });
  for (auto& fit : sites.fits) fit.freedom = 0;
  const std::vector<double> ones(kSites, 1);
  EXPECT_EQ(relative_noise(sites, 1, Context()), ones) << "no place has a say";
  sites = room([](const auto&, const auto&) { return 0.0; });
  EXPECT_EQ(relative_noise(sites, 1, Context()), ones) << "no noise anywhere";
  sites.at.assign(sites.at.size(), Eigen::Vector3d::Ones());
  EXPECT_EQ(relative_noise(sites, 1, Context()), ones) << "and all places are one";
}

}  // namespace
