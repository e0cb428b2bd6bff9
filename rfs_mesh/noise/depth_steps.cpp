#include "rfs_mesh/noise/depth_steps.h"

#include <algorithm>
#include <cmath>

#include "rfs_mesh/noise/scatter_statistics.h"

namespace rfsmooth::rfs_mesh {

namespace {

constexpr std::size_t kLookedAt = 20000;
constexpr std::size_t kPointsOfStep = 10;  // in the mean: free coordinates hardly ever meet
constexpr std::size_t kFewestSteps = 4;    // fewer are the sides of a box

}  // namespace

double rounding_noise(double step) {
  return step / std::sqrt(12.0);
}

double DepthSteps::gap(double depth) const {
  const auto above = std::lower_bound(depths.begin(), depths.end(), depth);
  const std::ptrdiff_t last = std::ptrdiff_t(depths.size()) - 1,
                       nearest = std::min(last, above - depths.begin()),
                       low = std::max<std::ptrdiff_t>(0, nearest - 1), high = std::min(last, nearest + 1);
  return (depths[std::size_t(high)] - depths[std::size_t(low)]) / double(high - low);
}

double DepthSteps::sigma(const Eigen::Vector3d& at, const Eigen::Vector3d& normal) const {
  return rounding_noise(std::abs(normal[axis]) * gap(at[axis]));
}

std::optional<DepthSteps> find_depth_steps(const Positions& points) {
  const Positions some = pick(points, std::min(points.size(), kLookedAt));
  std::optional<DepthSteps> found;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> depths, gaps;
    for (const Eigen::Vector3d& p : some) depths.push_back(p[axis]);
    std::sort(depths.begin(), depths.end());
    depths.erase(std::unique(depths.begin(), depths.end()), depths.end());
    if (depths.size() < kFewestSteps || depths.size() * kPointsOfStep >= some.size()) continue;
    if (found) return {};
    found.emplace();
    found->axis = axis;
    found->depths = std::move(depths);
    for (const Eigen::Vector3d& p : some) gaps.push_back(found->gap(p[axis]));
    found->typical = quantile(gaps, 0.5);
  }
  return found;
}

}  // namespace rfsmooth::rfs_mesh
