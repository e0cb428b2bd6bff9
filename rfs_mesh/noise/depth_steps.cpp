#include "rfs_mesh/noise/depth_steps.h"

#include <algorithm>
#include <cmath>

#include "rfs_mesh/noise/scatter_statistics.h"
#include "rfs_mesh/sample.h"

namespace rfsmooth::rfs_mesh {

namespace {

constexpr std::size_t kPointsOfStep = 10;  // in the mean: free coordinates hardly ever meet
// Chosen, not derived: 2,000 steps are found. Those whose rounding is kNoNoise of the spacing may be more, up
// to 11 sqrt(n) in a cloud of n points as deep as wide. All points of the real scans tell steps of one that
// these do not: of 1.5 where the noise is 2.4.
constexpr std::size_t kLookedAt = 20000;
constexpr std::size_t kFewestSteps = 4;  // fewer are the sides of a box
// Of a distance from the scanner: how far two that are the same lie apart where files keep seven digits of
// each coordinate.
constexpr double kSevenDigits = 2e-6;

/// The steps that points have in `steps`, which knows of what; false if they have none. \param depths of up
/// to kLookedAt points. \param rounding depths that differ by no more than this share of themselves are one.
bool fill_steps(std::vector<double> depths, double rounding, DepthSteps& steps) {
  const std::vector<double> all = depths;
  std::sort(depths.begin(), depths.end());
  std::size_t count = 0;
  for (const double depth : depths)
    if (count == 0 || depth - depths[count - 1] > rounding * depth) depths[count++] = depth;
  depths.resize(count);
  if (count < kFewestSteps || count * kPointsOfStep >= all.size()) return false;
  steps.depths = std::move(depths);
  std::vector<double> gaps;
  for (const double depth : all) gaps.push_back(steps.gap(depth));
  steps.typical = quantile(gaps, 0.5);
  // Free depths that rounding runs together are hardly farther apart than that.
  return steps.typical > 2 * rounding * steps.depths.back();
}

/// Whether the values of another coordinate are at the commonest depth, too, as those of a grid are: as many
/// as a draw from all of them would show. A camera's columns are at other places at any other depth, so there
/// it shows a kFewestSteps-th (4) or less of these. The limit is twice the one and half of the other.
bool is_same_at_depths(const Positions& points, const DepthSteps& depth, const DepthSteps& other) {
  std::vector<std::size_t> count(depth.depths.size(), 0);
  const auto which = [&](const Eigen::Vector3d& p) {
    return std::size_t(std::lower_bound(depth.depths.begin(), depth.depths.end(), p[depth.axis]) -
                       depth.depths.begin());
  };
  for (const Eigen::Vector3d& p : points) ++count[which(p)];
  const auto commonest = std::size_t(std::max_element(count.begin(), count.end()) - count.begin());
  std::vector<double> there;
  for (const Eigen::Vector3d& p : points)
    if (which(p) == commonest) there.push_back(p[other.axis]);
  const auto values = double(other.depths.size()), drawn = double(there.size());
  std::sort(there.begin(), there.end());
  there.erase(std::unique(there.begin(), there.end()), there.end());
  return 2 * double(there.size()) > values * (1 - std::exp(-drawn / values));
}

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
  if (on_grid) return rounding_noise(typical);
  if (!scanner) return rounding_noise(std::abs(normal[axis]) * gap(at[axis]));
  const Eigen::Vector3d ray = at - *scanner;
  return rounding_noise(std::abs(normal.dot(ray.normalized())) * gap(ray.norm()));
}

std::optional<DepthSteps> find_depth_steps(const Positions& points,
                                           const std::optional<Eigen::Vector3d>& scanner) {
  const Positions some = sample(points, kLookedAt);
  std::vector<double> depths(some.size());
  std::vector<DepthSteps> all;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::transform(some.begin(), some.end(), depths.begin(), [&](const auto& p) { return p[axis]; });
    DepthSteps steps;
    steps.axis = axis;
    if (fill_steps(depths, 0, steps)) all.push_back(std::move(steps));
  }
  std::optional<DepthSteps> found;
  for (const DepthSteps& steps : all)
    if (!found || steps.typical > found->typical) found = steps;
  for (const DepthSteps& steps : all)
    if (steps.axis != found->axis && is_same_at_depths(some, *found, steps)) return {};
  if (found || !scanner) return found;
  std::transform(some.begin(), some.end(), depths.begin(),
                 [&](const auto& p) { return (p - *scanner).norm(); });
  DepthSteps steps;
  steps.scanner = scanner;
  if (fill_steps(depths, kSevenDigits, steps)) found = std::move(steps);
  return found;
}

std::optional<DepthSteps> find_grid(std::vector<double> nearest) {
  constexpr double kSame = 1e-3;  // files of seven digits, some thousand points across
  if (nearest.empty()) return {};
  const double most = quantile(nearest, 0.75), least = quantile(nearest, 0.25);
  if (!(most - least < kSame * least)) return {};
  DepthSteps steps;
  steps.on_grid = true;
  steps.typical = least;
  return steps;
}

}  // namespace rfsmooth::rfs_mesh
