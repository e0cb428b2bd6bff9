/// Options are strict: numbers, ranges, words, names; every mistake is exit code 2, says what would be right,
/// and touches no file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/folder.h"
#include "cli/small_clouds.h"

using ::testing::HasSubstr;

namespace rfsmooth::test {
namespace {

struct Mistake {
  const char* name;
  std::vector<std::string> typed;
  const char* says;
};

class Mistakes : public InFolder, public ::testing::WithParamInterface<Mistake> {};

TEST_P(Mistakes, AreUsageErrors) {
  put("in.ply", noisy_plane(5).bytes());
  std::vector<std::string> arguments = {"denoise", "in.ply", "out.ply"};
  arguments.insert(arguments.end(), GetParam().typed.begin(), GetParam().typed.end());
  const Ran ran = run(arguments);
  EXPECT_EQ(ran.code, 2);
  EXPECT_EQ(ran.out, "");
  EXPECT_THAT(ran.err, HasSubstr(GetParam().says));
  EXPECT_EQ(names(), std::vector<std::string>{"in.ply"});
}

INSTANTIATE_TEST_SUITE_P(
    All, Mistakes,
    ::testing::Values(Mistake{"MisspeltOption", {"--itertions", "3"}, "did you mean '--iterations'?"},
                      Mistake{"MisspeltOptionWithValue", {"--itertions=3"}, "did you mean '--iterations'?"},
                      Mistake{"MisspeltFlow", {"--flow", "laplacain"}, "did you mean 'laplacian'?"},
                      Mistake{"MisspeltFormat", {"--format", "plyy"}, "did you mean 'ply'?"},
                      Mistake{"NumberWithTail", {"--beta", "0.5abc"}, "must be a number"},
                      Mistake{"NumberWithBlank", {"--beta", " 0.5"}, "must be a number"},
                      Mistake{"EmptyNumber", {"--beta", ""}, "must be a number"},
                      Mistake{"NotANumber", {"--beta", "nan"}, "must be a number"},
                      Mistake{"Infinite", {"--beta", "inf"}, "must be a number"},
                      Mistake{"Comma", {"--beta", "0,5"}, "must be a number"},
                      Mistake{"AboveRange", {"--beta", "1.5"}, "between 0 and 1"},
                      Mistake{"BelowRange", {"--alpha", "-0.5"}, "between 0 and 1"},
                      Mistake{"FractionalCount", {"--iterations", "2.5"}, "whole number"},
                      Mistake{"NegativeCount", {"--iterations", "-3"}, "between 0 and"},
                      Mistake{"HugeCount", {"--iterations", "99999999999999"}, "whole number"},
                      Mistake{"ZeroThreads", {"--threads", "0"}, "between 1 and"},
                      Mistake{"MissingValue", {"--beta"}, "--beta"},
                      Mistake{"GivenTwice", {"--beta", "0.6", "--beta", "0.7"}, "--beta"},
                      Mistake{"OptionOfAnotherFlow", {"--flow", "laplacian", "--beta", "0.6"}, "--beta"},
                      Mistake{"FlagWithValue", {"--force=maybe"}, "--force"},
                      Mistake{"UnknownShort", {"-z"}, "unknown option -z"}),
    [](const auto& test) { return test.param.name; });

TEST(Help, EveryOptionIsThereWithItsDefaultAndRange) {
  const Ran shorter = rfsmooth({"denoise", "-h"}), complete = rfsmooth({"denoise", "--help"});
  EXPECT_EQ(shorter.code, 0);
  EXPECT_EQ(complete.code, 0);
  EXPECT_EQ(complete.err, "");
  EXPECT_LT(shorter.out.size(), complete.out.size());
  for (const char* text :
       {"--flow", "--iterations", "--alpha", "--beta", "0 to 1", "default auto", "--no-swap", "--threads",
        "--report", "--config", "--force", "exit codes:", "130", "--sdg-reach", "one of auto, "})
    EXPECT_THAT(complete.out, HasSubstr(text));
  EXPECT_THAT(shorter.out, ::testing::Not(HasSubstr("--sdg-reach")));
}

TEST(Help, ManualPagesNameEveryOptionOfTheHelp) {
  for (const char* command : {"denoise", "mesh", "smooth-mesh", "info", "compare", "flows"}) {
    const Ran help = rfsmooth({command, "--help"}), man = rfsmooth({"man", command});
    ASSERT_EQ(man.code, 0);
    EXPECT_THAT(man.out, ::testing::StartsWith(".TH "));
    std::string plain;
    for (std::size_t i = 0; i < man.out.size(); ++i)
      if (man.out[i] != '\\') plain += man.out[i];
    std::size_t found = 0;
    for (std::size_t at = help.out.find("\n      --"); at != std::string::npos;
         at = help.out.find("\n      --", at + 1)) {
      const std::size_t begin = at + 7, end = help.out.find_first_of(" \n", begin);
      const std::string option = help.out.substr(begin, end - begin);
      if (option == "--help") continue;
      EXPECT_THAT(plain, HasSubstr(option)) << command;
      ++found;
    }
    EXPECT_GT(found, 0u) << command;
  }
}

TEST(Completion, BashOffersOptionsAndWords) {
  const std::string script = rfsmooth({"completion", "bash"}).out;
  const auto complete = [&](const std::string& words, int at) {
    RunSetup setup;
    setup.input = script + "\nCOMP_WORDS=(" + words + "); COMP_CWORD=" + std::to_string(at) +
                  "; _rfsmooth; echo \"${COMPREPLY[@]}\"\n";
    return run_program("bash", {}, setup).out;
  };
  EXPECT_EQ(complete("rfsmooth den", 1), "denoise\n");
  EXPECT_EQ(complete("rfsmooth denoise --rep", 2), "--report\n");
  EXPECT_EQ(complete("rfsmooth denoise --flow lapl", 3), "laplacian\n");
  EXPECT_THAT(complete("rfsmooth mesh --stage ''", 3), HasSubstr("emst sdg rfs"));
}

TEST(Flows, TextAndJsonListTheSameFlows) {
  const Ran text = rfsmooth({"flows"}), json = rfsmooth({"flows", "--json"});
  EXPECT_EQ(text.code, 0);
  EXPECT_EQ(json.err, "");
  const auto list = nlohmann::json::parse(json.out);
  ASSERT_GE(list.size(), 2u);
  for (const auto& flow : list) {
    EXPECT_THAT(text.out, HasSubstr(flow["name"].get<std::string>()));
    EXPECT_TRUE(flow["options"].contains("iterations")) << flow["name"];
  }
}

TEST(Command, LinksTheCoreOnly) {
  const Ran ran = run_program("ldd", {RFSMOOTH_COMMAND});
  if (ran.code != 0) GTEST_SKIP() << "no ldd here";
  for (const char* heavy : {"libpcl", "libCGAL", "libOpen3D", "libvtk", "libboost", "libGL"})
    EXPECT_THAT(ran.out, ::testing::Not(HasSubstr(heavy)));
}

}  // namespace
}  // namespace rfsmooth::test
