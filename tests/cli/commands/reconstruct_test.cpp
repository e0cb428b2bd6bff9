// rfsmooth reconstruct: the command hands the work to rfsmooth-reconstruct, which keeps every contract of the
// command.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pipeline/io/io.h"
#include "pipeline/io/mesh_file.h"
#include "pipeline/surface/topology.h"
#include "tests/cli/support/folder.h"

using ::testing::HasSubstr;

namespace rfsmooth::test {
namespace {

namespace io = pipeline::io;

/// Points of the unit sphere along a spiral, nearly even, each coloured by its octant.
io::Cloud coloured_sphere(std::size_t n) {
  std::vector<double> xyz;
  std::array<std::vector<double>, 3> colours;
  for (std::size_t i = 0; i < n; ++i) {
    const double z = 1 - (2 * double(i) + 1) / double(n), r = std::sqrt(1 - z * z),
                 turn = 2.399963 * double(i);
    for (const double c : {r * std::cos(turn), r * std::sin(turn), z}) {
      colours[xyz.size() % 3].push_back(c > 0 ? 200 : 50);
      xyz.push_back(c);
    }
  }
  io::Cloud cloud = io::make_cloud(xyz.data(), n, io::Scalar::float32);
  const char* const names[] = {"red", "green", "blue"};
  for (std::size_t k = 0; k < 3; ++k) io::set_field(cloud, names[k], io::Scalar::uint8, colours[k]);
  return cloud;
}

/// With the default method; the others have fixtures below. Skipped in builds that do not have what they use.
class Reconstruct : public InFolder {
 protected:
  explicit Reconstruct(std::vector<std::string> methods = {"poisson"}) : methods_(std::move(methods)) {}
  void SetUp() override {
    for (const std::string& method : methods_)
      if (std::string_view(RFSMOOTH_METHODS).find(method) == std::string_view::npos)
        GTEST_SKIP() << "built without " << method;
    put("in.ply", io::serialize_cloud(coloured_sphere(600), {}, {}).value());
  }

