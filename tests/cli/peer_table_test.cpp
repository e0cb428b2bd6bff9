/// What other tools get wrong, row by row (the awkward-input table of the measured peers): the real binary's
/// exit code, message and output bytes, for PLY and PCD, with the default flow.
#include <chrono>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/support/folder.h"
#include "tests/cli/support/rich_cloud.h"
#include "tests/support/sanitized.h"

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

namespace rfsmooth::test {
namespace {

constexpr std::size_t kTablePoints = 2000;

class PeerTable : public InFolder, public ::testing::WithParamInterface<bool> {
 protected:
  static bool pcd() { return GetParam(); }

  /// Runs denoise on the cloud; returns the bytes it wrote, after checking what must hold of every run.
  std::string denoised(const RichCloud& cloud) {
    const std::string before = cloud.bytes();
    put(cloud.name(), before);
    const Ran ran = run({"denoise", "--force", cloud.name(), cloud.output()});
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_EQ(ran.out, "");
    EXPECT_THAT(ran.err, Not(HasSubstr("error")));
    EXPECT_EQ(take(cloud.name()), before) << "the input is never written";
    std::string after = take(cloud.output());
    EXPECT_EQ(after.size(), before.size());
    after.resize(before.size());
    EXPECT_EQ(after.substr(0, cloud.header().size()), cloud.header());
    for (std::size_t i = 0; i < cloud.size(); ++i)
      EXPECT_EQ(cloud.extras(after, i), cloud.extras(before, i)) << "row " << i;
    return after;
  }
  /// The command must fail with this code and one line that says this; nothing is written.
  void expect_refused(const std::vector<std::string>& arguments, int code,
                      const ::testing::Matcher<std::string>& says) {
    const auto before = names();
    const Ran ran = run(arguments);
    EXPECT_EQ(ran.code, code) << ran.err;
    EXPECT_EQ(ran.out, "");
    EXPECT_THAT(ran.err, says);
    EXPECT_THAT(ran.err, HasSubstr("error: "));
    EXPECT_EQ(names(), before);
  }
  void expect_unchanged(const RichCloud& cloud) { EXPECT_EQ(denoised(cloud), cloud.bytes()); }
};

TEST_P(PeerTable, ExtraFieldsStayBitForBitAndPointsMove) {
  const RichCloud cloud = bumpy(kTablePoints, pcd());
  const std::string before = cloud.bytes(), after = denoised(cloud);
  std::size_t moved = 0;
  for (std::size_t i = 0; i < kTablePoints; ++i) moved += cloud.row(after, i) != cloud.row(before, i);
  EXPECT_GT(moved, kTablePoints / 2);
}

/// Rows with these coordinates stay bit for bit; all others come out as if those rows were not in the file.
void expect_harmless(const RichCloud& all, const std::string& after_all, const RichCloud& good,
                     const std::string& after_good) {
  const std::string before = all.bytes();
  std::size_t g = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!std::isfinite(all.xyz[3 * i] + all.xyz[3 * i + 1] + all.xyz[3 * i + 2])) {
      EXPECT_EQ(all.row(after_all, i), all.row(before, i)) << "row " << i;
      continue;
    }
    EXPECT_EQ(all.row(after_all, i).substr(0, all.coordinate_bytes()),
              good.row(after_good, g).substr(0, all.coordinate_bytes()))
        << "row " << i;
    ++g;
  }
  EXPECT_EQ(g, good.size());
}

TEST_P(PeerTable, HundredNanPointsOfTwoThousandStayAndAreHarmless) {
  RichCloud all = bumpy(kTablePoints, pcd()), good = all;
  good.xyz.clear();
  for (std::size_t i = 0; i < kTablePoints; ++i) {
    if (i % 20 == 3)
      for (std::size_t axis = 0; axis < 3; ++axis) all.xyz[3 * i + (axis + i) % 3] = std::nan("");
    else
      good.xyz.insert(good.xyz.end(), &all.xyz[3 * i], &all.xyz[3 * i] + 3);
  }
  ASSERT_EQ(good.size(), kTablePoints - 100);
  const std::string after = denoised(all);
  expect_harmless(all, after, good, denoised(good));
}

TEST_P(PeerTable, ThreeInfinitePointsStayAndAreHarmless) {
  RichCloud all = bumpy(kTablePoints, pcd()), good = all;
  all.xyz.insert(all.xyz.begin(), {INFINITY, 1, 2});
  all.xyz.insert(all.xyz.begin() + 300, {1, -INFINITY, 2});
  all.xyz.insert(all.xyz.end(), {1, 2, INFINITY});
  const std::string after = denoised(all);
  expect_harmless(all, after, good, denoised(good));
}

