/// Awkward input through the real command, beyond the rows of peer_table_test.cpp.
#include <chrono>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/cli/support/cloud_file.h"
#include "tests/cli/support/folder.h"
#include "tests/cli/support/small_clouds.h"
#include "tests/support/sanitized.h"

using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace rfsmooth::test {
namespace {

std::string ascii_ply(const std::vector<std::string>& rows) {
  std::string out = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(rows.size()) +
                    "\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
  for (const std::string& row : rows) out += row + "\n";
  return out;
}

class Awkward : public InFolder {
 protected:
  /// The input must be refused with this code and message, and nothing be written.
  void expect_refused(const std::string& name, int code, const std::string& says) {
    const auto before = names();
    const Ran ran = run({"denoise", name, "out.ply"});
    EXPECT_EQ(ran.code, code) << ran.err;
    EXPECT_EQ(ran.out, "");
    EXPECT_THAT(ran.err, HasSubstr(says));
    EXPECT_EQ(names(), before);
  }
  /// The output must be the input, byte for byte.
  void expect_unchanged(const std::string& name) {
    const Ran ran = run({"denoise", name, "same.ply"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    EXPECT_EQ(take("same.ply"), take(name));
  }
};

TEST_F(Awkward, MissingFile) {
  expect_refused("nothing.ply", 3, "nothing.ply");
}

TEST_F(Awkward, FolderAsInput) {
  std::filesystem::create_directory(at("folder.ply"));
  expect_refused("folder.ply", 3, "directory");
}

TEST_F(Awkward, OnlyNonFinitePoints) {
  put("in.ply", ascii_ply({"nan nan nan", "inf 0 0"}));
  expect_refused("in.ply", 4, "finite");
}

TEST_F(Awkward, TruncatedAtEveryByte) {
  const std::string whole = noisy_plane(3).bytes();
  for (std::size_t size = 0; size < whole.size(); size += size < 250 ? 7 : 1) {
    put("in.ply", whole.substr(0, size));
    const Ran ran = run({"denoise", "in.ply", "out.ply"});
    ASSERT_EQ(ran.code, 3) << "at byte " << size << ": " << ran.err;
    ASSERT_FALSE(there("out.ply"));
  }
}

TEST_F(Awkward, TwoAndThreePointsStayNear) {
  for (const std::vector<std::string>& rows :
       {std::vector<std::string>{"0 0 0", "1 0 0"}, {"0 0 0", "1 0 0", "0 1 0"}}) {
    put("in.ply", ascii_ply(rows));
    const Ran ran = run({"denoise", "--force", "in.ply", "out.ply"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    const auto before = pipeline::io::positions(read(at("in.ply"))),
               after = pipeline::io::positions(read(at("out.ply")));
    ASSERT_EQ(after.size(), 3 * rows.size());
    for (std::size_t k = 0; k < after.size(); ++k) EXPECT_NEAR(after[k], before[k], 0.5) << k;
  }
}

TEST_F(Awkward, AMillionIdenticalPoints) {
  BinaryPly cloud;
  cloud.xyz.assign(std::size_t{3} * 1000000, 0.25f);
  put("in.ply", cloud.bytes());
  expect_unchanged("in.ply");
}

TEST_F(Awkward, CollinearPointsStayOnTheirLine) {
  std::vector<std::string> rows;
  for (int i = 0; i < 200; ++i) rows.push_back(std::to_string(i * i % 97) + " 0 0");
  put("in.ply", ascii_ply(rows));
  const Ran ran = run({"denoise", "in.ply", "out.ply"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const std::string out = take("out.ply");
  std::size_t lines = 0;
  for (std::size_t at = out.find("end_header\n") + 11; at < out.size(); at = out.find('\n', at) + 1, ++lines)
    EXPECT_EQ(out.substr(out.find('\n', at) - 4, 4), " 0 0");
  EXPECT_EQ(lines, 200u);
}

TEST_F(Awkward, UntouchedTextKeepsItsText) {
  const std::string odd = ascii_ply({"1.500e+0 002.0 3", "1.500e+0 002.0 3"});
  put("in.ply", odd);
  expect_unchanged("in.ply");
}

TEST_F(Awkward, CarriageReturnsInTheHeader) {
  std::string text = ascii_ply({"0 0 0", "1 0 0", "0 1 0", "1 1 0.5"});
  std::string dos;
  for (const char c : text) dos += c == '\n' ? "\r\n" : std::string(1, c);
  put("in.ply", dos);
  const Ran ran = run({"denoise", "in.ply", "out.ply"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(take("out.ply"), HasSubstr("end_header\r\n"));
}

TEST_F(Awkward, AbsurdHeaders) {
  int number = 0;
  for (const char* header :
       {"ply\nformat ascii 1.0\nelement vertex -1\nproperty float x\nproperty float y\nproperty float "
        "z\nend_header\n",
        "ply\nformat ascii 1.0\nelement vertex 99999999999999999999\nproperty float x\nproperty float "
        "y\nproperty "
        "float z\nend_header\n",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty quaternion x\nproperty float y\nproperty float "
        "z\nend_header\n1 2 3\n",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n",
        "ply\nformat morse 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 3\nTYPE F F "
        "F\nCOUNT 1 1 1\n"
        "WIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n1 2 3\n",
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F "
        "F\nCOUNT 1 1 "
        "4000000000\nWIDTH 4000000000\nHEIGHT 4000000000\nPOINTS 1\nDATA binary\nabc"}) {
    const std::string name = "in" + std::to_string(number++);
    put(name, header);
    const Ran ran = run({"info", name});
    EXPECT_EQ(ran.code, 3) << header << ran.out;
    EXPECT_THAT(ran.err, HasSubstr(name));
  }
}

TEST_F(Awkward, OutputFolderIsAFile) {
  put("in.ply", noisy_plane(4).bytes());
  put("file", "precious");
  EXPECT_EQ(run({"denoise", "in.ply", "-o", "file/"}).code, 5);
  EXPECT_EQ(run({"denoise", "in.ply", "in.ply", "-o", "file"}).code, 5);
  EXPECT_EQ(run({"denoise", "in.ply", "file/out.ply"}).code, 5);
  EXPECT_EQ(take("file"), "precious");
}

TEST_F(Awkward, OutputIsAFolder) {
  put("in.ply", noisy_plane(4).bytes());
  std::filesystem::create_directory(at("out.ply"));
  EXPECT_EQ(run({"denoise", "--force", "in.ply", "out.ply"}).code, 5);
}

TEST_F(Awkward, OutputFolderNotWritable) {
  put("in.ply", noisy_plane(4).bytes());
  std::filesystem::create_directory(at("locked"));
  chmod(at("locked").c_str(), 0500);
  const std::string folder = geteuid() == 0 ? "/sys" : "locked";  // there even root makes no files
  const Ran ran = run({"denoise", "in.ply", folder + "/out.ply"});
  EXPECT_EQ(ran.code, 5);
  EXPECT_THAT(ran.err, HasSubstr(folder + "/out.ply: cannot write"));
}

TEST_F(Awkward, FullDisk) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  put("in.ply", noisy_plane(4).bytes());
  const Ran ran = run({"denoise", "in.ply", "/dev/full", "--force", "--format", "ply"});
  EXPECT_EQ(ran.code, 5);
  EXPECT_THAT(ran.err, HasSubstr("No space"));
}

TEST_F(Awkward, LinkAsOutputIsWrittenThrough) {
  put("in.ply", noisy_plane(4).bytes());
  put("target.ply", "old");
  std::filesystem::create_symlink("target.ply", at("link.ply"));
  ASSERT_EQ(run({"denoise", "--force", "in.ply", "link.ply"}).code, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(at("link.ply")));
  EXPECT_NE(take("target.ply"), "old");
}

TEST_F(Awkward, PipesAndOpenFilesTakeTheCloudByTheirNames) {
  put("in.ply", noisy_plane(20).bytes());
  ASSERT_EQ(run({"denoise", "in.ply", "out.ply"}).code, 0);
  const auto bash = [&](const std::string& line) {
    RunSetup setup;
    setup.folder = at("");
    setup.environment = {std::string("R=") + RFSMOOTH_COMMAND};
    const Ran ran = run_program("bash", {"-c", "set -o pipefail; " + line}, setup);
    EXPECT_EQ(ran.code, 0) << line << ran.err;
  };
  bash("$R denoise in.ply /dev/stdout | cat > a.ply");
  bash("$R denoise in.ply >(cat > b.part; mv b.part b.ply); until [ -e b.ply ]; do sleep 0.1; done");
  bash("$R denoise in.ply /dev/stdout > c.ply");
  bash("$R denoise in.ply /dev/fd/7 7> d.ply");
  bash("ln -s /dev/stdout link.ply; $R denoise in.ply link.ply | cat > e.ply");
  for (const char* name : {"a.ply", "b.ply", "c.ply", "d.ply", "e.ply"})
    EXPECT_EQ(take(name), take("out.ply")) << name;
  EXPECT_THAT(names(),
              ElementsAre("a.ply", "b.ply", "c.ply", "d.ply", "e.ply", "in.ply", "link.ply", "out.ply"));
  const Ran closed = run({"denoise", "in.ply", "/dev/fd/77"});
  EXPECT_EQ(closed.code, 5);
  EXPECT_THAT(closed.err, HasSubstr("/dev/fd/77: cannot write: Bad file descriptor"));
}

TEST_F(Awkward, MemoryIsRefusedBeforeStarting) {
  if (kSanitized) GTEST_SKIP() << "address space cannot be limited under the address sanitizer";
  BinaryPly cloud;
  cloud.xyz.assign(std::size_t{3} * 1000000, 0.5f);
  put("in.ply", cloud.bytes());
  RunSetup setup;
  setup.address_space = std::size_t{300} << 20;
  // A report is of the whole cloud, so that tiles are no way out.
  const Ran ran = run({"denoise", "--threads", "1", "--report", "report.json", "in.ply", "out.ply"}, setup);
  EXPECT_EQ(ran.code, 6) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("memory"));
  EXPECT_THAT(names(), ElementsAre("in.ply"));
}

TEST_F(Awkward, InterruptStopsWithinASecondAndLeavesNoFile) {
  put("in.ply", noisy_plane(300).bytes());
  RunSetup setup;
  setup.interrupt_after_ms = 1000;  // the handler is there, on a busy machine, too
  const auto start = std::chrono::steady_clock::now();
  const Ran ran = run({"denoise", "--flow", "hc", "--iterations", "100000", "in.ply", "out.ply"}, setup);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_EQ(ran.code, 130) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("cancelled"));
  EXPECT_THAT(names(), ElementsAre("in.ply"));
  EXPECT_LT(seconds, 30) << "100000 steps were not run to their end";
}

TEST_F(Awkward, InterruptWhileWaitingForStandardInput) {
  RunSetup setup;
  setup.hold_input_open = true;
  setup.interrupt_after_ms = 200;
  const Ran ran = run({"denoise", "-", "out.ply"}, setup);
  EXPECT_EQ(ran.code, 130) << ran.err;
  EXPECT_TRUE(names().empty());
}

TEST_F(Awkward, TheEndOfTheTerminalStopsTheWorkUnlessNohup) {
  put("in.ply", noisy_plane(300).bytes());
  RunSetup setup;
  setup.interrupt_after_ms = 1000;
  setup.interrupt_by = SIGHUP;
  const Ran ran = run({"denoise", "--flow", "hc", "--iterations", "100000", "in.ply", "out.ply"}, setup);
  EXPECT_EQ(ran.code, 130) << ran.err;
  EXPECT_THAT(names(), ElementsAre("in.ply"));
  setup.folder = at("");
  const Ran kept = run_program(
      "nohup", {RFSMOOTH_COMMAND, "denoise", "--flow", "hc", "--iterations", "40", "in.ply", "out.ply"},
      setup);
  EXPECT_EQ(kept.code, 0) << kept.err;
  EXPECT_TRUE(there("out.ply"));
}

TEST_F(Awkward, AFileBeyondTheLimitOfSizesIsAnErrorAndLeavesNothing) {
  put("in.ply", noisy_plane(80).bytes());  // 128 kB
  RunSetup setup;
  setup.folder = at("");
  const Ran ran = run_program(
      "sh", {"-c", std::string("ulimit -f 16; exec ") + RFSMOOTH_COMMAND + " denoise in.ply out.ply"}, setup);
  EXPECT_EQ(ran.code, 5) << ran.err;
  EXPECT_EQ(ran.err, "rfsmooth: error: out.ply: cannot write: File too large\n");
  EXPECT_THAT(names(), ElementsAre("in.ply"));
}

TEST_F(Awkward, FullStandardOutputIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  put("in.ply", noisy_plane(4).bytes());
  RunSetup setup;
  setup.folder = at("");
  const Ran ran =
      run_program("sh", {"-c", std::string("exec ") + RFSMOOTH_COMMAND + " info in.ply > /dev/full"}, setup);
  EXPECT_EQ(ran.code, 5);
}

TEST_F(Awkward, WhatCannotBeSaidFailsNothing) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  put("in.ply", noisy_plane(4).bytes());
  RunSetup setup;
  setup.folder = at("");
  const auto code = [&](const std::string& rest) {
    return run_program("sh", {"-c", std::string("exec ") + RFSMOOTH_COMMAND + " " + rest}, setup).code;
  };
  ASSERT_EQ(code("denoise in.ply out.ply"), 0);
  EXPECT_EQ(code("denoise -v in.ply full.ply 2> /dev/full"), 0);
  EXPECT_EQ(code("denoise -v in.ply closed.ply 2>&-"), 0);
  EXPECT_EQ(take("full.ply"), take("out.ply"));
  EXPECT_EQ(take("closed.ply"), take("out.ply"));
  EXPECT_EQ(code("denoise missing.ply x.ply 2> /dev/full"), 3);
  EXPECT_EQ(code("bogus 2> /dev/full"), 2);
}

}  // namespace
}  // namespace rfsmooth::test
