#include "rfs_mesh/noise/depth_steps.h"

#include <algorithm>
#include <cmath>

#include "rfs_mesh/noise/scatter_statistics.h"
#include "rfs_mesh/noise/step_directions.h"
#include "rfs_mesh/sample.h"

namespace rfsmooth::rfs_mesh {

namespace {

constexpr std::size_t kPointsOfStep = 10;  // in the mean: free coordinates hardly ever meet
// Chosen, not derived: 2,000 steps are found. Those whose rounding is kNoNoise of the spacing may be more, up
// to 11 sqrt(n) in a cloud of n points as deep as wide. All points of the real scans tell steps of one that
// these do not: of 1.5 where the noise is 2.4.
constexpr std::size_t kLookedAt = 20000;
constexpr std::size_t kFewestSteps = 4;  // fewer are the sides of a box
// Of the largest depth: how far two that are the same lie apart where files keep seven digits of each
// coordinate.
constexpr double kSevenDigits = 2e-6;

/// Fills `steps`, which knows along what, with those that points have there; false if they have none.
/// \param some up to kLookedAt points. \param same depths that differ by no more than this are one.
bool fill_steps(const Positions& some, double same, DepthSteps& steps) {
  std::vector<double> all(some.size());
  std::transform(some.begin(), some.end(), all.begin(), [&](const auto& p) { return steps.depth(p); });
  std::vector<double> depths = all;
  std::sort(depths.begin(), depths.end());
  std::size_t count = 0;
  for (const double depth : depths)
    if (count == 0 || depth - depths[count - 1] > same) depths[count++] = depth;
  depths.resize(count);
  if (count < kFewestSteps || count * kPointsOfStep >= all.size()) return false;
  steps.depths = std::move(depths);
  std::vector<double> gaps;
  for (const double depth : all) gaps.push_back(steps.gap(depth));
  steps.typical = quantile(gaps, 0.5);
  // Free depths that rounding runs together are hardly farther apart than that.
  return steps.typical > 2 * same;
}

/// Those of `directions` along which there are steps.
std::vector<DepthSteps> steps_along(const Positions& directions, const Positions& some, double same) {
  std::vector<DepthSteps> all;
  for (const Eigen::Vector3d& direction : directions) {
    DepthSteps steps;
    steps.direction = direction;
    if (fill_steps(some, same, steps)) all.push_back(std::move(steps));
  }
  return all;
}

/// Whether the steps along another direction are at the commonest depth, too, as those of a grid are: as many
/// as a draw from all of them would show. A camera's columns are at other places at any other depth, so there
/// it shows a kFewestSteps-th (4) or less of these. The limit is twice the one and half of the other.
bool is_same_at_depths(const Positions& points, const DepthSteps& depth, const DepthSteps& other) {
  std::vector<std::size_t> count(depth.depths.size(), 0);
  for (const Eigen::Vector3d& p : points) ++count[depth.nearest(depth.depth(p))];
  const auto commonest = std::size_t(std::max_element(count.begin(), count.end()) - count.begin());
  std::vector<std::size_t> there;
  for (const Eigen::Vector3d& p : points)
    if (depth.nearest(depth.depth(p)) == commonest) there.push_back(other.nearest(other.depth(p)));
  const auto values = double(other.depths.size()), drawn = double(there.size());
  std::sort(there.begin(), there.end());
  there.erase(std::unique(there.begin(), there.end()), there.end());
  return 2 * double(there.size()) > values * (1 - std::exp(-drawn / values));
}

/// That with the largest steps of all, at least one; none if they are those of a grid.
std::optional<DepthSteps> of_depth(std::vector<DepthSteps> all, const Positions& some) {
  const auto depth = std::max_element(all.begin(), all.end(),
                                      [](const auto& a, const auto& b) { return a.typical < b.typical; });
  for (auto other = all.begin(); other != all.end(); ++other)
    if (other != depth && is_same_at_depths(some, *depth, *other)) return {};
  return std::move(*depth);
}

/// The farthest that a point is from `from`.
double farthest(const Positions& points, const Eigen::Vector3d& from) {
  double most = 0;
  for (const Eigen::Vector3d& p : points) most = std::max(most, (p - from).norm());
  return most;
}

}  // namespace

double rounding_noise(double step) {
  return step / std::sqrt(12.0);
}

double DepthSteps::depth(const Eigen::Vector3d& at) const {
  return scanner ? (at - *scanner).norm() : direction.dot(at);
}

std::size_t DepthSteps::nearest(double depth) const {
  const auto above = std::size_t(std::lower_bound(depths.begin(), depths.end(), depth) - depths.begin());
  if (above == 0) return 0;
  if (above == depths.size() || depth - depths[above - 1] < depths[above] - depth) return above - 1;
  return above;
}

double DepthSteps::gap(double depth) const {
  const std::size_t at = nearest(depth), low = at > 0 ? at - 1 : 0,
                    high = std::min(depths.size() - 1, at + 1);
  return (depths[high] - depths[low]) / double(high - low);
}

double DepthSteps::sigma(const Eigen::Vector3d& at, const Eigen::Vector3d& normal) const {
  if (on_grid) return rounding_noise(typical);
  const Eigen::Vector3d ray = scanner ? Eigen::Vector3d((at - *scanner).normalized()) : direction;
  return rounding_noise(std::abs(normal.dot(ray)) * gap(depth(at)));
}

std::optional<DepthSteps> find_depth_steps(const SpatialIndex& index,
                                           const std::optional<Eigen::Vector3d>& scanner) {
  const Positions some = sample(index.points(), kLookedAt);
  std::vector<DepthSteps> found =
      steps_along({Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()}, some, 0);
  if (found.empty() && scanner) {
    DepthSteps steps;
    steps.scanner = scanner;
    if (fill_steps(some, kSevenDigits * farthest(some, *scanner), steps)) found.push_back(std::move(steps));
  }
  if (found.empty()) {
    const double same = kSevenDigits * farthest(some, some.front());
    found = steps_along(step_directions(index, same), some, same);
  }
  if (found.empty()) return {};
  return of_depth(std::move(found), some);
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
