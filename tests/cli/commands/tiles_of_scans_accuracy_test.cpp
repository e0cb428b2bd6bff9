/// Real scans in tiles: parts of them are ten times sparser than others, louder, in steps.
#include <cmath>
#include <cstddef>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/support/cloud_file.h"
#include "tests/cli/support/tile_jobs.h"
#include "tests/support/scans.h"

namespace rfsmooth::test {
namespace {

/// A scan, the points of its tiles, and how far they may be off the whole cloud (spacings, rms): with all
/// points for a sample, and with so few that they are measured but not smoothed.
struct Scan {
  std::string path, tile_points, sample_points;
  double seams, all;

  friend void PrintTo(const Scan& scan, std::ostream* out) { *out << scan.path; }
};

class TilesOfScans : public Tiles, public testing::WithParamInterface<Scan> {
 protected:
  /// The root mean square of the distances of two clouds' points.
  double apart(const std::string& one, const std::string& other) const {
    const auto places = [&](const std::string& name) {
      return pipeline::io::points_of(pipeline::io::positions(read(at(name))));
    };
    const Positions a = places(one), b = places(other);
    EXPECT_EQ(a.size(), b.size());
    double squares = 0, count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (!a[i].allFinite() || !b[i].allFinite()) continue;
      squares += (a[i] - b[i]).squaredNorm();
      ++count;
    }
    EXPECT_GT(count, 1000);
    return std::sqrt(squares / count);
  }

  void expect_as_whole(const Scan& scan) {
    pipeline::io::WriteOptions options;
    options.encoding = pipeline::io::Encoding::binary_little_endian;
    EXPECT_TRUE(pipeline::io::write_cloud(read(scan.path), at("in.pcd"), options, {}));
    EXPECT_EQ(run({"denoise", "--report", "report.json", "in.pcd", "whole.pcd"}).code, 0);
    const double spacing = nlohmann::json::parse(take("report.json"))["spacing"];
    EXPECT_GT(apart("in.pcd", "whole.pcd"), 0.1 * spacing) << "it is smoothed";
    joined({"in.pcd"}, "all", "all.pcd", scan.tile_points);
    EXPECT_GT(tiles_of("all").size(), 3U);
    EXPECT_LT(apart("all.pcd", "whole.pcd") / spacing, scan.seams);
    joined({"in.pcd"}, "some", "some.pcd", scan.tile_points, scan.sample_points);
    EXPECT_LT(apart("some.pcd", "whole.pcd") / spacing, scan.all);
  }
};

std::vector<Scan> scans() {
  std::vector<Scan> all = {
      // Far away the floor is sparser than near by, and patches are wider. Whether its far points are tails
      // of the noise or groups (tame.cpp) is a close call, which a sample decides otherwise.
      {kFloorCrop, "2000", "4000", 0.15, 1.3},
      // The sample is less than half of the points, and their noise is that of the whole cloud.
      {kBoxCrop, "2000", "4000", 0.005, 0.04},
      {kBuildingCrop, "2000", "4000", 0.02, 0.05}};
  // Its points lie twice at one place, and its walls stand out of the noise as tails do: in some of its
  // tiles.
  for (const std::string& room : whole_scans({"room_scan1.pcd"}))
    all.push_back({room, "20000", "1000000", 0.04, 0.04});
  return all;
}

TEST_P(TilesOfScans, AreTheWholeCloud) {
  expect_as_whole(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Crops, TilesOfScans, testing::ValuesIn(scans()),
                         [](const auto& test) { return test_name(test.param.path); });

}  // namespace
}  // namespace rfsmooth::test
