/// rfsmooth report and denoise --html: the page as a file. What it does in a browser: tests/page.
#include <cmath>
#include <limits>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/support/folder.h"
#include "tests/cli/support/rich_cloud.h"
#include "tests/cli/support/small_clouds.h"

using ::testing::HasSubstr;
using ::testing::Not;

namespace rfsmooth::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

class ReportPage : public InFolder {
 protected:
  /// The page of two clouds.
  std::string page(const BinaryPly& before, const BinaryPly& after, std::vector<std::string> options = {}) {
    put("before.ply", before.bytes());
    put("after.ply", after.bytes());
    options.insert(options.begin(), {"report", "before.ply", "after.ply", "-o", "r.html", "--force"});
    const Ran ran = run(options);
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_EQ(ran.out, "");
    return take("r.html");
  }
  /// The sum of the counts of the histogram's bars.
  static std::size_t counted(const std::string& page) {
    static const std::regex kCount("data-count=\"([0-9]+)\"");
    std::size_t sum = 0;
    for (std::sregex_iterator it(page.begin(), page.end(), kCount), end; it != end; ++it)
      sum += std::stoul((*it)[1]);
    return sum;
  }
  /// What the table of figures says.
  static std::string figure(const std::string& page, const std::string& name) {
    std::smatch found;
    return std::regex_search(page, found, std::regex("<th>" + name + "</th><td>([^<]*)</td>"))
               ? found[1].str()
               : "nothing";
  }
};

/// The plane, flat.
BinaryPly flattened(BinaryPly cloud) {
  for (std::size_t i = 2; i < cloud.xyz.size(); i += 3) cloud.xyz[i] = 0;
  return cloud;
}