 private:
  std::vector<std::string> methods_;
};

class ReconstructByFront : public Reconstruct {
 protected:
  ReconstructByFront() : Reconstruct({"advancing-front"}) {}
};

class ReconstructByAll : public Reconstruct {
 protected:
  ReconstructByAll() : Reconstruct({"poisson", "ball-pivoting", "advancing-front"}) {}
};

class ReconstructMethods : public Reconstruct, public ::testing::WithParamInterface<const char*> {
 protected:
  ReconstructMethods() : Reconstruct({GetParam()}) {}
};

TEST_P(ReconstructMethods, ASurfaceWithTheColoursOfItsPoints) {
  const std::string method = GetParam();
  const Ran ran = run({"reconstruct", "--method", method, "in.ply", "out.ply"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out, "");
  const auto read = io::read_cloud(at("out.ply"), {}, {});
  ASSERT_TRUE(read.ok());
  const io::Cloud& cloud = read.value();
  const Topology found = pipeline::topology(cloud.size(), io::faces_of(read.value()));
  EXPECT_EQ(found.components, 1u);
  if (method != "ball-pivoting") {
    EXPECT_TRUE(found.closed_manifold());
    EXPECT_EQ(found.genus, 0);
    EXPECT_THAT(ran.err, HasSubstr("closed, genus 0"));
  }
  const std::vector<double> xyz = io::positions(cloud);
  const char* const names[] = {"red", "green", "blue"};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<double> colour = io::field_values(cloud, io::find_field(cloud, names[k]).value());
    ASSERT_GT(colour.size(), 100u);
    for (std::size_t i = 0; i < colour.size(); ++i)
      if (std::abs(xyz[3 * i + k]) > 0.2) {
        EXPECT_EQ(colour[i], xyz[3 * i + k] > 0 ? 200 : 50);
      }
  }
}

TEST_P(ReconstructMethods, SameBytesForAnyNumberOfThreads) {
  const std::string method = GetParam();
  ASSERT_EQ(run({"reconstruct", "--method", method, "in.ply", "a.ply", "--threads", "1"}).code, 0);
  ASSERT_EQ(run({"reconstruct", "--method", method, "in.ply", "b.ply", "--threads", "4"}).code, 0);
  EXPECT_TRUE(take("a.ply") == take("b.ply"));
}

INSTANTIATE_TEST_SUITE_P(All, ReconstructMethods,
                         ::testing::Values("poisson", "advancing-front", "ball-pivoting"),
                         [](const auto& test) {
                           std::string name = test.param;
                           name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
                           return name;
                         });

TEST_P(ReconstructMethods, FindNoSurfaceInALine) {
  std::string line;
  for (int i = 0; i < 400; ++i) line += fmt::format("{},{},{}\n", 0.1 * i, 0.2 * i, 5 - 0.3 * i);
  put("line.csv", line);
  const Ran ran = run({"reconstruct", "--method", GetParam(), "line.csv", "out.ply"});
  EXPECT_EQ(ran.code, 4) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("line.csv: all points are on one line"));
  EXPECT_FALSE(there("out.ply"));
}

TEST_F(Reconstruct, ATableWithCommasBecomesAPly) {
  std::string table = "\"x\",\"y\",\"z\",\"i\"\n";
  for (int i = 0; i < 900; ++i) table += fmt::format("{},{},0.{},\n", i % 30, i / 30, i * i % 7);
  put("in.csv", table);
  ASSERT_EQ(run({"reconstruct", "in.csv", "out.ply"}).code, 0);
  const nlohmann::json out = nlohmann::json::parse(run({"info", "--json", "out.ply"}).out);
  EXPECT_EQ(out["encoding"], "ascii");
  EXPECT_EQ(out["finite"], out["points"]);
}

TEST_F(ReconstructByFront, ReportIsTakenBackByConfig) {
  ASSERT_EQ(run({"reconstruct", "--method", "advancing-front", "in.ply", "a.ply", "--no-denoise", "--report",
                 "a.json"})
                .code,
            0);
  const auto report = nlohmann::json::parse(take("a.json"));
  EXPECT_EQ(report["command"], "reconstruct");
  EXPECT_EQ(report["options"]["denoise"], false);
  EXPECT_EQ(report["closed_manifold"], true);
  EXPECT_EQ(report["counts"]["vertices"], 600);
  ASSERT_EQ(run({"reconstruct", "--config", "a.json", "in.ply", "b.ply"}).code, 0);
  EXPECT_TRUE(take("a.ply") == take("b.ply"));
}

TEST_F(ReconstructByFront, TheSurfaceOfAScanFacesTheScanner) {
  std::vector<double> xyz;
  for (int i = 0; i < 900; ++i) xyz.insert(xyz.end(), {double(i % 30), double(i / 30), 0.001 * (i * i % 7)});
  io::Cloud scan = io::make_cloud(xyz.data(), 900, io::Scalar::float32);
  const auto up = [&](const char* input, const std::vector<std::string>& typed) {
    std::vector<std::string> words = {"reconstruct", "--method", "advancing-front", input,
                                      "out.ply",     "--force",  "--report",        "r.json"};
    words.insert(words.end(), typed.begin(), typed.end());
    const Ran ran = run(words);
    EXPECT_EQ(ran.code, 0) << ran.err;
    const io::Cloud made = io::read_cloud(at("out.ply"), {}, {}).value();
    const std::vector<double> p = io::positions(made);
    double area = 0;  // twice, seen from above
    for (const Face& f : io::faces_of(made))
      area += (p[3 * f[1]] - p[3 * f[0]]) * (p[3 * f[2] + 1] - p[3 * f[0] + 1]) -
              (p[3 * f[2]] - p[3 * f[0]]) * (p[3 * f[1] + 1] - p[3 * f[0] + 1]);
    EXPECT_GT(std::abs(area), 1000);
    return area > 0;
  };
  WriteOptions as_pcd;
  as_pcd.format = Format::pcd;
  for (const bool above : {true, false}) {
    scan.viewpoint = above ? "15 15 40 1 0 0 0" : "15 15 -40 1 0 0 0";
    put("scan.pcd", io::serialize_cloud(scan, as_pcd, {}).value());
    EXPECT_EQ(up("scan.pcd", {}), above) << "as the file tells";
    EXPECT_EQ(nlohmann::json::parse(take("r.json"))["normals"]["viewpoint"][2], above ? 40 : -40);
    EXPECT_EQ(up("scan.pcd", {above ? "--viewpoint=15,15,-40" : "--viewpoint=15,15,40"}), !above)
        << "what is typed wins";
  }
  EXPECT_EQ(
      run({"reconstruct", "--method", "advancing-front", "in.ply", "new.ply", "--viewpoint", "here"}).code,
      2);
}

TEST_F(ReconstructByAll, OptionsThatDoNothingAreRefused) {
  const auto refused = [&](std::vector<std::string> typed, const char* says) {
    typed.insert(typed.begin(), {"reconstruct", "in.ply", "out.ply"});
    const Ran ran = run(typed);
    EXPECT_EQ(ran.code, 2) << says;
    EXPECT_THAT(ran.err, HasSubstr(says));
  };
  refused({"--no-denoise", "--strength", "2"}, "--strength has no effect with --no-denoise");
  refused({"--no-denoise", "--noise", "0.1"}, "--noise has no effect with --no-denoise");
  refused({"--no-denoise", "--flow", "taubin"}, "--flow has no effect with --no-denoise");
  refused({"--no-denoise", "--outliers", "smooth"}, "--outliers has no effect with --no-denoise");
  refused({"--no-denoise", "--connect-neighbours", "20"}, "--connect-neighbours has no effect");
  for (const std::string method : {"ball-pivoting", "advancing-front"})
    refused({"--method", method, "--trim", "3x"}, ("--trim has no effect with --method " + method).c_str());
  for (const char* word : {"keep", "mark"})
    refused({"--outliers", word}, "it must be one of: remove, smooth");
  EXPECT_EQ(names(), std::vector<std::string>{"in.ply"});
}

TEST_F(ReconstructByAll, TheReportHasTheOptionsThatDidSomething) {
  const auto options = [&](std::vector<std::string> typed) {
    typed.insert(typed.begin(), {"reconstruct", "in.ply", "out.ply", "--force", "--report", "r.json"});
    const Ran ran = run(typed);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return nlohmann::json::parse(take("r.json"))["options"];
  };
  const auto all = options({"--method", "poisson"}), front = options({"--method", "advancing-front"}),
             bare = options({"--method", "poisson", "--no-denoise"});
  EXPECT_EQ(all["outliers"], "remove");
  EXPECT_TRUE(all.contains("trim") && all.contains("strength"));
  EXPECT_TRUE(!front.contains("trim") && front.contains("strength"));
  EXPECT_TRUE(bare.contains("trim") && bare["denoise"] == false);
  for (const char* name : {"strength", "flow", "outliers", "connect-neighbours"})
    EXPECT_FALSE(bare.contains(name)) << name;
}

TEST_F(ReconstructByAll, WhatIsTypedWinsOverAReportAlsoWhereItLeavesOptionsIdle) {
  ASSERT_EQ(run({"reconstruct", "--method", "poisson", "in.ply", "a.ply", "--report", "a.json"}).code, 0);
  const Ran ran = run({"reconstruct", "--config", "a.json", "--method", "advancing-front", "--no-denoise",
                       "in.ply", "b.ply"});
  EXPECT_EQ(ran.code, 0) << ran.err;
}

TEST_F(Reconstruct, NothingIsReplacedWithoutForce) {
  put("out.ply", "mine");
  EXPECT_EQ(run({"reconstruct", "in.ply", "out.ply"}).code, 5);
  EXPECT_EQ(take("out.ply"), "mine");
  EXPECT_EQ(run({"reconstruct", "in.ply", "out.ply", "--force"}).code, 0);
  EXPECT_NE(take("out.ply"), "mine");
}

TEST_F(Reconstruct, StandardOutputTakesTheSurface) {
  ASSERT_EQ(run({"reconstruct", "in.ply", "out.ply"}).code, 0);
  const Ran ran = run({"reconstruct", "in.ply", "-", "--format", "ply", "--quiet"});
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.err, "");
  EXPECT_TRUE(ran.out == take("out.ply"));
}

