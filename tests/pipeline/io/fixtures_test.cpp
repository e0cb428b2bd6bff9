// Files written by PCL, Open3D, CloudCompare and MeshLab (fixtures/README.md).
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "pipeline/io/io.h"

using namespace rfsmooth;                // NOLINT(google-build-using-namespace)
using namespace rfsmooth::pipeline::io;  // NOLINT(google-build-using-namespace)

namespace {

TEST(Fixtures, FilesOfRealToolsAreReadAndComeBack) {
  std::size_t seen = 0;
  for (const auto& entry : std::filesystem::directory_iterator(RFSMOOTH_FIXTURES_DIR)) {
    if (!format_of_extension(entry.path()) || entry.path().filename() == "CMakeLists.txt") continue;
    SCOPED_TRACE(entry.path());
    ++seen;
    std::ifstream in(entry.path(), std::ios::binary);
    std::ostringstream bytes;
    bytes << in.rdbuf();
    const auto read = read_cloud(entry.path(), {}, {});
    ASSERT_TRUE(read.ok()) << read.error().message;
    const Cloud& cloud = read.value();
    const std::string ours = serialize_cloud(cloud, {}, {}).value();
    if (cloud.encoding != Encoding::binary_compressed) {
      EXPECT_EQ(ours, bytes.str());
    }
    EXPECT_EQ(parse_cloud(ours, "again", {}, {}).value().points().data, cloud.points().data);
    const std::vector<double> xyz = positions(cloud);
    const std::string name = entry.path().filename().string();
    if (name.substr(0, 6) == "open3d") {
      ASSERT_EQ(cloud.size(), 7u);
      EXPECT_EQ(xyz[3 * 6 + 2], 6);
      // Open3D itself writes six digits in ascii PLY and floats in binary PCD.
      if (cloud.format == Format::ply ? cloud.encoding != Encoding::ascii
                                      : cloud.encoding == Encoding::ascii) {
        EXPECT_NEAR(xyz[3 * 6], 500000.6, 1e-9);
      }
    } else if (name.substr(0, 3) == "pcl") {
      ASSERT_EQ(cloud.size(), 12u);
      EXPECT_TRUE(std::isnan(xyz[3 * 5 + 2]));
      EXPECT_EQ(xyz[3 * 11 + 2], -11);
      EXPECT_EQ(cloud.organised(), cloud.format == Format::pcd);
    }
  }
  EXPECT_GE(seen, 12u);
}

}  // namespace