TEST_F(ReportPage, IsNotForStandardOutput) {
  put("in.ply", noisy_plane(10).bytes());
  const Ran ran = run({"report", "in.ply", "in.ply", "-o", "-"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err, HasSubstr("does not take the page"));
  EXPECT_FALSE(there("-"));
}

TEST_F(ReportPage, TheCountsOfItsHistogramSumToTheFinitePoints) {
  BinaryPly before = noisy_plane(20);
  const BinaryPly clean = flattened(before);
  EXPECT_EQ(counted(page(before, clean)), 400u);
  EXPECT_EQ(counted(page(before, before)), 400u) << "no difference";
  EXPECT_EQ(counted(page(before, clean, {"--points", "100"})), 400u) << "of all, not of those shown";
  BinaryPly after = clean;
  before.xyz[0] = after.xyz[0] = kNan;
  after.xyz[3] = kNan;
  const std::string holes = page(before, after);
  EXPECT_EQ(counted(holes), 398u);
  EXPECT_EQ(figure(holes, "points"), "400");
  EXPECT_EQ(figure(holes, "not finite"), "1");
  EXPECT_EQ(figure(holes, "removed"), "1");
}

TEST_F(ReportPage, ShowsAsManyPointsAsAreAskedFor) {
  const BinaryPly before = noisy_plane(32), after = flattened(before);
  EXPECT_EQ(figure(page(before, after), "points in this page"), "1024");
  EXPECT_EQ(figure(page(before, after, {"--points", "all"}), "points in this page"), "1024");
  EXPECT_EQ(figure(page(before, after, {"--points", "1000"}), "points in this page"), "1000");
  EXPECT_EQ(figure(page(before, after, {"--points", "1"}), "points in this page"), "1");
  for (const char* wrong : {"0", "-3", "many", "1.5", ""})
    EXPECT_EQ(run({"report", "before.ply", "after.ply", "-o", "n.html", "--points", wrong}).code, 2) << wrong;
  EXPECT_FALSE(there("n.html"));
}

TEST_F(ReportPage, FiguresAreThoseOfTheClouds) {
  const BinaryPly before = noisy_plane(30);
  BinaryPly after = before;
  after.xyz[5] += 3;  // row 1
  after.xyz[6] += 4;  // row 2
  const std::string made = page(before, after);
  EXPECT_EQ(figure(made, "moved"), "2");
  EXPECT_EQ(figure(made, "largest move"), "4");
  EXPECT_EQ(figure(made, "median move"), "0");
  EXPECT_EQ(figure(made, "rms of moves"), "0.1667") << "5 / 30";
}

TEST_F(ReportPage, CloudsOfDifferentSizeAreRefused) {
  put("a.ply", noisy_plane(5).bytes());
  put("b.ply", noisy_plane(6).bytes());
  const Ran ran = run({"report", "a.ply", "b.ply", "-o", "r.html"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err, HasSubstr("a.ply has 25 points and b.ply has 36"));
  EXPECT_FALSE(there("r.html"));
}

TEST_F(ReportPage, OfCloudsWithoutAFinitePointNamesTheFile) {
  put("none.xyz", "nan nan nan\n1 nan 2\n");
  const Ran ran = run({"report", "none.xyz", "none.xyz", "-o", "none.html"});
  EXPECT_EQ(ran.code, 4) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("error: none.xyz: "));
  EXPECT_FALSE(there("none.html"));
}

TEST_F(ReportPage, KeepsTheContractsOfTheCommand) {
  put("a.ply", noisy_plane(5).bytes());
  put("r.html", "mine");
  EXPECT_EQ(run({"report", "a.ply", "a.ply", "-o", "r.html"}).code, 5);
  EXPECT_EQ(take("r.html"), "mine");
  EXPECT_EQ(run({"report", "a.ply", "a.ply", "-o", "a.ply", "--force"}).code, 5) << "a cloud stays";
  EXPECT_EQ(run({"report", "a.ply", "-o", "n.html"}).code, 2);
  EXPECT_EQ(run({"report", "a.ply", "a.ply"}).code, 2);
  EXPECT_EQ(run({"report", "a.ply", "none.ply", "-o", "n.html"}).code, 3);
  EXPECT_EQ(run({"report", "a.ply", "a.ply", "-o", "no/n.html"}).code, 5);
  BinaryPly nothing;
  nothing.xyz = {kNan, kNan, kNan};
  put("nan.ply", nothing.bytes());
  EXPECT_EQ(run({"report", "nan.ply", "nan.ply", "-o", "n.html"}).code, 4);
  EXPECT_FALSE(there("n.html"));
}

TEST_F(ReportPage, IsTheSameForAnyNumberOfThreads) {
  const BinaryPly before = noisy_plane(100), after = flattened(before);
  const std::regex command("<pre id=\"command\">[^<]*</pre>");
  const std::string one = std::regex_replace(page(before, after, {"--threads", "1"}), command, "");
  EXPECT_GT(one.size(), 20000u);
  EXPECT_TRUE(one == std::regex_replace(page(before, after, {"--threads", "3"}), command, ""));
}

TEST_F(ReportPage, CarriesTheCommandThatMakesItAgain) {
  put("it's a scan.ply", noisy_plane(5).bytes());
  ASSERT_EQ(run({"report", "it's a scan.ply", "it's a scan.ply", "-o", "r.html", "--points=7"}).code, 0);
  EXPECT_THAT(
      take("r.html"),
      HasSubstr("<pre id=\"command\">rfsmooth report --output=r.html --points=7 "
                "&#39;it&#39;\\&#39;&#39;s a scan.ply&#39; &#39;it&#39;\\&#39;&#39;s a scan.ply&#39;</pre>"));
}

TEST_F(ReportPage, AMillionPointsTakeLessThanTenMegabytes) {
  // A tenth of them, as denoise leaves them: bumpy with noise of a third of their spacing.
  put("in.ply", bumpy(100000, false).bytes());
  ASSERT_EQ(run({"denoise", "in.ply", "out.ply", "--flow", "hc"}).code, 0);
  BinaryPly before, after;  // without the colours that bumpy() makes up
  const auto positions_of = [&](const std::string& name, BinaryPly& cloud) {
    const RichCloud layout = bumpy(100000, false);
    const std::string file = take(name);
    for (std::size_t i = 0; i < layout.size(); ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        cloud.xyz.push_back(float(layout.coordinate(file, i, axis)));
  };
  positions_of("in.ply", before);
  positions_of("out.ply", after);
  EXPECT_LT(page(before, after, {"--points", "all"}).size(), 1000000u);
}

TEST_F(ReportPage, ComesFromDenoiseToo) {
  put("in.ply", noisy_plane(40).bytes());
  const Ran ran = run({"denoise", "in.ply", "out.ply", "--html", "r.html"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const std::string made = take("r.html");
  EXPECT_EQ(counted(made), 1600u);
  EXPECT_NE(figure(made, "noise"), "nothing");
  EXPECT_THAT(made, HasSubstr("rfsmooth denoise --html=r.html in.ply out.ply"));
  EXPECT_EQ(run({"denoise", "in.ply", "out2.ply"}).code, 0);
  EXPECT_TRUE(take("out.ply") == take("out2.ply")) << "the page changes nothing";
  EXPECT_EQ(run({"denoise", "in.ply", "out3.ply", "--html", "r.html"}).code, 5) << "before any work";
  EXPECT_FALSE(there("out3.ply"));
  EXPECT_EQ(run({"denoise", "in.ply", "out.ply", "-o", "folder", "--html", "n.html"}).code, 2);
  EXPECT_FALSE(there("n.html"));
}

TEST_F(ReportPage, OfDenoiseShowsWhatItRemoved) {
  BinaryPly cloud = noisy_plane(40);
  cloud.xyz.insert(cloud.xyz.end(), {20, 20, 15, 5, 30, -12});
  put("in.ply", cloud.bytes());
  const Ran ran = run({"denoise", "--outliers", "remove", "in.ply", "out.ply", "--html", "r.html"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const std::string made = take("r.html");
  EXPECT_EQ(figure(made, "points"), "1602");
  EXPECT_EQ(figure(made, "removed"), "2");
  EXPECT_EQ(counted(made), 1600u);
}

}  // namespace
}  // namespace rfsmooth::test