TEST_F(ReconstructByFront, PackedColoursAreUnpackedAndOtherFieldsStay) {
  std::vector<double> packed(600), label(600);
  for (std::size_t i = 0; i < 600; ++i) label[i] = double(i % 200);
  for (std::size_t i = 0; i < 600; ++i) packed[i] = double((7u << 16) | (8u << 8) | unsigned(i % 200));
  const std::vector<double> xyz = io::positions(coloured_sphere(600));
  io::Cloud pcd = io::make_cloud(xyz.data(), 600, io::Scalar::float32);
  io::set_field(pcd, "rgb", io::Scalar::uint32, packed);
  io::set_field(pcd, "label", io::Scalar::uint16, label);
  for (const char* normal : {"normal_x", "normal_y", "normal_z"})
    io::set_field(pcd, normal, io::Scalar::float32, std::vector<double>(600, 0.5));
  ASSERT_TRUE(io::write_cloud(pcd, at("in.pcd"), {}, {}).ok());
  ASSERT_EQ(run({"reconstruct", "--method", "advancing-front", "in.pcd", "out.ply"}).code, 0);
  const auto read = io::read_cloud(at("out.ply"), {}, {});
  ASSERT_TRUE(read.ok());
  const io::Cloud& made = read.value();
  const auto field = [&](const char* name) {
    return io::field_values(made, io::find_field(made, name).value());
  };
  const std::vector<double> red = field("red"), green = field("green"), blue = field("blue"),
                            labels = field("label");
  const std::vector<double> at_row = io::positions(made), nz = field("normal_z");
  ASSERT_EQ(made.size(), 600u) << "advancing front keeps the points";
  for (std::size_t v = 0; v < made.size(); ++v) {
    EXPECT_EQ(red[v], 7);
    EXPECT_EQ(green[v], 8);
    EXPECT_EQ(blue[v], labels[v]);
    EXPECT_NEAR(nz[v], at_row[3 * v + 2], 0.2) << "normals are the surface's";
  }
}

