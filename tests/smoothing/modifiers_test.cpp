// What the modifiers (threshold, push-back, invariants, boundary rules) keep of the flows' properties.
#include <cmath>
#include <functional>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <rfsmooth/flow.h>

#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using Eigen::Vector3d;
using rfsmooth::Mesh;

namespace {

struct Modifier {
  const char* name;
  std::function<void(FlowOptions&)> set;
  bool turns = true;  ///< commutes with rotations
};

std::vector<Modifier> all_modifiers() {
  std::vector<Modifier> all = {{"push_back", [](FlowOptions& o) { o.push_back = true; }}};
  for (const char* rule : {"constant", "one-ring", "two-ring"})
    all.push_back({rule, [rule](FlowOptions& o) {
                     o.threshold = rule;
                     if (o.threshold == "constant")
                       o.threshold_value = 0.02;
                     else
                       o.threshold_every = 2;
                   }});
  all.push_back({"area", [](FlowOptions& o) { o.preserve = "area"; }});
  all.push_back({"height-field", [](FlowOptions& o) { o.preserve = "height-field"; }, false});
  for (const char* rule : {"fixed", "curve", "virtual"})
    all.push_back({rule, [rule](FlowOptions& o) { o.boundary = rule; }});
  return all;
}

class EveryModifier : public testing::TestWithParam<Modifier> {
 protected:
  FlowOptions options() const {
    FlowOptions o;
    o.flow = "laplacian";
    o.iterations = 6;
    o.lambda = 0.5;
    GetParam().set(o);
    return o;
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
  for (const FlowEntry& entry : flows()) {
    Mesh mesh = tube();
    const Positions before = mesh.positions;
    FlowOptions o;
    o.flow = entry.name;
    o.iterations = 2;
    GetParam().set(o);
    if (!smooth(mesh, o, {}, constraints).ok()) continue;  // refused with a reason; see flow_test.cpp
    ++ran;
    EXPECT_EQ(mesh.positions[3], before[3]) << entry.name;
    EXPECT_EQ(mesh.positions[100], before[100]) << entry.name;
    EXPECT_LT((mesh.positions[101] - before[101]).cross(direction).norm(), 1e-13) << entry.name;
    EXPECT_LT(std::abs((mesh.positions[102] - before[102]).dot(direction)), 1e-13) << entry.name;
  }
  EXPECT_GE(ran, 10);
}

}  // namespace
