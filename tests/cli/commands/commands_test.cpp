/// info, mesh, smooth-mesh and compare.
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/support/folder.h"
#include "tests/cli/support/small_clouds.h"

using ::testing::HasSubstr;

namespace rfsmooth::test {
namespace {

using nlohmann::json;

class Commands : public InFolder {
 protected:
  json info(const std::string& name) const { return json::parse(run({"info", "--json", name}).out); }
};

TEST_F(Commands, InfoSaysWhatAFileHolds) {
  BinaryPly cloud = noisy_plane(10);
  cloud.xyz[0] = NAN;
  put("in.ply", cloud.bytes());
  const json in = info("in.ply");
  EXPECT_EQ(in["format"], "ply");
  EXPECT_EQ(in["points"], 100);
  EXPECT_EQ(in["finite"], 99);
  EXPECT_EQ(in["organised"], false);
  ASSERT_EQ(in["fields"].size(), 5u);
  EXPECT_EQ(in["fields"][3]["name"], "intensity");
  EXPECT_EQ(in["fields"][4]["type"], "uint32");
  EXPECT_NEAR(in["spacing"].get<double>(), 0.75, 0.3);
  const Ran text = run({"info", "in.ply"});
  EXPECT_EQ(text.err, "");
  EXPECT_THAT(text.out,
              ::testing::AllOf(HasSubstr("100 (99 finite"), HasSubstr("label:uint32"), HasSubstr("spacing")));
}

TEST_F(Commands, InfoOfPointsThatCannotBeMeasured) {
  put("in.ply",
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
      "z\nend_header\nnan 0 0\n");
  const json in = info("in.ply");
  EXPECT_EQ(in["finite"], 0);
  EXPECT_TRUE(in["spacing"].is_null());
}

TEST_F(Commands, MeshWritesEdgesForTheGraphsAndFacesForTheMesh) {
  put("in.ply", noisy_plane(20).bytes());
  for (const char* stage : {"emst", "sdg", "rfs"})
    ASSERT_EQ(run({"mesh", "in.ply", std::string(stage) + ".ply", "--stage", stage}).code, 0);
  const auto count = [&](const std::string& file, const std::string& element) {
    const json in = info(file);
    for (const auto& e : in.value("elements", json::array()))
      if (e["name"] == element) return e["count"].get<int>();
    return 0;
  };
  EXPECT_EQ(info("emst.ply")["points"], 400);
  EXPECT_EQ(count("emst.ply", "edge"), 399);
  EXPECT_GT(count("sdg.ply", "edge"), 399);
  EXPECT_EQ(count("emst.ply", "face"), 0);
  EXPECT_GT(count("rfs.ply", "face"), 400);
}

/// The edges of an ascii PLY with `points` vertices, and their kind if they have one.
std::map<std::pair<int, int>, int> edges_in(const std::string& ply, int points) {
  std::istringstream in(ply.substr(ply.find("end_header\n") + 11));
  std::string line;
  for (int i = 0; i < points; ++i) std::getline(in, line);
  std::map<std::pair<int, int>, int> edges;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    int a = 0, b = 0, kind = -1;
    words >> a >> b >> kind;
    edges[std::minmax(a, b)] = kind;
  }
  return edges;
}

/// Noise of a spacing, where connectivity is tested on the points' shadows, and a stray on a bridge.
TEST_F(Commands, TheGraphHoldsTheTreeItStandsOnAndSaysWhichEdgeIsWhich) {
  BinaryPly cloud = noisy_plane(20);
  std::mt19937_64 engine(4);
  std::normal_distribution<float> noise(0, 0.8f);
  for (std::size_t i = 2; i < cloud.xyz.size(); i += 3) cloud.xyz[i] += noise(engine);
  cloud.xyz.insert(cloud.xyz.end(), {60, 10, 0});
  put("in.ply", cloud.bytes());
  for (const char* stage : {"emst", "sdg"})
    ASSERT_EQ(
        run({"mesh", "in.ply", std::string(stage) + ".ply", "--stage", stage, "--encoding", "ascii"}).code,
        0);
  const auto tree = edges_in(take("emst.ply"), 401), graph = edges_in(take("sdg.ply"), 401);
  ASSERT_EQ(tree.size(), 400u);
  int of_kind[3] = {0, 0, 0};
  for (const auto& [edge, kind] : graph) {
    ASSERT_GE(kind, 0);
    ASSERT_LE(kind, 2);
    ++of_kind[kind];
    EXPECT_EQ(tree.count(edge) > 0, kind != 1) << edge.first << " " << edge.second;
  }
  EXPECT_EQ(of_kind[0] + of_kind[2], 400) << "all of the tree, so the graph is in one piece";
  EXPECT_GT(of_kind[1], 50);
  EXPECT_GT(of_kind[2], 0);
}

TEST_F(Commands, MeshRunsOnlyTheStagesThatItWrites) {
  put("in.ply", noisy_plane(20).bytes());
  const auto seconds = [&](const char* stage) {
    EXPECT_EQ(run({"mesh", "in.ply", "out.ply", "--force", "--stage", stage, "--report", "r.json"}).code, 0);
    return json::parse(take("r.json"))["seconds"];
  };
  const json alone = seconds("emst-points"), tree = seconds("emst"), graph = seconds("sdg"),
             mesh = seconds("rfs");
  EXPECT_TRUE(alone.contains("emst"));
  for (const char* later : {"noise", "local surfaces", "shadow", "sdg", "umbrellas", "rfs-mesh"})
    EXPECT_FALSE(alone.contains(later)) << later;
  for (const char* later : {"sdg", "umbrellas", "rfs-mesh"}) EXPECT_FALSE(tree.contains(later)) << later;
  EXPECT_TRUE(graph.contains("sdg"));
  for (const char* later : {"umbrellas", "rfs-mesh"}) EXPECT_FALSE(graph.contains(later)) << later;
  EXPECT_TRUE(mesh.contains("rfs-mesh"));
}

TEST_F(Commands, HelpOfMeshSaysWhatShowsItsEdges) {
  for (const char* help : {"--help", "--help-all"}) {
    const std::string text = run({"mesh", help}).out;
    for (const char* program : {"MeshLab", "Open3D", "CloudCompare"}) EXPECT_THAT(text, HasSubstr(program));
  }
}

/// A plane of points half a metre apart, far from the origin: in float32 with steps of half a metre.
std::string far_plane(const char* type) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex 400\n";
  for (const char* axis : {"x", "y", "z"}) text += std::string("property ") + type + " " + axis + "\n";
  text += "end_header\n";
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j)
      text += std::to_string(5400000 + i / 2) + (i % 2 ? ".5 " : " ") + std::to_string(j) + " 0\n";
  return text;
}

