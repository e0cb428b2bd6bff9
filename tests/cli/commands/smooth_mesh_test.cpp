// smooth-mesh beyond the flow: constraints from fields, refinement, ridges.
#include <cmath>
#include <cstdio>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/support/folder.h"
#include "tests/support/meshes.h"

using ::testing::HasSubstr;

namespace rfsmooth::test {
namespace {

constexpr int kMeshSide = 9;

/// A grid with a bump in the middle, as text: x y z and the given columns of every vertex; two triangles a
/// cell.
std::string bumpy_grid(
    const std::string& properties,
    const std::function<std::string(int, int)>& columns = [](int, int) { return ""; }, int side = kMeshSide) {
  const int middle = side / 2;
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(side * side) +
                     "\nproperty double x\nproperty double y\nproperty double z\n" + properties +
                     "element face " + std::to_string(2 * (side - 1) * (side - 1)) +
                     "\nproperty list uchar int vertex_indices\nend_header\n";
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const int u = i - middle, v = j - middle;
      text += std::to_string(i) + " " + std::to_string(j) + " " +
              std::to_string(std::exp(-0.3 * (u * u + v * v))) + columns(i, j) + "\n";
    }
  for (int i = 0; i + 1 < side; ++i)
    for (int j = 0; j + 1 < side; ++j) {
      const int a = i * side + j, b = a + 1, c = a + side, d = c + 1;
      for (const auto& f : {std::array{a, c, b}, std::array{b, c, d}})
        text += "3 " + std::to_string(f[0]) + " " + std::to_string(f[1]) + " " + std::to_string(f[2]) + "\n";
    }
  return text;
}

/// The numbers of the rows behind the header of an ascii PLY.
std::vector<std::vector<double>> rows_of(const std::string& ply, std::size_t n) {
  std::istringstream in(ply.substr(ply.find("end_header\n") + 11));
  std::vector<std::vector<double>> rows;
  std::string line;
  while (rows.size() < n && std::getline(in, line)) {
    std::istringstream words(line);
    std::vector<double> row;
    for (double v; words >> v;) row.push_back(v);
    rows.push_back(row);
  }
  return rows;
}

class SmoothMesh : public InFolder {
 protected:
  std::vector<std::vector<double>> smoothed(const std::string& in, std::vector<std::string> options,
                                            std::size_t rows = kMeshSide * kMeshSide) {
    put("in.ply", in);
    options.insert(options.begin(), {"smooth-mesh", "in.ply", "out.ply", "--force"});
    const Ran ran = run(options);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return rows_of(take("out.ply"), rows);
  }
};

TEST_F(SmoothMesh, StrengthFieldHoldsBackAndFixedFieldFixes) {
  const auto before = rows_of(bumpy_grid(""), kMeshSide * kMeshSide);
  const auto half = smoothed(
      bumpy_grid("property float s\n", [](int i, int) { return i < 4    ? " 0"
                                                               : i == 4 ? " 0.5"
                                                                        : " 1"; }),
      {"--flow", "laplacian", "--iterations", "1", "--strength-field", "s"});
  const auto whole = smoothed(bumpy_grid(""), {"--flow", "laplacian", "--iterations", "1"});
  for (std::size_t v = 0; v < before.size(); ++v) {
    const double s = v / kMeshSide < 4 ? 0 : v / kMeshSide == 4 ? 0.5 : 1;
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(half[v][c], before[v][c] + s * (whole[v][c] - before[v][c]), 1e-6) << v;
  }
  const auto fixed =
      smoothed(bumpy_grid("property uchar keep\n", [](int i, int j) { return i == j ? " 1" : " 0"; }),
               {"--flow", "implicit", "--fixed-field", "keep"});
  for (std::size_t v = 0; v < before.size(); ++v) {
    if (v / kMeshSide == v % kMeshSide) {
      EXPECT_EQ(fixed[v][2], before[v][2]) << v;
    }
  }
  EXPECT_NE(fixed[3 * kMeshSide + 4][2], before[3 * kMeshSide + 4][2]);
}

TEST_F(SmoothMesh, DenoiseTakesStrengthsFromAFieldToo) {
  const std::string in = bumpy_grid("property float s\n", [](int i, int) { return i < 4 ? " 0" : " 1"; });
  put("in.ply", in);
  for (const char* flow : {"hc", "implicit"}) {
    const Ran ran = run({"denoise", "in.ply", "out.ply", "--force", "--flow", flow, "--strength-field", "s"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    const auto before = rows_of(in, kMeshSide * kMeshSide),
               after = rows_of(take("out.ply"), kMeshSide * kMeshSide);
    double moved = 0;
    for (std::size_t v = 0; v < before.size(); ++v) {
      if (v / kMeshSide < 4) {
        EXPECT_EQ(after[v], before[v]) << v;
      }
      moved = std::max(moved, std::abs(after[v][2] - before[v][2]));
    }
    EXPECT_GT(moved, 0.01) << flow;
  }
  EXPECT_EQ(run({"denoise", "in.ply", "new.ply", "--strength-field", "t"}).code, 2);
}

// The condition number grows with dt and with the fourth power of the eigenvalues.
TEST_F(SmoothMesh, ASolveThatDoesNotGetThereIsToldAndReported) {
  const auto report_of = [&](const char* command, std::vector<std::string> options) {
    options.insert(options.begin(), {command, "in.ply", "out.ply", "--force", "--flow", "implicit",
                                     "--iterations", "1", "--report", "-"});
    const Ran ran = run(options);
    EXPECT_EQ(ran.code, 0) << ran.err;
    const auto solver = nlohmann::json::parse(ran.out).at("solver");
    EXPECT_EQ(ran.err.find("warning: in.ply: the solver stopped") == std::string::npos,
              solver.at("converged").get<bool>())
        << ran.err;
    return solver;
  };
  put("in.ply", bumpy_grid(
                    "", [](int, int) { return ""; }, 24));
  for (const char* command : {"smooth-mesh", "denoise"}) {
    SCOPED_TRACE(command);
    const auto far = report_of(command, {"--order", "4", "--dt", "1e9", "--tolerance", "1e-6"});
    EXPECT_FALSE(far.at("converged").get<bool>());
    EXPECT_GT(far.at("residual").get<double>(), 1e-6);
    const auto near = report_of(command, {"--order", "2", "--tolerance", "1e-6"});
    EXPECT_TRUE(near.at("converged").get<bool>());
    EXPECT_LE(near.at("residual").get<double>(), 1e-6);
    EXPECT_GT(near.at("iterations").get<int>(), 1);
  }
  const auto rounded = report_of("smooth-mesh", {"--order", "1", "--dt", "1e6", "--tolerance", "1e-14"});
  EXPECT_TRUE(rounded.at("converged").get<bool>()) << "as near as doubles get";
}

TEST_F(SmoothMesh, AxisAndPlaneFieldsLetVerticesSlide) {
  const auto before = rows_of(bumpy_grid(""), kMeshSide * kMeshSide);
  const std::string in = bumpy_grid("property int a\nproperty int p\n", [](int i, int) {
    return std::string(i < 4 ? " 1" : " 0") + (i > 4 ? " 1" : " 0");
  });
  const auto after = smoothed(in, {"--flow", "laplacian", "--iterations", "3", "--axis-field", "a",
                                   "--plane-field", "p", "--slide-direction", "0,0,2"});
  for (std::size_t v = 0; v < before.size(); ++v) {
    if (v / kMeshSide < 4) {
      EXPECT_EQ(after[v][0], before[v][0]) << v;
      EXPECT_EQ(after[v][1], before[v][1]) << v;
    }
    if (v / kMeshSide > 4) {
      EXPECT_EQ(after[v][2], before[v][2]) << v;
    }
  }
}

TEST_F(SmoothMesh, WrongFieldsAreToldBeforeAnythingIsWritten) {
  put("in.ply", bumpy_grid("property float s\n", [](int, int) { return " 2"; }));
  const Ran range = run({"smooth-mesh", "in.ply", "out.ply", "--strength-field", "s"});
  EXPECT_EQ(range.code, 2);
  EXPECT_THAT(range.err, HasSubstr("found 2 at point 0"));
  const Ran name = run({"smooth-mesh", "in.ply", "out.ply", "--fixed-field", "t"});
  EXPECT_EQ(name.code, 2);
  EXPECT_THAT(name.err, HasSubstr("x, y, z, s"));
  const Ran normals = run({"smooth-mesh", "in.ply", "out.ply", "--axis-field", "s"});
  EXPECT_EQ(normals.code, 2);
  EXPECT_THAT(normals.err, HasSubstr("nx"));
  EXPECT_FALSE(there("out.ply"));
}

/// The volume between the grid and the plane z = 0 of the file.
double volume_under(const std::vector<std::vector<double>>& rows) {
  double volume = 0;
  const auto add = [&](int a, int b, int c) {
    const auto &p = rows[std::size_t(a)], &q = rows[std::size_t(b)], &r = rows[std::size_t(c)];
    volume +=
        std::abs((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])) * (p[2] + q[2] + r[2]) / 6;
  };
  for (int i = 0; i + 1 < kMeshSide; ++i)
    for (int j = 0; j + 1 < kMeshSide; ++j) {
      const int a = i * kMeshSide + j, b = a + 1, c = a + kMeshSide, d = c + 1;
      add(a, c, b);
      add(b, c, d);
    }
  return volume;
}

TEST_F(SmoothMesh, AHeightFieldStandsOnTheFilesOwnPlaneZero) {
  for (const double lift : {10.0, -4.0}) {
    std::string raised;
    std::istringstream lines(bumpy_grid(""));
    std::string line;
    for (int row = -1; std::getline(lines, line); row += row >= 0 || line == "end_header") {
      double x = 0, y = 0, z = 0;
      if (row >= 0 && row < kMeshSide * kMeshSide &&
          std::sscanf(line.c_str(), "%lf %lf %lf", &x, &y, &z) == 3)
        line = std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z + lift);
      raised += line + "\n";
    }
    const double before = volume_under(rows_of(raised, kMeshSide * kMeshSide));
    const auto after =
        smoothed(raised, {"--flow", "laplacian", "--iterations", "5", "--preserve", "height-field"});
    EXPECT_NEAR(volume_under(after) / before, 1, 1e-6) << lift;  // the rim shrinks, so the heights grow
  }
}

TEST_F(SmoothMesh, AnOptionWithoutItsPartnerIsAnErrorThatNamesThePartner) {
  put("in.ply", bumpy_grid("property float s\n", [](int, int) { return " 1"; }));
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"--slide-direction", "0,0,1"}, "--axis-field or --plane-field"},
      {{"--slide-direction", "0,0,1", "--fixed-field", "s"}, "--axis-field or --plane-field"},
      {{"--sharp-angle", "40"}, "--refine"},
      {{"--refine-pimple", "0.1"}, "--refine"},
      {{"--refine-chart", "mixed"}, "--refine"},
      {{"--ridge-curvature", "0.1"}, "--ridges"},
      {{"--flow", "laplacian", "--alpha", "0.5"}, "--anchor"},
      {{"--push-alpha", "0"}, "--push-back"},
      {{"--threshold-value", "0.1"}, "--threshold constant"},
  };
  for (const auto& [options, partner] : cases) {
    std::vector<std::string> all = {"smooth-mesh", "in.ply", "out.ply"};
    all.insert(all.end(), options.begin(), options.end());
    const Ran ran = run(all);
    EXPECT_EQ(ran.code, 2) << options[0];
    EXPECT_THAT(ran.err,
                ::testing::AllOf(HasSubstr(options[options[0] == "--flow" ? 2 : 0]), HasSubstr(partner)));
    EXPECT_FALSE(there("out.ply"));
  }
}

