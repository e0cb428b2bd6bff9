#include <algorithm>
#include <functional>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <rfsmooth/flow.h>

#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using rfsmooth::Mesh;

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

  /// With every solve down to rounding, so that what is left over is not the solver's tolerance.
  FlowOptions exact_options() const {
    FlowOptions o = options();
    const auto& used = find_flow(o.flow).value()->parameters;
    if (std::find(used.begin(), used.end(), "tolerance") != used.end()) o.tolerance = 1e-12;
    return o;
  }

  /// Of the move: what rounding may change. The automatic flow sums its quadrics in single precision.
  double rounding() const { return options().flow == "auto" ? 1e-5 : 1e-8; }
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
    const auto run = smooth(mesh, o, {});
    if (!run.ok()) {
      EXPECT_EQ(run.error().code, ErrorCode::usage) << run.error().message;
    }
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

/// A lumpy closed mesh: nothing symmetric, every flow moves it.
Mesh lumpy() {
  Mesh mesh = support::torus(24, 12, 0.4);
  support::add_noise(mesh, 0.02, 7);
  for (Eigen::Vector3d& p : mesh.positions) p.x() += 0.2 * p.y() * p.y() + 0.1 * p.z();
  return mesh;
}

/// rms of |b_i - f(a_i)| in units of the rms move from `start` to `a`.
template <class Map>
double disagreement(const Positions& start, const Positions& a, const Positions& b, Map&& map, double scale) {
  Positions mapped = a;
  for (Eigen::Vector3d& p : mapped) p = map(p);
  const double move = support::rms_distance(start, a);
  return support::rms_distance(mapped, b) / (scale * std::max(move, 1e-9));
}

TEST_P(EveryFlow, TheLastStepGivesThePositionsOfAnyOther) {
  Mesh mesh = lumpy(), last = mesh;
  const auto flow = make_flow(mesh, options(), {}), other = make_flow(last, options(), {});
  ASSERT_TRUE(flow.ok() && other.ok());
  flow.value()->step(mesh, {});
  other.value()->last_step(last, {});
  EXPECT_EQ(mesh.positions, last.positions);
}

TEST_P(EveryFlow, MovesSomething) {
  Mesh mesh = lumpy();
  const Positions before = mesh.positions;
  ASSERT_TRUE(smooth(mesh, options(), {}).ok());
  EXPECT_GT(support::rms_distance(before, mesh.positions), 1e-5);
}

TEST_P(EveryFlow, CommutesWithRigidMotion) {
  Mesh mesh = lumpy();
  const Positions start = mesh.positions;
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  const auto motion = [&](const Eigen::Vector3d& p) {
    return Eigen::Vector3d(R * p + Eigen::Vector3d(3, -1, 2));
  };
  Mesh moved = mesh;
  for (Eigen::Vector3d& p : moved.positions) p = motion(p);
  ASSERT_TRUE(smooth(mesh, exact_options(), {}).ok());
  ASSERT_TRUE(smooth(moved, exact_options(), {}).ok());
  EXPECT_LT(disagreement(start, mesh.positions, moved.positions, motion, 1), rounding());
}

TEST_P(EveryFlow, CommutesWithUniformScale) {
  for (const double scale : {1e-6, 1e6}) {
    Mesh mesh = lumpy();
    const Positions start = mesh.positions;
    Mesh scaled = mesh;
    for (Eigen::Vector3d& p : scaled.positions) p *= scale;
    ASSERT_TRUE(smooth(mesh, exact_options(), {}).ok());
    ASSERT_TRUE(smooth(scaled, exact_options(), {}).ok());
    EXPECT_LT(disagreement(
                  start, mesh.positions, scaled.positions,
                  [&](const Eigen::Vector3d& p) { return Eigen::Vector3d(scale * p); }, scale),
              rounding());
  }
}

TEST_P(EveryFlow, CommutesWithPermutation) {
  Mesh mesh = lumpy();
  const auto n = Index(mesh.positions.size());
  std::vector<Index> place(n);
  for (Index i = 0; i < n; ++i) place[i] = Index((i * 13ull + 5) % n);  // 13 and n = 288 share no factor
  Mesh permuted = support::permuted(mesh, place);
  const Positions start = mesh.positions;
  ASSERT_TRUE(smooth(mesh, exact_options(), {}).ok());
  ASSERT_TRUE(smooth(permuted, exact_options(), {}).ok());
  Positions back(n);
  for (Index i = 0; i < n; ++i) back[i] = permuted.positions[place[i]];
  EXPECT_LT(disagreement(
                start, mesh.positions, back, [](const Eigen::Vector3d& p) { return p; }, 1),
            rounding());
}

