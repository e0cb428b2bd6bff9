// What the five papers claim of their flows, one test each.
#include <cmath>

#include <gtest/gtest.h>

#include <rfsmooth/flow.h>

#include "smoothing/integrators/explicit.h"
#include "smoothing/integrators/umbrella_speed.h"
#include "smoothing/operators/operator.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using Eigen::Vector3d;
using rfsmooth::Mesh;

namespace {

template <class Options>
Options flow(int iterations, Options o = {}) {
  o.iterations = iterations;
  return o;
}

Mesh run(Mesh mesh, const AnyFlow& any, Boundary boundary = Boundary::free) {
  FlowOptions options{any};
  options.modifiers.boundary = boundary;
  const auto result = smooth(mesh, options, {});
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().message);
  return mesh;
}

Mesh noisy_sphere(int levels, double sigma_over_edge) {
  Mesh mesh = support::icosphere(levels);
  support::add_noise(mesh, sigma_over_edge * support::mean_edge(mesh), 11);
  return mesh;
}

double thin_plate(const Mesh& mesh) {
  return thin_plate_energy(mesh.one_ring, umbrella(mesh.one_ring, {}), mesh.positions, {});
}

/// Relative spread of the distances from the true centre.
double radius_spread(const Mesh& mesh) {
  double mean = 0, square = 0;
  for (const Vector3d& p : mesh.positions) {
    mean += p.norm() / double(mesh.positions.size());
    square += p.squaredNorm() / double(mesh.positions.size());
  }
  return std::sqrt(std::max(0.0, square - mean * mean)) / mean;
}

double edge_unevenness(const Mesh& mesh) {
  const double mean = support::mean_edge(mesh);
  double square = 0;
  for (Index i = 0; i < mesh.positions.size(); ++i)
    for (const Index j : mesh.one_ring[i]) {
      const double d = (mesh.positions[i] - mesh.positions[j]).norm() / mean - 1;
      square += d * d / double(mesh.one_ring.items.size());
    }
  return std::sqrt(square);
}

TEST(Desbrun, ImplicitIsStableAtAHundredWhereExplicitBlowsUp) {
  const Mesh noisy = noisy_sphere(4, 0.3);
  auto o = flow<ImplicitOptions>(3);
  o.dt = 100;
  o.order = 1;
  const Mesh calm = run(noisy, o);
  EXPECT_LT(thin_plate(calm), thin_plate(noisy));
  for (const Vector3d& p : calm.positions) EXPECT_LT(p.norm(), 1.5);

  Mesh wild = noisy;
  const auto step = make_explicit(make_umbrella_speed(UmbrellaWeights::equal), 100);
  for (int k = 0; k < 3; ++k) step->step(wild, {});
  EXPECT_GT(thin_plate(wild), 1e6 * thin_plate(noisy));
}

TEST(Desbrun, OneImplicitStepOfTenLooksLikeTenExplicitOfOne) {
  const Mesh noisy = noisy_sphere(4, 0.3);
  auto o = flow<ImplicitOptions>(1);
  o.dt = 10;
  o.order = 1;
  const Mesh implicit = run(noisy, o);
  auto e = flow<LaplacianOptions>(10);
  const Mesh stepped = run(noisy, e);
  EXPECT_LT(support::rms_distance(implicit.positions, stepped.positions),
            0.25 * support::rms_distance(noisy.positions, stepped.positions));
}

TEST(Desbrun, CurvatureFlowKeepsATwoDensitySphereASphereTheUmbrellaDoesNot) {
  const Mesh sphere = support::two_density_sphere(48);
  auto c = flow<ImplicitOptions>(1);
  c.op = OperatorKind::curvature;
  c.order = 1;
  c.dt = 5;
  auto u = c;
  u.op = OperatorKind::umbrella;
  const double curvature = radius_spread(run(sphere, c)), umbrella = radius_spread(run(sphere, u));
  EXPECT_LT(curvature, 1e-3);
  EXPECT_GT(umbrella, 10 * curvature);
}

TEST(Desbrun, CurvatureFlowDoesNotSlidePointsInAPlaneTheUmbrellaDoes) {
  Mesh plane = support::grid(12, 12);
  support::add_noise(plane, 0.15, 2);
  for (Vector3d& p : plane.positions) p.z() = 0;
  const auto c = flow<CurvatureOptions>(5);
  const auto u = flow<LaplacianOptions>(5);
  EXPECT_LT(support::rms_distance(run(plane, c, Boundary::fixed).positions, plane.positions), 1e-12);
  EXPECT_GT(support::rms_distance(run(plane, u, Boundary::fixed).positions, plane.positions), 0.03);
}

TEST(Desbrun, SecondOrderKeepsMoreOfTheShapeThanFirst) {
  const Mesh noisy = noisy_sphere(4, 0.3);
  auto o = flow<ImplicitOptions>(1);
  o.order = 1;
  const double first = support::rms_off_unit_sphere(run(noisy, o).positions);
  o.order = 2;
  EXPECT_LT(support::rms_off_unit_sphere(run(noisy, o).positions), 0.5 * first);
}

