#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <rfsmooth/flow.h>

#include "rfs_mesh/measure.h"
#include "smoothing/operators/operator.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using Eigen::Vector3d;
using rfsmooth::Mesh;

namespace {

/// An egg: curved more at one end, so that it has a direction of its own.
Mesh egg(int levels) {
  Mesh mesh = support::icosphere(levels);
  for (Vector3d& p : mesh.positions) {
    p.x() *= 1 + 0.35 * p.z();
    p.y() *= 1 + 0.25 * p.z();
    p.z() *= 1.2;
  }
  return mesh;
}

Mesh stepped(Mesh mesh, double lambda, const char* direction, int power = 0, int steps = 1) {
  FlowOptions o;
  o.flow = "directional";
  o.iterations = steps;
  o.lambda = lambda;
  o.direction = direction;
  o.power = power;
  const auto result = smooth(mesh, o, {});
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().message);
  return mesh;
}

double bending(const Mesh& mesh, int power) {
  const Operator op = curvature(mesh, vertex_faces(mesh, {}), {});
  Positions Hn;
  apply(mesh.one_ring, op, mesh.positions, Hn, {});
  double energy = 0;
  for (std::size_t i = 0; i < Hn.size(); ++i) energy += 0.5 * op.mass[i] * std::pow(Hn[i].norm(), 2 * power);
  return energy;
}

TEST(Directional, VolumeChangeIsSecondOrderInTheStepForAnyDirection) {
  Mesh mesh = egg(3);
  support::add_noise(mesh, 0.01, 1);
  const double volume = support::enclosed_volume(mesh);
  for (const char* direction : {"auto", "1,0,0", "0.3,-1,2"}) {
    const double half = support::enclosed_volume(stepped(mesh, 0.05, direction)) - volume;
    const double whole = support::enclosed_volume(stepped(mesh, 0.1, direction)) - volume;
    EXPECT_NEAR(whole / half, 4, 0.5) << direction;
    EXPECT_LT(std::abs(whole), 1e-3 * volume);
  }
}

TEST(Directional, TheAreaFallsAlongItsOwnDirectionAndGrowsAgainstIt) {
  const Mesh mesh = egg(3);
  const double area = rfs_mesh::surface_area(mesh, {});
  const Mesh after = stepped(mesh, 0.05, "auto");
  EXPECT_LT(rfs_mesh::surface_area(after, {}), area);
  // The egg is symmetric about z up to its two widths: its own direction is along z, one of the two signs.
  const double up = rfs_mesh::surface_area(stepped(mesh, 0.05, "0,0,1"), {}) - area;
  const double down = rfs_mesh::surface_area(stepped(mesh, 0.05, "0,0,-1"), {}) - area;
  EXPECT_LT(std::min(up, down), 0);
  EXPECT_GT(std::max(up, down), 0) << "why one of the paper's two minus signs alone is wrong";
  EXPECT_NEAR(rfs_mesh::surface_area(after, {}) - area, std::min(up, down), 0.05 * std::abs(up));
}

TEST(Directional, TheBendingEnergyOfEveryPowerFalls) {
  for (const int power : {1, 2}) {
    const Mesh mesh = egg(4);
    EXPECT_LT(bending(stepped(mesh, 0.02, "auto", power), power), bending(mesh, power)) << power;
  }
}

TEST(Directional, ASphereHasNoDirection) {
  const Mesh mesh = support::icosphere(3);
  EXPECT_LT(support::rms_distance(stepped(mesh, 0.05, "auto").positions, mesh.positions), 1e-12);
}

TEST(Directional, OnAnOpenMeshTheBoundaryStaysAndOrientationDoesNotMatter) {
  Mesh sheet = support::grid(9, 9, true);
  for (Vector3d& p : sheet.positions) p.z() = 0.3 * std::sin(p.x()) * std::cos(p.y());
  Mesh turned = sheet;
  for (std::size_t f = 0; f < turned.faces.size(); f += 3) std::swap(turned.faces[f][0], turned.faces[f][1]);
  rebuild_adjacency(turned, {});
  const Mesh after = stepped(sheet, 0.05, "0,0,1");
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(after.positions[i], sheet.positions[i]);
  EXPECT_GT(support::rms_distance(after.positions, sheet.positions), 1e-3);
  EXPECT_EQ(stepped(turned, 0.05, "0,0,1").positions, after.positions);
}

TEST(Directional, BadDirectionsAreRefused) {
  FlowOptions o;
  o.flow = "directional";
  Mesh sphere = support::icosphere(1);
  for (const char* bad : {"up", "1,2", "0,0,0", "1,2,3,4", "1,nan,0"}) {
    o.direction = bad;
    EXPECT_FALSE(smooth(sphere, o, {}).ok()) << bad;
  }
}

TEST(LocalDirectional, SaddlesAndBoundariesNeverMove) {
  Mesh saddle = support::grid(11, 11, true);
  for (Vector3d& p : saddle.positions) {
    const double x = p.x() - 2.5, y = p.y() - 4.3;
    p.z() = 0.25 * (x * x - y * y);
  }
  const Positions before = saddle.positions;
  FlowOptions o;
  o.flow = "local-directional";
  o.iterations = 1;
  ASSERT_TRUE(smooth(saddle, o, {}).ok());
  EXPECT_EQ(saddle.positions[60], before[60]);  // the middle: K well below -eps
  EXPECT_EQ(saddle.positions[0], before[0]);
}

TEST(LocalDirectional, SmoothsNoiseOfASphere) {
  Mesh mesh = support::icosphere(4);
  support::add_noise(mesh, 0.15 * support::mean_edge(mesh), 2);
  const double before = support::rms_off_unit_sphere(mesh.positions);
  FlowOptions o;
  o.flow = "local-directional";
  o.iterations = 20;
  ASSERT_TRUE(smooth(mesh, o, {}).ok());
  EXPECT_LT(support::rms_off_unit_sphere(mesh.positions), 0.9 * before);
}

}  // namespace
