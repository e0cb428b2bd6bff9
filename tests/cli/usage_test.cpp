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

TEST(Usage, HelpIsAWordToo) {
  const std::pair<std::vector<std::string>, std::vector<std::string>> same[] = {
      {{"help"}, {"--help"}},
      {{"help", "denoise"}, {"denoise", "--help"}},
      {{"help", "tiles", "plan"}, {"tiles", "--help"}}};
  for (const auto& [word, option] : same) {
    const Ran ran = rfsmooth(word);
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_THAT(ran.out, HasSubstr("usage: rfsmooth"));
    EXPECT_EQ(ran.out, rfsmooth(option).out);
  }
  const Ran unknown = rfsmooth({"help", "denose"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("unknown command 'denose'; did you mean 'denoise'?"));
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

struct Slip {
  std::vector<std::string> typed;
  const char* meant;
};

TEST(Usage, WordsWithoutACommandSuggestTheOneThatIsMeant) {
  for (const Slip& slip :
       {Slip{{"smooth", "a", "b"}, "did you mean 'rfsmooth denoise a b'?"},
        Slip{{"a.ply", "b.ply"}, "did you mean 'rfsmooth denoise a.ply b.ply'?"},
        Slip{{"scans/x.PCD"}, "did you mean 'rfsmooth denoise scans/x.PCD'?"},
        Slip{{"--strength", "2", "a.ply", "b.ply"},
             "did you mean 'rfsmooth denoise --strength 2 a.ply b.ply'?"},
        Slip{{"polish", "a.ply", "b.ply"}, "did you mean 'rfsmooth denoise a.ply b.ply'?"},
        Slip{{"surface", "a.ply", "b.ply"}, "did you mean 'rfsmooth reconstruct a.ply b.ply'?"},
        Slip{{"denose", "a.ply", "b.ply"}, "did you mean 'denoise'?"},
        Slip{{"--strength", "2", "denoise", "a.ply", "b.ply"}, "rfsmooth denoise --strength"}}) {
    const Ran ran = rfsmooth(slip.typed);
    EXPECT_EQ(ran.code, 2);
    EXPECT_EQ(ran.out, "");
    EXPECT_THAT(ran.err, HasSubstr(slip.meant));
  }
}

TEST(Usage, ErrorsPointToTheHelpOfTheirCommand) {
  for (const char* command :
       {"denoise", "mesh", "smooth-mesh", "reconstruct", "info", "compare", "render", "report"}) {
    const std::string pointer = std::string("see: rfsmooth ") + command + " --help\n";
    EXPECT_THAT(rfsmooth({command, "--no-such-option"}).err, HasSubstr(pointer));
    const Ran ran = rfsmooth({command});  // no files; "reconstruct" may lack its program
    if (ran.code != 127) {
      EXPECT_THAT(ran.err, HasSubstr(pointer));
    }
  }
  EXPECT_THAT(rfsmooth({"denoise", "a.ply", "b.docx"}).err, HasSubstr("see: rfsmooth denoise --help\n"));
  EXPECT_THAT(rfsmooth({"xylophone"}).err, HasSubstr("see: rfsmooth --help\n"));
}

/// `rfsmooth WORDS | true`: the reader is gone before anything is written. What was said, and the exit code.
Ran into_closed_pipe(const std::string& words) {
  // The command starts when the reader has ended.
  return run_program(
      "bash", {"-c", "{ sleep 0.2; '" RFSMOOTH_COMMAND "' " + words + "; } | true; exit ${PIPESTATUS[0]}"});
}

TEST(Usage, AReaderThatHasSeenEnoughIsToldNothing) {
  for (const char* words : {"--help", "--help-all", "denoise --help-all", "flows", "flows --json",
                            "man denoise", "completion bash", "completion zsh"}) {
    const Ran ran = into_closed_pipe(words);
    EXPECT_EQ(ran.err, "") << words;
    EXPECT_EQ(ran.code, 5) << words;
  }
}

}  // namespace
}  // namespace rfsmooth::test
