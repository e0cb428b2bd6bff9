// From a raw scan to a surface: thin out, denoise, normals, Poisson. pipeline IN.pcd OUT.ply
#include <pcl/filters/voxel_grid.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>
#include <pcl/surface/poisson.h>

#include <rfsmooth/pcl/denoise_surface.h>

int main(int argc, char** argv) {
  const auto scan = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  if (argc != 3 || pcl::io::loadPCDFile(argv[1], *scan) < 0) return 1;

  pcl::VoxelGrid<pcl::PointXYZ> grid;
  grid.setInputCloud(scan);
  grid.setLeafSize(0.03F, 0.03F, 0.03F);
  const auto thinned = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  grid.filter(*thinned);

  rfsmooth::pcl::DenoiseSurface<pcl::PointXYZ, pcl::PointNormal> denoise;
  denoise.setInputCloud(thinned);
  const auto surface = pcl::make_shared<pcl::PointCloud<pcl::PointNormal>>();
  denoise.process(*surface);

  pcl::Poisson<pcl::PointNormal> poisson;
  poisson.setInputCloud(surface);
  poisson.setDepth(6);
  pcl::PolygonMesh mesh;
  poisson.reconstruct(mesh);
  return mesh.polygons.empty() ? 1 : pcl::io::savePLYFile(argv[2], mesh);
}