TEST_F(Commands, CoordinatesThatFloatsCannotHoldAreWarnedOf) {
  put("float.ply", far_plane("float"));
  put("double.ply", far_plane("double"));
  put("near.ply", noisy_plane(20).bytes());
  for (const auto& typed : std::vector<std::vector<std::string>>{
           {"denoise", "IN", "out.ply", "--force"}, {"mesh", "IN", "mesh.ply", "--force"}, {"info", "IN"}}) {
    const auto said = [&](const char* name) {
      std::vector<std::string> words = typed;
      words[1] = name;
      const Ran ran = run(words);
      EXPECT_EQ(ran.code, 0) << ran.err;
      return ran.err;
    };
    EXPECT_THAT(said("float.ply"),
                ::testing::AllOf(HasSubstr("warning: float.ply"), HasSubstr("steps of 0.5 in float32")));
    EXPECT_THAT(said("double.ply"), ::testing::Not(HasSubstr("float32")));
    EXPECT_THAT(said("near.ply"), ::testing::Not(HasSubstr("float32")));
  }
}

TEST_F(Commands, SmoothMeshMovesVerticesAndKeepsFaces) {
  put("in.ply", noisy_plane(20).bytes());
  ASSERT_EQ(run({"mesh", "in.ply", "rough.ply"}).code, 0);
  const Ran ran = run({"smooth-mesh", "--flow", "laplacian", "--iterations", "5", "rough.ply", "smooth.ply"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const std::string before = take("rough.ply"), after = take("smooth.ply");
  ASSERT_EQ(after.size(), before.size());
  const std::size_t faces = before.find("end_header\n") + 11 + 400 * 24;
  EXPECT_TRUE(after.substr(faces) == before.substr(faces));
  EXPECT_FALSE(after == before);
}

TEST_F(Commands, SmoothMeshNeedsFaces) {
  put("in.ply", noisy_plane(5).bytes());
  const Ran ran = run({"smooth-mesh", "in.ply", "out.ply"});
  EXPECT_EQ(ran.code, 3);
  EXPECT_THAT(ran.err, HasSubstr("no faces"));
}

TEST_F(Commands, CompareAgainstItselfIsZero) {
  put("in.ply", noisy_plane(20).bytes());
  ASSERT_EQ(run({"mesh", "in.ply", "mesh.ply"}).code, 0);
  const json cloud = json::parse(run({"compare", "--json", "in.ply", "in.ply"}).out);
  EXPECT_EQ(cloud["own_units"]["chamfer"], 0);
  EXPECT_EQ(cloud["points"], 400);
  const json mesh = json::parse(run({"compare", "--json", "in.ply", "mesh.ply"}).out);
  EXPECT_GT(mesh["truth_faces"], 0);
  EXPECT_TRUE(mesh["own_units"].contains("p2s_root"));
  EXPECT_TRUE(mesh["unit_sphere"].contains("p2s_root"));
  EXPECT_THAT(run({"compare", "in.ply", "mesh.ply"}).out, HasSubstr("p2s_root"));
}

TEST_F(Commands, CloudsOfOnePlaceHaveNoFiguresThatAreNoNumbers) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nend_header\n";
  put("equal.ply", header + "5 6 7\n5 6 7\n5 6 7\n");
  put("one.xyz", "5 6 7\n");
  put("two.xyz", "5 6 7\n5 6 8\n");
  for (const char* name : {"equal.ply", "one.xyz"}) {
    const Ran ran = run({"denoise", name, std::string("out-") + name});
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_THAT(ran.err, ::testing::Not(HasSubstr("float32"))) << "nothing was lost";
    EXPECT_EQ(take(std::string("out-") + name), take(name));
    for (const char* other : {"equal.ply", "one.xyz", "two.xyz"}) {
      const Ran text = run({"compare", other, name});
      EXPECT_EQ(text.code, 0) << text.err;
      for (const char* word : {"nan", "inf"}) EXPECT_THAT(text.out, ::testing::Not(HasSubstr(word))) << other;
      const json figures = json::parse(run({"compare", "--json", other, name}).out);
      EXPECT_TRUE(figures["own_units"].contains("chamfer"));
      EXPECT_FALSE(figures["unit_sphere"].contains("chamfer")) << "a place has no unit sphere";
    }
  }
}

TEST_F(Commands, ErrorsNameTheFile) {
  put("in.ply", noisy_plane(20).bytes());
  put("nan.xyz", "nan nan nan\n1 nan 2\n");
  const std::pair<std::vector<std::string>, std::string> mistakes[] = {
      {{"denoise", "in.ply", "out.off"}, "out.off: off (ascii) cannot carry field 'intensity'"},
      {{"denoise", "in.ply", "out.ply", "--encoding", "binary_compressed"}, "out.ply: ply has no encoding"},
      {{"mesh", "in.ply", "out.xyz"}, "out.xyz: xyz (ascii) cannot carry element 'face'"},
      {{"denoise", "in.ply", "out.ply", "--strength-field", "nope"},
       "in.ply: the points have no field 'nope'"},
      {{"denoise", "in.ply", "out.ply", "--strength-field", "label"}, "in.ply: --strength-field label: "},
      {{"compare", "in.ply", "nan.xyz"}, "in.ply against nan.xyz: the truth has no finite point"}};
  for (const auto& [words, says] : mistakes)
    EXPECT_THAT(run(words).err, ::testing::StartsWith("rfsmooth: error: " + says));
}

TEST_F(Commands, ErrorsNameAFileWhoseNameIsPartOfWhatTheySay) {
  for (const char* name : {"a", "field"}) {
    put(name, "0 0 0\n1 0 0\n0 1 0\n");
    EXPECT_THAT(
        run({"denoise", name, "out.xyz", "--strength-field", "nope"}).err,
        ::testing::StartsWith(std::string("rfsmooth: error: ") + name + ": the points have no field"));
  }
  RunSetup setup;
  setup.input = "0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_THAT(run({"smooth-mesh", "-", "out.ply"}, setup).err,
              ::testing::StartsWith("rfsmooth: error: standard input: has no faces"));
}

