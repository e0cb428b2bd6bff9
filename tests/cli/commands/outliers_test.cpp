/// denoise --outliers: what happens to strays in the file.
#include <array>
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/support/cloud_file.h"
#include "tests/cli/support/folder.h"

using ::testing::HasSubstr;

namespace rfsmooth::test {
namespace {

namespace io = pipeline::io;

constexpr int kSide = 30;
constexpr std::size_t kStrays[] = {100, 450, 700};  // rows

/// A noisy plane of kSide x kSide points on a grid of width kSide; three of them float high above it.
io::Cloud plane_with_strays() {
  std::mt19937_64 engine(9);
  std::normal_distribution<double> noise(0, 0.2);
  std::vector<double> xyz, row;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      for (const int c : {i, j, 0}) xyz.push_back(c + noise(engine));
      row.push_back(i * kSide + j);
    }
  for (const std::size_t i : kStrays) xyz[3 * i + 2] = 8 + 0.01 * double(i);
  io::Cloud cloud = io::make_cloud(xyz.data(), xyz.size() / 3, io::Scalar::float32);
  io::set_field(cloud, "row", io::Scalar::int32, row);
  return cloud;
}

/// The same, merged with a copy of itself that was moved a little, and with rows where nothing was seen.
io::Cloud merged_plane_with_strays() {
  std::vector<double> xyz = io::positions(plane_with_strays());
  const std::size_t n = xyz.size();
  for (std::size_t k = 0; k < n; ++k) xyz.push_back(xyz[k] + 1e-4);
  xyz.insert(xyz.begin() + 30, 12, std::nan(""));
  return io::make_cloud(xyz.data(), xyz.size() / 3, io::Scalar::float32);
}

class OutliersOption : public InFolder {
 protected:
  void write(const io::Cloud& cloud, const std::string& name) const {
    value_or_throw(io::write_cloud(cloud, at(name), {}, {}));
  }
  /// The output of a run over the plane, as `out` with the report "report.json".
  io::Cloud clean(const std::vector<std::string>& options, const std::string& extension = ".ply",
                  bool organised = false) {
    io::Cloud cloud = plane_with_strays();
    if (organised) {
      cloud.width = cloud.height = kSide;
    }
    std::filesystem::remove_all(at("in" + extension));
    write(cloud, "in" + extension);
    std::vector<std::string> arguments = {"denoise", "--force", "--report", "report.json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    arguments.insert(arguments.end(), {"in" + extension, "out" + extension});
    const Ran ran = run(arguments);
    EXPECT_EQ(ran.code, 0) << ran.err;
    said_ = ran.err;
    return read(at("out" + extension));
  }
  nlohmann::json report() const { return nlohmann::json::parse(take("report.json")); }
  std::string said_;
};

std::vector<double> values_of(const io::Cloud& cloud, const std::string& name) {
  return io::field_values(cloud, io::find_field(cloud, name).value());
}

TEST_F(OutliersOption, RemovedLeaveTheCommentsOfAHeaderWhereTheyAre) {
  std::string rows;
  const std::vector<double> xyz = io::positions(plane_with_strays());
  for (std::size_t i = 0; i < xyz.size(); i += 3)
    rows += fmt::format("{} {} {}\n", xyz[i], xyz[i + 1], xyz[i + 2]);
  const std::array<std::string, 3> cases[] = {
      {"in.off", "# by hand\nOFF\n# of stone\n900 0 0\n", "OFF\n# by hand\n# of stone\n897 0 0\n"},
      {"in.pts", "900\n# by hand\n", "897\n# by hand\n"},
      {"first.pts", "# by hand\n900\n", "# by hand\n897\n"},
      {"named.pts", "900\n# by hand\n//X Y Z\n", "897\n# by hand\n//X Y Z\n"},
      {"names_first.pts", "//X Y Z\n900\n", "//X Y Z\n897\n"}};
  for (const auto& [name, header, expected] : cases) {
    put(name, header + rows);
    const Ran ran = run({"denoise", "--outliers", "remove", name, "out-" + name});
    ASSERT_EQ(ran.code, 0) << ran.err;
    EXPECT_EQ(take("out-" + name).substr(0, expected.size()), expected) << name;
  }
}

TEST_F(OutliersOption, AreLeftWhereTheyAreByDefault) {
  const io::Cloud out = clean({});
  EXPECT_THAT(said_, HasSubstr("3 outliers"));
  EXPECT_EQ(report()["counts"]["outliers"], 3);
  EXPECT_EQ(report()["counts"]["removed"], 0);
  EXPECT_EQ(report()["options"]["outliers"], "keep");
  const auto before = io::positions(plane_with_strays()), after = io::positions(out);
  ASSERT_EQ(after.size(), before.size());
  EXPECT_EQ(out.points().fields.size(), 4u) << "no field is added";
  for (const std::size_t i : kStrays)
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(after[3 * i + axis], before[3 * i + axis]);
  EXPECT_NE(after[3], before[3]) << "others move";
}

TEST_F(OutliersOption, MarkAddsAField) {
  for (const char* extension : {".ply", ".pcd"}) {
    const io::Cloud out = clean({"--outliers", "mark"}, extension);
    const io::Field& field = out.points().fields.back();
    EXPECT_EQ(field.name, "outlier");
    EXPECT_EQ(field.type, io::Scalar::uint8);
    const std::vector<double> flags = values_of(out, "outlier");
    ASSERT_EQ(flags.size(), plane_with_strays().size());
    for (std::size_t i = 0; i < flags.size(); ++i)
      EXPECT_EQ(flags[i], std::count(std::begin(kStrays), std::end(kStrays), i)) << i;
  }
}

/// A sphere with noise of which one point in thirty has ten times as much.
TEST_F(OutliersOption, PointsThatHeavyTailsExplainAreNoneUnderTheAutomaticFlow) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> noise(0, 0.02);
  std::string text;
  const int n = 4000;
  for (int i = 0; i < n; ++i) {  // a spiral from pole to pole
    const double z = 1 - (2 * i + 1.0) / n, turn = i * 2.399963, r = std::sqrt(1 - z * z),
                 scale = 1 + noise(engine) * (i % 30 == 0 ? 10 : 1);
    text += fmt::format("{:.6f} {:.6f} {:.6f}\n", scale * r * std::cos(turn), scale * r * std::sin(turn),
                        scale * z);
  }
  put("tails.xyz", text);
  const auto removed = [&](const char* flow) {
    EXPECT_EQ(run({"denoise", "--flow", flow, "--outliers", "remove", "tails.xyz", "out.xyz", "--force",
                   "--report", "r.json"})
                  .code,
              0);
    return nlohmann::json::parse(take("r.json"))["counts"]["removed"].get<int>();
  };
  EXPECT_LT(2 * removed("auto"), removed("hc"));
  EXPECT_THAT(run({"denoise", "--help-all"}).out, HasSubstr("tails explain"));
  EXPECT_THAT(run({"man", "denoise"}).out, HasSubstr("heavy tails"));
}

TEST_F(OutliersOption, RemoveLeavesThemOutAndKeepsTheOrder) {
  const io::Cloud kept = clean({}), out = clean({"--outliers", "remove"});
  EXPECT_THAT(said_, HasSubstr("3 outliers removed"));
  EXPECT_EQ(report()["counts"]["removed"], 3);
  ASSERT_EQ(out.size(), kept.size() - 3);
  const std::vector<double> rows = values_of(out, "row");
  const auto all = io::positions(kept), left = io::positions(out);
  std::size_t next = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (std::count(std::begin(kStrays), std::end(kStrays), i) != 0) continue;
    EXPECT_EQ(rows[next], double(i));
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(left[3 * next + axis], all[3 * i + axis]);
    ++next;
  }
}

