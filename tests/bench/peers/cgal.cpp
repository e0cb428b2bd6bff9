#include <tuple>
#include <utility>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/bilateral_smooth_point_set.h>
#include <CGAL/compute_average_spacing.h>
#include <CGAL/jet_estimate_normals.h>
#include <CGAL/jet_smooth_point_set.h>
#include <CGAL/mst_orient_normals.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/property_map.h>
#include <CGAL/wlop_simplify_and_regularize_point_set.h>
#include <tbb/global_control.h>

#include "tests/bench/peers/peers.h"

namespace rfsmooth::bench::peers {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

#ifndef CGAL_LINKED_WITH_TBB
#error "CGAL's parallel tag runs on one core without its TBB support target"
#endif

/// CGAL takes its threads from TBB's arena.
class Threads {
 public:
  explicit Threads(int threads)
      : control_(tbb::global_control::max_allowed_parallelism,
                 threads > 0
                     ? std::size_t(threads)
                     : tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)) {}

 private:
  tbb::global_control control_;
};

Point to_cgal(const Eigen::Vector3d& p) {
  return {p[0], p[1], p[2]};
}
Eigen::Vector3d from_cgal(const Point& p) {
  return {p.x(), p.y(), p.z()};
}

using Oriented = std::tuple<Point, Kernel::Vector_3, Index>;

/// With room for normals.
std::vector<Oriented> oriented_cloud(const Positions& points) {
  std::vector<Oriented> cloud;
  for (std::size_t i = 0; i < points.size(); ++i)
    cloud.emplace_back(to_cgal(points[i]), Kernel::Vector_3(0, 0, 0), Index(i));
  return cloud;
}

auto oriented_maps() {
  return CGAL::parameters::point_map(CGAL::Nth_of_tuple_property_map<0, Oriented>())
      .normal_map(CGAL::Nth_of_tuple_property_map<1, Oriented>());
}

}  // namespace

Smoothed cgal_jet(const Positions& points, int k, int times, int threads) {
  const Threads limit(threads);
  std::vector<Point> cloud;
  for (const auto& p : points) cloud.push_back(to_cgal(p));
  for (int pass = 0; pass < times; ++pass) CGAL::jet_smooth_point_set<CGAL::Parallel_tag>(cloud, unsigned(k));
  Smoothed result;
  for (const auto& p : cloud) result.points.push_back(from_cgal(p));
  return result;
}

Smoothed cgal_bilateral(const Positions& points, int k, int times, int threads) {
  constexpr unsigned kNormals = 24;
  const Threads limit(threads);
  std::vector<Oriented> cloud = oriented_cloud(points);
  const auto maps = oriented_maps();
  CGAL::jet_estimate_normals<CGAL::Parallel_tag>(cloud, kNormals, maps);
  CGAL::mst_orient_normals(cloud, kNormals, maps);  // moves points without a consistent normal to the end
  for (int pass = 0; pass < times; ++pass)
    CGAL::bilateral_smooth_point_set<CGAL::Parallel_tag>(cloud, unsigned(k), maps.sharpness_angle(25));
  Smoothed result;
  for (const auto& o : cloud) {
    result.points.push_back(from_cgal(std::get<0>(o)));
    result.source.push_back(std::get<2>(o));
  }
  return result;
}

Smoothed cgal_wlop(const Positions& points, double radius, int threads) {
  using Row = std::pair<Point, Index>;
  const Threads limit(threads);
  std::vector<Row> cloud;
  for (std::size_t i = 0; i < points.size(); ++i) cloud.emplace_back(to_cgal(points[i]), Index(i));
  const auto map = CGAL::parameters::point_map(CGAL::First_of_pair_property_map<Row>());
  const double spacing = CGAL::compute_average_spacing<CGAL::Parallel_tag>(cloud, 6, map);
  std::vector<Point> moved;
  CGAL::wlop_simplify_and_regularize_point_set<CGAL::Parallel_tag>(
      cloud, std::back_inserter(moved), map.select_percentage(100).neighbor_radius(radius * spacing));
  // WLOP shuffles its input in place and gives the samples out in that order.
  Smoothed result;
  const std::size_t first = cloud.size() - moved.size();
  for (std::size_t i = 0; i < moved.size(); ++i) {
    result.points.push_back(from_cgal(moved[i]));
    result.source.push_back(cloud[first + i].second);
  }
  return result;
}

Normals cgal_normals(const Positions& points, int k, int threads) {
  const Threads limit(threads);
  std::vector<Oriented> cloud = oriented_cloud(points);
  const auto maps = oriented_maps();
  CGAL::pca_estimate_normals<CGAL::Parallel_tag>(cloud, unsigned(k), maps);
  CGAL::mst_orient_normals(cloud, unsigned(k), maps);
  Normals normals(points.size());
  for (const auto& [p, n, i] : cloud) normals[i] = Eigen::Vector3d(n.x(), n.y(), n.z()).normalized();
  return normals;
}

}  // namespace rfsmooth::bench::peers
