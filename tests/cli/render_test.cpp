/// rfsmooth render: pictures by the program that the command finds.
#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/support/folder.h"
#include "tests/cli/support/small_clouds.h"

using ::testing::HasSubstr;

namespace rfsmooth::test {
namespace {

class Render : public InFolder {
 protected:
  void SetUp() override { put("in.ply", noisy_plane(10).bytes()); }
  /// Width and height that the PNG's header says.
  std::pair<unsigned, unsigned> size(const std::string& name) const {
    const std::string png = take(name);
    EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
    const auto number = [&](std::size_t at) {
      unsigned value = 0;
      for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<unsigned char>(png.at(at + k));
      return value;
    };
    return {number(16), number(20)};
  }
};

TEST_F(Render, ColouringByAFieldNeedsItsName) {
  const Ran ran = run({"render", "in.ply", "-o", "one.png", "--color", "field"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err, HasSubstr("--color field needs the name of a field: --field NAME"));
}

/// A grid of 6 x 6 points as a PCD with one more field, the same for every point.
std::string pcd_with(int count, const std::string& values) {
  std::string rows;
  for (int i = 0; i < 36; ++i) rows += fmt::format("{} {} 0 {}\n", i % 6, i / 6, values);
  return fmt::format(
      "VERSION .7\nFIELDS x y z more\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 {}\nWIDTH 36\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 36\nDATA ascii\n{}",
      count, rows);
}

TEST_F(Render, AFieldOfSeveralValuesColoursNothing) {
  put("three.pcd", pcd_with(3, "1 2 3"));
  const Ran ran = run({"render", "three.pcd", "-o", "one.png", "--color", "field", "--field", "more"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err, HasSubstr("--color field takes one value for each point; 'more' has several"));
  EXPECT_FALSE(there("one.png"));
}

TEST_F(Render, ValuesThatAreNotFiniteHaveAColourOfTheirOwn) {
  std::set<std::string> pictures;
  for (const char* value : {"nan", "0", "0.5", "1"}) {
    put("field.pcd", pcd_with(1, value));
    const Ran ran = run({"render", "field.pcd", "-o", "out.png", "--force", "--color", "field", "--field",
                         "more", "--low", "0", "--high", "1", "--width", "100", "--height", "80"});
    ASSERT_EQ(ran.code, 0) << value << ran.err;
    pictures.insert(take("out.png"));
  }
  EXPECT_EQ(pictures.size(), 4u);
}

TEST_F(Render, DrawsCloudsSideBySide) {
  ASSERT_EQ(run({"render", "in.ply", "-o", "one.png", "--width", "100", "--height", "80"}).code, 0);
  EXPECT_EQ(size("one.png"), std::pair(100u, 80u));
  const Ran ran = run({"render", "in.ply", "in.ply", "-o", "two.png", "--width", "100", "--height", "80",
                       "--labels", "before,after", "--direction", "0,0.5,-1"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out, "");
  EXPECT_GT(size("two.png").first, 200u) << "both and a gap";
  EXPECT_GT(size("two.png").second, 80u) << "and the labels";
}

TEST_F(Render, DrawsTheEdgesOfAGraph) {
  ASSERT_EQ(run({"mesh", "--stage", "emst", "in.ply", "tree.ply"}).code, 0);
  ASSERT_EQ(run({"render", "in.ply", "-o", "points.png"}).code, 0);
  ASSERT_EQ(run({"render", "tree.ply", "-o", "tree.png"}).code, 0);
  EXPECT_EQ(size("tree.png"), size("points.png"));
  EXPECT_FALSE(take("tree.png") == take("points.png"));
}

TEST_F(Render, LeavesOutOutliersIfAsked) {
  BinaryPly cloud = noisy_plane(30);
  put("clean.ply", cloud.bytes());
  cloud.xyz.insert(cloud.xyz.end(), {15, 15, 200});
  put("stray.ply", cloud.bytes());
  const auto picture = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"-o", "out.png", "--force", "--width", "100", "--height", "80"});
    EXPECT_EQ(run(arguments).code, 0);
    return take("out.png");
  };
  const std::string clean = picture({"render", "clean.ply", "--direction", "0,1,-0.5"});
  EXPECT_FALSE(picture({"render", "stray.ply", "--direction", "0,1,-0.5"}) == clean);
  EXPECT_TRUE(picture({"render", "stray.ply", "--direction", "0,1,-0.5", "--without-outliers"}) == clean);
}

TEST_F(Render, WritesNoFormatButPngAndNothingToStandardOutput) {
  for (const char* name : {"out.jpg", "out.tiff", "-"}) {
    const Ran ran = run({"render", "in.ply", "-o", name});
    EXPECT_EQ(ran.code, 2) << name;
    EXPECT_THAT(ran.err, HasSubstr(*name == '-' ? "does not take the picture" : "out."));
    EXPECT_EQ(ran.out, "");
  }
  EXPECT_THAT(run({"render", "in.ply", "-o", "out.jpg"}).err, HasSubstr("the picture is a PNG"));
  EXPECT_EQ(names(), std::vector<std::string>{"in.ply"});
}

TEST_F(Render, KeepsTheContractsOfTheCommand) {
  put("out.png", "mine");
  EXPECT_EQ(run({"render", "in.ply", "-o", "out.png"}).code, 5);
  EXPECT_EQ(take("out.png"), "mine");
  EXPECT_EQ(run({"render", "in.ply", "-o", "out.png", "--force"}).code, 0);
  EXPECT_EQ(run({"render", "in.ply", "-o", "one.png", "--threads", "1"}).code, 0);
  EXPECT_TRUE(take("one.png") == take("out.png"));
  EXPECT_EQ(run({"render", "in.ply", "-o", "new.png", "--widht", "3"}).code, 2);
  EXPECT_EQ(run({"render", "in.ply", "-o", "new.png", "--direction", "1,2"}).code, 2);
  EXPECT_EQ(run({"render", "in.ply", "-o", "new.png", "--direction", "0,0,0"}).code, 2);
  EXPECT_EQ(run({"render", "in.ply", "-o", "new.png", "--labels", "a,b"}).code, 2);
  EXPECT_EQ(run({"render", "none.ply", "-o", "new.png"}).code, 3);
  EXPECT_EQ(run({"render", "in.ply", "-o", "no/folder/new.png"}).code, 5);
  EXPECT_FALSE(there("new.png"));
}

TEST_F(Render, WithoutItsProgramSaysWhatIsMissing) {
  std::filesystem::copy_file(RFSMOOTH_COMMAND, at("alone"));
  RunSetup setup;
  setup.folder = at("");
  setup.environment = {"PATH=" + at("")};
  const Ran ran = run_program(at("alone"), {"render", "in.ply", "-o", "out.png"}, setup);
  EXPECT_EQ(ran.code, 127);
  EXPECT_THAT(ran.err, HasSubstr("rfsmooth-render is not installed"));
}

TEST_F(Render, IsInstalledBesideTheCommand) {
  ASSERT_EQ(
      run_program("cmake", {"--install", RFSMOOTH_BINARY, "--prefix", at("usr"), "--component", "command"})
          .code,
      0);
  RunSetup setup;
  setup.folder = at("");
  EXPECT_EQ(run_program(at("usr/bin/rfsmooth"), {"render", "in.ply", "-o", "out.png"}, setup).code, 0);
  EXPECT_TRUE(there("usr/share/man/man1/rfsmooth-render.1.gz"));
}

}  // namespace
}  // namespace rfsmooth::test
