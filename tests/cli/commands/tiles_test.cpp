/// rfsmooth tiles: the whole cloud's result but for seams.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "pipeline/tiles/files/statistics_json.h"
#include "tests/cli/support/tile_jobs.h"
#include "tests/support/sanitized.h"

using ::testing::HasSubstr;

namespace rfsmooth::test {
namespace {

constexpr double kWall = 0.6, kWallNoise = 0.6;  // half of the wall's thickness, and the noise
constexpr int kWallEnds = 100, kRidgesStart = 340, kColumns = 40;
constexpr int kWidest = 25;  // no patch is wider

/// A long sheet with ridges near its end, where the learned step would act, and points `kWallNoise` spacings
/// off it; those of its first quarter off two, kWall on either side of it.
RichCloud sheet_with_wall() {
  constexpr int kRows = 400, kHalfRidge = 10;
  std::mt19937_64 engine(11);
  std::normal_distribution<double> normal(0, 1);
  RichCloud cloud;
  cloud.doubles = true;
  for (int i = 0; i < kRows; ++i) {
    const int ridge =
        i < kRidgesStart ? 0 : kHalfRidge - std::abs((i - kRidgesStart) % (2 * kHalfRidge) - kHalfRidge);
    for (int j = 0; j < kColumns; ++j) {
      const double half = i < kWallEnds ? (engine() % 2 != 0 ? kWall : -kWall) : 0;
      cloud.xyz.insert(cloud.xyz.end(), {i + 0.2 * normal(engine), j + 0.2 * normal(engine),
                                         2 * ridge + half + kWallNoise * normal(engine)});
    }
  }
  return cloud;
}

/// A job's result beside that of the whole cloud with its statistics.
struct Both {
  std::string job, tiled, whole;
  Statistics statistics;
};

class TilesAndWhole : public Tiles {
 protected:
  /// What was settled.
  Statistics statistics(const std::string& job) {
    return pipeline::tiles::statistics_of(
        nlohmann::ordered_json::parse(take(job + "/statistics.json")).at("statistics"));
  }
  /// Smooths a cloud of spacings of about one in tiles and as a whole, and compares. `option`: of both.
  /// `until`: points of larger x count for the difference of the whole cloud alone.
  Both expect_as_whole(const RichCloud& cloud, const std::string& points, const std::string& option = "",
                       double until = std::numeric_limits<double>::infinity()) {
    put("in.ply", cloud.bytes());
    Both both;
    both.job = "job" + std::to_string(++jobs_);
    both.tiled = joined({"in.ply"}, both.job, both.job + ".ply", points, "1000000", option);
    both.statistics = statistics(both.job);
    std::vector<std::string> whole = {"denoise", "--force",  "--statistics", both.job + "/statistics.json",
                                      "in.ply",  "whole.ply"};
    if (!option.empty()) whole.push_back(option);
    const Ran ran = run(whole);
    EXPECT_EQ(ran.code, 0) << ran.err;
    both.whole = take("whole.ply");
    double squares = 0, within = 0, count = 0, of_all = 0, all = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (!std::isfinite(cloud.xyz[3 * i + 2])) continue;
      double square = 0;
      for (std::size_t axis = 0; axis < 3; ++axis)
        square += std::pow(cloud.coordinate(both.tiled, i, axis) - cloud.coordinate(both.whole, i, axis), 2);
      of_all += square;
      ++all;
      if (cloud.xyz[3 * i] > until) continue;
      squares += square;
      within += square < 0.01 ? 1 : 0;  // a tenth of the spacing
      ++count;
    }
    EXPECT_LT(std::sqrt(squares / count), 0.02) << both.job;
    EXPECT_GT(within / count, 0.99) << both.job;
    EXPECT_LT(std::sqrt(of_all / all), 0.05) << both.job;
    return both;
  }

