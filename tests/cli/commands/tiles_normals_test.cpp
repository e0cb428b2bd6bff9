/// rfsmooth tiles --normals: on one side across tiles.
#include <cstring>
#include <string_view>

#include <gmock/gmock.h>

#include "pipeline/io/io.h"
#include "pipeline/tiles/files/row_file.h"
#include "tests/cli/support/tile_jobs.h"
#include "tests/support/sanitized.h"

namespace rfsmooth::test {
namespace {

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
  constexpr double kRadius = 12;
  for (const bool pcd : {false, true}) {
    if (kSanitized && pcd) break;
    const RichCloud cloud = noisy_ball(kRadius, pcd);
    put(cloud.name(), cloud.bytes());
    const std::string job = pcd ? "pcd" : "ply";
    EXPECT_EQ(run({"denoise", "--force", "--normals", cloud.name(), cloud.output()}).code, 0);
    const std::string whole = take(cloud.output());
    std::filesystem::remove(at(cloud.output()));
    const std::string one =
        joined({cloud.name()}, job + "1", cloud.output(), "1000000", "1000000", "--normals");
    EXPECT_TRUE(one == whole);
    std::filesystem::remove(at(cloud.output()));
    const std::string many = joined({cloud.name()}, job, cloud.output(), kTile, "1000000", "--normals");
    ASSERT_EQ(many.size(), whole.size());
    ASSERT_GE(tiles_of(job).size(), 2u);
    const auto normals = added_normals(cloud, many);
    std::size_t outward = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      double along = 0;
      for (std::size_t axis = 0; axis < 3; ++axis)
        along += double(normals[i][axis]) * cloud.xyz[3 * i + axis];
      outward += std::size_t(along > 0.9 * kRadius);
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

// The same job but for the rows that repeat one place on the surface; the last of two files has more of them.
TEST_F(Tiles, RowsAtOnePlaceBecomeWhatTheFirstOfThemDoes) {
  constexpr int kRows = 80;
  RichCloud once = strip(0.4, kRows);
  const std::array<double, 3> shared = {11, 12, 1.5};
  once.xyz.insert(once.xyz.begin(), shared.begin(), shared.end());
  RichCloud often = once;
  often.xyz.clear();
  for (std::size_t i = 0; i < once.size(); ++i) {
    const auto row = once.xyz.begin() + std::ptrdiff_t(3 * i);
    often.xyz.insert(often.xyz.end(), row, row + 3);
    often.xyz.insert(often.xyz.end(), shared.begin(), shared.end());
  }
  const auto [first, last] = often.cut_at(often.size() / 2);
  put("once.ply", once.bytes());
  put("first.ply", first.bytes());
  put("last.ply", last.bytes());
  const std::string expected = joined({"once.ply"}, "one", "one.ply", kTile, "1000000", "--normals");
  joined({"first.ply", "last.ply"}, "two", "out", kTile, "1000000", "--normals");
  EXPECT_GT(tiles_of("two").size(), 1u);
  const std::size_t normal = 12, wide = once.row_bytes() + normal;
  const auto places_of = [&](const std::string& bytes) {  // of rows, and their normals
    constexpr std::string_view kEnd = "end_header\n";
    std::vector<std::string> rows;
    for (std::size_t at = bytes.find(kEnd) + kEnd.size(); at < bytes.size(); at += wide)
      rows.push_back(bytes.substr(at, once.coordinate_bytes()) + bytes.substr(at + once.row_bytes(), normal));
    return rows;
  };
  const std::vector<std::string> one = places_of(expected);
  std::vector<std::string> two = places_of(take("out/first.ply"));
  for (const std::string& row : places_of(take("out/last.ply"))) two.push_back(row);
  ASSERT_EQ(two.size(), 2 * one.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    ASSERT_TRUE(two[2 * i] == one[i]) << i;
    ASSERT_TRUE(two[2 * i + 1] == one[0]) << i;
  }
  EXPECT_NE(one[0].substr(0, once.coordinate_bytes()),
            once.row(once.bytes(), 0).substr(0, once.coordinate_bytes()))
      << "it was smoothed";
}

// Left to itself, a tile faces the hollow of what it sees: one of a whole wave's halves up, the other one
// down.
TEST_F(Tiles, NormalsFaceTheViewpointAndElseTheSameSideInAllTiles) {
  struct Asked {
    std::string viewpoint;
    int rows;
    const char* tile_points;
  };
  std::size_t number = 0;
  for (const auto& [viewpoint, rows, tile_points] :
       {Asked{"40,12,-3000", 80, "1000"}, Asked{"auto", 250, "3000"}}) {
    const RichCloud cloud = strip(0.3, rows);
    put("in.ply", cloud.bytes());
    const std::string job = "job" + std::to_string(++number), out = job + ".ply";
    step({"plan", "--normals", "--viewpoint", viewpoint, "--tile-points", tile_points, "in.ply", job});
    ASSERT_EQ(tiles_of(job).size(), 2u);
    step_of_all("measure", job);
    step({"settle", job});
    step_of_all("run", job);
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

TEST_F(Tiles, NormalsThatTheFileCannotTakeAreRefusedByPlan) {
  using namespace pipeline::io;  // NOLINT(google-build-using-namespace)
  Cloud whole = make_cloud(strip(0.3, 20).xyz.data(), 100);
  for (const char* name : {"nx", "ny", "nz"})
    set_field(whole, name, Scalar::int8, std::vector<double>(100, 0));
  put("whole.ply", serialize_cloud(whole, {}, {}).value());
  const Ran ran = run({"tiles", "plan", "--normals", "whole.ply", "job"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err,
              ::testing::StartsWith(
                  "rfsmooth: error: whole.ply: the points have a field 'nx' already, of whole numbers "
                  "(int8); it cannot take values of type float32\n"));
  EXPECT_FALSE(std::filesystem::exists(at("job")));
  step({"plan", "whole.ply", "job"});
}

// A file as rows is looked at in its first rows only, and where two of them are too many, not at all.
TEST(RowFile, OfAGridTooWideToLookAtKnowsNoViewpointButItsHeaders) {
  for (const std::size_t width : {std::size_t{1000}, std::size_t{140'000}}) {
    std::vector<double> xyz;
    for (std::size_t row = 0; row < 2; ++row)
      for (std::size_t column = 0; column < width; ++column)
        xyz.insert(xyz.end(), {double(column), double(row), 10.0});
    pipeline::io::Cloud cloud = pipeline::io::make_cloud(xyz.data(), 2 * width);
    cloud.format = pipeline::io::Format::pcd;
    cloud.width = width;
    cloud.height = 2;
    for (const char* place : {"0 0 0 1 0 0 0", "1 2 3 1 0 0 0"}) {
      cloud.viewpoint = place;
      const std::string bytes = pipeline::io::serialize_cloud(cloud, {}, {}).value();
      const auto found = pipeline::tiles::RowFile(bytes, "wide.pcd", {}).viewpoint({});
      EXPECT_EQ(found.has_value(), width == 1000 || place[0] == '1') << width << ": " << place;
    }
  }
}

}  // namespace
}  // namespace rfsmooth::test
