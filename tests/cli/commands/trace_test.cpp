// --trace and --paper: what a flow does step by step, and the flow as its paper prints it.
#include <cmath>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/support/folder.h"

using ::testing::HasSubstr;

namespace rfsmooth::test {
namespace {

constexpr const char* kOctahedron =
    "OFF\n6 8 0\n1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n"
    "3 0 2 4\n3 2 1 4\n3 1 3 4\n3 3 0 4\n3 2 0 5\n3 1 2 5\n3 3 1 5\n3 0 3 5\n";

/// The numbers of a trace by row; NaN where a cell is empty.
std::vector<std::vector<double>> rows_of_trace(const std::string& csv) {
  std::istringstream in(csv);
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "step,volume,area,energy,roughness,largest_move");
  std::vector<std::vector<double>> rows;
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');)
      row.push_back(cell.empty() ? std::nan("") : std::stod(cell));
    rows.push_back(row);
  }
  return rows;
}

class Trace : public InFolder {};

// Every vertex's neighbours have their mean in the centre, so a step of one half halves the octahedron.
TEST_F(Trace, OfAnOctahedronThatHalves) {
  put("in.off", kOctahedron);
  const Ran ran = run({"smooth-mesh", "in.off", "out.off", "--flow", "laplacian", "--lambda", "0.5",
                       "--iterations", "2", "--trace", "t.csv"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto rows = rows_of_trace(take("t.csv"));
  ASSERT_EQ(rows.size(), 3u);
  const double turn = 180 - 180 / M_PI * std::acos(-1.0 / 3);
  for (std::size_t k = 0; k < 3; ++k) {
    const double r = std::pow(0.5, double(k));
    const std::vector<double> expected = {
        double(k), 4.0 / 3 * r * r * r, 4 * std::sqrt(3) * r * r, 24 * r * r, turn, k == 0 ? 0 : r};
    for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(rows[k][c], expected[c], 1e-9) << k << " " << c;
  }
}

TEST_F(Trace, OfACloudHasNoVolumeAndSeesTheFlowSettle) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> noise(0, 0.3);
  std::string cloud;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j)
      cloud += std::to_string(i) + " " + std::to_string(j) + " " + std::to_string(noise(engine)) + "\n";
  put("in.xyz", cloud);
  for (const char* flow : {"hc", "auto"}) {
    const Ran ran = run({"denoise", "in.xyz", "out.xyz", "--flow", flow, "--trace", "t.csv", "--force"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    const auto rows = rows_of_trace(take("t.csv"));
    ASSERT_EQ(rows.size(), flow == std::string("hc") ? 11u : 2u);
    EXPECT_TRUE(std::isnan(rows.back()[1]));
    EXPECT_LT(rows.back()[3], 0.5 * rows.front()[3]) << flow << ": the energy falls";
    EXPECT_LT(rows.back()[4], rows.front()[4]) << flow << ": it gets smoother";
  }
}

TEST_F(Trace, IsForOneInputAndReplacesNothing) {
  put("a.off", kOctahedron);
  put("b.off", kOctahedron);
  put("t.csv", "mine");
  Ran ran = run({"smooth-mesh", "a.off", "b.off", "-o", "out", "--trace", "u.csv"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err, HasSubstr("one input"));
  ran = run({"smooth-mesh", "a.off", "out.off", "--flow", "hc", "--trace", "t.csv"});
  EXPECT_NE(ran.code, 0);
  EXPECT_THAT(ran.err, HasSubstr("t.csv"));
  EXPECT_EQ(take("t.csv"), "mine");
  EXPECT_FALSE(there("out.off"));
}

TEST_F(Trace, PaperIsThePrintedSchemeAndIsRefusedForWhatIsInNoPaper) {
  put("in.off", kOctahedron);
  const auto result = [&](const std::string& flow, const std::vector<std::string>& scheme) {
    std::vector<std::string> words = {"smooth-mesh", "in.off", "out.off",  "--force",
                                      "--flow",      flow,     "--report", "r.json"};
    words.insert(words.end(), scheme.begin(), scheme.end());
    const Ran ran = run(words);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return take("out.off");
  };
  for (const char* flow : {"curvature", "median-direction", "local-directional"}) {
    const std::string printed = result(flow, {"--paper"});
    EXPECT_THAT(take("r.json"), HasSubstr("\"paper\": true"));
    EXPECT_EQ(printed, result(flow, {"--scheme", "printed"}));
    EXPECT_NE(printed, result(flow, {})) << flow << ": a third of the step";
  }
  EXPECT_EQ(result("hc", {"--paper"}), result("hc", {})) << "hc is printed as it is";
  const Ran ran = run({"smooth-mesh", "in.off", "out.off", "--force", "--paper"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err, HasSubstr("'auto' is in no paper"));
}

}  // namespace
}  // namespace rfsmooth::test
