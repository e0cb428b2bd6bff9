#include "smoothing/remesh/ridges.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using Eigen::Vector3d;
using rfsmooth::Mesh;

namespace {

TEST(PrincipalCurvatures, OfASphereAndACylinder) {
  const PrincipalCurvatures sphere = principal_curvatures(support::icosphere(4), {});
  ASSERT_EQ(sphere.k1.size(), 2562u);
  for (std::size_t i = 0; i < sphere.k1.size(); ++i) {
    EXPECT_NEAR(sphere.k1[i], 1, 0.03);
    EXPECT_NEAR(sphere.k2[i], 1, 0.03);
    EXPECT_NEAR(0.5 * (sphere.k1[i] + sphere.k2[i]), 1, 0.01);
  }
  // Rings apart by half their spacing: nearly equilateral faces.
  const int around = 64, rings = 9;
  const Mesh mesh = support::cylinder(around, rings, 0.085);
  const PrincipalCurvatures cylinder = principal_curvatures(mesh, {});
  for (std::size_t i = 3 * around; i < 6 * around; ++i) {
    EXPECT_NEAR(cylinder.k1[i], 1, 0.05);
    EXPECT_NEAR(cylinder.k2[i], 0, 0.05);
    EXPECT_LT(std::abs(cylinder.direction1[i].z()), 0.05);
  }
}

TEST(Ridges, ASineSheetHasRidgesOnItsCrestsAndRavinesInItsTroughs) {
  const int columns = 41, rows = 15;
  Mesh mesh = support::grid(columns, rows);
  for (Vector3d& p : mesh.positions) p.z() = 1.5 * std::cos(2 * 3.14159265358979 * p.x() / 20);
  const std::vector<int> kind = ridges_and_ravines(mesh, 0.01, {});
  for (int r = 3; r < rows - 3; ++r)
    for (int c = 3; c < columns - 3; ++c) {
      const int expected = c % 20 == 0 ? 1 : c % 20 == 10 ? -1 : 0;
      EXPECT_EQ(kind[std::size_t(r * columns + c)], expected) << c << ' ' << r;
    }
}

TEST(Ridges, APlaneHasNone) {
  EXPECT_EQ(ridges_and_ravines(support::grid(9, 9), 0, {}), std::vector<int>(81, 0));
}

}  // namespace
