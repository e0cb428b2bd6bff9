#include "smoothing/remesh/refine.h"

#include <cmath>

#include <gtest/gtest.h>

#include "smoothing/modifiers/boundary.h"
#include "smoothing/operators/operator.h"
#include "tests/support/fairing_energy.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using Eigen::Vector3d;
using rfsmooth::Edge;
using rfsmooth::Mesh;

namespace {

Mesh subdivided(Mesh mesh, int levels) {
  for (int k = 0; k < levels; ++k) {
    std::vector<Edge> curve = boundary_edges(mesh);
    mesh = split(mesh, curve, {});
  }
  return mesh;
}

TEST(Refine, InterpolatesExactlyWithLessThinPlateEnergyThanTheSubdividedInput) {
  for (const Chart chart : {Chart::tangent, Chart::exponential, Chart::mixed})
    for (const Mesh& coarse : {support::icosphere(1), support::torus(10, 8, 0.4)}) {
      RefineOptions options;
      options.levels = 2;
      options.chart = chart;
      const Mesh fine = refine(coarse, options, {}).value(), flat = subdivided(coarse, 2);
      ASSERT_EQ(fine.faces.size(), 16 * coarse.faces.size());
      EXPECT_TRUE(check(fine).empty());
      for (std::size_t i = 0; i < coarse.positions.size(); ++i)
        EXPECT_EQ(fine.positions[i], coarse.positions[i]);
      const Operator op = umbrella(fine.one_ring, {});
      EXPECT_LT(thin_plate_energy(fine.one_ring, op, fine.positions, {}),
                0.7 * thin_plate_energy(flat.one_ring, op, flat.positions, {}))
          << int(chart);
      const DividedDifferences d(flat, chart, {});
      EXPECT_LT(support::energy(d, fine.positions), support::energy(d, flat.positions)) << int(chart);
    }
}

TEST(Refine, ASphereBecomesRounder) {
  const Mesh coarse = support::icosphere(1);
  RefineOptions options;
  options.levels = 2;
  EXPECT_LT(support::rms_off_unit_sphere(refine(coarse, options, {}).value().positions),
            0.4 * support::rms_off_unit_sphere(subdivided(coarse, 2).positions));
}

TEST(Refine, TheNumberOfVerticesIsKnownBeforehand) {
  Mesh loose = support::grid(5, 4);
  loose.loose_edges = {{0, 19}};
  rebuild_adjacency(loose, {});
  for (const Mesh& coarse : {support::icosphere(1), support::torus(10, 8, 0.4), loose})
    for (const int levels : {0, 1, 3})
      EXPECT_EQ(refined_vertices(coarse, levels), subdivided(coarse, levels).positions.size());
}

TEST(Refine, MoreVerticesThanThereAreNumbersForAreRefusedBeforeAnyWork) {
  RefineOptions options;
  options.levels = 10;
  const auto refused = refine(support::grid(70, 70), options, {});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
}

TEST(Refine, APlaneStaysAPlane) {
  RefineOptions options;
  options.levels = 2;
  const Mesh fine = refine(support::grid(5, 4), options, {}).value();
  ASSERT_EQ(fine.positions.size(), 17u * 13) << "every edge in four";
  for (const Vector3d& p : fine.positions) EXPECT_EQ(p.z(), 0);
}

TEST(Refine, BoundaryCurvesDependOnThemselvesOnly) {
  Mesh flat = support::cylinder(12, 5, 0.5), bulged = flat;
  for (std::size_t i = 24; i < 36; ++i) bulged.positions[i] *= 1.5;
  RefineOptions options;
  options.levels = 2;
  const Mesh a = refine(flat, options, {}).value(), b = refine(bulged, options, {}).value();
  const std::vector<Edge> rims = boundary_edges(a);
  ASSERT_EQ(rims.size(), 2u * 12 * 4) << "two rims of twelve edges, each in four";
  std::size_t on_lower_rim = 0;
  for (const Edge& e : rims) {
    EXPECT_EQ(a.positions[e[0]], b.positions[e[0]]);
    if (std::abs(a.positions[e[0]].z()) < 1e-12) {
      ++on_lower_rim;
      EXPECT_NEAR(a.positions[e[0]].head<2>().norm(), 1, 0.01) << "the four-point scheme rounds the circle";
    }
  }
  EXPECT_EQ(on_lower_rim, 48u);
}

TEST(Refine, SharpLinesInsideFollowTheCurveScheme) {
  const Mesh mesh = support::grid(5, 5);
  std::vector<Edge> sharp;
  for (Index c = 0; c < 4; ++c) sharp.push_back({10 + c, 11 + c});
  Mesh bent = mesh;
  for (std::size_t i = 15; i < 25; ++i) bent.positions[i].z() = bent.positions[i].y() - 2;
  RefineOptions options;
  const Mesh fine = refine(bent, options, {}, sharp).value();
  std::size_t on_line = 0;
  for (const Vector3d& p : fine.positions)
    if (std::abs(p.y() - 2) < 1e-9) {
      ++on_line;
      EXPECT_NEAR(p.z(), 0, 1e-12);
    }
  EXPECT_EQ(on_line, 9u) << "five points of the line and one between each two";
  EXPECT_THROW((void)refine(mesh, options, {}, {{0, 24}}), std::invalid_argument);
}

TEST(Refine, PimplesMayMoveByTheirLimitOnly) {
  Mesh coarse = support::icosphere(1);
  coarse.positions[0] *= 1.2;
  RefineOptions options;
  options.levels = 2;
  options.pimple = 0.1;
  const Mesh fine = refine(coarse, options, {}).value();
  EXPECT_NE(fine.positions[0], coarse.positions[0]);
  for (std::size_t i = 0; i < coarse.positions.size(); ++i)
    EXPECT_LE((fine.positions[i] - coarse.positions[i]).norm(), 0.1 * support::mean_edge(fine) * 1.01);
}

TEST(Refine, BrokenMeshesStayFinite) {
  for (const Mesh& mesh : {support::non_manifold_fan(), support::degenerate_triangles()}) {
    const Mesh fine = refine(mesh, {}, {}).value();
    EXPECT_GT(fine.positions.size(), mesh.positions.size());
    for (const Vector3d& p : fine.positions) EXPECT_TRUE(p.allFinite());
  }
}

/// All edges of a cube are sharp, so its sides are planes with straight rims and stay that.
TEST(Refine, TheSidesOfASharpEdgeDoNotPullAtEachOther) {
  for (const Chart chart : {Chart::tangent, Chart::exponential, Chart::mixed})
    for (const double pimple : {0.0, 0.2}) {
      const Mesh cube = support::cube(2);
      std::vector<Edge> sharp;
      const auto sides = [&](Index i) { return (cube.positions[i].cwiseAbs().array() == 1).count(); };
      for (const Edge& e : rfsmooth::edges_of(cube.one_ring, {})) {
        const auto shared = (cube.positions[e[0]].array() == cube.positions[e[1]].array() &&
                             cube.positions[e[0]].array().abs() == 1)
                                .count();
        if (sides(e[0]) >= 2 && sides(e[1]) >= 2 && shared == 2) sharp.push_back(e);
      }
      ASSERT_EQ(sharp.size(), 24u);
      RefineOptions options;
      options.levels = 2;
      options.chart = chart;
      options.pimple = pimple;
      options.tolerance = 1e-10;
      const Mesh fine = refine(cube, options, {}, sharp).value();
      for (const Vector3d& p : fine.positions) EXPECT_NEAR(p.cwiseAbs().maxCoeff(), 1, 1e-8) << int(chart);
    }
}

}  // namespace
