/// LAS through the real command: what stays, what is refined, removed, added and said.
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/support/cloud_file.h"
#include "tests/cli/support/folder.h"
#include "tests/support/las_bytes.h"

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

namespace rfsmooth::test {
namespace {

constexpr double kSigma = 0.2;
constexpr int kAcross = 24;
constexpr double kSlope = 0.3;

/// kAcross x kAcross points a metre apart in the plane z = kSlope x in UTM, with Gaussian noise of kSigma, in
/// steps of `scale`.
LasBytes survey(int minor, int format, double scale) {
  std::mt19937_64 engine(9);
  std::normal_distribution<double> noise(0, kSigma);
  LasBytes las;
  las.minor = minor;
  las.format = format;
  las.scale = {scale, scale, scale};
  for (int i = 0; i < kAcross; ++i)
    for (int j = 0; j < kAcross; ++j) {
      const double p[] = {i + noise(engine), j + noise(engine), kSlope * i + noise(engine)};
      las.xyz.push_back({});
      for (std::size_t k = 0; k < 3; ++k) las.xyz.back()[k] = std::int32_t(std::lround(p[k] / scale));
    }
  return las;
}

class LasCommand : public InFolder {
 protected:
  /// Root of the mean square of the distances to the true plane.
  double rms(const std::string& name) const {
    const std::vector<double> xyz = pipeline::io::positions(read(at(name)));
    double sum = 0;
    for (std::size_t k = 0; k < xyz.size(); k += 3) {
      const double height = xyz[k + 2] - kSlope * (xyz[k] - LasBytes().offset[0]);
      sum += height * height / (1 + kSlope * kSlope);
    }
    return std::sqrt(3 * sum / double(xyz.size()));
  }
};

TEST_F(LasCommand, ChangesCoordinatesAndBoxOnly) {
  for (const auto& [minor, format] : {std::pair{2, 3}, {3, 4}, {4, 1}, {4, 6}, {4, 10}}) {
    const LasBytes las = survey(minor, format, 0.001);
    const std::string before = las.bytes();
    put("in.las", before);
    const Ran ran = run({"denoise", "--force", "in.las", "out.las"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    std::string after = take("out.las");
    ASSERT_EQ(after.size(), before.size());
    EXPECT_LT(rms("out.las"), kSigma / 2);
    std::string expected = before;
    expected.replace(179, 48, after.substr(179, 48));
    for (std::size_t i = 0; i < las.xyz.size(); ++i) {
      const std::size_t row = las.points() + i * las.row();
      expected.replace(row, 12, after.substr(row, 12));
    }
    EXPECT_EQ(after == expected, true) << "1." << minor << ", point format " << format;
  }
}

TEST_F(LasCommand, RoundingToACoarseScaleCostsMoreThanRefiningIt) {
  for (const double share : {1.0, 0.4}) {
    const double scale = share * kSigma;
    put("in.las", survey(2, 1, scale).bytes());
    ASSERT_EQ(run({"denoise", "--force", "--drop-unsupported", "in.las", "unrounded.ply"}).code, 0);
    const Ran refined = run({"denoise", "--force", "in.las", "refined.las"}),
              kept =
                  run({"denoise", "--force", "--keep-scale", "in.las", "kept.las", "--report", "kept.json"});
    ASSERT_EQ(refined.code + kept.code, 0) << refined.err << kept.err;
    EXPECT_THAT(refined.err,
                AllOf(HasSubstr(" is coarse"), HasSubstr("refined to "), HasSubstr("--keep-scale")));
    EXPECT_THAT(kept.err, AllOf(Not(HasSubstr("refined to")), HasSubstr(" is coarse"),
                                HasSubstr("rounding to it takes back some of the smoothing")));
    const double best = rms("unrounded.ply"), steps = scale / LasBytes::get<double>(take("refined.las"), 131);
    EXPECT_LT(rms("refined.las"), 1.02 * best) << scale;
    EXPECT_GT(rms("kept.las"), std::hypot(best, 0.9 * scale / std::sqrt(12))) << scale;
    EXPECT_NEAR(std::log10(steps), std::round(std::log10(steps)), 1e-12);
    EXPECT_EQ(LasBytes::get<double>(take("kept.las"), 131), scale);
    const double left = nlohmann::json::parse(take("kept.json"))["noise_left"];
    EXPECT_NEAR(left, rms("kept.las"), rms("kept.las") / 4) << "rounding is noise, too";
  }
}

TEST_F(LasCommand, AFineScaleThatIsKeptIsNotWarnedOf) {
  put("in.las", survey(2, 1, 0.001).bytes());
  EXPECT_THAT(run({"denoise", "--keep-scale", "in.las", "out.las"}).err, Not(HasSubstr("coarse")));
}

TEST_F(LasCommand, AnIndexBesideTheOutputIsSaidToBeStale) {
  put("in.las", survey(2, 1, 0.001).bytes());
  EXPECT_THAT(run({"denoise", "in.las", "out.las"}).err, Not(HasSubstr("index")));
  put("out.lax", "LASX");
  EXPECT_THAT(run({"denoise", "--force", "in.las", "out.las"}).err,
              HasSubstr("out.lax: an index of other points"));
  EXPECT_EQ(take("out.lax"), "LASX");
}

TEST_F(LasCommand, PointsThatDoNotMoveStayWhereTheyAreUnderARefinedScale) {
  const LasBytes las = survey(2, 1, kSigma);
  put("in.las", las.bytes());
  ASSERT_EQ(run({"denoise", "--outliers", "mark", "--write-displacement", "in.las", "out.las"}).code, 0);
  const auto cloud = read(at("out.las"));
  const auto displacement = pipeline::io::find_field(cloud, "displacement");
  ASSERT_TRUE(displacement);
  const std::vector<double> moved = pipeline::io::field_values(cloud, *displacement),
                            xyz = pipeline::io::positions(cloud);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    double squared = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double d = xyz[3 * i + k] - (las.xyz[i][k] * las.scale[k] + las.offset[k]);
      squared += d * d;
    }
    EXPECT_NEAR(moved[i], std::sqrt(squared), 1e-6) << i;
  }
}

TEST_F(LasCommand, RemovesMarksAndAddsFieldsAsInOtherFormats) {
  LasBytes las = survey(4, 6, 0.001);
  for (const int k : {0, 1, 2})
    las.xyz[std::size_t(200 * k + 100)][2] += 9000 + 500 * k;  // metres above the plane
  put("in.las", las.bytes());
  ASSERT_EQ(run({"denoise", "--outliers", "remove", "in.las", "removed.las"}).code, 0);
  const std::string removed = take("removed.las");
  const std::size_t n = las.xyz.size() - 3;
  EXPECT_EQ(LasBytes::get<std::uint64_t>(removed, 247), n);
  const std::size_t end = las.points() + n * las.row();
  EXPECT_EQ(LasBytes::get<std::uint64_t>(removed, 235), end + 7);
  EXPECT_EQ(removed.substr(end), las.tail());
  std::size_t row = las.points();
  for (std::size_t i = 0; i < las.xyz.size(); ++i) {
    if (i == 100 || i == 300 || i == 500) continue;
    ASSERT_EQ(removed.substr(row + 12, las.row() - 12), las.point(i).substr(12)) << i;
    row += las.row();
  }
  ASSERT_EQ(run({"denoise", "--outliers", "mark", "--normals", "in.las", "marked.las"}).code, 0);
  const auto cloud = read(at("marked.las"));
  const auto outlier = pipeline::io::find_field(cloud, "outlier"), up = pipeline::io::find_field(cloud, "nz");
  ASSERT_TRUE(outlier && up);
  EXPECT_EQ(pipeline::io::field_values(cloud, *outlier)[300], 1);
  EXPECT_EQ(pipeline::io::field_values(cloud, *outlier)[301], 0);
  EXPECT_GT(std::abs(pipeline::io::field_values(cloud, *up)[420]), 0.9);
}

TEST_F(LasCommand, NoTwoFieldsGetOneName) {
  std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 30\nproperty double x\nproperty double y\nproperty double z\n"
      "property float intensity_\nproperty float intensity\nend_header\n";
  for (int i = 0; i < 30; ++i) ply += fmt::format("{} {} 0 {} {}\n", i % 6, i / 6, i + 0.25, i + 0.5);
  put("in.ply", ply);
  ASSERT_EQ(run({"denoise", "--iterations", "0", "in.ply", "out.las"}).code, 0);
  const auto cloud = read(at("out.las"));
  const auto first = pipeline::io::find_field(cloud, "intensity_"),
             second = pipeline::io::find_field(cloud, "intensity__");
  ASSERT_TRUE(first && second);
  EXPECT_EQ(pipeline::io::field_values(cloud, *first)[7], 7.25);
  EXPECT_EQ(pipeline::io::field_values(cloud, *second)[7], 7.5);
}

TEST_F(LasCommand, ManyFilesGoIntoAFolder) {
  put("a.las", survey(2, 3, 0.001).bytes());
  put("b.las", survey(4, 7, 0.001).bytes());
  put("c.las", survey(4, 7, 0.001).bytes().substr(0, 9000));
  const Ran ran = run({"denoise", "a.las", "c.las", "b.las", "-o", "cleaned/"});
  EXPECT_EQ(ran.code, 3) << ran.err;
  EXPECT_THAT(ran.err, AllOf(HasSubstr("c.las: byte "), HasSubstr("2 of 3 done")));
  for (const char* name : {"cleaned/a.las", "cleaned/b.las"}) EXPECT_LT(rms(name), kSigma / 2) << name;
  EXPECT_FALSE(there("cleaned/c.las"));
}

TEST_F(LasCommand, EveryCommandReadsIt) {
  put("in.las", survey(4, 7, 0.001).bytes());
  const Ran info = run({"info", "in.las"});
  EXPECT_EQ(info.code, 0) << info.err;
  EXPECT_THAT(info.out,
              AllOf(HasSubstr("las binary"), HasSubstr("1.4, point format 7"),
                    HasSubstr("LASF_Projection 2112"), HasSubstr("ring:uint8"), HasSubstr("copyist 9")));
  const Ran json = run({"info", "--json", "in.las"});
  EXPECT_THAT(json.out, AllOf(HasSubstr("\"point_format\": 7"), HasSubstr("\"scale\": 0.001")));
  EXPECT_EQ(run({"mesh", "in.las", "mesh.ply"}).code, 0);
  EXPECT_EQ(run({"denoise", "in.las", "out.las"}).code, 0);
  EXPECT_EQ(run({"compare", "out.las", "in.las", "-o", "seen.las"}).code, 0);
  const auto seen = read(at("seen.las"));
  EXPECT_TRUE(pipeline::io::find_field(seen, "deviation"));
  EXPECT_EQ(run({"denoise", "--strength-field", "ring", "in.las", "never.las"}).code, 2);  // not from 0 to 1
}

TEST_F(LasCommand, ConversionsNameWhatIsLost) {
  LasBytes las = survey(4, 7, 0.001);
  las.undescribed = 0;
  put("in.las", las.bytes());
  const Ran refused = run({"denoise", "in.las", "out.ply"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("the coordinate system"), HasSubstr("record 'copyist' 9"),
                                 HasSubstr("--drop-unsupported")));
  EXPECT_FALSE(there("out.ply"));
  ASSERT_EQ(run({"denoise", "--drop-unsupported", "in.las", "out.ply"}).code, 0);
  const Ran back = run({"denoise", "out.ply", "back.las"});
  EXPECT_EQ(back.code, 0) << back.err;
  EXPECT_EQ(read(at("back.las")).format, Format::las);
}

TEST_F(LasCommand, MeshesSayThatTheyGoWithoutTheCoordinateSystem) {
  LasBytes las = survey(4, 7, 0.001);
  las.undescribed = 0;
  put("in.las", las.bytes());
  for (const std::string command : {"mesh", "reconstruct"}) {
    const Ran ran = run({command, "in.las", command + ".ply", "--report", command + ".json"});
    if (ran.code == 127) continue;  // reconstruct may lack its program
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_THAT(ran.err, AllOf(HasSubstr(".ply: left out, as ply cannot carry them: the coordinate system"),
                               HasSubstr("record 'copyist' 9")));
    const auto report = nlohmann::json::parse(take(command + ".json"));
    EXPECT_EQ(report["output"]["dropped"][0], "the coordinate system");
  }
  put("plain.xyz", "0 0 0\n1 0 0\n0 1 0\n");
  EXPECT_THAT(run({"mesh", "plain.xyz", "plain.ply"}).err, Not(HasSubstr("left out")));
}

TEST_F(LasCommand, SameBytesForAnyNumberOfThreads) {
  put("in.las", survey(4, 6, kSigma).bytes());
  std::string first;
  for (const char* threads : {"1", "2", "3"}) {
    ASSERT_EQ(run({"denoise", "--force", "--threads", threads, "in.las", "out.las"}).code, 0);
    if (first.empty()) first = take("out.las");
    EXPECT_EQ(take("out.las") == first, true) << threads;
  }
}

}  // namespace
}  // namespace rfsmooth::test
