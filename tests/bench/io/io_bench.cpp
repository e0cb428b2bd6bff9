// Reading and writing 1,000,000 points with five fields (x y z rgb label) beside PCL's own readers and
// writers: warm, in turns, the best and the median of many runs, without the final sync, each writer over its
// own last file (the one who replaces a file pays for letting go of its pages). PCLPointCloud2 is PCL's cloud
// of any fields, as ours is.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <random>
#include <vector>

#include <pcl/PCLPointCloud2.h>
#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <unistd.h>

#include "pipeline/io/io.h"

namespace {

constexpr int kRuns = 11;
constexpr std::size_t kPoints = 1000000;

struct Timed {
  const char* what;
  std::function<void()> run;
};

/// All of them in turns, so that a busy machine is unfair to none.
void time_in_turns(const std::vector<Timed>& all) {
  std::vector<std::vector<double>> ms(all.size());
  for (const Timed& timed : all) timed.run();  // warm
  for (int k = 0; k < kRuns; ++k)
    for (std::size_t i = 0; i < all.size(); ++i) {
      const auto start = std::chrono::steady_clock::now();
      all[i].run();
      ms[i].push_back(
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    }
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::sort(ms[i].begin(), ms[i].end());
    std::printf("%-44s best %8.1f ms   median %8.1f ms\n", all[i].what, ms[i].front(),
                ms[i][ms[i].size() / 2]);
  }
  std::fflush(stdout);
}

}  // namespace

int main() {
  namespace io = rfsmooth::pipeline::io;
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("rfsmooth_io_bench_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const std::string pcd = folder / "in.pcd", packed = folder / "in_compressed.pcd", ply = folder / "in.ply",
                    ours = folder / "ours", theirs = folder / "theirs";

  std::mt19937 engine(1);
  std::uniform_real_distribution<float> coordinate(-1, 1);
  pcl::PointCloud<pcl::PointXYZRGBL> points(kPoints, 1);
  for (auto& p : points) {
    p.x = coordinate(engine);
    p.y = coordinate(engine);
    p.z = coordinate(engine);
    p.rgba = engine();
    p.label = engine() % 100;
  }
  pcl::PCLPointCloud2 cloud2;
  pcl::io::savePCDFileBinary(pcd, points);
  pcl::io::savePCDFileBinaryCompressed(packed, points);
  pcl::io::loadPCDFile(pcd, cloud2);
  pcl::PLYWriter().writeBinary(ply, cloud2, Eigen::Vector4f::Zero(), Eigen::Quaternionf::Identity(), false);

  for (const std::string& file : {pcd, packed, ply}) {
    const bool is_ply = file == ply;
    std::printf("-- read %s\n", std::filesystem::path(file).filename().c_str());
    time_in_turns({{"rfsmooth read_cloud", [&] { (void)io::read_cloud(file, {}, {}).value().size(); }},
                   {"rfsmooth read_cloud + positions",
                    [&] { (void)io::positions(io::read_cloud(file, {}, {}).value()).size(); }},
                   {"PCL, PCLPointCloud2",
                    [&] {
                      pcl::PCLPointCloud2 read;
                      if (is_ply) {
                        pcl::PLYReader().read(file, read);
                      } else {
                        pcl::PCDReader().read(file, read);
                      }
                    }},
                   {"PCL, PointCloud<PointXYZRGBL>", [&] {
                      pcl::PointCloud<pcl::PointXYZRGBL> read;
                      if (is_ply) {
                        pcl::io::loadPLYFile(file, read);
                      } else {
                        pcl::io::loadPCDFile(file, read);
                      }
                    }}});
  }
  for (const std::string& file : {pcd, packed, ply}) {
    std::printf("-- write %s\n", std::filesystem::path(file).filename().c_str());
    const io::Cloud cloud = io::read_cloud(file, {}, {}).value();
    io::WriteOptions options;
    options.format = cloud.format;
    options.force = true;
    options.sync = false;
    time_in_turns({{"rfsmooth write_cloud", [&] { (void)io::write_cloud(cloud, ours, options, {}).value(); }},
                   {"PCL, PCLPointCloud2", [&] {
                      if (file == ply) {
                        pcl::PLYWriter().writeBinary(theirs, cloud2, Eigen::Vector4f::Zero(),
                                                     Eigen::Quaternionf::Identity(), false);
                      } else if (file == packed) {
                        pcl::PCDWriter().writeBinaryCompressed(theirs, cloud2);
                      } else {
                        pcl::PCDWriter().writeBinary(theirs, cloud2);
                      }
                    }}});
  }
  std::filesystem::remove_all(folder);
}
