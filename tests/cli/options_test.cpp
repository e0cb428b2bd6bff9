/// Options are strict: numbers, ranges, words, names; every mistake is exit code 2, says what would be right,
/// and touches no file.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/support/folder.h"
#include "tests/cli/support/small_clouds.h"

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
                      Mistake{"LengthOfAnotherUnit", {"--noise", "2m"}, "such as 0.02"},
                      Mistake{"LengthWithoutNumber", {"--noise", "x"}, "such as 0.02"},
                      Mistake{"NegativeLength", {"--noise", "-2x"}, "between 0 and"},
                      Mistake{"MisspeltAuto", {"--noise", "atuo"}, "or 'auto'"},
                      Mistake{"MissingValue", {"--beta"}, "--beta"},
                      Mistake{"GivenTwice", {"--beta", "0.6", "--beta", "0.7"}, "--beta"},
                      Mistake{"OptionOfAnotherFlow", {"--flow", "laplacian", "--beta", "0.6"}, "--beta"},
                      Mistake{
                          "Contradiction", {"--flow", "taubin", "--mu", "0.1"}, "--mu must be greater than"},
                      Mistake{"WordOfNoChoice", {"--boundary", "fixd"}, "did you mean 'fixed'?"},
                      Mistake{"DirectionOfTwo", {"--direction", "1,2"}, "three numbers x,y,z"},
                      Mistake{"DirectionOfFour", {"--direction", "1,2,3,4"}, "three numbers x,y,z"},
                      Mistake{"ZeroDirection", {"--direction", "0,0,0"}, "not all zero"},
                      Mistake{"FlagWithValue", {"--force=maybe"}, "--force"},
                      Mistake{"UnknownShort", {"-z"}, "unknown option -z"}),
    [](const auto& test) { return test.param.name; });

class Lengths : public InFolder {
 protected:
  nlohmann::json report(const std::string& noise) const {
    const Ran ran =
        run({"denoise", "--noise", noise, "in.ply", "out.ply", "--force", "--report", "report.json"});
    EXPECT_EQ(ran.code, 0) << ran.err;
    return nlohmann::json::parse(take("report.json"));
  }
};

TEST_F(Lengths, AreWorldUnitsTimesTheSpacingOrAuto) {
  put("in.ply", noisy_plane(20).bytes());
  EXPECT_EQ(report("0.02")["noise"], 0.02);
  const auto times = report("0.5x");
  EXPECT_NEAR(times["noise"].get<double>(), 0.5 * times["spacing"].get<double>(), 1e-12);
  EXPECT_EQ(times["options"]["noise"], "0.5x")
      << "another cloud with the report's options has spacings of its own";
  // Measured: the plane's noise is 0.2.
  EXPECT_NEAR(report("auto")["noise"].get<double>(), 0.2, 0.06);
}

TEST_F(Lengths, OfNoiseBeyondTheWholeCloudAreRefused) {
  put("in.ply", noisy_plane(20).bytes());
  for (const char* noise : {"30", "1e8", "1e300", "1e9x", "1e300x"}) {
    const Ran ran = run({"denoise", "--noise", noise, "in.ply", "out.ply"});
    EXPECT_EQ(ran.code, 2) << noise << ran.err;
    EXPECT_THAT(ran.err, HasSubstr("in.ply: --noise is ")) << noise;
    EXPECT_THAT(ran.err, HasSubstr("more than the whole cloud")) << noise;
    EXPECT_FALSE(there("out.ply")) << noise;
  }
  EXPECT_EQ(run({"denoise", "--noise", "20", "in.ply", "out.ply"}).code, 0) << "the plane's diagonal is 27";
}

