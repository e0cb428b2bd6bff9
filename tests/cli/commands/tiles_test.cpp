/// rfsmooth tiles: the same bytes however the work was done, and the whole cloud's result but for seams.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <future>
#include <limits>
#include <numeric>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <rfsmooth/denoise.h>

#include "pipeline/tiles/in_one_process.h"
#include "pipeline/tiles/statistics_json.h"
#include "tests/cli/support/folder.h"
#include "tests/cli/support/rich_cloud.h"
#include "tests/cli/support/small_clouds.h"
#include "tests/support/las_bytes.h"

using ::testing::HasSubstr;
using ::testing::Not;

namespace rfsmooth::test {
namespace {

constexpr int kLong = 900, kWide = 24;

enum class Kind { own, with_tails, shared, in_steps };

double bent(double x) {
  return 6 * std::sin(x / 40);
}

/// A long strip of a gently bent surface, points `noise` spacings off it; every thousandth is NaN. Noise is
/// of each point, of each with a tenth six times as loud, of each square of four by four, or rounding
/// besides.
RichCloud strip(double noise, bool pcd = false, Kind kind = Kind::own, unsigned seed = 5) {
  constexpr int kTogether = 4;
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal(0, 1);
  std::array<double, kWide / kTogether> of_square{};
  RichCloud cloud;
  cloud.pcd = pcd;
  cloud.doubles = true;
  for (int i = 0; i < kLong; ++i)
    for (int j = 0; j < kWide; ++j) {
      const double x = i + 0.2 * normal(engine), y = j + 0.2 * normal(engine);
      double off = normal(engine);
      if (kind == Kind::with_tails && cloud.size() % 10 == 3) off *= 6;
      if (kind == Kind::shared) {
        double& here = of_square[std::size_t(j / kTogether)];
        if (i % kTogether == 0 && j % kTogether == 0) here = off;
        off = here + 0.1 * off;
      }
      double z = bent(x) + noise * off;
      if (kind == Kind::in_steps) z = std::round(z);
      const double bad = cloud.size() % 1000 == 7 ? std::nan("") : 0;
      cloud.xyz.insert(cloud.xyz.end(), {x, y, z + bad});
    }
  return cloud;
}

constexpr double kWall = 0.6, kWallNoise = 0.6;  // half of the wall's thickness, and the noise
constexpr int kWallEnds = 100, kRidgesStart = 340;
constexpr int kWidest = 25;  // no patch is wider

/// A long sheet with ridges near its end, where the learned step would act, and points `kWallNoise` spacings
/// off it; those of its first quarter off two, kWall on either side of it.
RichCloud sheet_with_wall() {
  constexpr int kRows = 400, kColumns = 64, kHalfRidge = 10;
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

class Tiles : public InFolder {
 protected:
  std::vector<std::string> tiles_of(const std::string& job) {
    const Ran ran = run({"tiles", "status", job, "--json"});
    EXPECT_EQ(ran.code, 0) << ran.err;
    std::vector<std::string> tiles(nlohmann::json::parse(ran.out)["tiles"].get<std::size_t>());
    for (std::size_t t = 0; t < tiles.size(); ++t) tiles[t] = std::to_string(t);
    return tiles;
  }
  void step(const std::vector<std::string>& arguments) {
    std::vector<std::string> all = {"tiles"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Ran ran = run(all);
    EXPECT_EQ(ran.code, 0) << ran.err;
  }
  /// Plans, measures and settles a job of the inputs; its tiles.
  std::vector<std::string> settled(const std::vector<std::string>& inputs, const std::string& job,
                                   const std::string& points = "3000", const std::string& sample = "1000000",
                                   const std::string& option = "") {
    std::vector<std::string> plan = {"plan", "--tile-points", points, "--sample-points", sample};
    if (!option.empty()) plan.push_back(option);
    plan.insert(plan.end(), inputs.begin(), inputs.end());
    plan.push_back(job);
    step(plan);
    const std::vector<std::string> tiles = tiles_of(job);
    for (const std::string& tile : tiles) step({"measure", job, tile});
    step({"settle", job});
    return tiles;
  }
  /// What was settled.
  Statistics statistics(const std::string& job) {
    return pipeline::tiles::statistics_of(
        nlohmann::ordered_json::parse(take(job + "/statistics.json")).at("statistics"));
  }
  /// The whole of it.
  std::string joined(const std::vector<std::string>& inputs, const std::string& job,
                     const std::string& output, const std::string& points = "3000",
                     const std::string& sample = "1000000", const std::string& option = "") {
    for (const std::string& tile : settled(inputs, job, points, sample, option)) step({"run", job, tile});
    step({"join", job, output});
    return std::filesystem::is_directory(at(output)) ? "" : take(output);
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

TEST_F(Tiles, SameBytesForWorkersInAnyOrderAgainAndAfterKillsAndDamage) {
  put("in.ply", strip(0.4).bytes());
  const std::string expected = joined({"in.ply"}, "one", "one.ply");
  std::vector<std::string> tiles = settled({"in.ply"}, "many");
  ASSERT_GE(tiles.size(), 8u);
  std::vector<std::string> twice = tiles;
  twice.insert(twice.end(), tiles.begin(), tiles.end());
  std::shuffle(twice.begin(), twice.end(), std::mt19937(3));
  // Four workers are killed at random times, 20 of them on the way, though what is there is taken away again.
  std::atomic<int> killed = 0;
  const auto kill = [&](std::size_t worker) {
    std::mt19937 random(unsigned(worker) + 1);
    for (std::size_t k = worker; killed < 20; k += 4) {
      const std::string& tile = twice[k % twice.size()];
      const std::string after = std::to_string(double(1 + random() % 200) / 1000);
      std::error_code ignored;
      std::filesystem::remove(at("many/done/" + tile), ignored);
      killed += run_program("timeout", {"-s", "KILL", after, RFSMOOTH_COMMAND, "tiles", "run", at("many"),
                                        tile, "--threads", "1"})
                            .code == 128 + SIGKILL
                    ? 1
                    : 0;
    }
  };
  const auto finish = [&](std::size_t worker) {
    for (std::size_t k = worker; k < twice.size(); k += 4)
      run_program(RFSMOOTH_COMMAND, {"tiles", "run", at("many"), twice[k], "--threads", "1"});
  };
  const auto in_four = [](const auto& work) {
    std::vector<std::future<void>> workers;
    for (std::size_t w = 0; w < 4; ++w) workers.push_back(std::async(std::launch::async, work, w));
    for (auto& worker : workers) worker.get();
  };
  in_four(kill);
  in_four(finish);
  step({"join", "many", "many.ply"});
  EXPECT_TRUE(take("many.ply") == expected);
  const auto all = nlohmann::json::parse(run({"tiles", "status", "many", "--json"}).out);
  EXPECT_GT(all["halo_share"].get<double>(), 0.1);  // a strip is narrow, and its tiles are short
  EXPECT_LT(all["halo_share"].get<double>(), double(tiles.size()));
  EXPECT_GT(all["seconds"].get<double>(), 0);

  // Half a result, and one with a byte of another: both are found, made again, and nothing else is.
  std::filesystem::resize_file(at("many/done/2"), std::filesystem::file_size(at("many/done/2")) / 2);
  std::string damaged = take("many/done/5");
  damaged[damaged.size() / 2] = char(damaged[damaged.size() / 2] ^ 1);
  put("many/done/5", damaged);
  const auto status = nlohmann::json::parse(run({"tiles", "status", "many", "--json"}).out);
  EXPECT_EQ(status["missing"], nlohmann::json::array({2, 5}));
  const Ran early = run({"tiles", "join", "many", "early.ply"});
  EXPECT_EQ(early.code, 2);
  EXPECT_THAT(early.err, HasSubstr("tile 2"));
  EXPECT_FALSE(there("early.ply"));
  for (const std::string& tile : tiles) step({"run", "many", tile});
  step({"join", "many", "again.ply"});
  EXPECT_TRUE(take("again.ply") == expected);
}

TEST_F(Tiles, EveryRowOnceAndEveryOtherByteStays) {
  for (const bool pcd : {false, true}) {
    const RichCloud cloud = strip(0.4, pcd);
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

TEST_F(Tiles, OneTileIsTheWholeCloudToTheByte) {
  int job = 0;
  const auto same = [&](double noise, Kind kind) {
    put("in.ply", strip(noise, false, kind).bytes());
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
  for (const double noise : {0.0, 0.4, 1.3}) same(noise, Kind::own);
  EXPECT_GT(same(0.3, Kind::with_tails).tails->share, 0);
  EXPECT_GT(same(0.4, Kind::shared).noise->shared, 1);
  EXPECT_GT(same(0.2, Kind::in_steps).noise->step, 0);
}

// Of two strips together: there are a thousand points at the seams of one, and a single close call that is
// decided otherwise beside one of them moves their mean square by a hundredth either way.
TEST_F(Tiles, ManyTilesAreTheWholeCloudAndAsNearToTheTruth) {
  for (const double noise : {0.1, 0.5, 1.3, 2.0}) {
    std::array<double, 2> tiled{}, whole{};  // sums of squares: of all points, of those at seams
    for (const unsigned seed : {5U, 6U}) {
      const RichCloud cloud = strip(noise, false, Kind::own, seed);
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

// A wall thinner than the noise at one end of a sheet, which is a tile: what the whole cloud says of it
// holds in all tiles, with the learned step and without. Patches that reach the ridges do not fit there,
// chance has a say in which of them is taken, and tiles differ from the whole cloud by up to 0.1 spacings.
TEST_F(Tiles, FlowsOfFewRingsAreTheWholeCloudsAndOthersAreRefused) {
  for (const char* flow : {"laplacian", "hc", "taubin", "bilaplacian"}) {
    const Both both = expect_as_whole(strip(0.4), "6000", std::string("--flow=") + flow);
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

TEST_F(Tiles, WallsHiddenInOneTileAreWhatTheyAreInTheWholeCloud) {
  const RichCloud cloud = sheet_with_wall();
  for (const char* learned : {"", "--no-learned"}) {
    const Both both = expect_as_whole(cloud, "6400", learned, kRidgesStart - kWidest);
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
TEST_F(Tiles, AThinPlateCutAlongItsPlaneIsAsInTheWholeCloud) {
  constexpr int kSide = 60;
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
  const Both both = expect_as_whole(cloud, "7200");
  const nlohmann::json tiles = nlohmann::json::parse(take(both.job + "/job.json"))["tiles"];
  ASSERT_EQ(tiles.size(), 2u);
  EXPECT_NEAR(tiles[0]["box"][1][0].get<double>(), 0, kApart / 2) << "cut between the sheets";
}

/// Points of a sphere of that radius, spacing about 1, noise 0.3.
RichCloud noisy_ball(double radius, bool pcd) {
  const auto count = int(4 * M_PI * radius * radius);
  std::mt19937_64 engine(8);
  std::normal_distribution<double> normal(0, 1);
  RichCloud cloud;
  cloud.pcd = pcd;
  cloud.doubles = true;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, turn = i * M_PI * (3 - std::sqrt(5.0)),
                 r = std::sqrt(1 - z * z);
    const double at = radius + 0.3 * normal(engine);
    cloud.xyz.insert(cloud.xyz.end(), {at * r * std::cos(turn), at * r * std::sin(turn), at * z});
  }
  return cloud;
}

/// The normals in the fields that came behind all others.
std::vector<std::array<float, 3>> added_normals(const RichCloud& cloud, const std::string& bytes) {
  const std::size_t row = cloud.row_bytes() + 12, first = bytes.size() - cloud.size() * row;
  std::vector<std::array<float, 3>> normals(cloud.size());
  for (std::size_t i = 0; i < normals.size(); ++i)
    std::memcpy(normals[i].data(), bytes.data() + first + i * row + cloud.row_bytes(), 12);
  return normals;
}

TEST_F(Tiles, NormalsAreOutwardAcrossTilesAndOneTileHasThoseOfTheWholeCloud) {
  for (const bool pcd : {false, true}) {
    const RichCloud cloud = noisy_ball(30, pcd);
    put(cloud.name(), cloud.bytes());
    const std::string job = pcd ? "pcd" : "ply";
    EXPECT_EQ(run({"denoise", "--force", "--normals", cloud.name(), cloud.output()}).code, 0);
    const std::string whole = take(cloud.output());
    std::filesystem::remove(at(cloud.output()));
    const std::string one =
        joined({cloud.name()}, job + "1", cloud.output(), "1000000", "1000000", "--normals");
    EXPECT_TRUE(one == whole);
    std::filesystem::remove(at(cloud.output()));
    const std::string many = joined({cloud.name()}, job, cloud.output(), "3000", "1000000", "--normals");
    ASSERT_EQ(many.size(), whole.size());
    ASSERT_GE(tiles_of(job).size(), 4u);
    const auto normals = added_normals(cloud, many);
    std::size_t outward = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      double along = 0;
      for (std::size_t axis = 0; axis < 3; ++axis)
        along += double(normals[i][axis]) * cloud.xyz[3 * i + axis];
      outward += std::size_t(along > 0.9 * 30);
    }
    EXPECT_GT(double(outward), 0.999 * double(cloud.size()));
    std::filesystem::resize_file(at(job + "/done/1.normals"), 100);  // found, and made again
    EXPECT_EQ(run({"tiles", "join", job, "again.ply"}).code, 2);
    step({"run", job, "1"});
    std::filesystem::remove(at(cloud.output()));
    step({"join", job, cloud.output()});
    EXPECT_TRUE(take(cloud.output()) == many);
    std::filesystem::remove(at(cloud.output()));
  }
}

TEST_F(Tiles, NormalsFaceTheViewpointAndElseTheSameSideInAllTiles) {
  const RichCloud cloud = strip(0.3);
  put("in.ply", cloud.bytes());
  std::size_t number = 0;
  for (const std::string viewpoint : {"450,12,-3000", "auto"}) {
    const std::string job = "job" + std::to_string(++number), out = job + ".ply";
    step({"plan", "--normals", "--viewpoint", viewpoint, "--tile-points", "6000", "in.ply", job});
    const std::vector<std::string> tiles = tiles_of(job);
    ASSERT_GE(tiles.size(), 4u);
    for (const std::string& tile : tiles) step({"measure", job, tile});
    step({"settle", job});
    for (const std::string& tile : tiles) step({"run", job, tile});
    step({"join", job, out});
    double up = 0, finite = 0;
    const auto normals = added_normals(cloud, take(out));
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const bool there = std::isfinite(cloud.xyz[3 * i + 2]);
      ASSERT_EQ(std::isfinite(normals[i][2]), there);
      up += there && normals[i][2] > 0 ? 1 : 0;
      finite += there ? 1 : 0;
    }
    const double share = up / finite;
    if (viewpoint != "auto") {
      EXPECT_NEAR(share, 0, 0.001);
    }
    EXPECT_NEAR(std::abs(share - 0.5), 0.5, 0.001) << "all on one side";
  }
}

TEST_F(Tiles, AFolderOfFilesIsOneCloud) {
  const RichCloud all = strip(0.4);
  RichCloud first = all, second = all;
  const std::size_t cut = 3 * (all.size() / 3);
  first.xyz.resize(cut);
  second.xyz.erase(second.xyz.begin(), second.xyz.begin() + std::ptrdiff_t(cut));
  put("all.ply", all.bytes());
  put("a.ply", first.bytes());
  put("b.ply", second.bytes());
  const std::string one = joined({"all.ply"}, "one", "one.ply");
  joined({"a.ply", "b.ply"}, "two", "out");
  const std::string a = take("out/a.ply"), b = take("out/b.ply");
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double x = all.coordinate(one, i, axis);
      const double y =
          i < first.size() ? first.coordinate(a, i, axis) : second.coordinate(b, i - first.size(), axis);
      ASSERT_TRUE(x == y || (std::isnan(x) && std::isnan(y))) << i;
    }
}

TEST_F(Tiles, DenoiseTakesTilesWhereTheMemoryIsLess) {
  put("in.ply", noisy_plane(300).bytes());
  const Ran ran = run({"denoise", "--memory", "80M", "in.ply", "out.ply"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(names(), (std::vector<std::string>{"in.ply", "out.ply"})) << "nothing is left";
  const auto how = pipeline::tiles::plan_within(80'000'000, false).plan;
  EXPECT_GT(how.sample_points, 50'000U);
  EXPECT_THAT(ran.err, HasSubstr(fmt::format("in tiles of {} points", how.tile_points)));
  EXPECT_TRUE(take("out.ply") == joined({"in.ply"}, "job", "steps.ply", std::to_string(how.tile_points),
                                        std::to_string(how.sample_points)));
  EXPECT_LT(how.tile_points, pipeline::tiles::plan_within(800'000'000, false).plan.tile_points / 10);
  EXPECT_EQ(run({"denoise", "--memory", "1T", "in.ply", "whole.ply"}).code, 0);
  EXPECT_EQ(run({"denoise", "in.ply", "plain.ply"}).code, 0);
  EXPECT_TRUE(take("whole.ply") == take("plain.ply"));
  const Ran wrong = run({"denoise", "--memory", "much", "in.ply", "x.ply"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("'much'"));
  for (const std::vector<std::string>& of_all :
       {std::vector<std::string>{"--html", "x.html"}, {"--report", "x.json"}}) {
    std::vector<std::string> arguments = {"denoise", "--memory", "80M", "in.ply", "x.ply"};
    arguments.insert(arguments.end(), of_all.begin(), of_all.end());
    const Ran whole = run(arguments);
    EXPECT_EQ(whole.code, 2);
    EXPECT_THAT(whole.err, HasSubstr(of_all.front() + " needs the whole cloud"));
  }
}

TEST_F(Tiles, TheLeastMemoryIsSaidAndKept) {
  put("in.ply", noisy_plane(300).bytes());
  const std::string least =
      fmt::format("{:.0f}M", std::ceil(double(pipeline::tiles::least_memory(90'000, false)) / 1e6));
  const Ran less = run({"denoise", "--memory", "2M", "in.ply", "out.ply"});
  EXPECT_EQ(less.code, 2);
  EXPECT_THAT(less.err, HasSubstr("--memory " + least + " or more"));
  EXPECT_FALSE(there("out.ply"));
  EXPECT_EQ(run({"denoise", "--memory", least, "in.ply", "out.ply"}).code, 0);
}

/// A plane with normals, of which a share of the rows is not finite.
std::string plane_with_normals(int side, int finite_of_ten) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n",
      side * side);
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal(0, 0.2);
  for (int i = 0; i < side * side; ++i) {
    const bool finite = i % 10 < finite_of_ten;
    for (const double v : {i / side + normal(engine), i % side + normal(engine),
                           finite ? normal(engine) : std::nan(""), 0.0, 0.0, 1.0}) {
      const auto value = float(v);
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
  }
  return bytes;
}

// But for figures of a few digits that seams may change, what is said is the same.
TEST_F(Tiles, DenoiseSaysInTilesWhatItSaysOfTheWholeCloud) {
  put("in.ply", plane_with_normals(300, 10));
  const Ran whole = run({"denoise", "in.ply", "whole.ply"}),
            tiled = run({"denoise", "--memory", "80M", "in.ply", "tiled.ply"});
  EXPECT_EQ(tiled.code, 0);
  EXPECT_THAT(tiled.err, HasSubstr("in tiles"));
  for (const char* said :
       {"the normals are kept and stale", "90000 points, 90000 finite", "; spacing 0.", "largest move "})
    for (const Ran* ran : {&whole, &tiled}) EXPECT_THAT(ran->err, HasSubstr(said));
  const auto noise_in = [](const std::string& text) {
    const std::size_t at = text.find("noise 0.");
    return at == std::string::npos ? text : text.substr(at, 10);
  };
  EXPECT_EQ(noise_in(tiled.err), noise_in(whole.err));
}

TEST_F(Tiles, WhyNothingWasSmoothedIsSaidInTiles) {
  RichCloud clean;
  for (int i = 0; i < 300 * 300; ++i)
    clean.xyz.insert(clean.xyz.end(), {double(i / 300), double(i % 300), 0});
  put("in.ply", clean.bytes());
  const Ran ran = run({"denoise", "--memory", "80M", "in.ply", "out.ply"});
  EXPECT_EQ(ran.code, 0);
  EXPECT_THAT(ran.err, HasSubstr("in tiles"));
  EXPECT_THAT(ran.err, HasSubstr("too little to smooth"));
  EXPECT_TRUE(take("out.ply") == take("in.ply"));
}

TEST_F(Tiles, RowsThatAreNotFiniteTakeNoMemory) {
  put("in.ply", plane_with_normals(300, 5));  // 45,000 points
  const Ran ran = run({"denoise", "--memory", "80M", "in.ply", "out.ply"});
  EXPECT_EQ(ran.code, 0);
  EXPECT_THAT(ran.err, Not(HasSubstr("in tiles")));
}

TEST_F(Tiles, WhatCannotGoInTilesIsRefusedWhereTheMemoryIsLess) {
  put("in.ply", noisy_plane(300).bytes());
  EXPECT_EQ(run({"denoise", "-q", "--strength", "0", "--encoding", "ascii", "in.ply", "text.ply"}).code, 0);
  EXPECT_EQ(
      run({"denoise", "-q", "--strength", "0", "--encoding", "binary_compressed", "in.ply", "small.pcd"})
          .code,
      0);
  for (const std::string input : {"text.ply", "small.pcd"}) {
    const std::string output = "out." + input.substr(input.size() - 3);
    const Ran ran = run({"denoise", "--memory", "80M", input, output});
    EXPECT_EQ(ran.code, 6) << ran.err;
    EXPECT_THAT(ran.err, HasSubstr("--memory allows 80 MB"));
    EXPECT_THAT(ran.err, HasSubstr("binary PLY"));
    EXPECT_FALSE(there(output));
    EXPECT_EQ(run({"denoise", "--memory", "200M", input, output}).code, 0);
  }
}

// As denoise has it (las_test.cpp), the bytes too: one tile is the whole.
TEST_F(Tiles, ACoarseScaleOfALasFileIsRefinedAsForTheWholeCloud) {
  constexpr double kScale = 0.2;
  std::mt19937_64 engine(9);
  std::normal_distribution<double> noise(0, 0.2);
  LasBytes las;
  las.scale = {kScale, kScale, kScale};
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j) {
      las.xyz.push_back({});
      for (std::size_t k = 0; k < 3; ++k) {
        const double at = k == 0 ? i : k == 1 ? j : 0;
        las.xyz.back()[k] = std::int32_t(std::lround((at + noise(engine)) / kScale));
      }
    }
  put("in.las", las.bytes());
  for (const bool keep : {false, true}) {
    const std::vector<std::string> option(keep ? 1 : 0, "--keep-scale");
    std::vector<std::string> whole = {"denoise", "--force", "in.las", "whole.las"},
                             join = {"tiles", "join", "--force", "job", "tiled.las"};
    whole.insert(whole.end(), option.begin(), option.end());
    join.insert(join.end(), option.begin(), option.end());
    EXPECT_EQ(run(whole).code, 0);
    for (const std::string& tile : settled({"in.las"}, "job", "1000000")) step({"run", "job", tile});
    const Ran ran = run(join);
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_TRUE(take("tiled.las") == take("whole.las"));
    if (keep)
      EXPECT_THAT(ran.err, Not(HasSubstr("scale")));
    else
      EXPECT_THAT(ran.err, HasSubstr("is coarse for noise of"));
    EXPECT_EQ(LasBytes::get<double>(take("tiled.las"), 131) < kScale, !keep);
  }
  const Ran other = run({"tiles", "join", "job", "out.ply"});
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.err, HasSubstr("keeps its format"));
}

TEST_F(Tiles, WhatCannotBeDoneIsRefusedWithWhatToDo) {
  put("in.xyz", "1 2 3\n4 5 6\n");
  const Ran text = run({"tiles", "plan", "in.xyz", "job"});
  EXPECT_EQ(text.code, 2);
  EXPECT_THAT(text.err, HasSubstr("binary PLY"));
  put("in.ply", strip(0.4).bytes());
  EXPECT_EQ(run({"tiles", "run", "nothing", "0"}).code, 3);
  EXPECT_EQ(run({"tiles", "plan", "in.ply", "job", "--tile-points", "3000"}).code, 0);
  const Ran other = run({"tiles", "plan", "in.ply", "job", "--tile-points", "3000", "--strength", "0.5"});
  EXPECT_THAT(run({"tiles", "plan", "in.ply", "job", "--tile-points", "3.5"}).err, HasSubstr("or 5M"));
  EXPECT_EQ(other.code, 5);
  EXPECT_THAT(other.err, HasSubstr("other inputs or options"));
  EXPECT_EQ(run({"tiles", "plan", "in.ply", "job", "--tile-points", "3K"}).code, 0) << "the same again";
  const Ran early = run({"tiles", "settle", "job"});
  EXPECT_EQ(early.code, 2);
  EXPECT_THAT(early.err, HasSubstr("tile 0 is not measured"));
  EXPECT_EQ(run({"tiles", "measure", "job", "1000"}).code, 2);
  const Ran later = run({"tiles", "settle", "job", "--strength", "2"});
  EXPECT_EQ(later.code, 2);
  EXPECT_THAT(later.err, HasSubstr("tiles plan"));
}

TEST_F(Tiles, AFullDiskIsAnErrorAndTheWorkGoesOnWhenThereIsRoom) {
  put("in.ply", noisy_plane(150).bytes());
  std::filesystem::create_directory(at("disk"));
  RunSetup setup;
  setup.folder = at("");
  const std::string script =
      "mount -t tmpfs -o size=900k tmpfs disk || exit 99\n"
      "R='" RFSMOOTH_COMMAND
      "'\n"
      "$R tiles plan --tile-points 3000 in.ply disk/job -q || exit 98\n"
      "n=$($R tiles status disk/job --json | sed -n 's/.*\"tiles\": \\([0-9]*\\).*/\\1/p')\n"
      "$R tiles measure disk/job $(seq 0 $((n - 1))) -q; echo first $?\n"
      "mount -o remount,size=64m disk\n"
      "$R tiles measure disk/job $(seq 0 $((n - 1))) -q; echo then $?\n"
      "$R tiles settle disk/job -q && $R tiles run disk/job $(seq 0 $((n - 1))) -q &&\n"
      "$R tiles join disk/job full.ply -q; echo last $?\n";
  std::vector<std::string> arguments = {"--mount", "sh", "-c", script};
  if (geteuid() != 0) arguments.insert(arguments.begin(), {"--user", "--map-root-user"});
  const Ran ran = run_program("unshare", arguments, setup);
  if (ran.code == 99 || ran.code == 1) GTEST_SKIP() << "mounting is not allowed here";
  EXPECT_EQ(ran.out, "first 5\nthen 0\nlast 0\n") << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("No space left"));
  EXPECT_TRUE(take("full.ply") == joined({"in.ply"}, "job", "plenty.ply"));
}

}  // namespace
}  // namespace rfsmooth::test
