// Three doors, one room: the command, the PCL filter and the Open3D call give the same coordinates for the
// same float32 input, after rounding to float32.
#include <cmath>
#include <cstring>
#include <filesystem>

#include <gtest/gtest.h>
#include <open3d/geometry/PointCloud.h>
#include <pcl/point_types.h>

#include <rfsmooth/open3d/denoise.h>
#include <rfsmooth/pcl/denoise.h>

#include "pipeline/io/io.h"
#include "tests/cli/support/folder.h"

namespace rfsmooth::test {
namespace {

using Floats = std::vector<float>;  // n x 3

Floats read_floats(const std::string& path) {
  const auto cloud = pipeline::io::read_cloud(path, {}, {});
  EXPECT_TRUE(cloud.ok()) << path;
  const std::vector<double> xyz = pipeline::io::positions(cloud.value(), {});
  return {xyz.begin(), xyz.end()};
}

Floats through_pcl(const Floats& xyz) {
  const auto cloud = ::pcl::make_shared<::pcl::PointCloud<::pcl::PointXYZ>>();
  for (std::size_t i = 0; i < xyz.size(); i += 3) cloud->push_back({xyz[i], xyz[i + 1], xyz[i + 2]});
  rfsmooth::pcl::Denoise<::pcl::PointXYZ> denoise;
  denoise.setInputCloud(cloud);
  ::pcl::PointCloud<::pcl::PointXYZ> out;
  denoise.filter(out);
  EXPECT_EQ(denoise.getStatus(), "");
  Floats made;
  for (const auto& p : out) made.insert(made.end(), {p.x, p.y, p.z});
  return made;
}

Floats through_open3d(const Floats& xyz) {
  ::open3d::geometry::PointCloud cloud;
  for (std::size_t i = 0; i < xyz.size(); i += 3) cloud.points_.emplace_back(xyz[i], xyz[i + 1], xyz[i + 2]);
  const auto done = rfsmooth::open3d::denoise(cloud);
  EXPECT_TRUE(done.ok());
  Floats made;
  for (const auto& p : cloud.points_) made.insert(made.end(), {float(p[0]), float(p[1]), float(p[2])});
  return made;
}

class Doors : public InFolder, public ::testing::WithParamInterface<const char*> {};

TEST_P(Doors, GiveTheSameCoordinates) {
  const std::string name = GetParam();
  const auto source = std::filesystem::path(RFSMOOTH_SOURCE) / "clouds" / name;
  const Ran ran = run({"denoise", source.string(), name});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const Floats before = read_floats(source.string()), command = read_floats(at(name));
  const Floats pcl = through_pcl(before), open3d = through_open3d(before);
  ASSERT_EQ(command.size(), before.size());
  ASSERT_EQ(pcl.size(), before.size());
  ASSERT_EQ(open3d.size(), before.size());
  std::size_t moved = 0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    if (std::isnan(before[k])) {
      EXPECT_TRUE(std::isnan(command[k]) && std::isnan(pcl[k]) && std::isnan(open3d[k])) << k;
      continue;
    }
    moved += command[k] != before[k];
    EXPECT_EQ(command[k], pcl[k]) << "coordinate " << k;
    EXPECT_EQ(command[k], open3d[k]) << "coordinate " << k;
  }
  EXPECT_GT(3 * moved, before.size());
}

// Two PLY and two PCD files with float32 coordinates; the last is organised and has holes.
INSTANTIATE_TEST_SUITE_P(Samples, Doors,
                         ::testing::Values("l_part_scan.ply", "plate_scan.ply", "torus_scan.pcd",
                                           "wavy_sheet_organised.pcd"),
                         [](const auto& sample) {
                           return std::filesystem::path(sample.param).stem().string();
                         });

}  // namespace
}  // namespace rfsmooth::test
