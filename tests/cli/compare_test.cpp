/// rfsmooth compare: the figures in the units of the file, and the cloud coloured by them.
#include <cmath>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pipeline/io/io.h"
#include "tests/cli/support/folder.h"

using ::testing::AllOf;
using ::testing::HasSubstr;

namespace rfsmooth::test {
namespace {

namespace io = pipeline::io;

/// A hundred points over the square z = 0 in millimetres: the first is 2 away, every fourth 1, the others
/// 0.5; and one that is not finite.
class CompareCommand : public InFolder {
 protected:
  void SetUp() override {
    for (int i = 0; i < 100; ++i) {
      distance_.push_back(i == 0 ? 2 : i % 4 == 0 ? 1 : 0.5);
      xyz_.insert(xyz_.end(), {0.1 * (i % 10), 0.1 * double(i / 10), distance_.back()});
    }
    xyz_.insert(xyz_.end(), {NAN, 0, 0});
    put("cloud.ply", io::serialize_cloud(io::make_cloud(xyz_.data(), 101), {}, {}).value());
    put("truth.off", "OFF\n4 2 0\n-1 -1 0\n2 -1 0\n2 2 0\n-1 2 0\n3 0 1 2\n3 0 2 3\n");
  }
  double rms() const {
    double sum = 0;
    for (const double d : distance_) sum += d * d;
    return std::sqrt(sum / 100);
  }
  std::vector<double> field(const std::string& file, const char* name) const {
    const io::Cloud cloud = io::read_cloud(at(file), {}, {}).value();
    const auto found = io::find_field(cloud, name);
    EXPECT_TRUE(found) << name;
    return found ? io::field_values(cloud, *found) : std::vector<double>(101);
  }
  std::vector<double> distance_, xyz_;
};

TEST_F(CompareCommand, SaysRmsMedianAnd95PercentInTheUnitsOfTheFile) {
  const auto said =
      nlohmann::json::parse(run({"compare", "--json", "cloud.ply", "truth.off"}).out)["deviation"];
  EXPECT_NEAR(said["rms"].get<double>(), rms(), 1e-12);
  EXPECT_NEAR(said["median"].get<double>(), 0.5, 1e-12);
  EXPECT_NEAR(said["percentile_95"].get<double>(), 1, 1e-12);
  EXPECT_NEAR(said["largest"].get<double>(), 2, 1e-12);
  const std::string text = run({"compare", "cloud.ply", "truth.off"}).out;
  EXPECT_THAT(text, AllOf(HasSubstr("rms "), HasSubstr("median   0.5\n"), HasSubstr("95 %     1\n"),
                          HasSubstr("largest  2\n")));
}

TEST_F(CompareCommand, AgainstACloudTheDistanceIsToItsNearestPoint) {
  put("truth.xyz", "0 0 0\n");
  const auto said =
      nlohmann::json::parse(run({"compare", "--json", "cloud.ply", "truth.xyz"}).out)["deviation"];
  EXPECT_NEAR(said["largest"].get<double>(), 2, 1e-12) << "the corner that is 2 above";
}

/// A unit square's corners with normals that lean by so many degrees from z.
std::string leaning(double degrees) {
  const double angle = degrees * std::atan(1.0) / 45;
  std::string rows = "x y z nx ny nz\n";
  for (const char* at : {"0 0 0", "1 0 0", "0 1 0", "1 1 0"})
    rows += fmt::format("{} {:.17g} 0 {:.17g}\n", at, std::sin(angle), std::cos(angle));
  return rows;
}

TEST_F(CompareCommand, NormalsAreComparedWithThoseOfACleanCloud) {
  put("leaning.xyz", leaning(150));
  put("upright.xyz", leaning(0));
  const auto error = [&](std::vector<std::string> typed) {
    typed.insert(typed.begin(), {"compare", "--json", "leaning.xyz"});
    const Ran ran = run(typed);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return nlohmann::json::parse(ran.out)["own_units"]["normal_error"].get<double>();
  };
  EXPECT_NEAR(error({"upright.xyz"}), 30, 1e-9);
  EXPECT_NEAR(error({"upright.xyz", "--signed-normals"}), 150, 1e-9);
  EXPECT_NEAR(error({"truth.off"}), 30, 1e-9) << "faces look up";
}

TEST_F(CompareCommand, SidesOfNormalsThatAreNotThereAreRefused) {
  put("leaning.xyz", leaning(10));
  put("bare.xyz", "0 0 0\n1 0 0\n0 1 0\n");
  const Ran truth = run({"compare", "leaning.xyz", "bare.xyz", "--signed-normals"}),
            cloud = run({"compare", "bare.xyz", "truth.off", "--signed-normals"});
  EXPECT_EQ(truth.code, 2);
  EXPECT_THAT(truth.err, HasSubstr("bare.xyz: has no normals, which --signed-normals compares"));
  EXPECT_EQ(cloud.code, 2);
  EXPECT_THAT(cloud.err, HasSubstr("bare.xyz: has no normals"));
  EXPECT_EQ(run({"compare", "leaning.xyz", "bare.xyz"}).code, 0);
}

TEST_F(CompareCommand, WritesTheCloudColouredFromBlueToRed) {
  const Ran ran = run({"compare", "cloud.ply", "truth.off", "-o", "seen.ply"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("red from 1"));
  const auto deviation = field("seen.ply", "deviation"), red = field("seen.ply", "red"),
             green = field("seen.ply", "green"), blue = field("seen.ply", "blue");
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_NEAR(deviation[i], distance_[i], 1e-6);
    EXPECT_EQ(red[i], distance_[i] >= 1 ? 255 : 0) << i;
    EXPECT_EQ(green[i], distance_[i] >= 1 ? 0 : 255) << i << ": half of the way is green";
    EXPECT_EQ(blue[i], 0) << i;
  }
  EXPECT_TRUE(std::isnan(deviation[100]));
  EXPECT_EQ(red[100], blue[100]) << "grey";
  ASSERT_EQ(run({"compare", "cloud.ply", "truth.off", "-o", "far.ply", "--red-from", "1000"}).code, 0);
  EXPECT_EQ(field("far.ply", "blue")[0], 255);
}

TEST_F(CompareCommand, APcdHasItsColoursAsPclHasThem) {
  ASSERT_EQ(run({"compare", "cloud.ply", "truth.off", "-o", "seen.pcd"}).code, 0);
  EXPECT_EQ(field("seen.pcd", "rgb")[0], 255 << 16);
  EXPECT_EQ(field("seen.pcd", "rgb")[1], 255 << 8);
  // PCL writes the bits into a float.
  io::Cloud floats = io::make_cloud(xyz_.data(), 101, io::Scalar::float32);
  io::set_field(floats, "rgb", io::Scalar::float32, std::vector<double>(101, 0));
  ASSERT_TRUE(io::write_cloud(floats, at("floats.pcd"), {}, {}).ok());
  ASSERT_EQ(run({"compare", "floats.pcd", "truth.off", "-o", "seen_floats.pcd"}).code, 0);
  const auto packed = float(field("seen_floats.pcd", "rgb")[0]);
  std::uint32_t bits = 0;
  std::memcpy(&bits, &packed, sizeof bits);
  EXPECT_EQ(bits, 255u << 16);
}

TEST_F(CompareCommand, WhereNearlyAllIsExactTheRestIsRed) {
  std::string rows = "0 0 1\n";
  for (int i = 1; i < 100; ++i) rows += fmt::format("0.{:02} 0 0\n", i);
  put("exact.xyz", rows);
  const Ran ran = run({"compare", "exact.xyz", "truth.off", "-o", "seen.ply"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto red = field("seen.ply", "red"), blue = field("seen.ply", "blue");
  EXPECT_EQ(red[0], 255) << "the one that is off";
  EXPECT_EQ(blue[0], 0);
  EXPECT_EQ(red[1], 0);
  EXPECT_EQ(blue[1], 255) << "exact";
}

TEST_F(CompareCommand, ColoursThatThePointsHaveAreReplacedHoweverTheyAreStored) {
  const std::vector<double> old(101, 7);
  io::Cloud parts = io::make_cloud(xyz_.data(), 101, io::Scalar::float32);
  for (const char* name : {"red", "green", "blue"}) io::set_field(parts, name, io::Scalar::uint8, old);
  put("parts.ply", io::serialize_cloud(parts, {}, {}).value());
  ASSERT_EQ(run({"compare", "parts.ply", "truth.off", "-o", "parts.pcd"}).code, 0);
  EXPECT_EQ(field("parts.pcd", "red")[0], 255);
  EXPECT_EQ(field("parts.pcd", "green")[1], 255);
  EXPECT_FALSE(io::find_field(io::read_cloud(at("parts.pcd"), {}, {}).value(), "rgb")) << "one colour";

  io::Cloud both = parts;
  io::set_field(both, "rgba", io::Scalar::uint32, old);
  ASSERT_TRUE(io::write_cloud(both, at("both.pcd"), {}, {}).ok());
  ASSERT_EQ(run({"compare", "both.pcd", "truth.off", "-o", "both.ply"}).code, 0);
  EXPECT_EQ(field("both.ply", "red")[0], 255);
  EXPECT_EQ(field("both.ply", "rgba")[0], double(255U << 24 | 255U << 16));
}

TEST_F(CompareCommand, TheColouredCloudReplacesNothingWithoutForce) {
  put("seen.ply", "mine");
  EXPECT_EQ(run({"compare", "cloud.ply", "truth.off", "-o", "seen.ply"}).code, 5);
  EXPECT_EQ(take("seen.ply"), "mine");
  EXPECT_EQ(run({"compare", "cloud.ply", "truth.off", "-o", "seen.ply", "--force"}).code, 0);
  EXPECT_EQ(run({"compare", "cloud.ply", "truth.off", "-o", "-"}).code, 2);
}

}  // namespace
}  // namespace rfsmooth::test