TEST_F(Lengths, OfNoiseWithoutMeasureHarmNothing) {
  BinaryPly cloud = noisy_plane(20);
  cloud.xyz.insert(cloud.xyz.end(), {1e17F, 0, 0});
  put("far.ply", cloud.bytes());
  const Ran ran = run({"denoise", "--noise", "1e12", "far.ply", "out.ply"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  put("in.ply", noisy_plane(20).bytes());
  ASSERT_EQ(run({"mesh", "in.ply", "mesh.ply"}).code, 0);
  for (const char* noise : {"1e8", "1e300", "1e300x"}) {
    const Ran of_mesh =
        run({"smooth-mesh", "--flow", "auto", "--noise", noise, "mesh.ply", "m.ply", "--force"});
    EXPECT_EQ(of_mesh.code, 0) << noise << of_mesh.err;
  }
}

class Flags : public InFolder {};

TEST_F(Flags, ThatAreAutoCanBeTurnedOnAndOff) {
  put("in.ply", noisy_plane(20).bytes());
  const auto equalized = [&](const std::vector<std::string>& typed) {
    std::vector<std::string> words = {"denoise", "in.ply", "out.ply", "--force", "--report", "r.json"};
    words.insert(words.end(), typed.begin(), typed.end());
    const Ran ran = run(words);
    EXPECT_EQ(ran.code, 0) << ran.err;
    const auto report = nlohmann::json::parse(take("r.json"));
    EXPECT_EQ(report["equalized"]["rms"].get<double>() > 0, report["options"]["equalize"].get<bool>());
    return report["options"]["equalize"].get<bool>();
  };
  EXPECT_TRUE(equalized({}));
  EXPECT_TRUE(equalized({"--equalize"}));
  EXPECT_FALSE(equalized({"--no-equalize"}));
  for (const bool learned : {true, false}) {
    EXPECT_TRUE(equalized({learned ? "--learned" : "--no-learned"}));
    EXPECT_EQ(nlohmann::json::parse(take("r.json"))["options"]["learned"], learned);
  }
  const std::string help = rfsmooth({"denoise", "--help-all"}).out;
  EXPECT_THAT(help, HasSubstr("--equalize, --no-equalize"));
  for (const char* shell : {"bash", "zsh"})
    EXPECT_THAT(rfsmooth({"completion", shell}).out, HasSubstr("--no-equalize"));
}

TEST(Help, EveryOptionIsThereWithItsDefaultAndRange) {
  const Ran complete = rfsmooth({"denoise", "--help-all"});
  EXPECT_EQ(complete.code, 0);
  EXPECT_EQ(complete.err, "");
  for (const char* text :
       {"--flow", "--iterations", "--alpha", "--beta", "0 to 1", "default auto", "--no-swap", "--threads",
        "--report", "--config", "--force", "exit codes:", "130", "--sdg-reach", "one of auto, "})
    EXPECT_THAT(complete.out, HasSubstr(text));
}

/// The sub-commands that the overview lists.
std::vector<std::string> listed_commands() {
  const std::string overview = rfsmooth({"--help"}).out;
  std::istringstream lines(overview.substr(overview.find("commands:\n")));
  std::vector<std::string> found;
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line) && !line.empty())
    if (line[2] != ' ') found.push_back(line.substr(2, line.find(' ', 2) - 2));
  return found;
}

std::vector<std::string> options_in(const std::string& help) {
  std::vector<std::string> found;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);)
    if (const std::size_t at = line.find("--"); at == 6)
      found.push_back(line.substr(at, line.find(' ', at) - at));
  return found;
}

TEST(Help, ShowsTheEverydayOptionsOnOneScreen) {
  for (const std::string& command : listed_commands()) {
    const Ran shorter = rfsmooth({command, "-h"}), complete = rfsmooth({command, "--help-all"});
    EXPECT_EQ(shorter.code, 0);
    EXPECT_EQ(shorter.err, "");
    EXPECT_EQ(rfsmooth({command, "--help"}).out, shorter.out);
    const auto few = options_in(shorter.out), all = options_in(complete.out);
    EXPECT_LE(few.size(), 13u) << command << ": about ten and those of help";
    EXPECT_GE(few.size(), std::min<std::size_t>(all.size(), 8)) << command;
    EXPECT_THAT(all, ::testing::IsSupersetOf(few)) << command;
    EXPECT_LE(std::count(shorter.out.begin(), shorter.out.end(), '\n'), 40) << command;
  }
  const auto everyday = options_in(rfsmooth({"denoise", "--help"}).out);
  for (const char* option : {"--strength", "--noise", "--flow", "--outliers", "--output", "--force"})
    EXPECT_THAT(everyday, ::testing::Contains(option));
  EXPECT_GT(options_in(rfsmooth({"denoise", "--help-all"}).out).size(), 3 * everyday.size());
}

