// What the modifiers (threshold, push-back, invariants, boundary rules) keep of the flows' properties.
#include <cmath>
#include <functional>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <rfsmooth/flow.h>

#include "tests/support/meshes.h"

using namespace rfsmooth;
using Eigen::Vector3d;
using rfsmooth::Mesh;

namespace {

struct Modifier {
  const char* name;
  Modifiers modifiers;
  bool turns;  ///< commutes with rotations
};

std::vector<Modifier> all_modifiers() {
  std::vector<Modifier> all;
  const auto add = [&](const char* name, bool turns, const auto& set) {
    Modifiers modifiers;
    set(modifiers);
    all.push_back({name, modifiers, turns});
  };
  const auto add_threshold = [&](const char* name, ThresholdKind kind) {
    add(name, true, [kind](Modifiers& m) {
      m.threshold = kind;
      if (kind == ThresholdKind::constant)
        m.threshold_value = 0.02;
      else
        m.threshold_every = 2;
    });
  };
  const auto add_boundary = [&](const char* name, Boundary rule) {
    add(name, true, [rule](Modifiers& m) { m.boundary = rule; });
  };
  add("push_back", true, [](Modifiers& m) { m.push_back = true; });
  add_threshold("constant", ThresholdKind::constant);
  add_threshold("one-ring", ThresholdKind::one_ring);
  add_threshold("two-ring", ThresholdKind::two_ring);
  add("area", true, [](Modifiers& m) { m.preserve = Preserve::area; });
  add("height-field", false, [](Modifiers& m) { m.preserve = Preserve::height_field; });
  add_boundary("fixed", Boundary::fixed);
  add_boundary("curve", Boundary::curve);
  add_boundary("virtual", Boundary::virtual_vertices);
  return all;
}

class EveryModifier : public testing::TestWithParam<Modifier> {
 protected:
  FlowOptions options() const {
    LaplacianOptions laplacian;
    laplacian.iterations = 6;
    laplacian.lambda = 0.5;
    return {laplacian, GetParam().modifiers};
  }
};
INSTANTIATE_TEST_SUITE_P(Modifiers, EveryModifier, testing::ValuesIn(all_modifiers()),
                         [](const auto& modifier) {
                           std::string name(modifier.param.name);
                           for (char& c : name)
                             if (c == '-') c = '_';
                           return name;
                         });

/// An open tube, rough and not symmetric; above z = 0, so that it has a volume under it.
Mesh tube() {
  Mesh mesh = support::cylinder(24, 9, 0.25);
  support::add_noise(mesh, 0.03, 7);
  for (Vector3d& p : mesh.positions) p += Vector3d(0.2 * p.y() * p.y(), 0.1 * p.z(), 5);
  return mesh;
}

/// rms of |b_i - f(a_i)| in units of the rms move from `start` to `a`.
double disagreement(const Positions& start, const Positions& a, const Positions& b,
                    const std::function<Vector3d(const Vector3d&)>& f, double scale) {
  Positions mapped = a;
  for (Vector3d& p : mapped) p = f(p);
  return support::rms_distance(mapped, b) / (scale * support::rms_distance(start, a));
}

TEST_P(EveryModifier, CommutesWithScaleAndRigidMotion) {
  const Mesh start = tube();
  Mesh here = start;
  ASSERT_TRUE(smooth(here, options(), {}).ok());
  ASSERT_GT(support::rms_distance(start.positions, here.positions), 1e-3);
  const auto check = [&](const std::function<Vector3d(const Vector3d&)>& f, double scale) {
    Mesh there = start;
    for (Vector3d& p : there.positions) p = f(p);
    ASSERT_TRUE(smooth(there, options(), {}).ok());
    EXPECT_LT(disagreement(start.positions, here.positions, there.positions, f, scale), 1e-8);
  };
  for (const double scale : {1e-6, 1e6})
    check([scale](const Vector3d& p) { return Vector3d(scale * p); }, scale);
  if (!GetParam().turns) return;
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.7, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  check([&](const Vector3d& p) { return Vector3d(R * p + Vector3d(3, -1, 2)); }, 1);
}

TEST_P(EveryModifier, CommutesWithPermutation) {
  Mesh mesh = tube();
  const auto n = Index(mesh.positions.size());
  std::vector<Index> place(n);
  for (Index i = 0; i < n; ++i) place[i] = Index((i * 13ull + 5) % n);  // 13 and n = 216 share no factor
  Mesh permuted = support::permuted(mesh, place);
  const Positions start = mesh.positions;
  ASSERT_TRUE(smooth(mesh, options(), {}).ok());
  ASSERT_TRUE(smooth(permuted, options(), {}).ok());
  Positions back(n);
  for (Index i = 0; i < n; ++i) back[i] = permuted.positions[place[i]];
  EXPECT_LT(disagreement(
                start, mesh.positions, back, [](const Vector3d& p) { return p; }, 1),
            1e-8);
}

TEST_P(EveryModifier, ConstrainedVerticesStayExactlyWhereTheyMustUnderEveryFlow) {
  const Vector3d direction(1, 2, -2);
  const Constraints constraints{{{3, HardConstraint::Kind::fixed, Vector3d::Zero()},
                                 {100, HardConstraint::Kind::fixed, Vector3d::Zero()},
                                 {101, HardConstraint::Kind::axis, direction},
                                 {102, HardConstraint::Kind::plane, direction}},
                                {}};
  int ran = 0;
  for (AnyFlow flow : flows()) {
    Mesh mesh = tube();
    const Positions before = mesh.positions;
    iterations(flow) = 2;
    if (!smooth(mesh, {flow, GetParam().modifiers}, {}, constraints).ok())
      continue;  // refused with a reason; see flow_test.cpp
    ++ran;
    EXPECT_EQ(mesh.positions[3], before[3]) << name_of(flow);
    EXPECT_EQ(mesh.positions[100], before[100]) << name_of(flow);
    EXPECT_LT((mesh.positions[101] - before[101]).cross(direction).norm(), 1e-13) << name_of(flow);
    EXPECT_LT(std::abs((mesh.positions[102] - before[102]).dot(direction)), 1e-13) << name_of(flow);
  }
  EXPECT_GE(ran, 10);
}

}  // namespace