TEST_F(ReconstructByFront, PcdWithArraysPaddingAndWideFields) {
  const std::vector<double> xyz = io::positions(coloured_sphere(600));
  const auto pcd = [&](bool wide) {
    std::string out = "VERSION 0.7\nFIELDS x y z _ rgb pair";
    out += wide ? " stamp\nSIZE 4 4 4 1 4 4 8\nTYPE F F F U F F U\nCOUNT 1 1 1 4 1 2 1\n"
                : "\nSIZE 4 4 4 1 4 4\nTYPE F F F U F F\nCOUNT 1 1 1 4 1 2\n";
    out += "WIDTH 600\nHEIGHT 1\nPOINTS 600\nDATA binary\n";
    const auto add = [&](const auto& value) {
      out.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    for (std::uint32_t i = 0; i < 600; ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) add(float(xyz[3 * i + axis]));
      add(std::uint32_t{0xffffffff});
      add(std::uint32_t((7u << 16) | (8u << 8) | 9u));
      for (const float value : {float(i), 0.5f}) add(value);
      if (wide) add(std::uint64_t{1} << 60);
    }
    return out;
  };
  put("in.pcd", pcd(false));
  const std::vector<std::string> how = {"reconstruct", "--method", "advancing-front", "--no-denoise"};
  const auto made_of = [&](const char* in, const std::vector<std::string>& more) {
    std::vector<std::string> words = how;
    words.insert(words.end(), {in, "out.ply", "--force"});
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  };
  const Ran ran = made_of("in.pcd", {});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const io::Cloud made = value_or_throw(io::read_cloud(at("out.ply"), {}, {}));
  ASSERT_EQ(made.size(), 600u) << "advancing front keeps the points";
  EXPECT_FALSE(io::find_field(made, "_"));
  const std::vector<double> after = io::positions(made);
  const auto pairs = io::gather_lists(made.points(), io::find_field(made, "pair").value(), {});
  for (std::size_t v = 0; v < 600; ++v) {
    const auto row = std::size_t(pairs.values.at(2 * v));
    for (std::size_t axis = 0; axis < 3; ++axis)
      ASSERT_NEAR(after[3 * v + axis], xyz.at(3 * row + axis), 1e-6) << v;
    EXPECT_EQ(pairs.values.at(2 * v + 1), 0.5);
  }
  EXPECT_EQ(io::field_values(made, io::find_field(made, "green").value())[5], 8);
  EXPECT_FALSE(io::faces_of(made).empty());

  put("wide.pcd", pcd(true));
  const Ran refused = made_of("wide.pcd", {"--report", "-"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("out.ply: ply (binary_little_endian) cannot carry field 'stamp'; "
                                     "--drop-unsupported leaves that out"));
  EXPECT_FALSE(nlohmann::json::parse(refused.out).contains("counts")) << "before the work";
  const Ran dropped = made_of("wide.pcd", {"--drop-unsupported", "--report", "r.json"});
  ASSERT_EQ(dropped.code, 0) << dropped.err;
  EXPECT_THAT(dropped.err, HasSubstr("out.ply: left out, as ply cannot carry them: field 'stamp'"));
  EXPECT_EQ(nlohmann::json::parse(take("r.json"))["output"]["dropped"][0], "field 'stamp'");
  EXPECT_EQ(take("out.ply").find("int64"), std::string::npos);
}

TEST_F(Reconstruct, CoordinatesThatATableCallsOtherwiseAreXyzInAPly) {
  std::string table = "Easting,Northing,Height\n";
  for (int i = 0; i < 900; ++i) table += fmt::format("{},{},0.{}\n", i % 30, i / 30, i * i % 7);
  put("in.csv", table);
  const Ran ran = run({"reconstruct", "in.csv", "out.ply"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const io::Cloud made = value_or_throw(io::read_cloud(at("out.ply"), {}, {}));
  for (const char* name : {"x", "y", "z"}) EXPECT_TRUE(io::find_field(made, name)) << name;
}

TEST_F(Reconstruct, MistakesHaveTheirExitCodesAndLeaveNoFile) {
  put("three.xyz", "0 0 0\n1 0 0\n0 1 0\n");
  EXPECT_EQ(run({"reconstruct", "in.ply", "out.pcd"}).code, 2);
  EXPECT_EQ(run({"reconstruct", "in.ply", "out.ply", "--method", "magic"}).code, 2);
  EXPECT_EQ(run({"reconstruct", "in.ply", "out.ply", "--flow", "taubin", "--beta", "0.5"}).code, 2);
  EXPECT_EQ(run({"reconstruct", "in.ply"}).code, 2);
  EXPECT_EQ(run({"reconstruct", "none.ply", "out.ply"}).code, 3);
  EXPECT_EQ(run({"reconstruct", "three.xyz", "out.ply"}).code, 4);
  EXPECT_EQ(run({"reconstruct", "in.ply", "no/folder/out.ply"}).code, 5);
  EXPECT_EQ(names(), (std::vector<std::string>{"in.ply", "three.xyz"}));
}

TEST_F(Reconstruct, CtrlCLeavesNoFile) {
  put("large.ply", io::serialize_cloud(coloured_sphere(60000), {}, {}).value());
  RunSetup setup;
  setup.interrupt_after_ms = 400;
  const Ran ran = run({"reconstruct", "--method", "poisson", "large.ply", "out.ply"}, setup);
  EXPECT_EQ(ran.code, 130) << ran.err;  // also if it comes before there is a handler
  EXPECT_EQ(names(), (std::vector<std::string>{"in.ply", "large.ply"}));
}

TEST_F(Reconstruct, TheProgramStandsAloneToo) {
  RunSetup setup;
  setup.folder = at("");
  const Ran ran = run_program(RFSMOOTH_RECONSTRUCT, {"in.ply", "out.ply"}, setup);
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(there("out.ply"));
  EXPECT_EQ(run_program(RFSMOOTH_RECONSTRUCT, {"--version"}).out, rfsmooth({"--version"}).out);
}

TEST_F(InFolder, ReconstructWithoutItsProgramSaysWhatIsMissing) {
  std::filesystem::copy_file(RFSMOOTH_COMMAND, at("alone"));
  RunSetup setup;
  setup.environment = {"PATH=" + at("")};
  const Ran ran = run_program(at("alone"), {"reconstruct", "in.ply", "out.ply"}, setup);
  EXPECT_EQ(ran.code, 127);
  EXPECT_EQ(ran.out, "");
  EXPECT_THAT(ran.err, HasSubstr("rfsmooth-reconstruct is not installed"));
  EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1);
  EXPECT_EQ(run_program(at("alone"), {"reconstruct", "--methd", "x"}, setup).code, 2)
      << "options are still strict";
}

TEST_F(InFolder, TheReleasePresetSwitchesOffNothingThatReconstructNeeds) {
  RunSetup setup;
  setup.folder = RFSMOOTH_SOURCE;
  const Ran ran = run_program("cmake", {"-N", "--preset", "release", "-B", at("build")}, setup);
  EXPECT_THAT(ran.out, HasSubstr("RFSMOOTH_BUILD_TESTS=\"OFF\"")) << "the preset's variables are listed";
  for (const char* library : {"OPEN3D", "CGAL"})
    EXPECT_THAT(ran.out, ::testing::Not(HasSubstr(std::string("RFSMOOTH_WITH_") + library + "=\"OFF\"")));
}

TEST_F(InFolder, ConfiguringWithoutWhatReconstructNeedsSaysSo) {
  const Ran ran = run_program(
      "cmake", {"-S", RFSMOOTH_SOURCE, "-B", at("build"), "-G", "Ninja", "-DRFSMOOTH_BUILD_TESTS=OFF",
                "-DRFSMOOTH_WITH_PCL=OFF", "-DRFSMOOTH_WITH_CGAL=OFF", "-DRFSMOOTH_WITH_OPEN3D=OFF"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(ran.out, ::testing::AllOf(HasSubstr("rfsmooth reconstruct: will exit with 127"),
                                        HasSubstr("libopen3d-dev"), HasSubstr("libcgal-dev")));
}

}  // namespace
}  // namespace rfsmooth::test