 private:
  int jobs_ = 0;
};

TEST_F(Tiles, EveryRowOnceAndEveryOtherByteStays) {
  for (const bool pcd : {false, true}) {
    RichCloud cloud = strip(0.4);
    cloud.pcd = pcd;
    const std::string input = cloud.bytes();
    put(cloud.name(), input);
    const std::string output = joined({cloud.name()}, pcd ? "pcd" : "ply", cloud.output());
    ASSERT_EQ(output.size(), input.size());
    EXPECT_EQ(output.substr(0, cloud.header().size()), cloud.header());
    std::size_t moved = 0, finite = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      ASSERT_EQ(cloud.extras(output, i), cloud.extras(input, i));
      if (!std::isfinite(cloud.xyz[3 * i + 2])) {
        ASSERT_EQ(cloud.row(output, i), cloud.row(input, i));
        continue;
      }
      ++finite;
      moved += std::size_t(cloud.row(output, i) != cloud.row(input, i));
    }
    EXPECT_GT(double(moved), 0.999 * double(finite));
  }
}

TEST_F(TilesAndWhole, OneTileIsTheWholeCloudToTheByte) {
  int job = 0;
  const auto same = [&](double noise, Kind kind) {
    constexpr int kRows = 100;  // more where whole squares have noise in common
    put("in.ply", strip(noise, kind == Kind::shared ? kLong : kRows, kind).bytes());
    const std::string name = "job" + std::to_string(++job);
    const std::string tiled = joined({"in.ply"}, name, name + ".ply", "1000000");
    EXPECT_EQ(run({"denoise", "--force", "in.ply", "whole.ply"}).code, 0);
    EXPECT_TRUE(take("whole.ply") == tiled) << noise;
    const Ran known =
        run({"denoise", "--force", "--statistics", name + "/statistics.json", "in.ply", "as.ply"});
    EXPECT_EQ(known.code, 0) << known.err;
    EXPECT_TRUE(take("as.ply") == tiled) << noise;
    return statistics(name);
  };
  same(0.4, Kind::own);
  if (!kSanitized)
    for (const double noise : {0.0, 1.3}) same(noise, Kind::own);
  EXPECT_GT(same(0.3, Kind::with_tails).tails->share, 0);
  EXPECT_GT(same(0.4, Kind::shared).noise->shared, 1);
  EXPECT_GT(same(0.2, Kind::in_steps).noise->step, 0);
}

// Of two strips together: there are a thousand points at the seams of one, and a single close call that is
// decided otherwise beside one of them moves their mean square by a hundredth either way.
TEST_F(TilesAndWhole, ManyTilesAreTheWholeCloudAndAsNearToTheTruth) {
  if (kSanitized) GTEST_SKIP() << "how near tiles come to the whole is asked for without sanitizers";
  constexpr int kRows = 900;
  for (const double noise : {0.1, 0.5, 1.3, 2.0}) {
    std::array<double, 2> tiled{}, whole{};  // sums of squares: of all points, of those at seams
    for (const unsigned seed : {5U, 6U}) {
      const RichCloud cloud = strip(noise, kRows, Kind::own, seed);
      const Both both = expect_as_whole(cloud, "3000");
      std::vector<double> cuts;
      const nlohmann::json plan = nlohmann::json::parse(take(both.job + "/job.json"));
      for (const auto& tile : plan["tiles"]) cuts.push_back(tile["box"][1][0].get<double>());
      for (std::size_t i = 0; i < cloud.size(); ++i) {
        if (!std::isfinite(cloud.xyz[3 * i + 2])) continue;
        const bool at_seam = std::any_of(cuts.begin(), cuts.end(),
                                         [&](double x) { return std::abs(cloud.xyz[3 * i] - x) < 3; });
        const auto add = [&](const std::string& bytes, std::array<double, 2>& to) {
          const double off = cloud.coordinate(bytes, i, 2) - bent(cloud.coordinate(bytes, i, 0));
          to[0] += off * off;
          to[1] += at_seam ? off * off : 0;
        };
        add(both.tiled, tiled);
        add(both.whole, whole);
      }
    }
    EXPECT_LT(tiled[0], 1.005 * whole[0]) << noise;
    EXPECT_LT(tiled[1], 1.01 * whole[1]) << noise;
  }
}