/// Triangles over the plane, each with a number of its own; edges along its first row. As text for PLY.
std::string mesh_with_strays() {
  const io::Cloud plane = plane_with_strays();
  std::string faces, edges;
  std::size_t count = 0;
  for (int i = 0; i + 1 < kSide; ++i)
    for (int j = 0; j + 1 < kSide; ++j, ++count) {
      const int a = i * kSide + j;
      faces += fmt::format("7 4  {} {} {} {} 2 0.5 {}\n", a, a + 1, a + kSide + 1, a + kSide, count);
    }
  for (int i = 99; i < 110; ++i) edges += fmt::format("{} {} {}\n", i, i + 1, i);
  std::string text = value_or_throw(io::serialize_cloud(plane, {{}, io::Encoding::ascii}, {}));
  const std::string end = "end_header\n";
  text.replace(text.find(end), end.size(),
               fmt::format("element face {}\nproperty uchar kind\nproperty list uchar uint vertex_indices\n"
                           "property list uchar float texcoord\nelement edge 11\nproperty int vertex1\n"
                           "property int vertex2\nproperty int first\n",
                           count) +
                   end);
  return text + faces + edges;
}

TEST_F(OutliersOption, RemoveKeepsTheFacesAndEdgesWhosePointsStay) {
  put("in.ply", mesh_with_strays());
  for (const char* encoding : {"ascii", "binary", "binary_big_endian"}) {
    // A file of the encoding, then a run that changes nothing but the outliers.
    ASSERT_EQ(
        run({"denoise", "--iterations", "0", "--encoding", encoding, "in.ply", "same.ply", "--force"}).code,
        0);
    const Ran ran = run({"denoise", "--iterations", "0", "--outliers", "remove", "same.ply", "out.ply",
                         "--report", "report.json", "--force"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    EXPECT_THAT(ran.err, HasSubstr("3 outliers removed, with them 10 of 841 faces, 2 of 11 edges"));
    EXPECT_THAT(ran.err, ::testing::Not(HasSubstr("warning")));
    EXPECT_EQ(report()["counts"]["removed_with_points"], nlohmann::json({{"face", 10}, {"edge", 2}}));
    const io::Cloud before = read(at("in.ply")), after = read(at("out.ply"));
    const std::vector<double> row = values_of(after, "row");
    const io::Table &old = *before.element("face"), &face = *after.element("face");
    ASSERT_EQ(face.count, old.count - 10);
    const auto corners = io::gather_lists(face, 1, {}), old_corners = io::gather_lists(old, 1, {});
    const auto texture = io::gather_lists(face, 2, {});
    for (std::size_t f = 0; f < face.count; ++f) {
      ASSERT_EQ(texture.start[f + 1] - texture.start[f], 2u);
      const auto was = std::size_t(texture.values[texture.start[f] + 1]);  // the number it had
      for (std::size_t k = 0; k < 4; ++k)
        EXPECT_EQ(row[std::size_t(corners.values[4 * f + k])], old_corners.values[4 * was + k]);
    }
    const std::vector<double> edge = io::gather(*after.element("edge"), {0, 1, 2}, {});
    ASSERT_EQ(edge.size(), 9u * 3);
    for (std::size_t e = 0; e < edge.size(); e += 3) {
      EXPECT_EQ(row[std::size_t(edge[e])], edge[e + 2]);
      EXPECT_EQ(row[std::size_t(edge[e + 1])], edge[e + 2] + 1);
    }
  }
}

TEST_F(OutliersOption, FacesOfATextKeepTheirOtherWords) {
  const io::Cloud plane = plane_with_strays();
  const auto xyz = io::positions(plane);
  std::string text = "OFF\n900 3 0\n";
  for (std::size_t i = 0; i < plane.size(); ++i)
    text += fmt::format("{} {} {}\n", xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]);
  put("in.off", text + "3 00 1  2\t0.1 0.2 0.30\n3 99 100 101 1 1 1\n3  99 101 102\t.5 .50 0.500\n");
  const Ran ran = run({"denoise", "--iterations", "0", "--outliers", "remove", "in.off", "out.off"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("with them 1 of 3 faces"));
  const std::string out = take("out.off");
  EXPECT_THAT(out, ::testing::StartsWith("OFF\n897 2 0\n"));
  EXPECT_THAT(out, ::testing::EndsWith("\n3 00 1  2\t0.1 0.2 0.30\n3  99 100 101\t.5 .50 0.500\n"));
}

TEST_F(OutliersOption, RemoveKeepsTheGridOfAnOrganisedCloud) {
  const io::Cloud out = clean({"--outliers", "remove", "--write-displacement"}, ".pcd", true);
  EXPECT_EQ(out.width, std::size_t(kSide));
  EXPECT_EQ(out.height, std::size_t(kSide));
  EXPECT_EQ(report()["counts"]["removed"], 3);
  const auto xyz = io::positions(out);
  ASSERT_EQ(out.size(), std::size_t(kSide) * kSide);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const bool stray = std::count(std::begin(kStrays), std::end(kStrays), i) != 0;
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(std::isnan(xyz[3 * i + axis]), stray) << i;
  }
  for (const double moved : values_of(out, "displacement")) EXPECT_TRUE(moved >= 0 && moved < 2);
}

TEST_F(OutliersOption, AGridOfWholeNumbersIsLostAndThatIsSaid) {
  std::string pcd = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE I I I\nWIDTH 40\nHEIGHT 30\nDATA ascii\n";
  for (int i = 0; i < 40 * 30; ++i)
    pcd += fmt::format("{} {} {}\n", 100 * (i % 40), 100 * (i / 40), i == 615 ? 3000 : i * i % 7);
  put("in.pcd", pcd);
  const Ran ran = run({"denoise", "--outliers", "remove", "in.pcd", "out.pcd"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(ran.err, ::testing::AllOf(HasSubstr("1 outlier removed"), HasSubstr("the grid of 40 x 30 goes"),
                                        HasSubstr("--outliers mark")));
  const Ran marked = run({"denoise", "--outliers", "mark", "in.pcd", "marked.pcd"});
  EXPECT_THAT(marked.err, ::testing::Not(HasSubstr("grid")));
  EXPECT_THAT(take("marked.pcd"), HasSubstr("WIDTH 40\nHEIGHT 30\n"));
}

TEST_F(OutliersOption, SmoothLooksForNone) {
  clean({"--outliers", "smooth"});
  EXPECT_EQ(report()["counts"]["outliers"], 0);
  EXPECT_FALSE(report()["seconds"].contains("outliers"));
}

TEST_F(OutliersOption, EveryCommandSaysTheSameSpacingAndNoise) {
  write(merged_plane_with_strays(), "in.ply");
  ASSERT_EQ(run({"denoise", "in.ply", "out.ply", "--report", "report.json"}).code, 0);
  const auto denoised = report();
  const std::size_t strays = std::size(kStrays);
  ASSERT_EQ(denoised["counts"]["outliers"], 2 * strays);
  ASSERT_EQ(denoised["counts"]["finite"], 2 * kSide * kSide);
  const double spacing = denoised["spacing"], noise = denoised["noise"];
  EXPECT_GT(spacing, 0.1) << "twins are one";
  EXPECT_GT(noise, 0);

  const auto info = nlohmann::json::parse(run({"info", "--json", "in.ply"}).out);
  EXPECT_EQ(info["spacing"], spacing);
  EXPECT_EQ(info["noise"], noise);
  EXPECT_EQ(info["noise_measured"], denoised["noise_measured"]);

  for (const char* stage : {"emst-points", "emst", "sdg", "rfs"}) {
    ASSERT_EQ(
        run({"mesh", "in.ply", "mesh.ply", "--force", "--stage", stage, "--report", "report.json"}).code, 0);
    const auto mesh = report();
    if (std::string(stage) != "emst-points") {
      EXPECT_EQ(mesh["noise"], noise) << stage;
    }
    EXPECT_EQ(mesh["counts"]["vertices"], kSide * kSide) << stage << ": strays are vertices";
  }

  ASSERT_EQ(run({"report", "in.ply", "out.ply", "-o", "page.html"}).code, 0);
  EXPECT_THAT(take("page.html"),
              ::testing::AllOf(HasSubstr(fmt::format("<th>spacing before</th><td>{:.4g}</td>", spacing)),
                               HasSubstr(fmt::format("<th>noise before</th><td>{:.3g}</td>", noise)),
                               HasSubstr(fmt::format("<th>outliers</th><td>{}</td>", 2 * strays))));
}

TEST_F(OutliersOption, StraysDoNotPullTheOthers) {
  const auto with = io::positions(clean({}));
  io::Cloud alone = plane_with_strays();
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < alone.size(); ++i)
    if (std::count(std::begin(kStrays), std::end(kStrays), i) == 0) rows.push_back(i);
  io::select_points(alone, rows);
  write(alone, "alone.ply");
  ASSERT_EQ(run({"denoise", "alone.ply", "alone_out.ply"}).code, 0);
  const auto without = io::positions(read(at("alone_out.ply")));
  ASSERT_EQ(without.size(), 3 * rows.size());
  ASSERT_EQ(with.size(), without.size() + 9);
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(with[3 * rows[k] + axis], without[3 * k + axis], 0.05) << "row " << rows[k];
}

}  // namespace
}  // namespace rfsmooth::test
