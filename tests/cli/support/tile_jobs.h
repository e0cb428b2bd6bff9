/// Clouds larger than a tile, and the steps of smoothing them in tiles.
#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/support/folder.h"
#include "tests/cli/support/rich_cloud.h"

namespace rfsmooth::test {

// A strip is four tiles, each of which reaches 71 spacings into the others.
constexpr int kLong = 160, kWide = 24;
constexpr const char* kTile = "1000";

enum class Kind { own, with_tails, shared, in_steps };

inline double bent(double x) {
  return 6 * std::sin(x / 40);
}

/// A strip of a gently bent surface, `rows` long, points `noise` spacings off it; every thousandth is NaN.
/// Noise is of each point, of each with a tenth six times as loud, of each square of four by four, or
/// rounding besides.
inline RichCloud strip(double noise, int rows = kLong, Kind kind = Kind::own, unsigned seed = 5) {
  constexpr int kTogether = 4;
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal(0, 1);
  std::array<double, kWide / kTogether> of_square{};
  RichCloud cloud;
  cloud.doubles = true;
  for (int i = 0; i < rows; ++i)
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

class Tiles : public InFolder {
 protected:
  /// The tiles of a job, as the command takes them.
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
  /// A step of all tiles of a job in one process.
  void step_of_all(const std::string& what, const std::string& job) {
    std::vector<std::string> arguments = tiles_of(job);
    arguments.insert(arguments.begin(), {what, job});
    step(arguments);
  }
  /// Plans, measures and settles a job of the inputs; its tiles.
  std::vector<std::string> settled(const std::vector<std::string>& inputs, const std::string& job,
                                   const std::string& points = kTile, const std::string& sample = "1000000",
                                   const std::string& option = "") {
    std::vector<std::string> plan = {"plan", "--tile-points", points, "--sample-points", sample};
    if (!option.empty()) plan.push_back(option);
    plan.insert(plan.end(), inputs.begin(), inputs.end());
    plan.push_back(job);
    step(plan);
    step_of_all("measure", job);
    step({"settle", job});
    return tiles_of(job);
  }
  /// The whole job: the cloud that it makes.
  std::string joined(const std::vector<std::string>& inputs, const std::string& job,
                     const std::string& output, const std::string& points = kTile,
                     const std::string& sample = "1000000", const std::string& option = "") {
    settled(inputs, job, points, sample, option);
    step_of_all("run", job);
    step({"join", job, output});
    return std::filesystem::is_directory(at(output)) ? "" : take(output);
  }
};

}  // namespace rfsmooth::test