TEST_P(EveryFlow, HardConstraintsHold) {
  Mesh mesh = lumpy();
  const Positions before = mesh.positions;
  const Eigen::Vector3d direction(1, 2, -2);
  const Constraints constraints{{{3, HardConstraint::Kind::fixed, Eigen::Vector3d::Zero()},
                                 {50, HardConstraint::Kind::axis, direction},
                                 {90, HardConstraint::Kind::plane, direction}},
                                {}};
  FlowOptions o = options();
  if (o.flow == "hc-limit") {
    EXPECT_FALSE(smooth(mesh, o, {}, constraints).ok()) << "axes and planes are refused";
    return;
  }
  ASSERT_TRUE(smooth(mesh, o, {}, constraints).ok());
  EXPECT_EQ(mesh.positions[3], before[3]);
  EXPECT_LT((mesh.positions[50] - before[50]).cross(direction).norm(), 1e-14);
  EXPECT_LT(std::abs((mesh.positions[90] - before[90]).dot(direction)), 1e-14);
}

TEST_P(EveryFlow, StrengthZeroStaysAndOneIsTheFreeFlow) {
  Mesh free = lumpy(), ones = free, zeros = free;
  const std::size_t n = free.positions.size();
  const Positions before = free.positions;
  ASSERT_TRUE(smooth(free, options(), {}).ok());
  ASSERT_TRUE(smooth(ones, options(), {}, {{}, std::vector<double>(n, 1)}).ok());
  ASSERT_TRUE(smooth(zeros, options(), {}, {{}, std::vector<double>(n, 0)}).ok());
  EXPECT_LT(support::rms_distance(free.positions, ones.positions), 1e-12);
  EXPECT_EQ(zeros.positions, before);
}

TEST_P(EveryFlow, EveryModifierWorks) {
  for (const char* preserve : {"none", "volume", "area", "height-field"})
    for (const char* threshold : {"none", "constant", "two-ring"})
      for (const bool push_back : {false, true}) {
        Mesh mesh = lumpy();
        const double volume = support::enclosed_volume(mesh);
        FlowOptions o = options();
        o.iterations = 2;
        o.preserve = preserve;
        o.threshold = threshold;
        if (o.threshold == "constant") o.threshold_value = 0.01;
        o.push_back = push_back;
        ASSERT_TRUE(smooth(mesh, o, {}).ok());
        for (const auto& p : mesh.positions) ASSERT_TRUE(p.allFinite());
        if (o.preserve == "volume") {
          EXPECT_NEAR(support::enclosed_volume(mesh) / volume, 1, 1e-12);
        }
      }
}

TEST_P(EveryFlow, EveryBoundaryRuleWorks) {
  for (const char* rule : {"free", "fixed", "curve", "virtual"}) {
    Mesh mesh = support::cylinder(24, 8, 0.25);
    support::add_noise(mesh, 0.02, 3);
    const Positions before = mesh.positions;
    FlowOptions o = options();
    o.boundary = rule;
    ASSERT_TRUE(smooth(mesh, o, {}).ok());
    for (const auto& p : mesh.positions) ASSERT_TRUE(p.allFinite());
    if (o.boundary == "fixed") {
      for (std::size_t i = 0; i < 24; ++i) EXPECT_EQ(mesh.positions[i], before[i]);
    }
  }
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

TEST(Flows, AnOptionWithoutItsPartnerIsAnErrorThatNamesThePartner) {
  struct Case {
    const char* flow;
    std::function<void(FlowOptions&)> set;
    const char* option;
    const char* partner;
  };
  const std::vector<Case> cases = {
      {"laplacian", [](FlowOptions& o) { o.alpha = 0.5; }, "--alpha", "--anchor"},
      {"directional", [](FlowOptions& o) { o.direction = "0,0,1", o.power = 1; }, "--power",
       "--direction auto"},
      {"hc", [](FlowOptions& o) { o.push_alpha = 0.1; }, "--push-alpha", "--push-back"},
      {"hc", [](FlowOptions& o) { o.push_beta = 0.6; }, "--push-beta", "--push-back"},
      {"hc", [](FlowOptions& o) { o.threshold_value = 0.1; }, "--threshold-value", "--threshold constant"},
      {"hc", [](FlowOptions& o) { o.threshold_value = 0.1, o.threshold = "one-ring"; }, "--threshold-value",
       "--threshold constant"},
      {"hc", [](FlowOptions& o) { o.threshold_every = 5, o.threshold = "constant"; }, "--threshold-every",
       "--threshold one-ring"},
  };
  for (const Case& c : cases) {
    FlowOptions o;
    o.flow = c.flow;
    c.set(o);
    const auto result = complete(o);
    ASSERT_FALSE(result.ok()) << c.option;
    EXPECT_EQ(result.error().code, ErrorCode::usage);
    for (const char* word : {c.option, c.partner})
      EXPECT_NE(result.error().message.find(word), std::string::npos) << result.error().message;
  }
}

TEST_P(EveryFlow, CompleteOptionsAreComplete) {
  const FlowOptions once = complete(options()).value();
  EXPECT_TRUE(complete(once).ok()) << complete(once).error().message;
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
