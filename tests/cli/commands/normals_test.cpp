/// denoise --normals: which fields, which types, which side; and what happens without it.
#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/support/cloud_file.h"
#include "tests/cli/support/folder.h"
#include "tests/support/awkward_clouds.h"

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

namespace rfsmooth::test {
namespace {

namespace io = pipeline::io;

std::vector<std::string> field_names(const io::Cloud& cloud) {
  std::vector<std::string> names;
  for (const auto& field : cloud.points().fields) names.push_back(field.name);
  return names;
}

std::vector<double> values(const io::Cloud& cloud, const std::string& name) {
  return io::field_values(cloud, io::find_field(cloud, name).value());
}

class NormalsCommand : public InFolder {
 protected:
  /// A noisy sphere of 800 points, its last row not finite, with more fields of zeros, as `name`.
  void put_sphere(const std::string& name,
                  const std::vector<std::pair<std::string, io::Scalar>>& fields = {}) const {
    std::vector<double> xyz;
    for (const auto& p : noisy_sphere(800, 0.01, 5)) xyz.insert(xyz.end(), p.data(), p.data() + 3);
    xyz.insert(xyz.end(), {std::nan(""), 0, 0});
    io::Cloud cloud = io::make_cloud(xyz.data(), xyz.size() / 3, io::Scalar::float32);
    for (const auto& [field, type] : fields)
      io::set_field(cloud, field, type, std::vector<double>(cloud.size(), 0.5));
    value_or_throw(io::write_cloud(cloud, at(name), {}, {}));
  }

