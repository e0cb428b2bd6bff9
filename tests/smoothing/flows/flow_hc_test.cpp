#include <gtest/gtest.h>

#include <rfsmooth/flow.h>

#include "tests/support/meshes.h"

using namespace rfsmooth;

namespace {

/// The paper's listing, word for word (Vollmer, Algorithmus 1), one step.
void hc_listing(const Mesh& mesh, const Positions& o, Positions& p, double alpha, double beta) {
  const Positions q = p;
  Positions b(p.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (mesh.one_ring.degree(i) == 0) continue;
    p[i].setZero();
    for (const Index j : mesh.one_ring[i]) p[i] += q[j] / double(mesh.one_ring.degree(i));
    b[i] = p[i] - (alpha * o[i] + (1 - alpha) * q[i]);
  }
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (mesh.one_ring.degree(i) == 0) continue;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Index j : mesh.one_ring[i]) mean += b[j] / double(mesh.one_ring.degree(i));
    p[i] -= beta * b[i] + (1 - beta) * mean;
  }
}

TEST(Hc, IsThePapersListing) {
  for (Mesh& mesh : support::all_small()) {
    support::add_noise(mesh, 0.05, 3);
    const Positions o = mesh.positions;
    Positions expected = o;
    for (int step = 0; step < 3; ++step) hc_listing(mesh, o, expected, 0.2, 0.7);
    HcOptions options;
    options.iterations = 3;
    options.alpha = 0.2;
    options.beta = 0.7;
    ASSERT_TRUE(smooth(mesh, {options}, {}).ok());
    EXPECT_LT(support::rms_distance(mesh.positions, expected), 1e-13);
  }
}

TEST(Hc, KeepsTheVolumeThatTheLaplacianLoses) {
  const Mesh clean = support::icosphere(4);
  Mesh hc = clean;
  support::add_noise(hc, 0.2 * support::mean_edge(clean), 1);
  Mesh laplacian = hc;
  const double volume = support::enclosed_volume(hc);
  ASSERT_TRUE(smooth(hc, {HcOptions()}, {}).ok());
  ASSERT_TRUE(smooth(laplacian, {LaplacianOptions()}, {}).ok());
  EXPECT_NEAR(support::enclosed_volume(hc) / volume, 1, 0.01);
  EXPECT_LT(support::rms_off_unit_sphere(hc.positions), 0.1 * support::mean_edge(clean));
  EXPECT_LT(support::enclosed_volume(laplacian) / volume, 0.99);
}

}  // namespace