TEST_F(SmoothMesh, AFaceOfAMissingPointIsToldWithItsFile) {
  put("bad.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n");
  put("in.ply", bumpy_grid(""));
  for (const std::vector<std::string>& words : {std::vector<std::string>{"smooth-mesh", "bad.off", "out.off"},
                                                {"compare", "in.ply", "bad.off"},
                                                {"render", "bad.off", "-o", "out.png"}}) {
    const Ran ran = run(words);
    EXPECT_EQ(ran.code, 3) << words[0];
    EXPECT_THAT(ran.err, HasSubstr("bad.off: face 0: expected points below 3, found 3"));
  }
}

TEST_F(SmoothMesh, WhatNeedsASurfaceWithoutHolesIsRefusedForClouds) {
  put("in.ply", bumpy_grid(""));
  for (const std::vector<std::string>& rule : {std::vector<std::string>{"--boundary", "fixed"},
                                               {"--boundary", "curve"},
                                               {"--boundary", "virtual"},
                                               {"--preserve", "volume"}}) {
    const Ran ran = run({"denoise", "in.ply", "out.ply", rule[0], rule[1]});
    EXPECT_EQ(ran.code, 2) << rule[1];
    EXPECT_THAT(ran.err,
                ::testing::AllOf(HasSubstr(rule[0]), HasSubstr("umbrellas"), HasSubstr("smooth-mesh")));
    EXPECT_FALSE(there("out.ply"));
  }
}

