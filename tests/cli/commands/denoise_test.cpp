/// rfsmooth denoise on small files: the cloud's own bytes, and the contracts of files and streams.
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/support/folder.h"
#include "tests/cli/support/small_clouds.h"
#include "tests/support/sanitized.h"

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

namespace rfsmooth::test {
namespace {

class DenoiseCommand : public InFolder {};

TEST_F(DenoiseCommand, MovesPointsAndKeepsEveryOtherByte) {
  const BinaryPly cloud = noisy_plane(30);
  put("in.ply", cloud.bytes());
  const Ran ran = run({"denoise", "--flow", "hc", "in.ply", "out.ply"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out, "");
  const std::string before = cloud.bytes(), after = take("out.ply");
  ASSERT_EQ(after.size(), before.size());
  EXPECT_NE(after, before);
  const std::size_t header = cloud.header().size();
  EXPECT_EQ(after.substr(0, header), before.substr(0, header));
  for (std::size_t byte = header; byte < before.size(); ++byte) {
    const bool coordinate = (byte - header) % BinaryPly::kRow < 12;
    ASSERT_TRUE(coordinate || after[byte] == before[byte]) << "byte " << byte;
  }
  EXPECT_THAT(names(), ElementsAre("in.ply", "out.ply"));
}

TEST_F(DenoiseCommand, SaysWhatItDidOnStderr) {
  put("in.ply", noisy_plane(20).bytes());
  const Ran ran = run({"denoise", "--flow", "hc", "in.ply", "out.ply"});
  EXPECT_THAT(ran.err, HasSubstr("400 points"));
  EXPECT_THAT(ran.err, HasSubstr("noise"));
  EXPECT_THAT(ran.err, HasSubstr("spacing"));
  EXPECT_THAT(ran.err, HasSubstr("largest move"));
  EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 3) << ran.err;
  std::istringstream lines(ran.err);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
  EXPECT_THAT(ran.err, Not(HasSubstr("seconds")));
  EXPECT_THAT(run({"denoise", "--flow", "hc", "-v", "in.ply", "verbose.ply"}).err,
              HasSubstr("seconds: read"));
  EXPECT_THAT(ran.err, Not(HasSubstr("\x1b"))) << "no colours away from a terminal";
  EXPECT_THAT(ran.err, Not(HasSubstr("\r"))) << "no bar away from a terminal";
}

TEST_F(DenoiseCommand, SaysOfNoiseWhatBelongsTogether) {
  put("in.ply", noisy_plane(16).bytes());
  const auto said = [&](const std::vector<std::string>& typed) {
    std::vector<std::string> words = {"denoise", "in.ply", "out.ply", "--force", "--report", "r.json"};
    words.insert(words.end(), typed.begin(), typed.end());
    const Ran ran = run(words);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return ran.err;
  };
  const auto report = [&] { return nlohmann::json::parse(take("r.json")); };
  EXPECT_THAT(said({}), HasSubstr(" left"));
  const double noise = report()["noise"], left = report()["noise_left"];
  EXPECT_TRUE(report().at("not_smoothed").is_null());
  for (const char* option : {"--strength", "--iterations"}) {
    const std::string err = said({option, "0"});
    EXPECT_THAT(err, HasSubstr(std::string(", not smoothed, as ") + option + " 0 asks;"));
    EXPECT_THAT(err, Not(HasSubstr("too little")));
    EXPECT_EQ("--" + report()["not_smoothed"].get<std::string>().substr(3), option);  // "no-strength"
    EXPECT_EQ(report()["noise_left"], report()["noise"]) << option;
    EXPECT_EQ(report()["noise"], noise) << option;
  }
  said({"--iterations", "3"});
  EXPECT_EQ(report()["noise"], noise) << "the scan's, not what the third step found";
  EXPECT_EQ(report()["noise_left"], left) << "not what a later step hears of it";
  EXPECT_TRUE(report()["options"]["noise"].is_null()) << "each step measures its own";
  const std::string once = take("out.ply");
  put("again.json", take("r.json"));
  said({"--config", "again.json"});
  EXPECT_TRUE(take("out.ply") == once);
  EXPECT_THAT(said({"--push-back"}), Not(HasSubstr(" left"))) << "nobody knows";
  EXPECT_TRUE(report()["noise_left"].is_null());
  for (const char* stated : {"0.01", "5"}) {
    const std::string err = said({"--noise", stated});
    EXPECT_THAT(err, HasSubstr(std::string("noise ") + stated + ", as stated"));
    EXPECT_THAT(err, Not(HasSubstr("loudest tenth"))) << "that is of another figure";
  }
  put("few.xyz", "5 6 7\n5 6 8\n5 7 7\n");
  EXPECT_THAT(run({"denoise", "few.xyz", "few_out.xyz"}).err,
              HasSubstr("noise 0, too few points to smooth;"));
}

TEST_F(DenoiseCommand, LittleNoiseIsSmoothedAndMoreStrengthIsNotAdvisedForNone) {
  for (const double sigma : {0.0, 0.02}) {
    std::mt19937_64 engine(9);
    std::normal_distribution<double> noise(0, 1);
    BinaryPly cloud;
    for (int i = 0; i < 30; ++i)
      for (int j = 0; j < 30; ++j)
        for (const double c : {double(i), double(j), sigma * noise(engine)}) cloud.xyz.push_back(float(c));
    put("in.ply", cloud.bytes());
    const std::string err = run({"denoise", "in.ply", "out.ply", "--force"}).err;
    EXPECT_EQ(err.find("too little to smooth") != std::string::npos, sigma == 0) << err;
    EXPECT_THAT(err, Not(HasSubstr("--strength 2")));
  }
}

TEST_F(DenoiseCommand, WhatLooksLikeShapeIsNamedAndMoreStrengthAdvised) {
  BinaryPly cloud;
  for (int i = 0; i < 50; ++i)
    for (int j = 0; j < 50; ++j)
      for (const double c : {double(i), double(j), 0.2 * std::sin(M_PI * i / 5) * std::sin(M_PI * j / 5)})
        cloud.xyz.push_back(float(c));
  put("in.ply", cloud.bytes());
  const std::string err = run({"denoise", "in.ply", "out.ply"}).err;
  EXPECT_THAT(err, HasSubstr("noise 0, beside 0.0"));
  EXPECT_THAT(err, HasSubstr(" that looks like small shape, too little to smooth (--strength 2 does it all"));
  EXPECT_THAT(run({"info", "in.ply"}).out, HasSubstr("  noise     0, beside 0.0")) << "as denoise says";
  EXPECT_EQ(nlohmann::json::parse(run({"info", "--json", "in.ply"}).out)["noise"], 0);
  for (const char* none : {"0", "-0"}) {
    const Ran stated =
        run({"denoise", "in.ply", "out.ply", "--force", "--noise", none, "--report", "r.json"});
    EXPECT_EQ(stated.code, 0) << stated.err;
    EXPECT_THAT(stated.err, HasSubstr("noise 0, as stated, nothing to smooth; spacing"));
    EXPECT_EQ(nlohmann::json::parse(take("r.json"))["noise"].dump(), "0.0");
  }
}

TEST_F(DenoiseCommand, OneIsCountedAsOne) {
  put("one.xyz", "1 2 3\n");
  EXPECT_THAT(run({"denoise", "-v", "one.xyz", "out.xyz"}).err,
              ::testing::AllOf(HasSubstr(": 1 point, 1 finite"), HasSubstr(", 1 point without a face,")));
  EXPECT_THAT(run({"mesh", "one.xyz", "mesh.ply"}).err, HasSubstr("1 vertex, 0 edges, 0 faces"));
  EXPECT_THAT(run({"compare", "one.xyz", "one.xyz"}).out,
              HasSubstr("1 point (1 finite) against 1 clean point\n"));
}

TEST_F(DenoiseCommand, QuietSaysNothing) {
  put("in.ply", noisy_plane(10).bytes());
  const Ran ran = run({"denoise", "--flow", "hc", "-q", "in.ply", "out.ply"});
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.err, "");
  EXPECT_EQ(ran.out, "");
}

TEST_F(DenoiseCommand, ExistingOutputIsRefusedWithoutForce) {
  put("in.ply", noisy_plane(10).bytes());
  put("out.ply", "precious");
  const Ran refused = run({"denoise", "--flow", "hc", "in.ply", "out.ply"});
  EXPECT_EQ(refused.code, 5);
  EXPECT_THAT(refused.err, HasSubstr("--force"));
  EXPECT_EQ(take("out.ply"), "precious");
  const Ran forced = run({"denoise", "--flow", "hc", "--force", "in.ply", "out.ply"});
  EXPECT_EQ(forced.code, 0) << forced.err;
  EXPECT_NE(take("out.ply"), "precious");
}

TEST_F(DenoiseCommand, InputAndOutputMayBeTheSameFileWithForce) {
  const std::string before = noisy_plane(10).bytes();
  put("a.ply", before);
  EXPECT_EQ(run({"denoise", "--flow", "hc", "a.ply", "a.ply"}).code, 5);
  EXPECT_EQ(take("a.ply"), before);
  ASSERT_EQ(run({"denoise", "--flow", "hc", "a.ply", "b.ply"}).code, 0);
  ASSERT_EQ(run({"denoise", "--flow", "hc", "a.ply", "a.ply", "--force"}).code, 0);
  EXPECT_EQ(take("a.ply"), take("b.ply"));
}

TEST_F(DenoiseCommand, StreamsGiveTheSameBytesAsFiles) {
  const std::string cloud = noisy_plane(10).bytes();
  put("in.ply", cloud);
  ASSERT_EQ(run({"denoise", "--flow", "hc", "in.ply", "out.ply"}).code, 0);
  RunSetup setup;
  setup.input = cloud;
  const Ran ran = run({"denoise", "--flow", "hc", "-", "-", "--format", "ply"}, setup);
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(ran.out == take("out.ply"));
}

TEST_F(DenoiseCommand, StandardOutputHasTheFormatOfTheInput) {
  put("in.ply", noisy_plane(10).bytes());
  put("in.xyz", "0 0 0\n1 0 0\n0 1 0\n");
  ASSERT_EQ(run({"denoise", "in.ply", "out.ply"}).code, 0);
  RunSetup setup;
  setup.input = take("in.ply");
  const Ran ran = run({"denoise", "-", "-"}, setup);
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(ran.out == take("out.ply"));
  EXPECT_EQ(run({"denoise", "in.xyz", "-"}).out, take("in.xyz"));
  EXPECT_EQ(run({"denoise", "in.xyz", "-", "--format", "pcd"}).out.substr(0, 6), "# .PCD");
}

TEST_F(DenoiseCommand, StandardInputIsCalledSo) {
  RunSetup setup;
  setup.input = "no cloud";
  const Ran ran = run({"denoise", "-", "out.ply"}, setup);
  EXPECT_EQ(ran.code, 3);
  EXPECT_THAT(ran.err, HasSubstr("error: standard input: "));
  EXPECT_THAT(ran.err, Not(HasSubstr("/dev/stdin")));
}

TEST_F(DenoiseCommand, WhatStandsBesideTheCloudNeedsAName) {
  put("in.ply", noisy_plane(10).bytes());
  for (const char* option : {"--html", "--trace"}) {
    const Ran ran = run({"denoise", "in.ply", "out.ply", option, "-"});
    EXPECT_EQ(ran.code, 2) << option;
    EXPECT_THAT(ran.err, HasSubstr("standard output (-) does not take the"));
  }
  EXPECT_THAT(names(), ElementsAre("in.ply"));
}

TEST_F(DenoiseCommand, NormalsStayAndAWarningSaysTheyAreOld) {
  put("in.ply", noisy_plane(10, "nx").bytes());
  const Ran ran = run({"denoise", "--flow", "hc", "in.ply", "out.ply"});
  EXPECT_EQ(ran.code, 0);
  EXPECT_THAT(ran.err, HasSubstr("warning"));
  EXPECT_THAT(ran.err, HasSubstr("normals"));
}

TEST_F(DenoiseCommand, ReportSaysWhatWasDoneAndConfigDoesItAgain) {
  put("in.ply", noisy_plane(20).bytes());
  const Ran first = run({"denoise", "--flow", "hc", "--beta", "0.7", "--iterations", "4", "in.ply", "one.ply",
                         "--report", "report.json"});
  ASSERT_EQ(first.code, 0) << first.err;
  const auto report = nlohmann::json::parse(take("report.json"));
  EXPECT_EQ(report["command"], "denoise");
  EXPECT_EQ(report["input"]["path"], "in.ply");
  EXPECT_EQ(report["input"]["points"], 400);
  EXPECT_EQ(report["options"]["flow"], "hc");
  EXPECT_EQ(report["options"]["beta"], 0.7);
  EXPECT_EQ(report["options"]["iterations"], 4);
  EXPECT_FALSE(report["options"]["alpha"].is_null()) << "chosen values are filled in";
  EXPECT_EQ(report["counts"]["points"], 400);
  EXPECT_GT(report["spacing"], 0);
  EXPECT_TRUE(report.contains("noise"));
  EXPECT_GE(report["seconds"]["smooth"], 0);
  const Ran again = run({"denoise", "--config", "report.json", "in.ply", "two.ply"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_TRUE(take("one.ply") == take("two.ply"));
  const Ran other = run({"denoise", "--config", "report.json", "--beta", "0.9", "in.ply", "three.ply"});
  ASSERT_EQ(other.code, 0) << other.err;
  EXPECT_FALSE(take("one.ply") == take("three.ply")) << "the command line wins";
}

TEST_F(DenoiseCommand, ReportOfTheAutomaticFlowSaysEverythingItChose) {
  put("in.ply", noisy_plane(20).bytes());
  const Ran first = run({"denoise", "in.ply", "one.ply", "--threads", "2", "--report", "report.json"});
  ASSERT_EQ(first.code, 0) << first.err;
  const auto report = nlohmann::json::parse(take("report.json"));
  EXPECT_THAT(rfsmooth({"--version"}).out, HasSubstr(report["rfsmooth"].get<std::string>()));
  EXPECT_EQ(report["input"]["format"], "ply");
  EXPECT_EQ(report["input"]["fields"].size(), 5u);
  EXPECT_EQ(report["output"]["path"], "one.ply");
  EXPECT_EQ(report["threads"], 2);
  EXPECT_EQ(report["options"]["flow"], "auto");
  // The flow's own, not asked for: iterations, strength, evening out.
  EXPECT_EQ(report["options"]["iterations"], 1);
  EXPECT_EQ(report["options"]["strength"], 1);
  EXPECT_EQ(report["options"]["equalize"], true);
  EXPECT_TRUE(report["options"]["noise"].is_null()) << "measured, so another cloud has its own";
  EXPECT_GT(report["noise"], 0);
  EXPECT_LT(report["noise_left"], report["noise"]);
  const auto measured = nlohmann::json::parse(run({"info", "--json", "in.ply"}).out)["noise_measured"];
  EXPECT_EQ(report["noise_measured"], measured) << "both say the same of a cloud";
  EXPECT_EQ(measured["typical"], report["noise"]);
  EXPECT_GE(measured["loudest_tenth"], 0.5 * measured["typical"].get<double>());
  EXPECT_EQ(measured["depth_step"], 0);
  EXPECT_GT(report["guide_strength"], 0);
  EXPECT_GT(report["equalized"]["rms"], 0);
  EXPECT_GT(report["largest_move"], report["rms_move"]);
  for (const char* count : {"points", "finite", "distinct", "moved", "faces", "edges", "bridges", "stranded"})
    EXPECT_TRUE(report["counts"].contains(count)) << count;
  for (const char* stage : {"read", "prepare", "emst", "sdg", "rfs-mesh", "smooth", "write"})
    EXPECT_TRUE(report["seconds"].contains(stage)) << stage;
  const Ran again = run({"denoise", "--config", "report.json", "in.ply", "two.ply", "--threads", "1"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_TRUE(take("one.ply") == take("two.ply"));
}

TEST_F(DenoiseCommand, ConfigOfOneCloudIsMeasuredAnewOnAnother) {
  BinaryPly cloud = noisy_plane(20);
  put("metres.ply", cloud.bytes());
  for (float& x : cloud.xyz) x *= 1000;
  put("millimetres.ply", cloud.bytes());
  ASSERT_EQ(run({"denoise", "metres.ply", "out.ply", "--report", "r.json"}).code, 0);
  ASSERT_EQ(run({"denoise", "millimetres.ply", "expected.ply"}).code, 0);
  const Ran ran = run({"denoise", "--config", "r.json", "millimetres.ply", "by_config.ply"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(ran.err, Not(HasSubstr("as stated")));
  EXPECT_TRUE(take("by_config.ply") == take("expected.ply"));
}

TEST_F(DenoiseCommand, ConfigWritesNothingBesideTheCloud) {
  put("in.ply", noisy_plane(10).bytes());
  ASSERT_EQ(
      run({"denoise", "in.ply", "one.ply", "--report", "r.json", "--html", "p.html", "--trace", "t.csv"})
          .code,
      0);
  const Ran ran = run({"denoise", "--config", "r.json", "in.ply", "two.ply"});
  EXPECT_EQ(ran.code, 0) << "neither page nor trace is in its way: " << ran.err;
  EXPECT_THAT(names(), ElementsAre("in.ply", "one.ply", "p.html", "r.json", "t.csv", "two.ply"));
}

TEST_F(DenoiseCommand, ThreadsBindsEveryThreadOfTheProgram) {
  put("in.ply", noisy_plane(kSanitized ? 60 : 150).bytes());
  for (const std::size_t threads : {1u, 2u}) {
    const Ran ran = run({"denoise", "--force", "--threads", std::to_string(threads), "in.ply", "out.ply"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    // More threads may exist asleep; a hundredth of a second is what the clocks differ by.
    EXPECT_LE(ran.processor_seconds, 1.02 * double(threads) * ran.seconds + 0.01) << threads;
  }
}

TEST_F(DenoiseCommand, ConfigAloneRunsTheReportAgain) {
  put("in.ply", noisy_plane(10).bytes());
  ASSERT_EQ(run({"denoise", "--flow", "hc", "in.ply", "out.ply", "--report", "r.json"}).code, 0);
  const std::string first = take("out.ply");
  std::filesystem::remove(at("out.ply"));
  const Ran again = run({"denoise", "--config", "r.json"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_TRUE(take("out.ply") == first);
}

TEST_F(DenoiseCommand, ConfigErrorsAreNamed) {
  put("in.ply", noisy_plane(10).bytes());
  put("typo.json", R"({"betta": 0.7})");
  const Ran typo = run({"denoise", "--config", "typo.json", "in.ply", "out.ply"});
  EXPECT_EQ(typo.code, 2);
  EXPECT_THAT(typo.err, HasSubstr("did you mean 'beta'?"));
  put("broken.json", R"({"beta": )");
  const Ran broken = run({"denoise", "--config", "broken.json", "in.ply", "out.ply"});
  EXPECT_EQ(broken.code, 3);
  EXPECT_THAT(broken.err, HasSubstr("byte"));
  put("range.json", R"({"beta": 7})");
  EXPECT_EQ(run({"denoise", "--config", "range.json", "in.ply", "out.ply"}).code, 2);
  EXPECT_EQ(run({"denoise", "--config", "missing.json", "in.ply", "out.ply"}).code, 3);
  put("huge.json", R"({"strength": 1e400})");
  const Ran huge = run({"denoise", "--config", "huge.json", "in.ply", "out.ply"});
  EXPECT_EQ(huge.code, 2);
  EXPECT_THAT(huge.err, ::testing::AllOf(HasSubstr("huge.json: "), HasSubstr("too large")));
  put("itself.json", R"({"config": "typo.json"})");
  const Ran itself = run({"denoise", "--config", "itself.json", "in.ply", "out.ply"});
  EXPECT_EQ(itself.code, 2);
  EXPECT_THAT(itself.err, HasSubstr("itself.json: 'config' is for the command line only"));
  const Ran piped = run({"denoise", "--config", "-", "in.ply", "out.ply"});
  EXPECT_EQ(piped.code, 2);
  EXPECT_THAT(piped.err, HasSubstr("--config takes the name of a file, not standard input"));
  EXPECT_FALSE(there("out.ply"));
}

TEST_F(DenoiseCommand, JsonThatIsNoneIsSaidInPlainWords) {
  put("in.ply", noisy_plane(10).bytes());
  put("broken.json", "{\"halo\": ");
  put("empty.json", "{}");
  put("words.json", R"({"halo": "far"})");
  const std::array<const char*, 3> cases[] = {
      {"--config", ".", ".: is a directory, expected a file"},
      {"--statistics", ".", ".: is a directory, expected a file"},
      {"--statistics", "missing.json", "missing.json: cannot open: No such file or directory"},
      {"--statistics", "broken.json", "broken.json: not JSON at byte 10"},
      {"--statistics", "empty.json",
       "empty.json: is not what 'rfsmooth tiles settle' writes: the key 'halo' is missing"},
      {"--statistics", "words.json",
       "words.json: is not what 'rfsmooth tiles settle' writes: a value in it is of another kind than "
       "rfsmooth "
       "writes"}};
  for (const auto& [option, file, says] : cases) {
    const Ran ran = run({"denoise", option, file, "in.ply", "out.ply"});
    EXPECT_EQ(ran.code, 3) << says;
    EXPECT_THAT(ran.err, HasSubstr(std::string(says) + "\n"));
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  }
}

TEST_F(DenoiseCommand, AReportThatCannotTellANameSaysSo) {
  const std::string name = "caf\xe9.ply";  // Latin-1, which JSON does not hold
  put(name, noisy_plane(10).bytes());
  ASSERT_EQ(run({"denoise", "--flow", "hc", name, "out.ply", "--report", "r.json"}).code, 0);
  const Ran alone = run({"denoise", "--config", "r.json", "--force"});
  EXPECT_EQ(alone.code, 2);
  EXPECT_THAT(alone.err, HasSubstr("r.json: cannot tell the name of caf"));
  EXPECT_EQ(run({"denoise", "--config", "r.json", name, "two.ply"}).code, 0);
  EXPECT_TRUE(take("two.ply") == take("out.ply"));
}

TEST_F(DenoiseCommand, ManyFilesGoOnAfterAnError) {
  put("a.ply", noisy_plane(10).bytes());
  put("b.ply", "not a cloud");
  put("c.ply", noisy_plane(12).bytes());
  const Ran ran = run({"denoise", "--flow", "hc", "a.ply", "b.ply", "c.ply", "-o", "out/"});
  EXPECT_EQ(ran.code, 3);
  EXPECT_TRUE(there("out/a.ply"));
  EXPECT_FALSE(there("out/b.ply"));
  EXPECT_TRUE(there("out/c.ply"));
  EXPECT_THAT(ran.err, HasSubstr("2 of 3 done"));
  EXPECT_THAT(ran.err, HasSubstr("FAILED"));
  ASSERT_EQ(run({"denoise", "--flow", "hc", "a.ply", "single.ply"}).code, 0);
  EXPECT_TRUE(take("out/a.ply") == take("single.ply"));
}

TEST_F(DenoiseCommand, ConfigOfSeveralFilesDoesThemAgain) {
  put("broken.ply", "not a cloud");
  put("a.ply", noisy_plane(10).bytes());
  put("b.ply", noisy_plane(12).bytes());
  EXPECT_EQ(run({"denoise", "--flow", "hc", "--beta", "0.7", "broken.ply", "a.ply", "b.ply", "-o", "out/",
                 "--report", "r.json"})
                .code,
            3);
  const std::string a = take("out/a.ply"), b = take("out/b.ply");
  std::filesystem::remove_all(at("out"));
  EXPECT_EQ(run({"denoise", "--config", "r.json"}).code, 3) << "the broken one again";
  EXPECT_TRUE(take("out/a.ply") == a);
  EXPECT_TRUE(take("out/b.ply") == b);
  ASSERT_EQ(run({"denoise", "--config", "r.json", "a.ply", "alone.ply"}).code, 0);
  EXPECT_TRUE(take("alone.ply") == a) << "its options, on another file";
  put("none.json", R"({"command": "denoise", "files": [{"input": {"path": "a.ply"}}]})");
  const Ran none = run({"denoise", "--config", "none.json"});
  EXPECT_EQ(none.code, 2);
  EXPECT_THAT(none.err, HasSubstr("none.json: a report of several files, none of which was done"));
}

TEST_F(DenoiseCommand, WithoutACloudNothingStandsBesideIt) {
  put("broken.ply", "not a cloud");
  // Bytes of float32 cannot hold all digits of coordinates that did not move, which is found when all the
  // work is done.
  std::string digits = "ply\nformat ascii 1.0\nelement vertex 100\n";
  for (const char* property : {"float x", "float y", "float z"})
    digits += std::string("property ") + property + "\n";
  digits += "end_header\n";
  for (int i = 0; i < 100; ++i)
    digits += std::to_string(i % 10) + " " + std::to_string(i / 10) + " 0.123456789012" +
              std::to_string(i * i % 7) + "\n";
  put("digits.ply", digits);
  for (const auto& [input, code] : {std::pair("broken.ply", 3), {"digits.ply", 2}})
    for (int again = 0; again < 2; ++again) {
      const Ran ran = run({"denoise", "--flow", "hc", "--iterations", "0", "--encoding", "binary", input,
                           "out.ply", "--report", "r.json", "--html", "page.html", "--trace", "trace.csv"});
      EXPECT_EQ(ran.code, code) << ran.err;
      EXPECT_THAT(names(), ElementsAre("broken.ply", "digits.ply")) << "they would be in the next run's way";
    }
  const Ran piped = run({"denoise", "broken.ply", "out.xyz", "--report", "-"});
  EXPECT_EQ(nlohmann::json::parse(piped.out)["error"]["code"], 3);
  put("good.ply", noisy_plane(10).bytes());
  EXPECT_EQ(run({"denoise", "good.ply", "broken.ply", "-o", "out/", "--report", "r.json"}).code, 3);
  const auto files = nlohmann::json::parse(take("r.json"))["files"];
  ASSERT_EQ(files.size(), 2u);
  EXPECT_FALSE(files[0].contains("error"));
  EXPECT_EQ(files[1]["error"]["code"], 3);
}

TEST_F(DenoiseCommand, TwoInputsOfOneNameAreRefusedBeforeAnythingIsDone) {
  std::filesystem::create_directory(at("x"));
  put("a.ply", noisy_plane(10).bytes());
  put("x/a.ply", noisy_plane(10).bytes());
  const Ran ran = run({"denoise", "a.ply", "x/a.ply", "-o", "out/"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_FALSE(there("out"));
}

TEST_F(DenoiseCommand, AFileCalledLikeACommandIsAFile) {
  put("info", noisy_plane(10).bytes());
  const Ran ran = run({"denoise", "--flow", "hc", "info", "mesh", "--format", "ply"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(there("mesh"));
}

TEST_F(DenoiseCommand, BehindTwoDashesNoWordIsAnOption) {
  put("-in.ply", noisy_plane(10).bytes());
  const Ran unknown = run({"denoise", "--flow", "hc", "-in.ply", "out.ply"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("./-in.ply"));
  ASSERT_EQ(run({"denoise", "--flow", "hc", "./-in.ply", "plain.ply"}).code, 0);
  for (const auto& words : std::vector<std::vector<std::string>>{{"--", "-in.ply", "-o.ply"},
                                                                 {"--force", "./-in.ply", "--", "-o.ply"},
                                                                 {"--output=-o.ply", "--", "-in.ply"}}) {
    std::vector<std::string> typed = {"denoise", "--flow", "hc"};
    typed.insert(typed.end(), words.begin(), words.end());
    const Ran ran = run(typed);
    ASSERT_EQ(ran.code, 0) << ran.err;
    EXPECT_TRUE(take("-o.ply") == take("plain.ply"));
    std::filesystem::remove(at("-o.ply"));
  }
  EXPECT_EQ(run({"denoise", "--", "-in.ply", "--force"}).code, 0) << "a cloud called --force";
  EXPECT_TRUE(there("--force"));
  EXPECT_EQ(run({"info", "--", "--help"}).code, 3) << "a file that is not there";
  EXPECT_EQ(run({"render", "--width", "50", "-o", "p.png", "--", "-in.ply"}).code, 0) << "another program's";
}

TEST_F(DenoiseCommand, PositionalArgumentsAreCounted) {
  for (const auto& arguments : std::vector<std::vector<std::string>>{{"denoise"},
                                                                     {"denoise", "a"},
                                                                     {"denoise", "a", "b", "c"},
                                                                     {"denoise", "-o", "b"},
                                                                     {"denoise", "a", ""}}) {
    const Ran ran = run(arguments);
    EXPECT_EQ(ran.code, 2);
    EXPECT_EQ(ran.out, "");
    EXPECT_THAT(ran.err, HasSubstr("error"));
  }
}

TEST_F(DenoiseCommand, MemoryIsSpelledAsPeopleDo) {
  put("in.ply", noisy_plane(20).bytes());
  for (const char* memory : {"8G", "8g", "8GB", "8gb", "500M", "500mb", "4e9"})
    EXPECT_EQ(run({"denoise", "--force", "--memory", memory, "in.ply", "out.ply"}).code, 0) << memory;
  for (const char* memory : {"8 apples", "GB", "8GiB", "8"}) {
    const Ran ran = run({"denoise", "--force", "--memory", memory, "in.ply", "out.ply"});
    EXPECT_EQ(ran.code, 2) << memory;
    EXPECT_THAT(ran.err, ::testing::AllOf(HasSubstr("8G, 8GB or 500M"), HasSubstr(memory)));
  }
}

}  // namespace
}  // namespace rfsmooth::test
