#include "pipeline/tiles/files/statistics_json.h"

#include <gtest/gtest.h>

namespace rfsmooth::pipeline::tiles {
namespace {

/// Statistics with something in every place, numbers that need all their digits.
Statistics full() {
  Statistics all;
  all.box = {{-1.0 / 3, 0, 1e5 + 0.1}, {2.0 / 3, 1, 2e5}};
  all.points = 123456;
  all.reach = 0.1;
  all.scale = {0.1 / 3, 64, 0.7};
  all.spacing = 1.0 / 7;
  all.noise.emplace();
  all.noise->sigma = 1.0 / 9;
  all.noise->shape = 0.2;
  all.noise->spacing = 1.0 / 7;
  all.noise->piece = 128;
  all.noise->on_lines = true;
  all.noise->shared = 3.7;
  all.noise->step = 1.0 / 30;
  all.noise->apart = 0.05;
  all.noise->on_grid = true;
  all.noise->sites = {{0.1, 0.2, 0.3}, {1, 2, 3}};
  all.noise->at_sites = {0.1, 1.0 / 3};
  all.noise->spacing_at_sites = {1.0 / 7, 0.01};
  all.noise->told_at_sites = {1, 0};
  all.noise->shared_at_sites = {3.7, 5};
  all.tails = {0.05, 4.1, 0.9, 1.2};
  all.passes.resize(2);
  all.passes[0].narrow = {16, 1};
  all.passes[0].scales = {{32, 2}, {64, 3}};
  all.passes[0].shares = {0.25, 0.75};
  all.sheets = {2.5, 0.8};
  all.thin_walls = true;
  const Statistics own = all;
  all.parts = {{0, own}, {1.0 / 3, own}};
  return all;
}

TEST(StatisticsJson, IsTheSameWhenReadAgain) {
  const nlohmann::ordered_json json = json_of(full());
  const Statistics again = statistics_of(nlohmann::ordered_json::parse(json.dump()));
  EXPECT_EQ(json_of(again), json);
  ASSERT_TRUE(again.noise);
  EXPECT_EQ(again.noise->piece, 128u);
  EXPECT_TRUE(again.noise->on_lines);
  EXPECT_EQ(again.noise->shared, full().noise->shared);
  EXPECT_EQ(again.noise->apart, 0.05);
  EXPECT_TRUE(again.noise->on_grid);
  EXPECT_EQ(again.noise->at_sites, full().noise->at_sites);
  EXPECT_EQ(again.noise->spacing_at_sites, full().noise->spacing_at_sites);
  EXPECT_EQ(again.noise->told_at_sites, full().noise->told_at_sites);
  EXPECT_EQ(again.noise->shared_at_sites, full().noise->shared_at_sites);
  EXPECT_EQ(again.passes.at(0).shares, full().passes[0].shares);
  EXPECT_EQ(again.spacing, full().spacing);
  ASSERT_EQ(again.parts.size(), 2U);
  EXPECT_EQ(again.parts[1].from, 1.0 / 3);
  EXPECT_EQ(again.parts[1].own.passes.at(0).shares, full().passes[0].shares);
}

TEST(StatisticsJson, WhatIsNotThereStaysOut) {
  Statistics some = full();
  some.noise->spacing_at_sites.clear();
  EXPECT_TRUE(statistics_of(json_of(some)).noise->spacing_at_sites.empty());
  EXPECT_FALSE(statistics_of(json_of(Statistics())).noise);
}

TEST(StatisticsJson, TheSummaryOfTheNoiseIsTheSameWhenReadAgain) {
  const NoiseSummary summary = {1.0 / 3, 0.5, 7, 1.0 / 9, true, false};
  const NoiseSummary again = summary_of(json_of(summary));
  EXPECT_EQ(again.typical, summary.typical);
  EXPECT_EQ(again.loudest, summary.loudest);
  EXPECT_EQ(again.shared, summary.shared);
  EXPECT_EQ(again.step, summary.step);
  EXPECT_EQ(again.on_grid, summary.on_grid);
  EXPECT_EQ(again.on_lines, summary.on_lines);
}

}  // namespace
}  // namespace rfsmooth::pipeline::tiles
