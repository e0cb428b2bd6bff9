#include <cmath>
#include <limits>

#include <pcl/features/normal_3d_omp.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/mls.h>

#include "tests/bench/peers/peers.h"

namespace rfsmooth::bench::peers {
namespace {

using Cloud = ::pcl::PointCloud<::pcl::PointXYZ>;
using Tree = ::pcl::search::KdTree<::pcl::PointXYZ>;

/// Answers a radius search with the k nearest points.
class NearestInstead : public Tree {
 public:
  explicit NearestInstead(int k) : Tree(true), k_(k) {}
  using Tree::radiusSearch;
  int radiusSearch(::pcl::index_t index, double, ::pcl::Indices& found, std::vector<float>& squared,
                   unsigned int) const override {
    return nearestKSearch(index, k_, found, squared);
  }

 private:
  int k_;
};

Cloud::Ptr to_pcl(const Positions& points) {
  Cloud::Ptr cloud(new Cloud);
  for (const auto& p : points) cloud->push_back({float(p[0]), float(p[1]), float(p[2])});
  return cloud;
}

double mean_distance_to_kth(const Cloud::Ptr& cloud, int k) {
  Tree tree(true);
  tree.setInputCloud(cloud);
  double sum = 0;
  std::size_t count = 0;
  const std::size_t step = std::max<std::size_t>(1, cloud->size() / 1000);  // a thousand points tell the mean
  ::pcl::Indices found;
  std::vector<float> squared;
  for (std::size_t i = 0; i < cloud->size(); i += step, ++count) {
    tree.nearestKSearch(::pcl::index_t(i), k, found, squared);
    sum += std::sqrt(double(squared.back()));
  }
  return sum / double(count);
}

Smoothed moving_least_squares(const Cloud::Ptr& cloud, int k, int threads) {
  ::pcl::MovingLeastSquares<::pcl::PointXYZ, ::pcl::PointXYZ> mls;
  mls.setInputCloud(cloud);
  mls.setSearchMethod(Tree::Ptr(new NearestInstead(k)));
  mls.setSearchRadius(mean_distance_to_kth(cloud, k));
  mls.setPolynomialOrder(2);
  mls.setComputeNormals(false);
  mls.setNumberOfThreads(unsigned(threads));  // 0 = all cores here too
  Cloud out;
  mls.process(out);
  Smoothed result;
  const auto& rows = mls.getCorrespondingIndices()->indices;
  for (std::size_t i = 0; i < out.size(); ++i) {
    result.points.emplace_back(out[i].x, out[i].y, out[i].z);
    result.source.push_back(Index(rows[i]));
  }
  return result;
}

}  // namespace

Smoothed pcl_mls(const Positions& points, int k, int threads) {
  return moving_least_squares(to_pcl(points), k, threads);
}

Smoothed pcl_outliers_mls(const Positions& points, double deviations, int k, int threads) {
  constexpr int kNeighbours = 50;  // the value of PCL's tutorial
  const auto cloud = to_pcl(points);
  ::pcl::StatisticalOutlierRemoval<::pcl::PointXYZ> filter;
  filter.setInputCloud(cloud);
  filter.setMeanK(kNeighbours);
  filter.setStddevMulThresh(deviations);
  ::pcl::Indices kept;
  filter.filter(kept);
  Cloud::Ptr inliers(new Cloud(*cloud, kept));
  Smoothed result = moving_least_squares(inliers, k, threads);
  for (auto& row : result.source) row = Index(kept[row]);
  return result;
}

Normals pcl_normals(const Positions& points, int k, int threads) {
  ::pcl::NormalEstimationOMP<::pcl::PointXYZ, ::pcl::Normal> estimation(static_cast<unsigned int>(threads));
  estimation.setInputCloud(to_pcl(points));
  estimation.setSearchMethod(Tree::Ptr(new Tree(false)));
  estimation.setKSearch(k);
  ::pcl::PointCloud<::pcl::Normal> out;
  estimation.compute(out);
  Normals normals;
  for (const auto& n : out) normals.emplace_back(double(n.normal_x), double(n.normal_y), double(n.normal_z));
  return normals;
}

}  // namespace rfsmooth::bench::peers
