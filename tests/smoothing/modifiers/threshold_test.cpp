#include "smoothing/modifiers/threshold.h"

#include <gtest/gtest.h>

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
  for (const char* name : {"laplacian", "curvature", "median-direction"}) {
    Mesh mesh = rough_sphere();
    FlowOptions o;
    o.flow = name;
    o.threshold = "constant";
    o.threshold_value = 0.3;  // above what a sphere of 16 edges around moves by itself
    const auto flow = make_flow(mesh, o, {});
    ASSERT_TRUE(flow.ok());
    for (int step = 0; step < 300; ++step) flow.value()->step(mesh, {});
    const Positions settled = mesh.positions;
    for (int step = 0; step < 50; ++step) flow.value()->step(mesh, {});
    EXPECT_LT(support::rms_distance(settled, mesh.positions), 1e-3 * support::mean_edge(mesh)) << name;
    Mesh free = rough_sphere();
    o.threshold = "none";
    o.iterations = 300;
    ASSERT_TRUE(smooth(free, o, {}).ok());
    EXPECT_GT(support::enclosed_volume(mesh), 2 * support::enclosed_volume(free)) << name;
  }
}

TEST(Threshold, RingMeansLeaveAnEvenSphereNearlyStill) {
  Mesh mesh = support::icosphere(3), free = mesh;
  const Positions before = mesh.positions;
  FlowOptions o;
  o.flow = "curvature";
  ASSERT_TRUE(smooth(free, o, {}).ok());
  for (const char* rings : {"one-ring", "two-ring"}) {
    mesh.positions = before;
    o.threshold = rings;
    ASSERT_TRUE(smooth(mesh, o, {}).ok());
    EXPECT_LT(support::rms_distance(before, mesh.positions),
              0.25 * support::rms_distance(before, free.positions));
  }
}

TEST(Threshold, MovesByTheExcess) {
  Mesh mesh = rough_sphere(), free = mesh;
  const Positions before = mesh.positions;
  FlowOptions o;
  o.flow = "laplacian";
  o.lambda = 0.5;
  o.iterations = 1;
  ASSERT_TRUE(smooth(free, o, {}).ok());
  o.threshold = "constant";
  o.threshold_value = 0.1;
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
