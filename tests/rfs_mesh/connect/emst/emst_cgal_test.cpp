/// The EMST beside CGAL's Delaunay triangulation and Kruskal's rule: a program of its own, since that part is
/// GPL.
#include "tests/bench/peers/emst_cgal.h"

#include <cmath>

#include <gtest/gtest.h>

#include "rfs_mesh/connect/emst/emst.h"
#include "tests/support/awkward_clouds.h"

using rfsmooth::Positions;
using rfsmooth::rfs_mesh::emst;
using rfsmooth::rfs_mesh::SpatialIndex;

namespace {

TEST(EmstBesideCgal, NoisySurfaceHasTheSameTotalLength) {
  constexpr std::size_t kPoints = 200000;
  const double spacing = std::sqrt(4 * 3.14159 / kPoints);
  const Positions points = rfsmooth::test::noisy_sphere(kPoints, 0.5 * spacing, 6);
  const double expected = rfsmooth::bench::peers::emst_length_cgal(points[0].data(), kPoints, false);
  double total = 0;
  const SpatialIndex index(points, {});
  for (const auto& e : emst(index, index.nearest(6, {}), {})) total += (points[e[0]] - points[e[1]]).norm();
  EXPECT_NEAR(total, expected, 1e-10 * expected);
}

}  // namespace