TEST(Help, ManualPagesNameEveryOptionOfTheHelp) {
  for (const std::string& command : listed_commands()) {
    const Ran help = rfsmooth({command, "--help-all"}), man = rfsmooth({"man", command});
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
      if (option == "--help-all") continue;
      EXPECT_THAT(plain, HasSubstr(option)) << command;
      ++found;
    }
    EXPECT_GT(found, 0u) << command;
  }
}

TEST(Help, WordsOfTheNoiseAreExplained) {
  for (const auto& words : std::vector<std::vector<std::string>>{{"info", "--help"}, {"man", "info"}}) {
    std::string text = rfsmooth(words).out;
    std::replace(text.begin(), text.end(), '\n', ' ');
    for (const char* said :
         {"in the loudest tenth", "shared by N neighbours", "points along lines", "depth in steps of"})
      EXPECT_THAT(text, HasSubstr(said)) << words[0];
  }
  EXPECT_THAT(rfsmooth({"denoise", "--help-all"}).out, HasSubstr("rfsmooth info --help"));
  std::ifstream file(std::filesystem::path(RFSMOOTH_SOURCE) / "docs/GLOSSARY.md");
  EXPECT_THAT(std::string((std::istreambuf_iterator<char>(file)), {}),
              HasSubstr("| shared by N neighbours |"));
}

TEST(Help, ExitCodesAreDocumentedThereAndInTheReadme) {
  std::ifstream file(std::filesystem::path(RFSMOOTH_SOURCE) / "README.md");
  const std::string readme((std::istreambuf_iterator<char>(file)), {});
  const std::size_t from = readme.find("Exit codes:");
  std::string codes = readme.substr(from, readme.find("\n\n", from) - from);
  std::replace(codes.begin(), codes.end(), '\n', ' ');
  std::vector<std::vector<std::string>> pages = {{"--help-all"}};
  for (const std::string& command : listed_commands()) pages.push_back({command, "--help-all"});
  for (const std::vector<std::string>& page : pages) {
    const std::string help = rfsmooth(page).out, command = page.front();
    const std::size_t at = help.find("exit codes:");
    ASSERT_NE(at, std::string::npos) << command;
    for (const std::string code : {"0", "1", "2", "3", "4", "5", "6", "127", "130"}) {
      EXPECT_THAT(help.substr(at), HasSubstr("\n  " + code + " ")) << command;
      EXPECT_THAT(codes, HasSubstr(" " + code + " "));
    }
  }
}

TEST(Help, ManualPagesAreCleanToTheirFormatter) {
  if (run_program("groff", {"--version"}).code != 0) GTEST_SKIP() << "no groff here";
  for (const std::string& command : listed_commands()) {
    RunSetup setup;
    setup.input = rfsmooth({"man", command}).out;
    const Ran ran = run_program("groff", {"-man", "-Tutf8", "-ww", "-z"}, setup);
    EXPECT_EQ(ran.code, 0);
    EXPECT_EQ(ran.err, "") << command;
  }
}

class Installed : public InFolder {};

