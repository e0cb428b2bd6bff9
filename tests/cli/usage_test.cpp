/// What is typed wrong is exit code 2 and says what would be right; help and version are data on stdout.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/support/run_command.h"

using ::testing::HasSubstr;

namespace rfsmooth::test {
namespace {

TEST(Usage, VersionIsOneLineOnStdout) {
  const Ran ran = rfsmooth({"--version"});
  EXPECT_EQ(ran.code, 0);
  EXPECT_THAT(ran.out, ::testing::MatchesRegex("rfsmooth [0-9]+\\.[0-9]+\\.[0-9]+\n"));
  EXPECT_EQ(ran.err, "");
}

TEST(Usage, NothingTypedShowsTheOverviewOnStderr) {
  const Ran ran = rfsmooth({});
  EXPECT_EQ(ran.code, 2);
  EXPECT_EQ(ran.out, "");
  EXPECT_THAT(ran.err, HasSubstr("usage: rfsmooth COMMAND"));
}

TEST(Usage, MisspeltCommandIsCorrected) {
  const Ran ran = rfsmooth({"completoin"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_EQ(ran.out, "");
  EXPECT_THAT(ran.err, HasSubstr("unknown command 'completoin'; did you mean 'completion'?"));
}

TEST(Usage, MisspeltOptionBeforeTheCommandIsCorrected) {
  const Ran ran = rfsmooth({"--verison"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err, HasSubstr("did you mean '--version'?"));
}

TEST(Usage, NothingNearGivesNoSuggestion) {
  const Ran ran = rfsmooth({"xylophone"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err, HasSubstr("unknown command 'xylophone'"));
  EXPECT_THAT(ran.err, ::testing::Not(HasSubstr("did you mean")));
}

}  // namespace
}  // namespace rfsmooth::test