/// What comes as text stays text.
TEST_F(SmoothMesh, RefineQuadruplesTheFacesThroughTheGivenVertices) {
  const auto before = rows_of(bumpy_grid(""), kMeshSide * kMeshSide);
  put("in.ply", bumpy_grid(""));
  const Ran ran = run({"smooth-mesh", "in.ply", "fine.ply", "--iterations", "0", "--refine", "1"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const nlohmann::json in = nlohmann::json::parse(run({"info", "--json", "fine.ply"}).out);
  EXPECT_EQ(in["points"], (2 * kMeshSide - 1) * (2 * kMeshSide - 1));
  const auto after = rows_of(take("fine.ply"), before.size());
  for (std::size_t v = 0; v < before.size(); ++v) EXPECT_EQ(after[v], before[v]) << v;
}

TEST_F(SmoothMesh, RefiningBeyondTheMemoryIsRefusedBeforeAnyWork) {
  put("in.ply", bumpy_grid(
                    "", [](int, int) { return ""; }, 40));
  const Ran ran = run({"smooth-mesh", "in.ply", "out.ply", "--refine", "10"});  // 1.6 billion vertices
  EXPECT_EQ(ran.code, 6) << ran.err;
  EXPECT_THAT(ran.err,
              ::testing::AllOf(HasSubstr("in.ply: needs about 15"), HasSubstr("nothing was started")));
  EXPECT_FALSE(there("out.ply"));
}

TEST_F(SmoothMesh, RidgesAreWrittenAsAField) {
  // The top of the bump is the only place where the larger curvature has a maximum both ways.
  const auto after = smoothed(bumpy_grid(""), {"--iterations", "0", "--ridges", "--ridge-curvature", "0.3"});
  ASSERT_EQ(after[0].size(), 4u);
  int marked = 0;
  for (const auto& row : after) marked += row[3] != 0;
  EXPECT_GT(marked, 0);
  EXPECT_EQ(after[0][3], 0);
  EXPECT_EQ(after[4 * kMeshSide + 4][3], 1);

  // The same with a third of the faces turned over.
  std::string mixed = bumpy_grid("");
  std::istringstream lines(mixed.substr(mixed.find("end_header\n") + 11));
  std::string text = mixed.substr(0, mixed.find("end_header\n") + 11), line;
  for (int row = 0; std::getline(lines, line); ++row) {
    std::istringstream words(line);
    std::string n, a, b, c;
    words >> n >> a >> b >> c;
    text +=
        row >= kMeshSide * kMeshSide && row % 3 == 0 ? n + " " + a + " " + c + " " + b + "\n" : line + "\n";
  }
  const auto again = smoothed(text, {"--iterations", "0", "--ridges", "--ridge-curvature", "0.3"});
  bool same = true, opposite = true;  // an open sheet has no outside
  for (std::size_t v = 0; v < after.size(); ++v) {
    same = same && again[v][3] == after[v][3];
    opposite = opposite && (again[v][3] != 0) == (after[v][3] != 0);
  }
  EXPECT_TRUE(same || opposite);
}

/// The vertices of an octahedron about (x, 0, 0), half as high as wide: a line each.
std::string octahedron_vertices(double x) {
  std::string text;
  for (const Eigen::Vector3d& v : support::octahedron().positions)
    text +=
        std::to_string(x + v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(0.5 * v.z()) + "\n";
  return text;
}

/// Its faces, outward or all inward. \param first the row of its first vertex
std::string octahedron_faces(Index first, bool inward) {
  std::string text;
  for (const Face& f : support::octahedron().faces)
    text += "3 " + std::to_string(first + f[0]) + " " + std::to_string(first + f[inward ? 2 : 1]) + " " +
            std::to_string(first + f[inward ? 1 : 2]) + "\n";
  return text;
}

TEST_F(SmoothMesh, RidgesOfAPartKeepTheSideOfTheFileWhateverStandsBesideIt) {
  const auto file = [](bool two) {
    return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(two ? 12 : 6) +
           "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
           std::to_string(two ? 16 : 8) + "\nproperty list uchar int vertex_indices\nend_header\n" +
           octahedron_vertices(0) + (two ? octahedron_vertices(10) : "") + octahedron_faces(0, true) +
           (two ? octahedron_faces(6, false) : "");
  };
  const auto alone = smoothed(file(false), {"--iterations", "0", "--ridges"}, 6),
             beside = smoothed(file(true), {"--iterations", "0", "--ridges"}, 12);
  int marked = 0;
  for (std::size_t v = 0; v < 6; ++v) {
    EXPECT_EQ(alone[v][3], beside[v][3]) << v;
    EXPECT_EQ(beside[v][3], -beside[6 + v][3]) << v;
    marked += alone[v][3] != 0;
  }
  EXPECT_GT(marked, 0);
}

TEST_F(SmoothMesh, WhatARefinedMeshGoesWithoutIsSaid) {
  std::string text = "ply\nformat ascii 1.0\ncomment by hand\ncomment of stone\nelement vertex 6\n";
  for (const char* property : {"int x", "int y", "int z", "float heat"})
    text += std::string("property ") + property + "\n";
  text +=
      "element face 8\nproperty list uchar int vertex_indices\nproperty uchar part\n"
      "element camera 1\nproperty float focus\nend_header\n";
  for (const char* row : {"10 0 0", "-10 0 0", "0 10 0", "0 -10 0", "0 0 10", "0 0 -10"})
    text += std::string(row) + " 5\n";
  for (const char* face : {"0 2 4", "2 1 4", "1 3 4", "3 0 4", "2 0 5", "1 2 5", "3 1 5", "0 3 5"})
    text += std::string("3 ") + face + " 1\n";
  put("in.ply", text + "50\n");
  const Ran ran = run({"smooth-mesh", "in.ply", "out.ply", "--iterations", "0", "--refine", "1"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("only x, y, z and triangles are written, not field 'heat', field 'part' of "
                                 "the faces, element 'camera', 2 comments\n"));
  EXPECT_THAT(ran.err, HasSubstr("the coordinates are whole numbers (int32): new ones are rounded"));
  put("plain.ply", bumpy_grid(""));
  EXPECT_THAT(run({"smooth-mesh", "plain.ply", "fine.ply", "--iterations", "0", "--refine", "1"}).err,
              ::testing::Not(HasSubstr("warning")));
}

TEST_F(SmoothMesh, RidgesOfAnOffFileGoIntoAPly) {
  put("in.off", "OFF\n6 8 0\n" + octahedron_vertices(0) + octahedron_faces(0, false));
  const Ran ran = run({"smooth-mesh", "in.off", "out.ply", "--iterations", "0", "--ridges"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(take("out.ply"), HasSubstr("ridge"));
  const Ran off = run({"smooth-mesh", "in.off", "out.off", "--iterations", "0", "--ridges"});
  EXPECT_EQ(off.code, 2);
  EXPECT_THAT(off.err, HasSubstr("out.off: OFF cannot hold the field of --ridges; use PLY"));
  EXPECT_FALSE(there("out.off"));
}

TEST_F(SmoothMesh, AFaceWithoutAreaMakesNoSharpEdges) {
  // Three vertices in a row of the grid's border.
  std::string mesh = bumpy_grid("");
  const std::string count = "element face 128", more = "element face 129";
  mesh.replace(mesh.find(count), count.size(), more);
  mesh += "3 0 2 1\n";
  put("with.ply", mesh);
  put("without.ply", bumpy_grid(""));
  for (const char* name : {"with", "without"}) {
    const Ran ran = run({"smooth-mesh", std::string(name) + ".ply", std::string(name) + "_out.ply",
                         "--iterations", "0", "--refine", "1", "--sharp-angle", "60"});
    ASSERT_EQ(ran.code, 0) << ran.err;
  }
  const auto with = rows_of(take("with_out.ply"), 81), without = rows_of(take("without_out.ply"), 81);
  for (std::size_t v = 27; v < 81; ++v)  // away from the face
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(with[v][c], without[v][c], 1e-5) << v;
}

TEST_F(SmoothMesh, FacesWithACornerThatIsNotFiniteAreSaid) {
  std::string mesh = bumpy_grid("");
  const std::size_t first = mesh.find("end_header\n") + 11;
  mesh.replace(first, mesh.find('\n', first) - first, "nan nan nan");
  put("in.ply", mesh);
  const Ran ran = run({"smooth-mesh", "in.ply", "out.ply"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("in.ply: left out of the work: 1 face with a corner that is not finite"));
  put("in.ply", bumpy_grid(""));
  EXPECT_EQ(run({"smooth-mesh", "in.ply", "out.ply", "--force"}).err.find("not finite"), std::string::npos);
}

}  // namespace
}  // namespace rfsmooth::test
