/// What is shown on a terminal only, and Ctrl-C at every stage.
#include <algorithm>
#include <cctype>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/support/folder.h"
#include "tests/cli/support/small_clouds.h"
#include "tests/support/sanitized.h"

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Gt;
using ::testing::HasSubstr;
using ::testing::Lt;
using ::testing::Not;

namespace rfsmooth::test {
namespace {

class Terminal : public InFolder {
 protected:
  /// A run long enough for a bar with rate and time left.
  Ran watched(const std::vector<std::string>& more = {}, const std::vector<std::string>& environment = {},
              const char* steps = "1000") {
    put("in.ply", noisy_plane(30).bytes());
    std::vector<std::string> arguments = {"denoise", "--flow",  "hc",     "--iterations",
                                          steps,     "--force", "in.ply", "out.ply"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    RunSetup setup;
    setup.terminal = true;
    setup.environment = {"TERM=xterm", "NO_COLOR="};
    setup.environment.insert(setup.environment.end(), environment.begin(), environment.end());
    Ran ran = run(arguments, setup);
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_EQ(ran.out, "");
    return ran;
  }
  Ran failing(const std::vector<std::string>& environment) {
    RunSetup setup;
    setup.terminal = true;
    setup.environment = environment;
    return run({"denoise", "none.ply", "out.ply"}, setup);
  }
};

TEST_F(Terminal, ShowsABarWithStageRateAndTimeLeft) {
  const Ran ran = watched();
  EXPECT_THAT(ran.err, HasSubstr("\r\x1b[Ksmooth"));
  EXPECT_THAT(ran.err, HasSubstr(" %"));
  EXPECT_THAT(ran.err, HasSubstr("points/s"));
  EXPECT_THAT(ran.err, HasSubstr("s left"));
  // The bar is wiped before anything else is said.
  EXPECT_THAT(ran.err, HasSubstr("\r\x1b[Krfsmooth: in.ply -> out.ply"));
}

/// The numbers before each " %", in order.
std::vector<int> percents(const std::string& text) {
  std::vector<int> found;
  for (std::size_t at = text.find("] "); at != std::string::npos; at = text.find("] ", at + 1))
    found.push_back(std::stoi(text.substr(at + 2)));
  return found;
}

TEST_F(Terminal, TheBarGoesOnceFromNothingToAHundred) {
  put("a.ply", noisy_plane(24).bytes());
  put("b.ply", noisy_plane(20).bytes());
  RunSetup setup;
  setup.terminal = true;
  setup.environment = {"TERM=xterm"};
  for (const auto& typed :
       std::vector<std::vector<std::string>>{{"denoise", "a.ply", "out.ply"},
                                             {"denoise", "--normals", "a.ply", "with.ply"},
                                             {"denoise", "a.ply", "b.ply", "-o", "out"},
                                             {"mesh", "a.ply", "mesh.ply"},
                                             {"mesh", "--stage", "emst", "a.ply", "emst.ply"}}) {
    const Ran ran = run(typed, setup);
    ASSERT_EQ(ran.code, 0) << ran.err;
    const std::vector<int> shown = percents(ran.err);
    ASSERT_GE(shown.size(), 5u);
    EXPECT_EQ(shown.front(), 0);
    EXPECT_EQ(shown.back(), 100);
    EXPECT_TRUE(std::is_sorted(shown.begin(), shown.end())) << ran.err;
  }
}

TEST_F(Terminal, TheBarMovesWhileAMeshIsSmoothed) {
  put("in.ply", noisy_plane(60).bytes());
  ASSERT_EQ(run({"mesh", "in.ply", "mesh.ply"}).code, 0);
  RunSetup setup;
  setup.terminal = true;
  setup.environment = {"TERM=xterm"};
  const Ran ran =
      run({"smooth-mesh", "--flow", "hc", "--iterations", kSanitized ? "500" : "5000", "mesh.ply", "out.ply"},
          setup);
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("\x1b[Ksmooth"));
  EXPECT_THAT(percents(ran.err), Contains(AllOf(Gt(15), Lt(75)))) << ran.err;
}

TEST_F(Terminal, QuietAndDumbTerminalsShowNoBar) {
  EXPECT_EQ(watched({"--quiet"}, {}, "5").err, "");
  EXPECT_THAT(watched({}, {"TERM=dumb"}, "5").err, Not(AnyOf(HasSubstr("\r"), HasSubstr("\x1b"))));
}

TEST_F(Terminal, NoColorTurnsColoursOff) {
  EXPECT_THAT(failing({"TERM=xterm", "NO_COLOR="}).err, HasSubstr("\x1b[31merror: \x1b[0m"));
  const Ran plain = failing({"TERM=xterm", "NO_COLOR=1"});
  EXPECT_EQ(plain.code, 3);
  EXPECT_THAT(plain.err, HasSubstr("rfsmooth: error: none.ply"));
  EXPECT_THAT(plain.err, Not(HasSubstr("\x1b[3")));
}

TEST_F(Terminal, VerboseSaysMore) {
  put("in.ply", noisy_plane(20).bytes());
  const Ran less = run({"denoise", "in.ply", "a.ply"}), more = run({"denoise", "-v", "in.ply", "b.ply"});
  EXPECT_GT(more.err.size(), less.err.size());
  EXPECT_THAT(more.err, HasSubstr(" bridge"));
  EXPECT_THAT(less.err, Not(HasSubstr(" bridge")));
}

/// Ctrl-C when the bar shows a stage.
class Interrupted : public InFolder, public ::testing::WithParamInterface<const char*> {};

TEST_P(Interrupted, StopsAndLeavesNoFile) {
  constexpr int kSide = kSanitized ? 200 : 500;
  const bool last = std::string(GetParam()) == "write";  // all the work is done before
  put("in.ply", noisy_plane(last ? 100 : kSide).bytes());
  RunSetup setup;
  setup.terminal = true;
  setup.environment = {"TERM=xterm"};
  setup.interrupt_when = std::string("\x1b[K") + GetParam();
  const Ran ran = run({"denoise", "in.ply", "out.ply", "--report", "r.json", "--html", "page.html"}, setup);
  RecordProperty("seconds_after_interrupt", std::to_string(ran.seconds_after_interrupt));
  EXPECT_THAT(ran.err, HasSubstr(setup.interrupt_when));
  if (ran.code == 0) {
    // The signal came after the last look before the file was renamed: then it is complete.
    EXPECT_TRUE(last);
    EXPECT_EQ(take("out.ply").size(), take("in.ply").size());
    EXPECT_THAT(names(), ElementsAre("in.ply", "out.ply", "page.html", "r.json"));
    return;
  }
  EXPECT_EQ(ran.code, 130) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("cancelled"));
  EXPECT_THAT(names(), ElementsAre("in.ply"));
  EXPECT_LT(ran.seconds_after_interrupt, 20) << "a loaded machine takes its time, the rest of the work more";
}

INSTANTIATE_TEST_SUITE_P(Stages, Interrupted,
                         ::testing::Values("read", "prepare", "index", "neighbours", "noise", "emst",
                                           "local surfac", "sdg", "umbrellas", "rfs-mesh", "smooth", "write"),
                         [](const auto& test) {
                           std::string name;
                           for (const char c : std::string(test.param))
                             if (std::isalnum(static_cast<unsigned char>(c)) != 0) name += c;
                           return name;
                         });

}  // namespace
}  // namespace rfsmooth::test
