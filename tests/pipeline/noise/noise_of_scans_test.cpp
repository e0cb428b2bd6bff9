/// The noise figure on real scans beside what their flat places show.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "pipeline/io/io.h"
#include "rfs_mesh/fit/local_surface.h"
#include "rfs_mesh/noise/noise.h"
#include "tests/support/scans.h"

namespace rfsmooth::test {
namespace {

using Eigen::Vector3d;

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Robust deviation of points from a plane: the least 70 % quantile of the distances over 80 planes through
/// three of them (RANSAC), as that of a normal distribution.
double off_plane(const Positions& points, const std::vector<rfs_mesh::Neighbor>& near,
                 std::mt19937_64& engine) {
  double least = std::numeric_limits<double>::infinity();
  std::uniform_int_distribution<std::size_t> any(0, near.size() - 1);
  std::vector<double> off(near.size());
  for (int trial = 0; trial < 80; ++trial) {
    const Vector3d& a = points[near[any(engine)].index];
    const Vector3d& b = points[near[any(engine)].index];
    const Vector3d& c = points[near[any(engine)].index];
    const Vector3d normal = (b - a).cross(c - a);
    if (normal.norm() < 1e-12 * near.back().squared_distance) continue;
    for (std::size_t i = 0; i < near.size(); ++i)
      off[i] = std::abs(normal.normalized().dot(points[near[i].index] - a));
    least = std::min(least, quantile(off, 0.7));
  }
  return least / 1.036;
}

struct Scan {
  std::string path;
  double flat;  ///< share of the places that are walls, floors, tables or roofs to the eye
};

/// The crops, and whole scans where there are some.
std::vector<Scan> scans_with_flat_places() {
  std::vector<Scan> scans = {{kBoxCrop, 0.3}, {kBuildingCrop, 0.3}};
  for (const std::string& path :
       whole_scans({"milk_cartoon_all_small_clorox.pcd", "table_scene_mug_stereo_textured.pcd",
                    "mOSD_learn0.pcd", "room_scan1.pcd"}))
    scans.push_back({path, 0.3});
  return scans;
}

class NoiseOfScans : public ::testing::TestWithParam<Scan> {};

TEST_P(NoiseOfScans, IsThatOfTheirFlatPlaces) {
  const Context context;
  const auto cloud = pipeline::io::read_cloud(GetParam().path, {}, context).value();
  const std::vector<double> xyz = pipeline::io::positions(cloud, context);
  const auto working = rfs_mesh::make_working_cloud(xyz.data(), cloud.size(), context).value();
  const Positions& points = working.points;
  const rfs_mesh::SpatialIndex index(points, context);
  std::mt19937_64 engine(1);
  std::vector<double> off;
  std::vector<rfs_mesh::Neighbor> near;
  for (std::size_t s = 0; s < 300; ++s) {
    index.nearest(points[s * points.size() / 300], 100, near);
    off.push_back(off_plane(points, near, engine));
  }
  const double flat = quantile(off, GetParam().flat);
  const NoiseModel noise = rfs_mesh::measure_noise(index, context);
  EXPECT_GT(noise.sigma, flat / 1.7);
  // Planes through so few points follow what neighbours share.
  EXPECT_LT(noise.sigma, flat * 1.5 * std::sqrt(std::max(1.0, noise.shared)));
}

INSTANTIATE_TEST_SUITE_P(Files, NoiseOfScans, ::testing::ValuesIn(scans_with_flat_places()),
                         [](const auto& test) { return test_name(test.param.path); });

}  // namespace
}  // namespace rfsmooth::test
