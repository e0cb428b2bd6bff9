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

Mesh stepped(Mesh mesh, double lambda, std::optional<Vector3d> direction, int power = 0, int steps = 1) {
  DirectionalOptions o;
  o.iterations = steps;
  o.lambda = lambda;
  o.direction = direction;
  if (!direction) o.power = power;
  const auto result = smooth(mesh, {o}, {});
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
  for (const auto& direction : {std::optional<Vector3d>(), {Vector3d(1, 0, 0)}, {Vector3d(0.3, -1, 2)}}) {
    const double half = support::enclosed_volume(stepped(mesh, 0.05, direction)) - volume;
    const double whole = support::enclosed_volume(stepped(mesh, 0.1, direction)) - volume;
    EXPECT_NEAR(whole / half, 4, 0.5) << direction.value_or(Vector3d::Zero()).transpose();
    EXPECT_LT(std::abs(whole), 1e-3 * volume);
  }
}

TEST(Directional, TheAreaFallsAlongItsOwnDirectionAndGrowsAgainstIt) {
  const Mesh mesh = egg(3);
  const double area = rfs_mesh::surface_area(mesh, {});
  const Mesh after = stepped(mesh, 0.05, {});
  EXPECT_LT(rfs_mesh::surface_area(after, {}), area);
  // The egg is symmetric about z up to its two widths: its own direction is along z, one of the two signs.
  const double up = rfs_mesh::surface_area(stepped(mesh, 0.05, Vector3d(0, 0, 1)), {}) - area;
  const double down = rfs_mesh::surface_area(stepped(mesh, 0.05, Vector3d(0, 0, -1)), {}) - area;
  EXPECT_LT(std::min(up, down), 0);
  EXPECT_GT(std::max(up, down), 0) << "why one of the paper's two minus signs alone is wrong";
  EXPECT_NEAR(rfs_mesh::surface_area(after, {}) - area, std::min(up, down), 0.05 * std::abs(up));
}

TEST(Directional, TheBendingEnergyOfEveryPowerFalls) {
  for (const int power : {1, 2}) {
    const Mesh mesh = egg(4);
    EXPECT_LT(bending(stepped(mesh, 0.02, {}, power), power), bending(mesh, power)) << power;
  }
}

TEST(Directional, ASphereHasNoDirection) {
  const Mesh mesh = support::icosphere(3);
  EXPECT_LT(support::rms_distance(stepped(mesh, 0.05, {}).positions, mesh.positions), 1e-12);
}

TEST(Directional, OnAnOpenMeshTheBoundaryStaysAndOrientationDoesNotMatter) {
  Mesh sheet = support::grid(9, 9, true);
  for (Vector3d& p : sheet.positions) p.z() = 0.3 * std::sin(p.x()) * std::cos(p.y());
  Mesh turned = sheet;
  for (std::size_t f = 0; f < turned.faces.size(); f += 3) std::swap(turned.faces[f][0], turned.faces[f][1]);
  rebuild_adjacency(turned, {});
  const Mesh after = stepped(sheet, 0.05, Vector3d(0, 0, 1));
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(after.positions[i], sheet.positions[i]);
  EXPECT_GT(support::rms_distance(after.positions, sheet.positions), 1e-3);
  EXPECT_EQ(stepped(turned, 0.05, Vector3d(0, 0, 1)).positions, after.positions);
}

/// A bowl bends towards the direction, a dome away from it; both are open, with all faces up as the file has
/// them, so both are smoothed along z.
TEST(Directional, AnOpenMeshKeepsItsSide) {
  for (const double bend : {1.0, -1.0}) {
    Mesh clean = support::bowl(8);
    for (Vector3d& p : clean.positions) p.z() *= bend;
    Mesh mesh = clean;
    support::add_noise(mesh, 0.05, 4);
    // What the noise has become is what tells the two apart after the same steps.
    const auto heights_apart = [](const Mesh& one, const Mesh& other) {
      double sum = 0;
      for (std::size_t i = 0; i < one.positions.size(); ++i)
        sum += std::pow(one.positions[i].z() - other.positions[i].z(), 2);
      return std::sqrt(sum / double(one.positions.size()));
    };
    EXPECT_LT(heights_apart(stepped(mesh, 0.05, Vector3d(0, 0, 1), 0, 8),
                            stepped(clean, 0.05, Vector3d(0, 0, 1), 0, 8)),
              0.9 * heights_apart(mesh, clean))
        << bend;
  }
}