TEST_F(Commands, OptionsThatDoNothingBesideTheOthersAreRefused) {
  put("in.ply", noisy_plane(20).bytes());
  const std::pair<std::vector<std::string>, std::string> cases[] = {
      {{"render", "in.ply", "-o", "a.png", "--field", "intensity"},
       "--field has no effect without --color field"},
      {{"render", "in.ply", "-o", "a.png", "--low", "1"}, "--low has no effect with --color plain"},
      {{"render", "in.ply", "-o", "a.png", "--color", "rgb", "--high", "1"},
       "--high has no effect with --color rgb"},
      {{"compare", "in.ply", "in.ply", "--red-from", "1"}, "--red-from has no effect without -o"}};
  for (const auto& [words, says] : cases) {
    const Ran ran = run(words);
    EXPECT_EQ(ran.code, 2) << says;
    EXPECT_THAT(ran.err, HasSubstr(says));
  }
  EXPECT_THAT(names(), ::testing::ElementsAre("in.ply"));
}

TEST_F(Commands, StandardInputIsTakenOnce) {
  RunSetup setup;
  setup.input = noisy_plane(20).bytes();
  for (const std::vector<std::string>& words : {std::vector<std::string>{"compare", "-", "-"},
                                                {"info", "-", "-"},
                                                {"report", "-", "-", "-o", "a.html"}}) {
    const Ran ran = run(words, setup);
    EXPECT_EQ(ran.code, 2) << words[0];
    EXPECT_THAT(ran.err, HasSubstr("standard input (-) is given twice"));
  }
}

