#include "rfs_mesh/noise/sites/loud_shape.h"

#include <gtest/gtest.h>

namespace {

using namespace rfsmooth;
using namespace rfsmooth::rfs_mesh;

constexpr std::size_t kFewSites = 200, kFirstLoud = 150;

/// On a line: calm sites that show noise of 1 for sure, and then loud ones of 10 that show nothing.
NoiseSites calm_and_loud() {
  NoiseSites sites;
  sites.fits.resize(kFewSites);
  sites.speaks.assign(kFewSites, 1);
  sites.plain.assign(kFewSites, 0);
  sites.volume.assign(kFewSites, 0);
  for (std::size_t s = 0; s < kFewSites; ++s) {
    const bool loud = s >= kFirstLoud;
    sites.at.emplace_back(double(s), 0, 0);
    sites.fits[s].radius = 1;
    sites.sigma.push_back(loud ? 10 : 1);
    sites.told.push_back(char(!loud));
    sites.turned.push_back(char(loud));
  }
  return sites;
}

TEST(LoudShape, IsSilenced) {
  NoiseSites sites = calm_and_loud();
  silence_loud_shape(sites, {});
  for (std::size_t s = 0; s < kFewSites; ++s) {
    EXPECT_EQ(sites.speaks[s] != 0, s < kFirstLoud) << s;
    EXPECT_EQ(sites.sigma[s], 1) << s;
    EXPECT_EQ(sites.volume[s], s < kFirstLoud ? 0 : 10) << s;
  }
}

TEST(LoudShape, IsNoneWhereEveryThirdLoudSiteShowsNoise) {
  NoiseSites sites = calm_and_loud();
  for (std::size_t s = kFirstLoud; s < kFewSites; s += 3) {
    sites.plain[s] = 1;
    sites.turned[s] = 0;
  }
  silence_loud_shape(sites, {});
  EXPECT_EQ(sites.sigma, calm_and_loud().sigma);
}

TEST(LoudShape, IsNoneWhereThereAreSurfaces) {
  NoiseSites sites = calm_and_loud();
  sites.turned.assign(kFewSites, 0);
  silence_loud_shape(sites, {});
  EXPECT_EQ(sites.sigma, calm_and_loud().sigma);
}

TEST(LoudShape, IsNoneOfACloudThatShowsNoNoiseForSure) {
  NoiseSites sites = calm_and_loud();
  sites.told.assign(kFewSites, 0);
  silence_loud_shape(sites, {});
  EXPECT_EQ(sites.sigma, calm_and_loud().sigma);
}

TEST(LoudShape, IsNoneOfLessThanThreeTimesTheNoise) {
  NoiseSites sites = calm_and_loud();
  for (double& sigma : sites.sigma)
    if (sigma > 1) sigma = 2.9;
  const std::vector<double> before = sites.sigma;
  silence_loud_shape(sites, {});
  EXPECT_EQ(sites.sigma, before);
}

}  // namespace
