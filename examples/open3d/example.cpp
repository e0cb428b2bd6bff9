// Read a cloud, take the noise out, write it again: example IN OUT
#include <cstdio>

#include <open3d/geometry/PointCloud.h>
#include <open3d/io/PointCloudIO.h>

#include <rfsmooth/open3d/denoise.h>

int main(int argc, char** argv) {
  open3d::geometry::PointCloud cloud;
  if (argc != 3 || !open3d::io::ReadPointCloud(argv[1], cloud)) return 1;
  const auto done = rfsmooth::open3d::denoise(cloud);
  if (!done.ok()) return std::printf("%s\n", done.error().message.c_str()), 1;
  return open3d::io::WritePointCloud(argv[2], cloud) ? 0 : 1;
}