TEST_F(Commands, InfoTakesThreads) {
  put("in.ply", noisy_plane(20).bytes());
  EXPECT_EQ(run({"info", "--threads", "1", "in.ply"}).out, run({"info", "in.ply"}).out);
  EXPECT_EQ(run({"info", "--threads", "0", "in.ply"}).code, 2);
}

TEST_F(Commands, CompareNeedsTwoFiles) {
  EXPECT_EQ(run({"compare", "a.ply"}).code, 2);
  EXPECT_EQ(run({"compare", "a.ply", "b.ply"}).code, 3);
}

TEST_F(Commands, FilesInAFolderAreCalledAfterTheFormatThatTheyAreWrittenIn) {
  const std::string rows = "0 0 0\n1 0 0\n0 1 0\n1 1 0.1\n2 0 0\n2 1 0.1\n";
  for (const char* name : {"a.xyz", "scan.v2", "plain", "kept.ply.txt"}) put(name, rows);
  ASSERT_EQ(
      run({"denoise", "--format", "ply", "a.xyz", "scan.v2", "plain", "kept.ply.txt", "-o", "made/"}).code,
      0);
  for (const char* name : {"made/a.ply", "made/scan.v2.ply", "made/plain.ply", "made/kept.ply.ply"})
    EXPECT_EQ(info(name)["format"], "ply") << name;
  ASSERT_EQ(run({"denoise", "--format", "xyz", "kept.ply.txt", "scan.v2", "-o", "texts/"}).code, 0);
  EXPECT_TRUE(there("texts/kept.ply.txt")) << "an extension of that format stays";
  EXPECT_TRUE(there("texts/scan.v2.xyz"));
  ASSERT_EQ(run({"denoise", "a.xyz", "plain", "-o", "same/"}).code, 0);
  EXPECT_TRUE(there("same/a.xyz") && there("same/plain")) << "without --format as the inputs";
}

TEST_F(Commands, MeshesInAFolderArePlyEncodedAsTheInput) {
  put("a.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0.1\n2 0 0\n2 1 0.1\n");
  put("b.ply", noisy_plane(5).bytes());
  ASSERT_EQ(run({"mesh", "a.xyz", "b.ply", "-o", "meshes"}).code, 0);
  EXPECT_EQ(info("meshes/a.ply")["encoding"], "ascii");
  EXPECT_EQ(info("meshes/b.ply")["encoding"], "binary_little_endian");
  ASSERT_EQ(run({"mesh", "a.xyz", "--encoding", "binary", "-o", "meshes", "--force"}).code, 0);
  EXPECT_EQ(info("meshes/a.ply")["encoding"], "binary_little_endian");
}

TEST_F(Commands, TwoFilesThatWouldGetOneNameAreRefusedBeforeAnythingIsWritten) {
  put("a.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0.1\n");
  put("a.ply", noisy_plane(5).bytes());
  const Ran ran = run({"denoise", "--format", "pcd", "a.xyz", "a.ply", "-o", "made/"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err, HasSubstr("a.xyz and a.ply would both be written to made/a.pcd"));
  EXPECT_FALSE(there("made"));
}

}  // namespace
}  // namespace rfsmooth::test