TEST_P(PeerTable, UtmCoordinatesInDoubleAreSmoothedAsNearTheOrigin) {
  RichCloud near = bumpy(kTablePoints, pcd(), true);
  const double utm[] = {500000, 4649776, 130};
  RichCloud far = near;
  for (std::size_t i = 0; i < far.xyz.size(); ++i) {
    far.xyz[i] += utm[i % 3];
    near.xyz[i] = far.xyz[i] - utm[i % 3];  // the same rounding
  }
  const std::string after_near = denoised(near), after_far = denoised(far);
  double moved = 0;
  for (std::size_t i = 0; i < kTablePoints; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double is = far.coordinate(after_far, i, axis) - utm[axis];
      EXPECT_NEAR(is, near.coordinate(after_near, i, axis), 1e-7) << "row " << i;
      moved = std::max(moved, std::abs(is - near.xyz[3 * i + axis]));
    }
  EXPECT_GT(moved, 0.01);
}

TEST_P(PeerTable, EmptyFileIsUnreadable) {
  const RichCloud cloud = bumpy(1, pcd());
  put(cloud.name(), "");
  expect_refused({"denoise", cloud.name(), cloud.output()}, 3,
                 AllOf(HasSubstr(cloud.name()), HasSubstr("byte 0"), HasSubstr("expected")));
}

TEST_P(PeerTable, HeaderWithoutPointsHasNothingToClean) {
  const RichCloud cloud = bumpy(0, pcd());
  put(cloud.name(), cloud.bytes());
  expect_refused({"denoise", cloud.name(), cloud.output()}, 4,
                 AllOf(HasSubstr(cloud.name()), HasSubstr("no points")));
}

TEST_P(PeerTable, TruncatedFileNamesTheByte) {
  const RichCloud cloud = bumpy(50, pcd());
  const std::string whole = cloud.bytes();
  put(cloud.name(), whole.substr(0, whole.size() - 30));
  expect_refused(
      {"denoise", cloud.name(), cloud.output()}, 3,
      AllOf(HasSubstr(cloud.name()), HasSubstr("byte"), HasSubstr("expected"), HasSubstr("found")));
}

TEST_P(PeerTable, HeaderThatPromisesFourBillionPointsIsCheckedBeforeAllocating) {
  const RichCloud cloud = bumpy(50, pcd());
  std::string bytes = cloud.bytes();
  const auto promise = [&](const std::string& line) {
    const std::size_t at = bytes.find(line + "50\n");
    ASSERT_NE(at, std::string::npos);
    bytes.replace(at + line.size(), 2, "4000000000");
  };
  if (pcd()) {
    promise("WIDTH ");
    promise("POINTS ");
  } else {
    promise("element vertex ");
  }
  put(cloud.name(), bytes);
  RunSetup setup;
  if (!kSanitized) setup.address_space = std::size_t{1} << 30;
  const Ran ran = run({"denoise", "--threads", "1", cloud.name(), cloud.output()}, setup);
  EXPECT_EQ(ran.code, 3) << ran.err;
  EXPECT_THAT(ran.err, AllOf(HasSubstr("4000000000"), HasSubstr("expected"), HasSubstr("found")));
  EXPECT_THAT(names(), ElementsAre(cloud.name()));
}

TEST_P(PeerTable, OnePointComesBack) {
  RichCloud cloud = bumpy(1, pcd());
  expect_unchanged(cloud);
}

TEST_P(PeerTable, TwoCoincidentPointsComeBack) {
  RichCloud cloud = bumpy(1, pcd());
  cloud.xyz.insert(cloud.xyz.end(), {cloud.xyz[0], cloud.xyz[1], cloud.xyz[2]});
  expect_unchanged(cloud);
}

TEST_P(PeerTable, MisspeltOptionIsAnError) {
  const RichCloud cloud = bumpy(50, pcd());
  put(cloud.name(), cloud.bytes());
  expect_refused({"denoise", "--strenght", "0.5", cloud.name(), cloud.output()}, 2,
                 HasSubstr("did you mean '--strength'?"));
}

TEST_P(PeerTable, ValueThatIsNotANumberIsAnError) {
  const RichCloud cloud = bumpy(50, pcd());
  put(cloud.name(), cloud.bytes());
  expect_refused({"denoise", "--strength", "abc", cloud.name(), cloud.output()}, 2,
                 AllOf(HasSubstr("--strength is 'abc'"), HasSubstr("must be a number")));
}

TEST_P(PeerTable, OutputFolderMissingIsAnError) {
  const RichCloud cloud = bumpy(50, pcd());
  put(cloud.name(), cloud.bytes());
  expect_refused({"denoise", cloud.name(), std::string("no/such/folder/") + cloud.output()}, 5,
                 HasSubstr("no/such/folder"));
}

TEST_P(PeerTable, RegularOpenGridKeepsItsRimAndItsBytes) {
  RichCloud cloud;
  cloud.pcd = pcd();
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) cloud.xyz.insert(cloud.xyz.end(), {i * 0.25, j * 0.25, 1.0});
  expect_unchanged(cloud);
}

INSTANTIATE_TEST_SUITE_P(Files, PeerTable, ::testing::Values(false, true),
                         [](const auto& test) { return test.param ? "Pcd" : "Ply"; });

}  // namespace
}  // namespace rfsmooth::test
