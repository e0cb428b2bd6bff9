/// The tools rfsmooth is measured against, behind plain arrays. Each library's headers stay in one .cpp here.
///
/// Every call takes n x 3 points in any unit, at most `threads` threads (0 = all cores), and gives back the
/// smoothed points with the input row each came from. Peers see what their users give them: positions only.
#pragma once

#include "rfs_mesh/points.h"

namespace rfsmooth::bench::peers {

struct Smoothed {
  Positions points;
  std::vector<Index> source;  ///< input row of each point; empty = row i
};

/// CGAL::jet_smooth_point_set on the k nearest points, `times` passes, degree 2 as by default.
Smoothed cgal_jet(const Positions& points, int k, int times, int threads);

/// CGAL::bilateral_smooth_point_set, `times` passes with sharpness angle 25 degrees (the value of CGAL's own
/// example), after jet normals on 24 points made consistent along CGAL's minimum spanning tree.
Smoothed cgal_bilateral(const Positions& points, int k, int times, int threads);

/// CGAL::wlop_simplify_and_regularize_point_set keeping every point, `radius` x average spacing
/// (CGAL::compute_average_spacing, k = 6), the default 35 iterations.
Smoothed cgal_wlop(const Positions& points, double radius, int threads);

/// pcl::MovingLeastSquares, polynomial order 2, simple projection. PCL searches by radius; here its search is
/// given the k nearest points of each point instead, and the Gaussian weight's width, which PCL takes from
/// the one radius, is the cloud's mean distance to the k-th neighbour.
Smoothed pcl_mls(const Positions& points, int k, int threads);

/// pcl::StatisticalOutlierRemoval (50 neighbours, `deviations` standard deviations), then pcl_mls.
Smoothed pcl_outliers_mls(const Positions& points, double deviations, int k, int threads);

/// Unit normals, n x 3 in the order of the points.
using Normals = std::vector<Eigen::Vector3d>;

/// CGAL::pca_estimate_normals and CGAL::mst_orient_normals, both on the k nearest points. Normals that CGAL
/// could not orient keep the side that they had.
Normals cgal_normals(const Positions& points, int k, int threads);

/// pcl::NormalEstimationOMP on the k nearest points; the side of each normal means nothing.
Normals pcl_normals(const Positions& points, int k, int threads);

}  // namespace rfsmooth::bench::peers