/// The explicit limit of a vertex on a spike or fold, where the gradient of the volume vanishes.
TEST(Directional, DoesNotRunAwayOnIrregularNoise) {
  Mesh mesh = support::icosphere(3);
  const double h = support::mean_edge(mesh);
  support::add_noise(mesh, 0.6 * h, 3);
  const double volume = support::enclosed_volume(mesh);
  const Mesh once = stepped(mesh, 0.05, {}), often = stepped(mesh, 0.05, {}, 0, 40);
  double largest = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    largest = std::max(largest, (once.positions[i] - mesh.positions[i]).norm());
  EXPECT_LT(largest, 0.5 * h);
  EXPECT_LT(support::area(often), 1.1 * support::area(mesh));
  EXPECT_NEAR(support::enclosed_volume(often) / volume, 1, 0.05);
}

/// (37), (33) and the step of section 4 at m = 0, written out with the two minus signs taken together.
TEST(Directional, ThePrintedSchemeIsThePapers) {
  Mesh mesh = egg(3);
  support::add_noise(mesh, 0.01, 2);
  const std::size_t n = mesh.positions.size();
  const Positions& x = mesh.positions;
  Positions Hn(n, Vector3d::Zero()), normal(n, Vector3d::Zero());
  std::vector<double> ring(n, 0);
  for (const Face& f : mesh.faces)
    for (int k = 0; k < 3; ++k) {
      const Index i = f[k], j = f[(k + 1) % 3], l = f[(k + 2) % 3];
      const auto cot = [&](Index at, Index a, Index b) {
        const Vector3d u = x[a] - x[at], v = x[b] - x[at];
        return u.dot(v) / u.cross(v).norm();
      };
      const Vector3d cross = (x[j] - x[i]).cross(x[l] - x[i]);
      Hn[i] += cot(l, i, j) * (x[j] - x[i]) + cot(j, i, l) * (x[l] - x[i]);
      normal[i] += cross;
      ring[i] += 0.5 * cross.norm();
    }
  const Operator op = curvature(mesh, vertex_faces(mesh, {}), {});
  Vector3d a = Vector3d::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    Hn[i] /= 4 * ring[i];
    normal[i].normalize();
    a += 0.5 * op.mass[i] * 2 * Hn[i].squaredNorm() * normal[i];
  }
  a.normalize();
  DirectionalOptions o;
  o.scheme = Scheme::printed;
  o.iterations = 1;
  o.lambda = 0.05;
  Mesh after = mesh;
  ASSERT_TRUE(smooth(after, {o}, {}).ok());
  const double h = support::mean_edge(mesh);
  for (std::size_t i = 0; i < n; ++i)
    EXPECT_LT((after.positions[i] - x[i] - 0.05 * h * h * a.dot(normal[i]) * Hn[i]).norm(), 1e-13);
}

TEST(Directional, SaysWhatAMeshIsMissing) {
  const auto said = [](Mesh mesh) {
    std::string all;
    Context context;
    context.log = [&](LogLevel, const std::string& text) { all += text; };
    EXPECT_TRUE(smooth(mesh, {DirectionalOptions()}, context).ok());
    return all;
  };
  EXPECT_EQ(said(egg(2)), "");
  EXPECT_NE(said(support::bowl(3)).find("24 edges with one face, 0 with more"), std::string::npos);
  EXPECT_NE(said(support::finned_sphere(1)).find("2 edges with one face, 1 with more"), std::string::npos);
  EXPECT_NE(said(support::moebius(16)).find("only one side"), std::string::npos);
  EXPECT_EQ(said(support::bowl(3)).find("only one side"), std::string::npos);
}

TEST(Directional, BadDirectionsAreRefused) {
  DirectionalOptions o;
  Mesh sphere = support::icosphere(1);
  for (const Vector3d& bad : {Vector3d(0, 0, 0), Vector3d(1, std::nan(""), 0)}) {
    o.direction = bad;
    EXPECT_FALSE(smooth(sphere, {o}, {}).ok()) << bad.transpose();
  }
}

TEST(LocalDirectional, SaddlesAndBoundariesNeverMove) {
  Mesh saddle = support::grid(11, 11, true);
  for (Vector3d& p : saddle.positions) {
    const double x = p.x() - 2.5, y = p.y() - 4.3;
    p.z() = 0.25 * (x * x - y * y);
  }
  const Positions before = saddle.positions;
  LocalDirectionalOptions o;
  o.iterations = 1;
  ASSERT_TRUE(smooth(saddle, {o}, {}).ok());
  EXPECT_EQ(saddle.positions[60], before[60]);  // the middle: K well below -eps
  EXPECT_EQ(saddle.positions[0], before[0]);
}

TEST(LocalDirectional, SmoothsNoiseOfASphere) {
  Mesh mesh = support::icosphere(4);
  support::add_noise(mesh, 0.15 * support::mean_edge(mesh), 2);
  const double before = support::rms_off_unit_sphere(mesh.positions);
  LocalDirectionalOptions o;
  o.iterations = 20;
  ASSERT_TRUE(smooth(mesh, {o}, {}).ok());
  EXPECT_LT(support::rms_off_unit_sphere(mesh.positions), 0.9 * before);
}

}  // namespace
