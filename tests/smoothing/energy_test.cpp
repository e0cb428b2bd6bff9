// The energy that a paper says falls, falls, step by step.
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <rfsmooth/flow.h>

#include "smoothing/operators/operator.h"
#include "tests/support/fairing_energy.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using Eigen::Vector3d;
using rfsmooth::Mesh;

namespace {

Mesh noisy_sphere() {
  Mesh mesh = support::icosphere(3);
  support::add_noise(mesh, 0.3 * support::mean_edge(mesh), 11);
  return mesh;
}

/// Runs one step at a time; `energy` must fall every time.
template <class Energy>
void falls(AnyFlow flow, int steps, Energy&& energy) {
  iterations(flow) = 1;
  Mesh mesh = noisy_sphere();
  double before = energy(mesh);
  for (int step = 0; step < steps; ++step) {
    ASSERT_TRUE(smooth(mesh, {flow}, {}).ok());
    const double after = energy(mesh);
    EXPECT_LT(after, before) << name_of(flow) << ", step " << step;
    before = after;
  }
}

double thin_plate_of(const Mesh& mesh) {
  return thin_plate_energy(mesh.one_ring, umbrella(mesh.one_ring, {}), mesh.positions, {});
}

double membrane(const Mesh& mesh) {
  double sum = 0;
  for (Index i = 0; i < mesh.positions.size(); ++i)
    for (const Index j : mesh.one_ring[i]) sum += (mesh.positions[i] - mesh.positions[j]).squaredNorm();
  return sum;
}

TEST(Energy, LaplacianLowersTheMembraneEnergy) {
  falls(LaplacianOptions(), 10, membrane);
}

TEST(Energy, BilaplacianAndHcLowerTheThinPlateEnergy) {
  falls(BilaplacianOptions(), 10, thin_plate_of);
  falls(HcOptions(), 10, thin_plate_of);
}

TEST(Energy, CurvatureFlowsLowerTheArea) {
  falls(CurvatureOptions(), 10, support::area);
  CurvatureOptions normalised;
  normalised.normalised = true;
  falls(normalised, 10, support::area);
  ImplicitOptions implicit;
  implicit.op = OperatorKind::curvature;
  implicit.order = 1;
  implicit.dt = 1;
  falls(implicit, 5, support::area);
}

TEST(Energy, ImplicitFairingLowersTheEnergyOfItsOrder) {
  ImplicitOptions o;
  for (const double dt : {1.0, 100.0}) {
    o.dt = dt;
    o.order = 1;
    falls(o, 4, membrane);
    o.order = 2;
    falls(o, 4, thin_plate_of);
  }
}

TEST(Energy, DiscreteFairingLowersTheThinPlateEnergyOfItsCharts) {
  Mesh mesh = noisy_sphere();
  const DividedDifferences charts(mesh, Chart::mixed, {});  // the default
  const double before = support::energy(charts, mesh.positions);
  ASSERT_TRUE(smooth(mesh, {DiscreteFairingOptions()}, {}).ok());
  EXPECT_LT(support::energy(charts, mesh.positions), 0.5 * before);
}

}  // namespace
