/// What --force replaces and what it does not: nobody's scan is lost to a pattern that names it as OUT.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include "tests/cli/support/folder.h"
#include "tests/cli/support/small_clouds.h"

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace rfsmooth::test {
namespace {

class Replacing : public InFolder {
 protected:
  void SetUp() override {
    put("a.ply", noisy_plane(10).bytes());
    put("b.ply", raw_);
  }
  /// Whether this file system keeps what a file was marked with.
  bool keeps_marks() const { return setxattr(at("a.ply").c_str(), "user.rfsmooth-test", "1", 1, 0) == 0; }
  const std::string raw_ = noisy_plane(12).bytes();
};

class ReplacingBy : public Replacing, public ::testing::WithParamInterface<const char*> {};

TEST_P(ReplacingBy, APatternOfTwoScansKeepsTheSecond) {
  const std::string command = GetParam();
  const Ran ran = run({command, "--force", "a.ply", "b.ply"});  // what the shell makes of *.ply
  EXPECT_EQ(ran.code, 5);
  EXPECT_THAT(ran.err, AllOf(HasSubstr("b.ply: is a cloud"), HasSubstr("--force a.ply -o b.ply"),
                             HasSubstr("a.ply b.ply -o FOLDER")));
  EXPECT_TRUE(take("b.ply") == raw_);
  EXPECT_EQ(run({command, "a.ply", "b.ply"}).code, 5);
  EXPECT_TRUE(take("b.ply") == raw_);
}

INSTANTIATE_TEST_SUITE_P(Commands, ReplacingBy, ::testing::Values("denoise", "mesh"));

TEST_F(Replacing, AScanOfAnyFormatIsKept) {
  put("b.xyz", "0 0 0\n1 0 0\n0 1 0\n");
  put("broken.pcd", "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\n");
  for (const std::string name : {"b.xyz", "broken.pcd"}) {
    const std::string before = take(name);
    EXPECT_EQ(run({"denoise", "--force", "a.ply", name}).code, 5) << name;
    EXPECT_EQ(take(name), before);
  }
}

/// Root reads everything: there the command is run as somebody else.
TEST_F(Replacing, WhatCannotBeReadMayBeAScanAndIsKept) {
  ASSERT_EQ(chmod(at("").c_str(), 0777), 0);
  ASSERT_EQ(chmod(at("b.ply").c_str(), 0), 0);
  RunSetup setup;
  setup.folder = at("");
  const auto as_user = [&](std::vector<std::string> words) {
    words.insert(words.begin(), RFSMOOTH_COMMAND);
    if (geteuid() == 0) words.insert(words.begin(), {"setpriv", "--reuid=65534", "--clear-groups"});
    return run_program(words[0], {words.begin() + 1, words.end()}, setup);
  };
  if (as_user({"info", "a.ply"}).code != 0) GTEST_SKIP() << "nobody else may run the command here";
  if (as_user({"info", "b.ply"}).code == 0) GTEST_SKIP() << "everybody reads everything here";
  for (const auto& words :
       std::vector<std::vector<std::string>>{{"denoise", "--force", "a.ply", "b.ply"},
                                             {"report", "--force", "a.ply", "a.ply", "-o", "b.ply"}}) {
    const Ran ran = as_user(words);
    EXPECT_EQ(ran.code, 5) << words[0];
    EXPECT_THAT(ran.err, HasSubstr("b.ply: cannot be read and may be a cloud"));
  }
  chmod(at("b.ply").c_str(), 0644);
  EXPECT_TRUE(take("b.ply") == raw_);
}

TEST_F(Replacing, WhatIsNamedWithOIsMeant) {
  const Ran ran = run({"denoise", "--flow", "hc", "--force", "a.ply", "-o", "b.ply"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_FALSE(take("b.ply") == raw_);
}

TEST_F(Replacing, WhatTheCommandWroteMayBeWrittenAgain) {
  if (!keeps_marks()) GTEST_SKIP() << "no extended attributes here";
  ASSERT_EQ(run({"denoise", "--flow", "hc", "a.ply", "out.ply"}).code, 0);
  const Ran again = run({"denoise", "--flow", "hc", "--iterations", "3", "--force", "a.ply", "out.ply"});
  EXPECT_EQ(again.code, 0) << again.err;
}

TEST_F(Replacing, TheMarkEndsWhenAnotherProgramChangesTheFile) {
  ASSERT_EQ(run({"denoise", "--flow", "hc", "a.ply", "out.ply"}).code, 0);
  put("out.ply", raw_);  // written into the same file, attributes and all
  EXPECT_EQ(run({"denoise", "--force", "a.ply", "out.ply"}).code, 5);
  EXPECT_TRUE(take("out.ply") == raw_);
}

TEST_F(Replacing, TheMarkIsInNoByteOfTheFile) {
  put("same.xyz", "0 0 0\n1 0 0\n0 1 0\n");
  ASSERT_EQ(run({"denoise", "same.xyz", "out.xyz"}).code, 0);
  EXPECT_EQ(take("out.xyz"), take("same.xyz"));
}

TEST_F(Replacing, NeitherReportNorPictureTakesTheNameOfAScan) {
  const Ran report = run({"denoise", "--force", "a.ply", "out.ply", "--report", "b.ply"});
  EXPECT_EQ(report.code, 5);
  const Ran picture = run({"render", "--force", "a.ply", "-o", "b.ply"});
  EXPECT_EQ(picture.code, 5);
  EXPECT_THAT(picture.err, HasSubstr("b.ply: is a cloud"));
  EXPECT_TRUE(take("b.ply") == raw_);
  EXPECT_THAT(names(), ElementsAre("a.ply", "b.ply"));
}

TEST_F(Replacing, TwoOutputsOfOneNameAreRefusedBeforeTheWork) {
  struct Slip {
    std::vector<std::string> words;
    const char* said;
  };
  std::filesystem::create_directory(at("made"));
  for (const Slip& slip :
       {Slip{{"a.ply", "z.xyz", "--html", "z.xyz"}, "OUT and --html are the same file: z.xyz"},
        Slip{{"a.ply", "-o", "z.xyz", "--trace", "./z.xyz"}, "OUT and --trace are the same file: ./z.xyz"},
        Slip{{"a.ply", "z.xyz", "--report", at("z.xyz")}, "OUT and --report are the same file: "},
        Slip{{"a.ply", "-o", "made", "--report", "made/a.ply"},
             "OUT and --report are the same file: made/a.ply"},
        Slip{{"a.ply", "b.ply", "-o", "made", "--report", "./made/../made/b.ply"}, "OUT and --report are"},
        Slip{{"a.ply", "z.xyz", "--html", "z", "--report", "./z"},
             "--report and --html are the same file: z"},
        Slip{{"a.ply", "-", "--report", "-"}, "OUT and --report are the same file: standard output (-)"}}) {
    std::vector<std::string> words = {"denoise", "--force"};
    words.insert(words.end(), slip.words.begin(), slip.words.end());
    const Ran ran = run(words);
    EXPECT_EQ(ran.code, 2);
    EXPECT_EQ(ran.out, "");
    EXPECT_THAT(ran.err, HasSubstr(slip.said));
    EXPECT_THAT(names(), ElementsAre("a.ply", "b.ply", "made"));
    EXPECT_FALSE(there("made/a.ply"));
  }
  EXPECT_EQ(run({"mesh", "--force", "a.ply", "z.ply", "--report", "./z.ply"}).code, 2);
  EXPECT_EQ(run({"denoise", "a.ply", "/dev/null", "--report", "/dev/null"}).code, 0) << "takes any number";
}

TEST_F(Replacing, AFileBesideTheCloudThatExistsIsRefusedBeforeTheWork) {
  put("mine", "mine");
  for (const char* option : {"--report", "--html", "--trace"}) {
    const Ran ran = run({"denoise", "a.ply", "out.ply", option, "mine"});
    EXPECT_EQ(ran.code, 5) << option;
    EXPECT_THAT(ran.err, HasSubstr("mine: exists already; --force replaces it"));
    EXPECT_EQ(take("mine"), "mine");
    EXPECT_FALSE(there("out.ply")) << option;
  }
}

TEST_F(Replacing, SeveralInputsMakeTheirFolder) {
  const Ran ran = run({"denoise", "--flow", "hc", "a.ply", "b.ply", "-o", "cleaned"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(there("cleaned/a.ply"));
  EXPECT_TRUE(there("cleaned/b.ply"));
  EXPECT_TRUE(take("b.ply") == raw_);
}

TEST_F(Replacing, NoFolderIsMadeWhereNothingIsWritten) {
  put("broken.ply", "not a cloud");
  put("tiles.ply", noisy_plane(20).bytes());
  ASSERT_EQ(run({"tiles", "plan", "tiles.ply", "job"}).code, 0);
  struct Slip {
    std::vector<std::string> words;
    int code;
  };
  for (const Slip& slip :
       {Slip{{"denoise", "a.ply", "b.ply", "-o", "made", "--viewpoint", "1,2,3"}, 2},
        Slip{{"denoise", "a.ply", "b.ply", "-o", "made", "--html", "page.html"}, 2},
        Slip{{"denoise", "a.ply", "-o", "made/", "--report", "made/a.ply"}, 2},
        Slip{{"denoise", "a.ply", "-o", "made/", "--strength-field", "none"}, 2},
        Slip{{"denoise", "a.ply", "-o", "made/", "--memory", "much"}, 2},
        Slip{{"smooth-mesh", "a.ply", "-o", "made/", "--refine-chart", "mixed"}, 2},
        Slip{{"denoise", "broken.ply", "-o", "made/"}, 3}, Slip{{"tiles", "join", "job", "made/"}, 2},
        Slip{{"denoise", "a.ply", "-o", "none/made/"}, 5}}) {
    const Ran ran = run(slip.words);
    EXPECT_EQ(ran.code, slip.code) << slip.words[2] << ran.err;
    EXPECT_FALSE(there("made")) << ran.err;
  }
}

TEST_F(Replacing, FilesBesideTheCloudMayGoIntoItsNewFolder) {
  const Ran ran = run({"denoise", "--flow", "hc", "a.ply", "-o", "made/", "--report", "made/r.json", "--html",
                       "made/../made/r.html"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  for (const char* name : {"made/a.ply", "made/r.json", "made/r.html"}) EXPECT_TRUE(there(name)) << name;
}

TEST_F(Replacing, AFolderThatHoldsTheInputsKeepsThem) {
  const std::string a = take("a.ply");
  const Ran ran = run({"denoise", "--force", "a.ply", "b.ply", "-o", "."});
  EXPECT_EQ(ran.code, 5);
  EXPECT_THAT(ran.err, HasSubstr("--force b.ply -o b.ply"));
  EXPECT_TRUE(take("a.ply") == a);
  EXPECT_TRUE(take("b.ply") == raw_);
}

TEST_F(Replacing, SeveralInputsIntoWhatIsCalledLikeACloudAreASlip) {
  const Ran ran = run({"denoise", "a.ply", "b.ply", "-o", "c.ply"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err, HasSubstr("need a folder"));
  EXPECT_EQ(run({"denoise", "--force", "a.ply", "a.ply", "-o", "b.ply"}).code, 5) << "b.ply is a file";
  EXPECT_TRUE(take("b.ply") == raw_);
  EXPECT_THAT(names(), ElementsAre("a.ply", "b.ply"));
}

}  // namespace
}  // namespace rfsmooth::test
