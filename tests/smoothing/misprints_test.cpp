// Why the library differs from what the papers print: each printed formula, and what it does.
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <rfsmooth/flow.h>

#include "rfs_mesh/measure.h"
#include "smoothing/operators/operator.h"
#include "smoothing/operators/surface.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using Eigen::Vector3d;
using rfsmooth::Mesh;

namespace {

Mesh after(Mesh mesh, const AnyFlow& flow) {
  EXPECT_TRUE(smooth(mesh, {flow}, {}).ok());
  return mesh;
}

Mesh noisy_unit_sphere() {
  Mesh mesh = support::icosphere(3);
  support::add_noise(mesh, 0.3 * support::mean_edge(mesh), 11);
  return mesh;
}

/// L x of the umbrella.
Positions umbrella_of(const Mesh& mesh, const Positions& x) {
  Positions y;
  apply(mesh.one_ring, umbrella(mesh.one_ring, {}), x, y, {});
  return y;
}

TEST(Bilaplacian, ThePrintedPlusAmplifiesOursDamps) {
  const Mesh noisy = noisy_unit_sphere();
  const auto energy = [&](const Positions& x) {
    return thin_plate_energy(noisy.one_ring, umbrella(noisy.one_ring, {}), x, {});
  };
  const Positions second = umbrella_of(noisy, umbrella_of(noisy, noisy.positions));
  Positions printed = noisy.positions;
  for (std::size_t i = 0; i < printed.size(); ++i) printed[i] += 0.4 * second[i];
  EXPECT_GT(energy(printed), energy(noisy.positions));
  BilaplacianOptions o;
  o.iterations = 1;
  EXPECT_LT(energy(after(noisy, o).positions), 0.5 * energy(noisy.positions));
}

TEST(Bilaplacian, IsHcWithoutTheOriginalPoint) {
  const Mesh noisy = noisy_unit_sphere();
  BilaplacianOptions bilaplacian;
  HcOptions hc;
  bilaplacian.lambda = 0.3;
  hc.alpha = 0;
  hc.beta = 0.7;
  bilaplacian.iterations = hc.iterations = 5;
  EXPECT_LT(support::rms_distance(after(noisy, bilaplacian).positions, after(noisy, hc).positions), 1e-14);
}

TEST(Taubin, IsOhtakesSixNotDesbrunsSign) {
  // q - (mu - lambda) U q - mu lambda U^2 q with U = -L; Desbrun 2.1 has the last sign turned for its mu < 0.
  const Mesh noisy = noisy_unit_sphere();
  const double lambda = 0.6307, mu = 0.6732;
  const Positions first = umbrella_of(noisy, noisy.positions), second = umbrella_of(noisy, first);
  Positions six = noisy.positions, turned = noisy.positions;
  for (std::size_t i = 0; i < six.size(); ++i) {
    six[i] += (mu - lambda) * first[i] - mu * lambda * second[i];
    turned[i] += (mu - lambda) * first[i] + mu * lambda * second[i];
  }
  TaubinOptions o;
  o.iterations = 1;
  const Mesh ours = after(noisy, o);
  EXPECT_LT(support::rms_distance(ours.positions, six), 1e-14);
  const auto energy = [&](const Positions& x) {
    return thin_plate_energy(noisy.one_ring, umbrella(noisy.one_ring, {}), x, {});
  };
  EXPECT_GT(energy(turned), energy(noisy.positions));
}

TEST(ModifiedCurvature, ThePrintedBracketIsNotTangentialOursIs) {
  // On a sphere whose sampling is uneven: U0 - (U0 . n) U0 keeps nearly all of U0's normal part.
  const Mesh sphere = support::two_density_sphere(32);
  const Positions first = umbrella_of(sphere, sphere.positions);
  ModifiedCurvatureOptions with, without;
  with.iterations = without.iterations = 1;
  with.tangential = 1;
  without.tangential = 0;
  const Positions a = after(sphere, with).positions, b = after(sphere, without).positions;
  const Positions normal = unsigned_normals(sphere, fans_of(sphere, {}), {});
  double ours = 0, printed = 0;
  for (Index i = 0; i < a.size(); ++i) {
    const Vector3d n = normal[i], U = -first[i];
    ours = std::max(ours, std::abs((a[i] - b[i]).dot(n)));
    printed = std::max(printed, std::abs((U - U.dot(n) * U).dot(n)));
  }
  EXPECT_LT(ours, 1e-14);
  EXPECT_GT(printed, 1e-3);
}

TEST(ScaleDependent, IsTwiceTheUmbrellaForUnitEdges) {
  Mesh mesh = support::icosphere(0);  // an icosahedron: all edges equal
  const double edge = support::mean_edge(mesh);
  for (Vector3d& p : mesh.positions) p /= edge;
  Positions scale;
  apply(mesh.one_ring, scale_dependent(mesh, {}), mesh.positions, scale, {});
  const Positions one = umbrella_of(mesh, mesh.positions);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_LT((scale[i] - 2 * one[i]).norm(), 1e-12);
}

/// The largest eigenvalue of the umbrella I - T, by its symmetric form.
double largest_eigenvalue(const Mesh& mesh) {
  const auto n = Eigen::Index(mesh.positions.size());
  Eigen::MatrixXd L = Eigen::MatrixXd::Identity(n, n);
  for (Index i = 0; i < n; ++i)
    for (const Index j : mesh.one_ring[i])
      L(i, j) -= 1 / std::sqrt(double(mesh.one_ring.degree(i)) * double(mesh.one_ring.degree(j)));
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(L, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

// Desbrun prints the umbrella's spectrum as [-1, 0]: explicit steps would then be stable up to 2.
TEST(Umbrella, TheSpectrumReachesOneAndAHalfOnARegularMeshAndTwoOnABipartiteGraph) {
  EXPECT_NEAR(largest_eigenvalue(support::torus(12, 12, 0.4)), 1.5, 1e-9);
  Mesh ring;  // an even cycle of loose edges
  for (Index i = 0; i < 8; ++i) ring.positions.emplace_back(std::cos(i), std::sin(i), 0);
  for (Index i = 0; i < 7; ++i) ring.loose_edges.push_back({i, i + 1});
  ring.loose_edges.insert(ring.loose_edges.begin() + 1, {0, 7});
  rebuild_adjacency(ring, {});
  EXPECT_NEAR(largest_eigenvalue(ring), 2, 1e-12);
}

}  // namespace