  /// How many of the first 800 rows have a unit normal within 30 degrees of outward.
  static int outward(const io::Cloud& cloud, const std::array<const char*, 3>& names) {
    const auto xyz = io::positions(cloud);
    const auto nx = values(cloud, names[0]), ny = values(cloud, names[1]), nz = values(cloud, names[2]);
    int count = 0;
    for (std::size_t i = 0; i < 800; ++i) {
      const double length = std::sqrt(nx[i] * nx[i] + ny[i] * ny[i] + nz[i] * nz[i]);
      const double dot = nx[i] * xyz[3 * i] + ny[i] * xyz[3 * i + 1] + nz[i] * xyz[3 * i + 2];
      const double radius = std::hypot(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]);
      count += std::abs(length - 1) < 1e-6 && dot > 0.866 * radius ? 1 : 0;
    }
    return count;
  }
};

constexpr std::array<const char*, 3> kPly = {"nx", "ny", "nz"}, kPcd = {"normal_x", "normal_y", "normal_z"};

TEST_F(NormalsCommand, NewFieldsAreFloat32AndNamedAsTheFormatDoes) {
  put_sphere("in.ply");
  for (const char* out : {"out.ply", "out.pcd", "out.xyz"}) {
    const Ran ran = run({"denoise", "--normals", "in.ply", out});
    ASSERT_EQ(ran.code, 0) << ran.err;
    const io::Cloud cloud = read(at(out));
    const auto& names = cloud.format == io::Format::pcd ? kPcd : kPly;
    EXPECT_THAT(field_names(cloud), ElementsAre("x", "y", "z", names[0], names[1], names[2])) << out;
    for (const auto& field : cloud.points().fields)
      EXPECT_TRUE(field.type == io::Scalar::float32 || cloud.format == io::Format::xyz) << out;
    EXPECT_EQ(outward(cloud, names), 800);
    EXPECT_TRUE(std::isnan(values(cloud, names[0])[800])) << "a row that is not finite";
  }
}

TEST_F(NormalsCommand, PresentFieldsKeepPlaceAndTypeAndCurvatureIsLeftAlone) {
  put_sphere("in.pcd", {{"normal_x", io::Scalar::float64},
                        {"normal_y", io::Scalar::float64},
                        {"normal_z", io::Scalar::float64},
                        {"curvature", io::Scalar::float32}});
  const Ran ran = run({"denoise", "--normals", "in.pcd", "out.pcd"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(ran.err, Not(HasSubstr("stale")));
  const io::Cloud cloud = read(at("out.pcd"));
  EXPECT_THAT(field_names(cloud),
              ElementsAre("x", "y", "z", "normal_x", "normal_y", "normal_z", "curvature"));
  EXPECT_EQ(cloud.points().fields[3].type, io::Scalar::float64);
  EXPECT_EQ(outward(cloud, kPcd), 800);
  ASSERT_EQ(cloud.size(), 801u);
  for (const double c : values(cloud, "curvature")) EXPECT_EQ(c, 0.5);
  EXPECT_EQ(values(cloud, "normal_x")[800], 0.5) << "a row that is not finite keeps what it had";
}

TEST_F(NormalsCommand, WithoutTheOptionNormalsStayAndAWarningSaysTheyAreStale) {
  put_sphere("in.ply",
             {{"nx", io::Scalar::float32}, {"ny", io::Scalar::float32}, {"nz", io::Scalar::float32}});
  const Ran ran = run({"denoise", "in.ply", "out.ply"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("stale"));
  EXPECT_THAT(ran.err, HasSubstr("--normals"));
  const io::Cloud cloud = read(at("out.ply"));
  ASSERT_EQ(cloud.size(), 801u);
  for (const char* name : kPly)
    for (const double value : values(cloud, name)) EXPECT_EQ(value, 0.5);
}

/// Columns without names: x y z, `between`, and the direction from the middle, which no file says is a
/// normal.
std::string columns(const std::string& between, double length = 1) {
  std::string out;
  for (const auto& p : noisy_sphere(800, 0.01, 5)) {
    const Eigen::Vector3d inward = -length * p.normalized();
    out += fmt::format("{:.6f} {:.6f} {:.6f} {}{:.6f} {:.6f} {:.6f}\n", p.x(), p.y(), p.z(), between,
                       inward.x(), inward.y(), inward.z());
  }
  return out;
}

TEST_F(NormalsCommand, UnitVectorsInColumnsWithoutNamesAreNormals) {
  for (const char* between : {"", "0.5 ", "10 20 30 "}) {
    put("in.xyz", columns(between));
    const Ran kept = run({"denoise", "in.xyz", "kept.xyz", "--force"});
    ASSERT_EQ(kept.code, 0) << kept.err;
    EXPECT_THAT(kept.err, HasSubstr("stale")) << between;
    const Ran ran = run({"denoise", "--normals", "in.xyz", "out.xyz", "--force"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    EXPECT_THAT(ran.err, Not(HasSubstr("stale")));
    const io::Cloud before = read(at("in.xyz")), after = read(at("out.xyz"));
    EXPECT_EQ(field_names(after), field_names(before)) << "in their place, and no line of names";
    EXPECT_EQ(outward(before, kPly), 0);
    EXPECT_EQ(outward(after, kPly), 800);
    for (const auto& field : before.points().fields)
      if (field.name.rfind("column", 0) == 0) {
        EXPECT_EQ(values(after, field.name), values(before, field.name)) << field.name;
      }
  }
}

TEST_F(NormalsCommand, NamesAsCloudCompareWritesThemAreKnown) {
  put("in.txt", "//X Y Z R G B Nx Ny Nz\n" + columns("10 20 30 "));
  const Ran kept = run({"denoise", "in.txt", "kept.txt"});
  ASSERT_EQ(kept.code, 0) << kept.err;
  EXPECT_THAT(kept.err, HasSubstr("stale"));
  const Ran ran = run({"denoise", "--normals", "in.txt", "out.txt"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const io::Cloud after = read(at("out.txt"));
  EXPECT_THAT(field_names(after), ElementsAre("X", "Y", "Z", "R", "G", "B", "Nx", "Ny", "Nz"));
  EXPECT_EQ(outward(after, {"Nx", "Ny", "Nz"}), 800);
  ASSERT_EQ(run({"denoise", "in.txt", "out.las"}).code, 0);
  const io::Cloud las = read(at("out.las"));
  EXPECT_EQ(values(las, "red")[0], 2560) << "the place of colours, not extra bytes";
  EXPECT_THAT(field_names(las), Not(::testing::Contains("R")));
}

TEST_F(NormalsCommand, ColumnsOfACubesNormalsAreNormalsToo) {
  std::string text;
  for (int i = 0; i < 100; ++i)
    text +=
        fmt::format("{} {} 0 {} 0 {}\n", i % 10, i / 10, i % 20 == 0 ? "-1" : "1e-14", i % 20 == 0 ? 0 : 1);
  put("in.xyz", text);
  EXPECT_THAT(field_names(read(at("in.xyz"))), ElementsAre("x", "y", "z", "nx", "ny", "nz"));
}

TEST_F(NormalsCommand, OtherColumnsWithoutNamesAreNone) {
  std::string flags;
  for (int i = 0; i < 100; ++i)
    flags += fmt::format("{} {} 0.{} {} {} {}\n", i % 10, i / 10, i * i % 7, int(i % 3 == 0), int(i % 3 == 1),
                         int(i % 3 == 2));
  for (const std::string& text : {columns("", 0.9), columns("", 255), flags}) {
    put("in.xyz", text);
    const Ran ran = run({"denoise", "in.xyz", "out.xyz", "--force"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    EXPECT_THAT(ran.err, Not(HasSubstr("stale")));
    EXPECT_THAT(field_names(read(at("in.xyz"))),
                ElementsAre("x", "y", "z", "column_4", "column_5", "column_6"));
  }
}

TEST_F(NormalsCommand, FaceTheViewpointTyped) {
  put_sphere("in.ply");
  const Ran ran = run({"denoise", "--normals", "--viewpoint", "0,0,0", "in.ply", "out.ply"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(outward(read(at("out.ply")), kPly), 0) << "seen from inside";
}

TEST_F(NormalsCommand, FaceTheViewpointOfThePcdUnlessItIsTheDefault) {
  put_sphere("in.pcd");
  std::string bytes = take("in.pcd");
  const std::string none = "VIEWPOINT 0 0 0 1 0 0 0", turned = "VIEWPOINT 0 0 0 0 1 0 0";
  ASSERT_NE(bytes.find(none), std::string::npos);
  bytes.replace(bytes.find(none), none.size(), turned);
  put("seen.pcd", bytes);
  ASSERT_EQ(run({"denoise", "--normals", "in.pcd", "a.pcd", "--report", "a.json"}).code, 0);
  ASSERT_EQ(run({"denoise", "--normals", "seen.pcd", "b.pcd", "--report", "b.json"}).code, 0);
  EXPECT_EQ(outward(read(at("a.pcd")), kPcd), 800);
  EXPECT_EQ(outward(read(at("b.pcd")), kPcd), 0);
  EXPECT_TRUE(nlohmann::json::parse(take("a.json"))["normals"]["viewpoint"].is_null());
  EXPECT_EQ(nlohmann::json::parse(take("b.json"))["normals"]["viewpoint"],
            nlohmann::json::array({0.0, 0.0, 0.0}));
}

TEST_F(NormalsCommand, MistakesAreUsageErrors) {
  put_sphere("in.ply", {{"nx", io::Scalar::int8}});
  for (const char* wrong : {"", "1,2", "1,2,3,4", "1,2,x", "1, 2,3", "1,2,inf", "1,2,3,"}) {
    const Ran ran = run({"denoise", "--normals", "--viewpoint", wrong, "in.ply", "out.ply"});
    EXPECT_EQ(ran.code, 2) << wrong;
    EXPECT_THAT(ran.err, HasSubstr("--viewpoint"));
  }
  EXPECT_EQ(run({"denoise", "--viewpoint", "1,2,3", "in.ply", "out.ply"}).code, 2) << "without --normals";
  const Ran whole = run({"denoise", "--normals", "in.ply", "out.ply"});
  EXPECT_EQ(whole.code, 2);
  EXPECT_THAT(whole.err, HasSubstr("'nx'"));
  EXPECT_FALSE(there("out.ply"));
}

}  // namespace
}  // namespace rfsmooth::test
