// Constraints inside a step: what a fixed vertex shows its neighbours.
#include "smoothing/modifiers/constraint.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <rfsmooth/flow.h>

#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using Eigen::Vector3d;
using rfsmooth::Mesh;

namespace {

/// A flow made of umbrellas, in which several part steps or an order of vertices could let a fixed one move.
struct GraphFlow {
  const char* name;
  FlowOptions options;
};

template <class Flow>
Flow in_order() {
  Flow flow;
  flow.update = Update::sequential;
  return flow;
}

FlowOptions pushed_back(const AnyFlow& flow, double alpha) {
  FlowOptions o{flow};
  o.modifiers.push_back = true;
  o.modifiers.push_alpha = alpha;
  return o;
}

class EveryGraphFlow : public testing::TestWithParam<GraphFlow> {
 protected:
  FlowOptions options() const {
    FlowOptions o = GetParam().options;
    iterations(o.flow) = 3;
    return o;
  }
};
INSTANTIATE_TEST_SUITE_P(
    Flows, EveryGraphFlow,
    testing::Values(GraphFlow{"laplacian", {LaplacianOptions()}},
                    GraphFlow{"laplacian_in_order", {in_order<LaplacianOptions>()}},
                    GraphFlow{"hc", {HcOptions()}}, GraphFlow{"hc_in_order", {in_order<HcOptions>()}},
                    GraphFlow{"taubin", {TaubinOptions()}},
                    GraphFlow{"pushed_back_laplacian", pushed_back(LaplacianOptions(), 0)},
                    GraphFlow{"pushed_back_taubin", pushed_back(TaubinOptions(), 0.1)}),
    [](const auto& flow) { return std::string(flow.param.name); });

Mesh rough_torus() {
  Mesh mesh = support::torus(24, 12, 0.4);
  support::add_noise(mesh, 0.04, 7);
  return mesh;
}

/// Every seventh vertex and a whole ring of neighbours.
std::vector<Index> held(const Mesh& mesh) {
  std::vector<Index> all;
  for (Index i = 0; i < mesh.positions.size(); ++i)
    if (i % 7 == 0 || (i >= 100 && i < 112)) all.push_back(i);
  return all;
}

Constraints all_fixed(const std::vector<Index>& vertices) {
  Constraints constraints;
  for (const Index i : vertices)
    constraints.hard.push_back({i, HardConstraint::Kind::fixed, Vector3d::Zero()});
  return constraints;
}

Constraints with_strength(const std::vector<Index>& vertices, double strength, std::size_t n) {
  Constraints constraints;
  constraints.strength.assign(n, 1);
  for (const Index i : vertices) constraints.strength[i] = strength;
  return constraints;
}

/// If it never moves, not even for part of a step, its own neighbours mean nothing to anybody.
TEST_P(EveryGraphFlow, WhatFixedVerticesAreJoinedToDoesNotMatter) {
  Mesh mesh = rough_torus(), joined = mesh;
  const std::vector<Index> vertices = held(mesh);
  for (std::size_t k = 0; k + 5 < vertices.size(); ++k) {
    const auto row = mesh.one_ring[vertices[k]];
    if (std::find(row.begin(), row.end(), vertices[k + 5]) == row.end())
      joined.loose_edges.push_back({vertices[k], vertices[k + 5]});
  }
  ASSERT_GT(joined.loose_edges.size(), 10u);
  rebuild_adjacency(joined, {});
  const Positions before = mesh.positions;
  ASSERT_TRUE(smooth(mesh, options(), {}, all_fixed(vertices)).ok());
  ASSERT_TRUE(smooth(joined, options(), {}, all_fixed(vertices)).ok());
  EXPECT_GT(support::rms_distance(mesh.positions, before), 1e-2);
  EXPECT_LT(support::rms_distance(mesh.positions, joined.positions), 1e-14);
}

TEST_P(EveryGraphFlow, ALittleStrengthIsNearlyFixed) {
  Mesh mesh = rough_torus(), soft = mesh;
  const std::vector<Index> vertices = held(mesh);
  ASSERT_TRUE(smooth(mesh, options(), {}, all_fixed(vertices)).ok());
  ASSERT_TRUE(smooth(soft, options(), {}, with_strength(vertices, 1e-9, mesh.positions.size())).ok());
  EXPECT_LT(support::rms_distance(mesh.positions, soft.positions), 1e-8);
}

/// All at once, and where the flow has an order, one after the other.
std::vector<AnyFlow> every_flow_and_order() {
  std::vector<AnyFlow> all = flows();
  all.emplace_back(in_order<LaplacianOptions>());
  all.emplace_back(in_order<HcOptions>());
  return all;
}

TEST(Constraints, StrengthZeroIsFixedUnderEveryFlowWithAndWithoutPushBack) {
  for (const AnyFlow& flow : every_flow_and_order())
    for (const bool push_back : {false, true}) {
      FlowOptions o{flow};
      iterations(o.flow) = 2;
      o.modifiers.push_back = push_back;
      Mesh hard = rough_torus(), zero = hard;
      const std::vector<Index> vertices = held(hard);
      ASSERT_TRUE(smooth(hard, o, {}, all_fixed(vertices)).ok());
      ASSERT_TRUE(smooth(zero, o, {}, with_strength(vertices, 0, zero.positions.size())).ok());
      EXPECT_LT(support::rms_distance(hard.positions, zero.positions), 1e-13)
          << name_of(flow) << (push_back ? " pushed back" : "");
    }
}

/// Each with one thing wrong, for a mesh of n vertices.
std::vector<std::pair<const char*, Constraints>> that_do_not_fit(std::size_t n) {
  const auto last = Index(n - 1);
  const auto fixed = [](Index i) { return HardConstraint{i, HardConstraint::Kind::fixed, Vector3d::Zero()}; };
  return {{"a strength too many", {{}, std::vector<double>(n + 1, 1)}},
          {"a strength too few", {{}, std::vector<double>(n - 1, 1)}},
          {"a strength above one", {{}, std::vector<double>(n, 2)}},
          {"a vertex that is not there", {{fixed(Index(n))}, {}}},
          {"two on one vertex", {{fixed(last), fixed(last)}, {}}},
          {"a direction of no length", {{{last, HardConstraint::Kind::axis, Vector3d::Zero()}}, {}}}};
}

TEST(Constraints, ThatDoNotFitAreRefusedUnderEveryBoundaryRule) {
  const Mesh tube = support::cylinder(12, 5, 0.3);  // its last vertex is on a rim
  for (const Boundary rule : {Boundary::free, Boundary::fixed, Boundary::curve, Boundary::virtual_vertices})
    for (const auto& [wrong, constraints] : that_do_not_fit(tube.positions.size())) {
      FlowOptions o{HcOptions{}};
      o.modifiers.boundary = rule;
      Mesh mesh = tube;
      EXPECT_THROW((void)smooth(mesh, o, {}, constraints), std::invalid_argument)
          << wrong << ' ' << int(rule);
      EXPECT_THROW((void)make_flow(mesh, o, {}, constraints), std::invalid_argument)
          << wrong << ' ' << int(rule);
      EXPECT_EQ(mesh.positions, tube.positions);
    }
}

}  // namespace