TEST_F(TilesAndWhole, FlowsOfFewRingsAreTheWholeCloudsAndOthersAreRefused) {
  for (const char* flow : {"laplacian", "bilaplacian", "hc", "taubin"}) {
    if (kSanitized && flow == std::string("hc")) break;
    const Both both = expect_as_whole(strip(0.4), kTile, std::string("--flow=") + flow);
    EXPECT_GT(tiles_of(both.job).size(), 2U);
    EXPECT_FALSE(both.whole == take("in.ply")) << flow;
  }
  for (const std::vector<std::string>& solved :
       {std::vector<std::string>{"--flow", "implicit"}, {"--flow", "hc", "--update", "sequential"}}) {
    std::vector<std::string> plan = {"tiles", "plan", "in.ply", "none"};
    plan.insert(plan.end(), solved.begin(), solved.end());
    const Ran ran = run(plan);
    EXPECT_EQ(ran.code, 2);
    EXPECT_THAT(ran.err, HasSubstr("auto, laplacian, hc, taubin, bilaplacian"));
    EXPECT_FALSE(std::filesystem::exists(at("none")));
  }
}

// A wall thinner than the noise at one end of a sheet, which is a tile: what the whole cloud says of it
// holds in all tiles, with the learned step and without. Patches that reach the ridges do not fit there,
// chance has a say in which of them is taken, and tiles differ from the whole cloud by up to 0.1 spacings.
TEST_F(TilesAndWhole, WallsHiddenInOneTileAreWhatTheyAreInTheWholeCloud) {
  const RichCloud cloud = sheet_with_wall();
  for (const char* learned : {"", "--no-learned"}) {
    if (kSanitized && *learned != 0) break;
    const Both both =
        expect_as_whole(cloud, std::to_string(kWallEnds * kColumns), learned, kRidgesStart - kWidest);
    EXPECT_GT(both.statistics.sheets->evidence, 7);
    const auto parted = [&](const std::string& bytes) {  // share of the wall's points
      double beside = 0, all = 0;
      for (std::size_t i = 0; i < cloud.size(); ++i) {
        if (cloud.xyz[3 * i] > kWallEnds) continue;
        beside += std::abs(cloud.coordinate(bytes, i, 2)) > kWall / 2 ? 1 : 0;
        ++all;
      }
      return beside / all;
    };
    EXPECT_GT(parted(both.whole), 0.5);
    EXPECT_NEAR(parted(both.tiled), parted(both.whole), 0.01);
  }
}

// Two sheets across x = 0, three sigma apart, with a sheet on either side: the cut is between them.
TEST_F(TilesAndWhole, AThinPlateCutAlongItsPlaneIsAsInTheWholeCloud) {
  constexpr int kSide = 42;
  constexpr double kApart = 1.2, kSigma = 0.4;
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal(0, 1);
  RichCloud cloud;
  cloud.doubles = true;
  for (const double x : {-100.0, -kApart / 2, kApart / 2, 100.0})
    for (int i = 0; i < kSide; ++i)
      for (int j = 0; j < kSide; ++j)
        cloud.xyz.insert(cloud.xyz.end(),
                         {x + kSigma * normal(engine), i + 0.2 * normal(engine), j + 0.2 * normal(engine)});
  const Both both = expect_as_whole(cloud, std::to_string(2 * kSide * kSide));
  const nlohmann::json tiles = nlohmann::json::parse(take(both.job + "/job.json"))["tiles"];
  ASSERT_EQ(tiles.size(), 2u);
  EXPECT_NEAR(tiles[0]["box"][1][0].get<double>(), 0, kApart / 2) << "cut between the sheets";
}

}  // namespace
}  // namespace rfsmooth::test
