#include "smoothing/automatic/guide/guide_normals.h"

#include <cmath>

#include <gtest/gtest.h>

namespace rfsmooth::smoothing {
namespace {

/// Circles about the z axis on the unit sphere, `gap` apart, with points a twentieth of that apart.
Positions circles(double gap) {
  Positions points;
  for (double polar = gap; polar < M_PI - gap / 2; polar += gap) {
    const auto count = int(2 * M_PI * std::sin(polar) / (gap / 20));
    for (int i = 0; i < count; ++i) {
      const double turn = 2 * M_PI * i / count;
      points.emplace_back(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn),
                          std::cos(polar));
    }
  }
  return points;
}

/// The share of the points whose normals are within 10 degrees of the sphere's, all on one side.
double share_right(const Positions& points, const std::vector<Eigen::Vector3f>& normals) {
  std::size_t out = 0, in = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double cosine = points[i].dot(normals[i].cast<double>());
    out += std::size_t(cosine > std::cos(M_PI / 18));
    in += std::size_t(cosine < -std::cos(M_PI / 18));
  }
  return double(std::max(out, in)) / double(points.size());
}

TEST(GuideNormals, AcrossLinesAreThoseOfTheSurfaceOnOneSide) {
  const Positions points = circles(M_PI / 40);
  ASSERT_GT(points.size(), 10000u);
  const rfs_mesh::NeighborTable near = rfs_mesh::SpatialIndex(points, {}).nearest(32, {});
  EXPECT_LT(share_right(points, surface_normals(points, near, {})), 0.5)
      << "a circle's plane is not the sphere's";
  EXPECT_GT(share_right(points, normals_across_lines(points, near, 128, {})), 0.98);
}

TEST(GuideNormals, AreUnitAlsoOfFewPoints) {
  for (const std::size_t n : {2u, 3u, 40u}) {
    Positions points;
    for (std::size_t i = 0; i < n; ++i) points.emplace_back(double(i), 0.1 * double(i % 3), 0);
    const rfs_mesh::NeighborTable near = rfs_mesh::SpatialIndex(points, {}).nearest(32, {});
    for (const auto& normals :
         {surface_normals(points, near, {}), normals_across_lines(points, near, 64, {})}) {
      ASSERT_EQ(normals.size(), n);
      for (const Eigen::Vector3f& normal : normals) EXPECT_NEAR(normal.norm(), 1, 1e-5) << n;
    }
  }
}

}  // namespace
}  // namespace rfsmooth::smoothing
