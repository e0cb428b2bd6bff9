#include "smoothing/modifiers/threshold.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "smoothing/operators/operator.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using rfsmooth::Mesh;

namespace {

Mesh rough_sphere() {
  Mesh mesh = support::icosphere(3);
  support::add_noise(mesh, 0.2 * support::mean_edge(mesh), 5);
  return mesh;
}

TEST(Threshold, StopsByItself) {
  for (const AnyFlow& any :
       {AnyFlow(LaplacianOptions()), AnyFlow(CurvatureOptions()), AnyFlow(MedianDirectionOptions())}) {
    const std::string_view name = name_of(any);
    Mesh mesh = rough_sphere();
    FlowOptions o{any};
    o.modifiers.threshold = ThresholdKind::constant;
    o.modifiers.threshold_value = 0.3;  // above what a sphere of 16 edges around moves by itself
    const auto flow = make_flow(mesh, o, {});
    ASSERT_TRUE(flow.ok());
    for (int step = 0; step < 300; ++step) flow.value()->step(mesh, {});
    const Positions settled = mesh.positions;
    for (int step = 0; step < 50; ++step) flow.value()->step(mesh, {});
    EXPECT_LT(support::rms_distance(settled, mesh.positions), 1e-3 * support::mean_edge(mesh)) << name;
    Mesh free = rough_sphere();
    o.modifiers = {};
    iterations(o.flow) = 300;
    ASSERT_TRUE(smooth(free, o, {}).ok());
    EXPECT_GT(support::enclosed_volume(mesh), 2 * support::enclosed_volume(free)) << name;
  }
}

TEST(Threshold, RingMeansLeaveAnEvenSphereNearlyStill) {
  Mesh mesh = support::icosphere(3), free = mesh;
  const Positions before = mesh.positions;
  FlowOptions o{CurvatureOptions()};
  ASSERT_TRUE(smooth(free, o, {}).ok());
  for (const ThresholdKind rings : {ThresholdKind::one_ring, ThresholdKind::two_ring}) {
    mesh.positions = before;
    o.modifiers.threshold = rings;
    ASSERT_TRUE(smooth(mesh, o, {}).ok());
    EXPECT_LT(support::rms_distance(before, mesh.positions),
              0.25 * support::rms_distance(before, free.positions));
  }
}

/// Ohtake's T(P), written out: the mean of the mean curvatures of the ring, P itself not among them.
double ring_threshold(const Mesh& mesh, Index i, int rings) {
  std::set<Index> ring = {i};
  for (int r = 0; r < rings; ++r) {
    std::set<Index> wider = ring;
    for (const Index j : ring) wider.insert(mesh.one_ring[j].begin(), mesh.one_ring[j].end());
    ring = std::move(wider);
  }
  ring.erase(i);
  const Operator op = curvature(mesh, vertex_faces(mesh, {}), {});
  Positions Hn;
  apply(mesh.one_ring, op, mesh.positions, Hn, {});
  double sum = 0;
  for (const Index j : ring) sum += std::pow(support::mean_edge(mesh), 2) * Hn[j].norm();
  return sum / double(ring.size());
}

TEST(Threshold, OfTheRingsIsTheirMeanCurvatureUnderEveryFlow) {
  LaplacianOptions laplacian;
  CurvatureOptions curvature;
  laplacian.lambda = curvature.lambda = 0.2;
  laplacian.iterations = curvature.iterations = 1;
  for (const AnyFlow& flow : {AnyFlow(laplacian), AnyFlow(curvature)})
    for (const int rings : {1, 2}) {
      Mesh mesh = rough_sphere(), free = mesh;
      const Mesh before = mesh;
      FlowOptions o{flow};
      ASSERT_TRUE(smooth(free, o, {}).ok());
      o.modifiers.threshold = rings == 1 ? ThresholdKind::one_ring : ThresholdKind::two_ring;
      ASSERT_TRUE(smooth(mesh, o, {}).ok());
      for (Index i = 0; i < mesh.positions.size(); i += 17) {
        const double F = (free.positions[i] - before.positions[i]).norm() / 0.2;
        const double T = ring_threshold(before, i, rings);
        EXPECT_NEAR((mesh.positions[i] - before.positions[i]).norm(), F > T ? 0.2 * (F - T) : 0, 1e-12)
            << name_of(flow);
      }
    }
}

TEST(Threshold, MovesByTheExcess) {
  Mesh mesh = rough_sphere(), free = mesh;
  const Positions before = mesh.positions;
  LaplacianOptions laplacian;
  laplacian.lambda = 0.5;
  laplacian.iterations = 1;
  FlowOptions o{laplacian};
  ASSERT_TRUE(smooth(free, o, {}).ok());
  o.modifiers.threshold = ThresholdKind::constant;
  o.modifiers.threshold_value = 0.1;
  const double T = 0.1 * support::mean_edge(mesh);
  ASSERT_TRUE(smooth(mesh, o, {}).ok());
  int moved = 0, stayed = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double F = (free.positions[i] - before[i]).norm() / 0.5;
    EXPECT_NEAR((mesh.positions[i] - before[i]).norm(), F > T ? 0.5 * (F - T) : 0, 1e-13);
    ++(F > T ? moved : stayed);
  }
  EXPECT_GT(moved, 0);
  EXPECT_GT(stayed, 0);
}

}  // namespace
