#include <algorithm>
#include <map>
#include <typeinfo>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rfsmooth/flow.h>

#include "smoothing/automatic/flow_auto.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using rfsmooth::Mesh;

namespace {

class EveryFlow : public testing::TestWithParam<AnyFlow> {
 protected:
  static FlowOptions options() { return {GetParam()}; }

  /// With every solve down to rounding, so that what is left over is not the solver's tolerance.
  static FlowOptions exact_options() {
    FlowOptions o = options();
    FlowOptions::describe(o, [](const OptionInfo& info, auto& value) {
      if constexpr (std::is_same_v<decltype(value), double&>)
        if (info.name == "tolerance") value = 1e-12;
    });
    return o;
  }

  /// Of the move: what rounding may change. The automatic flow sums its quadrics in single precision.
  static double rounding() { return name_of(GetParam()) == "auto" ? 1e-5 : 1e-8; }
};
INSTANTIATE_TEST_SUITE_P(Flows, EveryFlow, testing::ValuesIn(flows()), [](const auto& flow) {
  std::string name(name_of(flow.param));
  for (char& c : name)
    if (c == '-') c = '_';
  return name;
});

TEST_P(EveryFlow, ZeroStepsAreTheIdentity) {
  for (Mesh& mesh : support::all_small()) {
    const Positions before = mesh.positions;
    FlowOptions o = options();
    iterations(o.flow) = 0;
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

TEST_P(EveryFlow, SameBytesForAnyNumberOfThreads) {
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

/// By vertex: how many edges it is away from `from`.
std::vector<int> rings_around(const Mesh& mesh, Index from) {
  std::vector<int> ring(mesh.positions.size(), -1);
  std::vector<Index> reached = {from};
  ring[from] = 0;
  for (std::size_t k = 0; k < reached.size(); ++k)
    for (const Index j : mesh.one_ring[reached[k]])
      if (ring[j] < 0) {
        ring[j] = ring[reached[k]] + 1;
        reached.push_back(j);
      }
  return ring;
}

TEST_P(EveryFlow, HasNoVertexBeyondItsSupportInItsSay) {
  constexpr Index kMoved = 100;
  for (const bool push_back : {false, true}) {
    FlowOptions o = options();
    iterations(o.flow) = 2;
    o.modifiers.push_back = push_back;
    const auto support = support_rings(o);
    if (!support) continue;
    Mesh before = support::icosphere(4);
    support::add_noise(before, 0.01, 1);
    Mesh after = before;
    after.positions[kMoved] *= 1.1;
    ASSERT_TRUE(smooth(before, o, {}).ok());
    ASSERT_TRUE(smooth(after, o, {}).ok());
    const std::vector<int> ring = rings_around(before, kMoved);
    int farthest = 0;
    for (std::size_t i = 0; i < ring.size(); ++i)
      if (before.positions[i] != after.positions[i]) farthest = std::max(farthest, ring[i]);
    EXPECT_EQ(farthest, *support) << "push-back " << push_back;
  }
}

TEST(SupportRings, AreNotSaidWhereAnyVertexMayHaveASay) {
  EXPECT_EQ(support_rings({HcOptions()}), 20);
  HcOptions in_order;
  in_order.update = Update::sequential;
  EXPECT_EQ(support_rings({in_order}), std::nullopt);
  EXPECT_EQ(support_rings({AutomaticOptions()}), std::nullopt);
  EXPECT_EQ(support_rings({ImplicitOptions()}), std::nullopt);
  FlowOptions kept = {TaubinOptions()};
  kept.modifiers.preserve = Preserve::area;
  EXPECT_EQ(support_rings(kept), std::nullopt);
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

TEST(AutomaticFlow, UsingUpTheMeshGivesThePositionsThatKeepingItGives) {
  Mesh kept = lumpy(), used_up = kept;
  const auto report = smooth_automatically(kept, {}, {});
  ASSERT_TRUE(report.has_value());
  EXPECT_GT(report->noise, 0);
  ASSERT_TRUE(smooth_automatically(used_up, {}, {}, Connectivity::used_up).has_value());
  EXPECT_EQ(kept.positions, used_up.positions);
  EXPECT_TRUE(check(kept).empty());
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
  if (name_of(o.flow) == "hc-limit") {
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
  for (const Preserve preserve : {Preserve::none, Preserve::volume, Preserve::area, Preserve::height_field})
    for (const ThresholdKind threshold :
         {ThresholdKind::none, ThresholdKind::constant, ThresholdKind::two_ring})
      for (const bool push_back : {false, true}) {
        Mesh mesh = lumpy();
        const double volume = support::enclosed_volume(mesh);
        FlowOptions o = options();
        iterations(o.flow) = 2;
        o.modifiers.preserve = preserve;
        o.modifiers.threshold = threshold;
        if (threshold == ThresholdKind::constant) o.modifiers.threshold_value = 0.01;
        o.modifiers.push_back = push_back;
        ASSERT_TRUE(smooth(mesh, o, {}).ok());
        for (const auto& p : mesh.positions) ASSERT_TRUE(p.allFinite());
        if (preserve == Preserve::volume) {
          EXPECT_NEAR(support::enclosed_volume(mesh) / volume, 1, 1e-12);
        }
      }
}

TEST_P(EveryFlow, EveryBoundaryRuleWorks) {
  for (const Boundary rule : {Boundary::free, Boundary::fixed, Boundary::curve, Boundary::virtual_vertices}) {
    Mesh mesh = support::cylinder(24, 8, 0.25);
    support::add_noise(mesh, 0.02, 3);
    const Positions before = mesh.positions;
    FlowOptions o = options();
    o.modifiers.boundary = rule;
    ASSERT_TRUE(smooth(mesh, o, {}).ok());
    for (const auto& p : mesh.positions) ASSERT_TRUE(p.allFinite());
    if (rule == Boundary::fixed) {
      for (std::size_t i = 0; i < 24; ++i) EXPECT_EQ(mesh.positions[i], before[i]);
    }
  }
}

TEST_P(EveryFlow, IsFoundByItsNameAndOptionsOutOfRangeAreNamed) {
  EXPECT_EQ(find_flow(name_of(GetParam())).value().index(), GetParam().index());
  Mesh mesh = lumpy();
  const Positions before = mesh.positions;
  FlowOptions o = options();
  iterations(o.flow) = -1;
  const auto result = smooth(mesh, o, {});
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::usage);
  EXPECT_NE(result.error().message.find("`iterations` is -1"), std::string::npos);
  EXPECT_EQ(mesh.positions, before);
}

/// What a table says of an option, as text.
using Table = std::map<std::string_view, std::string>;
struct Collect {
  Table& table;
  template <class T>
  void operator()(const OptionInfo& info, const T&) const {
    table[info.name] = fmt::format("{} {} {} {} {} {}", info.help, info.unit, info.min, info.max,
                                   fmt::join(info.choices, ","), typeid(T).name());
  }
};

TEST(Flows, OptionsOfOneNameMeanTheSameInEveryFlow) {
  Table all;
  for (const AnyFlow& flow : flows()) {
    Table own;
    const FlowOptions options{flow};
    FlowOptions::describe(options, Collect{own});
    ASSERT_GT(own.size(), 8u) << name_of(flow);
    for (const auto& [name, text] : own)
      EXPECT_EQ(all.emplace(name, text).first->second, text) << name << " of " << name_of(flow);
  }
}

TEST(Flows, AnUnknownNameIsAnErrorThatSaysTheNames) {
  const auto result = find_flow("laplcian");
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::usage);
  for (const AnyFlow& flow : flows())
    EXPECT_NE(result.error().message.find(name_of(flow)), std::string::npos) << name_of(flow);
}

TEST(Flows, AnEnumerationsValueWithoutAWordIsAnError) {
  ImplicitOptions o;
  o.op = OperatorKind::curvature_normalised;
  const auto result = validate(FlowOptions{o});
  ASSERT_FALSE(result.ok());
  EXPECT_NE(result.error().message.find("`operator`"), std::string::npos);
}

TEST(Flows, AnOptionWithoutItsPartnerIsAnErrorThatNamesThePartner) {
  struct Case {
    FlowOptions options;
    const char* option;
    const char* partner;
  };
  std::vector<Case> cases;
  const auto refused = [&](const char* option, const char* partner, const FlowOptions& options) {
    cases.push_back({options, option, partner});
  };
  const auto with_modifiers = [](const auto& set) {
    FlowOptions options{HcOptions()};
    set(options.modifiers);
    return options;
  };
  LaplacianOptions laplacian;
  laplacian.alpha = 0.4;
  refused("`alpha`", "`anchor`", {laplacian});
  DirectionalOptions directional;
  directional.direction = Eigen::Vector3d(0, 0, 1);
  directional.power = 1;
  refused("`power`", "`direction` auto", {directional});
  refused("`push-alpha`", "`push-back`", with_modifiers([](Modifiers& m) { m.push_alpha = 0.1; }));
  refused("`push-beta`", "`push-back`", with_modifiers([](Modifiers& m) { m.push_beta = 0.7; }));
  refused("`threshold-value`", "`threshold` constant",
          with_modifiers([](Modifiers& m) { m.threshold_value = 0.2; }));
  refused("`threshold-value`", "`threshold` constant", with_modifiers([](Modifiers& m) {
            m.threshold_value = 0.2;
            m.threshold = ThresholdKind::one_ring;
          }));
  refused("`threshold-every`", "`threshold` one-ring", with_modifiers([](Modifiers& m) {
            m.threshold_every = 6;
            m.threshold = ThresholdKind::constant;
          }));
  Mesh mesh = lumpy();
  for (const Case& c : cases) {
    const auto result = smooth(mesh, c.options, {});
    ASSERT_FALSE(result.ok()) << c.option;
    EXPECT_EQ(result.error().code, ErrorCode::usage);
    for (const char* word : {c.option, c.partner})
      EXPECT_NE(result.error().message.find(word), std::string::npos) << result.error().message;
  }
}

TEST_P(EveryFlow, ItsDefaultsAreValid) {
  const auto result = validate(options());
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().message);
}

TEST(Flows, ReportOneStageFromNothingToTheEnd) {
  Mesh mesh = support::icosphere(2);
  std::vector<double> shares;
  Context context;
  context.progress = [&](std::string_view stage, double fraction) {
    EXPECT_EQ(stage, "smooth");
    shares.push_back(fraction);
    return true;
  };
  FlowOptions options{HcOptions{}};
  iterations(options.flow) = 4;
  ASSERT_TRUE(smooth(mesh, options, context).ok());
  EXPECT_EQ(shares, (std::vector<double>{0, 0.25, 0.5, 0.75, 1}));
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
