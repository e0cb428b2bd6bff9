#include "rfs_mesh/normals/orient.h"

#include <random>

#include <gtest/gtest.h>

#include <rfsmooth/connect.h>

#include "rfs_mesh/normals/bilateral_normals.h"
#include "rfs_mesh/normals/sides.h"
#include "tests/support/shapes.h"

namespace rfsmooth::rfs_mesh {
namespace {

using Eigen::Vector3d;

TEST(Sides, RegionsFollowTheLinksOfATree) {
  // 0 - 1 agree, 1 - 2 do not, 3 is alone.
  const Regions regions = grow_regions(4, {{0, 1, 0.9f, 1}, {2, 1, -0.7f, 1}}, {}, {});
  EXPECT_EQ(regions.of_point, (std::vector<Index>{0, 0, 0, 3}));
  EXPECT_EQ(regions.turned, (std::vector<char>{0, 0, 1, 0}));
}

TEST(Sides, ManyVoicesOverruleOneSurerLink) {
  // Two cliques of three whose members agree surely; one sure link between them says "turned", eight doubtful
  // ones say "alike".
  std::vector<SideLink> links;
  for (const Index base : {0u, 3u})
    for (Index i = 0; i < 3; ++i)
      for (Index j = 0; j < i; ++j) links.push_back({base + i, base + j, 1, 1});
  for (Index i = 0; i < 3; ++i)
    for (Index j = 3; j < 6; ++j) links.push_back({i, j, i == 0 && j == 3 ? -0.85f : 0.6f, 1});
  const Regions regions = grow_regions(6, links, {}, {});
  EXPECT_EQ(regions.of_point, std::vector<Index>(6, 0));
  EXPECT_EQ(regions.turned, std::vector<char>(6, 0));
}

TEST(Sides, VotesRefuseAJoinThatSpeaksSofter) {
  const std::vector<SideLink> links = {{0, 1, 0.5f, 1}};
  EXPECT_EQ(grow_regions(2, links, {1, -0.4}, {}).of_point, (std::vector<Index>{0, 0}));
  EXPECT_EQ(grow_regions(2, links, {1, -0.6}, {}).of_point, (std::vector<Index>{0, 1}));
  EXPECT_EQ(grow_regions(2, links, {1, 0.6}, {}).of_point, (std::vector<Index>{0, 0}));
}

TEST(Sides, InBlocksPointsFindTheSameSideAsAllAtOnce) {
  // A strip many blocks long whose points are turned at random; every hundredth column agrees faintly only.
  const std::size_t width = 10, n = 3000 * width;
  std::mt19937 engine(5);
  std::vector<float> side(n);
  for (float& s : side) s = engine() % 2 == 0 ? 1 : -1;
  const auto links = [&](std::size_t begin, std::size_t end, std::vector<SideLink>& out) {
    for (std::size_t i = begin; i < end; ++i)
      for (const std::size_t step : {std::size_t{1}, width}) {
        if (i + step >= n || (step == 1 && (i + 1) % width == 0)) continue;
        const float sure = step == width && i / width % 100 == 7 ? 0.3F : 0.95F;
        out.push_back({Index(i + step), Index(i), sure * side[i] * side[i + step], 1});
      }
  };
  std::vector<SideLink> all;
  links(0, n, all);
  const Regions once = grow_regions(n, all, {}, {}), blocks = grow_regions_in_blocks(n, links, {});
  EXPECT_EQ(blocks.of_point, std::vector<Index>(n, 0));
  EXPECT_EQ(blocks.of_point, once.of_point);
  EXPECT_EQ(blocks.turned, once.turned);
  for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(blocks.turned[i] != 0, side[i] != side[0]);
}

TEST(Orient, DoesNotDependOnTheSideTheNormalsCameWith) {
  const Positions points = test::poisson_points(test::cube(), 2000, 1);
  const Connection c = rfsmooth::connect(points, {}, {}).value();
  std::mt19937 engine(3);
  Positions one, other;
  for (const auto& s : c.surfaces) {
    one.push_back(s.normal);
    other.emplace_back(engine() % 2 == 0 ? s.normal : Vector3d(-s.normal));
  }
  EXPECT_EQ(orient(c.mesh, c.emst, c.bridges, {}, one, {}), orient(c.mesh, c.emst, c.bridges, {}, other, {}));
  EXPECT_EQ(one, other);
}

TEST(Orient, RefusesAnotherNumberOfNormals) {
  Mesh mesh;
  mesh.positions.assign(3, Vector3d::Zero());
  rebuild_adjacency(mesh, {});
  Positions normals(2, Vector3d::UnitX());
  EXPECT_THROW(orient(mesh, {}, {}, {}, normals, {}), std::invalid_argument);
}

TEST(BilateralNormals, LeaveAPlaneAloneAndKeepAnEdge) {
  // A roof: two planes at a right angle, exact normals but for noise of a few degrees.
  std::mt19937 engine(1);
  std::normal_distribution<double> noise(0, 0.05);
  Positions points, truth, normals;
  for (int i = -20; i < 20; ++i)
    for (int j = 0; j < 40; ++j) {
      const double u = i + 0.5;
      points.emplace_back(u, j, -std::abs(u));
      truth.push_back(Vector3d(u < 0 ? -1 : 1, 0, 1).normalized());
      const double x = noise(engine), y = noise(engine), z = noise(engine);
      normals.push_back((truth.back() + Vector3d(x, y, z)).normalized());
    }
  const SpatialIndex index(points, {});
  const std::vector<double> scatter(points.size(), 0.1);
  bilateral_normals(points, index.nearest(32, {}), scatter, normals, {});
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(normals[i].norm(), 1, 1e-12);
    EXPECT_GT(normals[i].dot(truth[i]), std::cos(0.06)) << "half of the noise is gone, at the edge, too";
  }
}

TEST(BilateralNormals, FollowAShapeThatPointsLieOnAndCalmOneThatTheyScatterAbout) {
  // Normals that turn by a twentieth of a radian and more from point to point, all ways mixed.
  Positions points, normals;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) {
      points.emplace_back(i, j, 0);
      normals.push_back(Vector3d(0.05 * ((i + 2 * j) % 5 - 2), 0, 1).normalized());
    }
  const SpatialIndex index(points, {});
  const NeighborTable near = index.nearest(48, {});
  const auto turned = [&](double scatter) {
    Positions filtered = normals;
    bilateral_normals(points, near, std::vector<double>(points.size(), scatter), filtered, {});
    double most = 0;
    for (const auto& n : filtered) most = std::max(most, std::abs(n[0]));
    return most;
  };
  EXPECT_GT(turned(0), 0.075) << "the shape";
  EXPECT_LT(turned(0.3), 0.05) << "noise";
}

}  // namespace
}  // namespace rfsmooth::rfs_mesh