TEST_F(Installed, TheCommandItsManualPagesAndCompletions) {
  const Ran ran =
      run_program("cmake", {"--install", RFSMOOTH_BINARY, "--prefix", at("usr"), "--component", "command"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  RunSetup setup;
  const auto text = [&](const std::string& name) { return take("usr/" + name); };
  EXPECT_EQ(run_program(at("usr/bin/rfsmooth"), {"--version"}).code, 0);
  const auto page = [&](const std::string& name) {
    return run_program("gzip", {"-dc", at("usr/share/man/man1/" + name + ".1.gz")}).out;
  };
  EXPECT_EQ(page("rfsmooth"), rfsmooth({"man"}).out);
  std::set<std::string> expected = {"rfsmooth.1.gz"}, installed;
  for (const std::string& command : listed_commands()) {
    if (command == "reconstruct") continue;  // its page goes with its program
    expected.insert("rfsmooth-" + command + ".1.gz");
    EXPECT_EQ(page("rfsmooth-" + command), rfsmooth({"man", command}).out);
  }
  for (const auto& file : std::filesystem::directory_iterator(at("usr/share/man/man1")))
    installed.insert(file.path().filename().string());
  EXPECT_EQ(installed, expected) << "a page for every command, as pipeline/cli/install.cmake lists them";
  EXPECT_EQ(text("share/bash-completion/completions/rfsmooth"), rfsmooth({"completion", "bash"}).out);
  EXPECT_EQ(text("share/zsh/site-functions/_rfsmooth"), rfsmooth({"completion", "zsh"}).out);
}

class ZshCompletion : public InFolder {};

TEST_F(ZshCompletion, OffersOptionsAndWords) {
  if (run_program("zsh", {"--version"}).code != 0) GTEST_SKIP() << "no zsh here";
  put("_rfsmooth", rfsmooth({"completion", "zsh"}).out);
  EXPECT_EQ(run_program("zsh", {"-n", at("_rfsmooth")}).err, "") << "syntax";
  // A shell in a pseudo-terminal; what is typed there is completed by TAB. Numbered prompts say when it is
  // ready.
  put("type.zsh", R"(
zmodload zsh/zpty
zpty shell 'TERM=dumb zsh -f -i'
expect() { zpty -r -m shell reply "*$1*" || exit 1 }
zpty -w shell "PROMPT= RPROMPT=; stty -echo; fpath=($PWD \$fpath); autoload -Uz compinit; compinit -u -D; print READY''1"
expect READY1
n=1
for typed in "$@"; do
  (( ++n ))
  # The line is printed after TAB completed it, then thrown away.
  zpty -w -n shell "$typed"$'	'$''"print -r -- 'GOT:"$''"' READY''$n"$'
'
  expect READY$n
  print -r -- "${${reply##*GOT:}%%READY*}"
done
)");
  const auto completed = [&](const std::string& typed) {
    RunSetup setup;
    setup.folder = at("");
    return run_program("zsh", {"-f", "type.zsh", typed}, setup).out;
  };
  EXPECT_THAT(completed("rfsmooth den"), HasSubstr("rfsmooth denoise"));
  EXPECT_THAT(completed("rfsmooth denoise --rep"), HasSubstr("--report"));
  EXPECT_THAT(completed("rfsmooth denoise --flow lapl"), HasSubstr("--flow laplacian"));
  EXPECT_THAT(completed("rfsmooth mesh --stage sd"), HasSubstr("--stage sdg"));
  EXPECT_THAT(completed("rfsmooth tiles stat"), HasSubstr("tiles status"));
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
  EXPECT_EQ(complete("rfsmooth tiles stat", 2), "status\n");
  EXPECT_EQ(complete("rfsmooth man den", 2), "denoise\n");
  EXPECT_EQ(complete("rfsmooth completion z", 2), "zsh\n");
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

TEST_F(Flags, FlowsPrintsWhatCanBeTyped) {
  put("in.ply", noisy_plane(12).bytes());
  std::istringstream lines(rfsmooth({"flows"}).out);
  int seen = 0;
  for (std::string name, options; std::getline(lines, name) && std::getline(lines, options); ++seen) {
    name = name.substr(0, name.find(' '));
    std::istringstream words(options);
    std::vector<std::vector<std::string>> printed;  // options with their values
    for (std::string word; words >> word;) {
      // A flag is in brackets: "[--no-equalize]", "[--on|--no-on]"; another option has its value behind it.
      if (word.front() == '[') {
        printed.push_back({word.substr(1, word.find_first_of("|]") - 1)});
      } else {
        printed.push_back({word});
        ASSERT_TRUE(words >> word) << options;
        printed.back().push_back(word);
      }
    }
    // All at once, but for those that are refused since they want another value of one of the others.
    for (;;) {
      std::vector<std::string> typed = {"denoise", "in.ply", "out.ply", "--force", "--flow", name};
      for (const auto& option : printed) typed.insert(typed.end(), option.begin(), option.end());
      const Ran ran = run(typed);
      if (ran.code == 0) break;
      const auto alone = std::find_if(printed.begin(), printed.end(), [&](const auto& option) {
        return ran.err.find(option[0] + " has no effect without") != std::string::npos;
      });
      ASSERT_TRUE(alone != printed.end()) << options << ran.err;
      printed.erase(alone);
    }
  }
  EXPECT_GE(seen, 13);
}

TEST(Command, LinksTheCoreOnly) {
  const Ran ran = run_program("ldd", {RFSMOOTH_COMMAND});
  if (ran.code != 0) GTEST_SKIP() << "no ldd here";
  for (const char* heavy : {"libpcl", "libCGAL", "libOpen3D", "libvtk", "libboost", "libGL"})
    EXPECT_THAT(ran.out, ::testing::Not(HasSubstr(heavy)));
}

}  // namespace
}  // namespace rfsmooth::test
