// Read a PCD file, take the noise out, write it again: example IN.pcd OUT.pcd
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include <rfsmooth/pcl/denoise.h>

int main(int argc, char** argv) {
  const auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  if (argc != 3 || pcl::io::loadPCDFile(argv[1], *cloud) < 0) return 1;
  rfsmooth::pcl::Denoise<pcl::PointXYZ> denoise;
  denoise.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointXYZ> cleaned;
  denoise.filter(cleaned);
  return cleaned.size() == cloud->size() ? pcl::io::savePCDFile(argv[2], cleaned) : 1;
}