TEST(Vollmer, HcAndTaubinKeepTheVolumeTheLaplacianLoses) {
  const Mesh noisy = noisy_sphere(4, 0.2);
  const double volume = support::enclosed_volume(noisy);
  EXPECT_NEAR(support::enclosed_volume(run(noisy, flow<HcOptions>(10))) / volume, 1, 0.01);
  EXPECT_NEAR(support::enclosed_volume(run(noisy, flow<TaubinOptions>(10))) / volume, 1, 0.01);
  EXPECT_LT(support::enclosed_volume(run(noisy, flow<LaplacianOptions>(10))) / volume, 0.95);
}

TEST(Vollmer, HcConvergesToTheOneSolveLimit) {
  Mesh noisy = noisy_sphere(2, 0.3);
  auto o = flow<HcOptions>(4000);
  o.alpha = 0.1;
  o.beta = 0.7;
  auto limit = flow<HcLimitOptions>(1);
  limit.alpha = o.alpha;
  limit.beta = o.beta;
  limit.tolerance = 1e-13;
  EXPECT_LT(support::rms_distance(run(noisy, o).positions, run(noisy, limit).positions), 1e-10);
}

TEST(Vollmer, HcWithFixedVerticesConvergesToItsLimitToo) {
  Mesh noisy = noisy_sphere(2, 0.3), limit = noisy;
  const Constraints fixed{{{0, HardConstraint::Kind::fixed, Vector3d::Zero()},
                           {17, HardConstraint::Kind::fixed, Vector3d::Zero()}},
                          {}};
  auto o = flow<HcOptions>(4000);
  o.alpha = 0.1;
  o.beta = 0.7;
  auto l = flow<HcLimitOptions>(1);
  l.alpha = o.alpha;
  l.beta = o.beta;
  l.tolerance = 1e-13;
  ASSERT_TRUE(smooth(noisy, {o}, {}, fixed).ok());
  ASSERT_TRUE(smooth(limit, {l}, {}, fixed).ok());
  EXPECT_LT(support::rms_distance(noisy.positions, limit.positions), 1e-10);
}

TEST(Vollmer, TheLaplacianWithTheOriginalPointIsOneImplicitSolveForBothUpdates) {
  const Mesh noisy = noisy_sphere(2, 0.3);
  auto o = flow<LaplacianOptions>(2000);
  o.anchor = Anchor::original;
  o.alpha = 0.2;
  auto solve = flow<ImplicitOptions>(1);
  solve.order = 1;
  solve.dt = (1 - 0.2) / 0.2;
  solve.tolerance = 1e-13;
  const Positions limit = run(noisy, solve).positions;
  EXPECT_LT(support::rms_distance(run(noisy, o).positions, limit), 1e-10);
  o.update = Update::sequential;
  EXPECT_LT(support::rms_distance(run(noisy, o).positions, limit), 1e-10);
}

TEST(Vollmer, OnTwoVerticesTheSimultaneousLaplacianAlternates) {
  Mesh pair;
  pair.positions = {{0, 0, 0}, {1, 0, 0}};
  pair.loose_edges = {{0, 1}};
  rebuild_adjacency(pair, {});
  const Mesh once = run(pair, flow<LaplacianOptions>(1));
  EXPECT_EQ(once.positions[0], pair.positions[1]);
  EXPECT_EQ(run(pair, flow<LaplacianOptions>(2)).positions, pair.positions);
}

TEST(Ohtake, UmbrellaEvensTheSamplingInverseDistanceDoesLess) {
  Mesh plane = support::grid(16, 16, true);
  support::add_noise(plane, 0.15, 4);
  for (Vector3d& p : plane.positions) p.z() = 0;
  auto equal = flow<LaplacianOptions>(5), inverse = equal;
  inverse.weights = UmbrellaWeights::inverse_distance;
  const double before = edge_unevenness(plane), after = edge_unevenness(run(plane, equal, Boundary::fixed));
  EXPECT_LT(after, 0.7 * before);
  EXPECT_GT(edge_unevenness(run(plane, inverse, Boundary::fixed)), after);
}

TEST(Ohtake, MedianDirectionMakesEdgesMoreEvenThanCurvatureFlowAtEqualSmoothing) {
  const Mesh noisy = noisy_sphere(4, 0.2);
  const Mesh median = run(noisy, flow<MedianDirectionOptions>(10));
  // Curvature flow until it is as smooth as that, judged by the normal part of the noise.
  Mesh curvature = noisy;
  int steps = 0;
  while (radius_spread(curvature) > radius_spread(median) && steps < 200) {
    curvature = run(curvature, flow<CurvatureOptions>(1));
    ++steps;
  }
  ASSERT_LT(steps, 200);
  EXPECT_LT(edge_unevenness(median), edge_unevenness(curvature));
}

TEST(Ohtake, ModifiedCurvatureFlowEvensTheSampling) {
  const Mesh noisy = noisy_sphere(4, 0.2);
  EXPECT_LT(edge_unevenness(run(noisy, flow<ModifiedCurvatureOptions>(10))),
            0.8 * edge_unevenness(run(noisy, flow<CurvatureOptions>(10))));
}

}  // namespace
