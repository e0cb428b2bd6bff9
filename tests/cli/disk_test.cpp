/// Full and read-only disks: small file systems in memory, mounted in a name space of their own. Where
/// mounting is not allowed the tests are skipped and say so.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/support/folder.h"
#include "tests/cli/support/small_clouds.h"

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace rfsmooth::test {
namespace {

class Disk : public InFolder {
 protected:
  /// Runs `script` in a shell with a file system of 64 kB at disk/, which is gone when the shell ends.
  Ran with_disk(const std::string& script) {
    std::filesystem::create_directory(at("disk"));
    RunSetup setup;
    setup.folder = at("");
    const std::string mount = "mount -t tmpfs -o size=64k tmpfs disk || exit 99\nexport RFSMOOTH='" +
                              std::string(RFSMOOTH_COMMAND) + "'\n";
    std::vector<std::string> arguments = {"--mount", "sh", "-c", mount + script};
    if (geteuid() != 0) arguments.insert(arguments.begin(), {"--user", "--map-root-user"});
    return run_program("unshare", arguments, setup);
  }
  /// Whether a disk can be mounted here.
  bool allowed() { return with_disk("true").code == 0; }
};

#define NEED_MOUNT() \
  if (!allowed()) GTEST_SKIP() << "mounting is not allowed here (unshare --mount, mount -t tmpfs)"

TEST_F(Disk, AFullOneIsAnErrorAndNothingIsLeftOnIt) {
  NEED_MOUNT();
  put("in.ply", noisy_plane(80).bytes());  // 128 kB
  const Ran ran = with_disk("$RFSMOOTH denoise in.ply disk/out.ply; code=$?; ls -A disk; exit $code");
  EXPECT_EQ(ran.code, 5) << ran.err;
  EXPECT_THAT(ran.err, AllOf(HasSubstr("disk/out.ply"), HasSubstr("No space left")));
  EXPECT_EQ(ran.out, "") << "files on the disk";
}

TEST_F(Disk, AFullOneKeepsTheFileThatWasToBeReplaced) {
  NEED_MOUNT();
  put("in.ply", noisy_plane(80).bytes());
  const Ran ran = with_disk(
      "echo precious > disk/out.ply\n$RFSMOOTH denoise --force in.ply disk/out.ply; code=$?\n"
      "ls -A disk; cat disk/out.ply; exit $code");
  EXPECT_EQ(ran.code, 5) << ran.err;
  EXPECT_EQ(ran.out, "out.ply\nprecious\n");
}

TEST_F(Disk, AFullOneFailsOneOfManyFilesAndTheOthersAreWritten) {
  NEED_MOUNT();
  put("a.ply", noisy_plane(20).bytes());
  put("b.ply", noisy_plane(80).bytes());
  put("c.ply", noisy_plane(20).bytes());
  const Ran ran = with_disk("$RFSMOOTH denoise a.ply b.ply c.ply -o disk/; code=$?; ls -A disk; exit $code");
  EXPECT_EQ(ran.code, 5) << ran.err;
  EXPECT_EQ(ran.out, "a.ply\nc.ply\n");
  EXPECT_THAT(ran.err, HasSubstr("2 of 3 done"));
}

TEST_F(Disk, AReportThatDoesNotFitIsAnErrorAndLeavesNothing) {
  NEED_MOUNT();
  put("in.ply", noisy_plane(20).bytes());
  const Ran ran = with_disk(
      "head -c 64k /dev/zero > disk/filler\n"
      "$RFSMOOTH denoise in.ply out.ply --report disk/report.json; code=$?; ls -A disk; exit $code");
  EXPECT_EQ(ran.code, 5) << ran.err;
  EXPECT_EQ(ran.out, "filler\n");
  EXPECT_THAT(ran.err, HasSubstr("disk/report.json"));
}

TEST_F(Disk, AReadOnlyOneIsRefusedBeforeTheWorkIsDone) {
  NEED_MOUNT();
  put("in.ply", noisy_plane(20).bytes());
  const Ran ran = with_disk(
      "echo precious > disk/old.ply\nmount -o remount,ro disk\n"
      "$RFSMOOTH denoise in.ply disk/out.ply; first=$?\n$RFSMOOTH denoise --force in.ply disk/old.ply; "
      "second=$?\n"
      "ls -A disk; cat disk/old.ply; echo $first $second");
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out, "old.ply\nprecious\n5 5\n");
  EXPECT_THAT(ran.err, HasSubstr("Read-only file system"));
  EXPECT_THAT(ran.err, ::testing::Not(HasSubstr("spacing"))) << "nothing was computed";
}

TEST_F(Disk, CloudsOnAReadOnlyOneAreRead) {
  NEED_MOUNT();
  put("in.ply", noisy_plane(20).bytes());
  const Ran ran =
      with_disk("cp in.ply disk/ && mount -o remount,ro disk && $RFSMOOTH denoise disk/in.ply out.ply");
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(there("out.ply"));
}

}  // namespace
}  // namespace rfsmooth::test
