#include "rfsmooth/smoothing/flow.h"

#include <gtest/gtest.h>

#include "support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using rfs_mesh::Mesh;

namespace {

std::vector<std::string_view> names() {
  std::vector<std::string_view> all;
  for (const FlowEntry& entry : flows()) all.push_back(entry.name);
  return all;
}

class EveryFlow : public testing::TestWithParam<std::string_view> {
 protected:
  FlowOptions options() const {
    FlowOptions o;
    o.flow = GetParam();
    return o;
  }
};
INSTANTIATE_TEST_SUITE_P(Flows, EveryFlow, testing::ValuesIn(names()), [](const auto& flow) {
  std::string name(flow.param);
  for (char& c : name)
    if (c == '-') c = '_';
  return name;
});

TEST_P(EveryFlow, ZeroStepsAreTheIdentity) {
  for (Mesh& mesh : support::all_small()) {
    const Positions before = mesh.positions;
    FlowOptions o = options();
    o.iterations = 0;
    ASSERT_TRUE(smooth(mesh, o, {}).ok());
    EXPECT_EQ(mesh.positions, before);
  }
}

TEST_P(EveryFlow, LeavesFinitePositionsOnEveryMesh) {
  for (Mesh& mesh : support::all_small()) {
    const auto run = smooth(mesh, options(), {});
    if (!run.ok()) {
      EXPECT_EQ(run.error().code, ErrorCode::usage) << run.error().message;  // refused, with a reason
      continue;
    }
    for (const auto& p : mesh.positions) ASSERT_TRUE(p.allFinite());
  }
}

TEST_P(EveryFlow, SameBytesForAnyThreadCount) {
  Mesh first = support::icosphere(4);
  support::add_noise(first, 0.01, 1);
  Mesh second = first;
  Context one, four;
  one.threads = 1;
  four.threads = 4;
  ASSERT_TRUE(smooth(first, options(), one).ok());
  ASSERT_TRUE(smooth(second, options(), four).ok());
  EXPECT_EQ(first.positions, second.positions);
}

TEST(Flows, UnknownNameSuggestsTheNearest) {
  const auto result = find_flow("laplcian");
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::usage);
  EXPECT_NE(result.error().message.find("'laplacian'"), std::string::npos);
}

TEST(Flows, AParameterTheFlowDoesNotUseIsAnError) {
  FlowOptions o;
  o.flow = "laplacian";
  o.beta = 0.3;
  const auto result = complete(o);
  ASSERT_FALSE(result.ok());
  EXPECT_NE(result.error().message.find("--beta"), std::string::npos);
}

TEST(Flows, CompleteFillsTheFlowsOwnDefaults) {
  FlowOptions o;
  o.flow = "hc";
  o.beta = 0.7;
  const FlowOptions full = complete(o).value();
  EXPECT_TRUE(full.iterations.has_value());
  EXPECT_EQ(*full.beta, 0.7);
}

TEST(Flows, CancelLeavesTheMesh) {
  Mesh mesh = support::icosphere(3);
  support::add_noise(mesh, 0.01, 1);
  const Positions before = mesh.positions;
  Context context;
  context.progress = [](std::string_view, double fraction) { return fraction < 0.5; };
  const auto result = smooth(mesh, {}, context);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::cancelled);
  EXPECT_EQ(mesh.positions, before);
}

}  // namespace
