#include "rfs_mesh/noise/depth_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "rfs_mesh/fit/principal_axes.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise.h"
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
// Points that cover four lines where these are twenty times farther apart than their points.
constexpr std::size_t kNoMoreALine = kNarrowestPatch * kNeighbourhood;
// Of the largest depth: how far two that are the same lie apart where files keep seven digits of each
// coordinate.
constexpr double kSevenDigits = 2e-6;
constexpr double kSame = 1e-3;  // of a distance between neighbours, some thousand of which make up the cloud

/// How many points the steps of a cloud have.
enum class Steps { of_all, of_part };

/// Whether more depths are the same than by chance: as many as a step has in the mean, and more than as many
/// others nearby would make. \param run of `sorted`, those that are the same.
bool is_step(const std::vector<double>& sorted, std::size_t begin, std::size_t end, double same) {
  const double reach = double(kNeighbourhood) / 2 * same;
  const auto low = std::lower_bound(sorted.begin(), sorted.end(), sorted[begin] - reach),
             high = std::upper_bound(low, sorted.end(), sorted[begin] + same + reach);
  const double count = double(end - begin), mean = (double(high - low) - count) / double(kNeighbourhood);
  return count >= double(kPointsOfStep) && count > mean + kNoiseReach * std::sqrt(mean);
}

/// Of sorted depths the first of each run of those that are the same; of a part, of those that are steps.
std::vector<double> commonest(const std::vector<double>& sorted, Steps steps, double same) {
  std::vector<double> depths;
  for (std::size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
    while (end < sorted.size() && sorted[end] - sorted[begin] <= same) ++end;
    if (steps == Steps::of_all || is_step(sorted, begin, end, same)) depths.push_back(sorted[begin]);
  }
  return depths;
}

/// Sets the typical gap between depths. False if these are too few, too many, or no steps. \param some up to
/// kLookedAt points.
bool measure_gaps(const Positions& some, Terraces& terraces) {
  const std::vector<double>& depths = terraces.depths;
  if (depths.size() < kFewestSteps || depths.size() * kPointsOfStep >= some.size()) return false;
  std::vector<double> gaps, narrower;  // of the gaps on both sides
  for (const Eigen::Vector3d& p : some) {
    const auto at = terraces.step_of(p);
    if (!at) continue;
    gaps.push_back(terraces.gap(depths[*at]));
    narrower.push_back(std::min(*at > 0 ? depths[*at] - depths[*at - 1] : gaps.back(),
                                *at + 1 < depths.size() ? depths[*at + 1] - depths[*at] : gaps.back()));
  }
  terraces.typical = quantile(gaps, 0.5);
  // Free depths that rounding runs together are hardly farther apart than that.
  return quantile(narrower, 0.5) > 2 * terraces.same &&
         double(gaps.size()) > kLeastPart * double(some.size());
}

/// Fills terraces, which know along what, with the steps that all points have there, or that a part of them
/// has. False if there are none. \param some up to kLookedAt points.
bool fill(const Positions& some, Steps steps, Terraces& terraces) {
  std::vector<double> all(some.size());
  std::transform(some.begin(), some.end(), all.begin(), [&](const auto& p) { return terraces.depth(p); });
  std::sort(all.begin(), all.end());
  terraces.depths = commonest(all, steps, terraces.same);
  return measure_gaps(some, terraces);
}

/// The steps of all points without the depths that one has alone: a stray, which lies free. Nothing if these
/// were all.
std::optional<DepthSteps> without_strays(Terraces terraces, const Positions& some,
                                         const SpatialIndex& index) {
  std::vector<std::size_t> points(terraces.depths.size(), 0);
  for (const Eigen::Vector3d& p : some) ++points[terraces.nearest(terraces.depth(p))];
  std::vector<double> shared;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (points[k] > 1) shared.push_back(terraces.depths[k]);
  terraces.depths = std::move(shared);
  if (!measure_gaps(some, terraces)) return {};
  return DepthSteps({std::move(terraces)}, index);
}

/// Those along some directions that have any, the largest steps first.
std::vector<Terraces> terraces_along(const Positions& directions, const Positions& some, Steps steps,
                                     double same) {
  std::vector<Terraces> all;
  for (const Eigen::Vector3d& direction : directions) {
    Terraces terraces;
    terraces.direction = direction;
    terraces.same = same;
    if (!fill(some, steps, terraces)) continue;
    const auto after = std::find_if(all.begin(), all.end(),
                                    [&](const auto& other) { return other.typical < terraces.typical; });
    all.insert(after, std::move(terraces));
  }
  return all;
}

/// Whether the steps along another direction are at the commonest depth, too, as those of a grid are: as many
/// as a draw from all of them would show. A camera's columns are at other places at any other depth, so there
/// it shows a kFewestSteps-th (4) or less of these. The limit is twice the one and half of the other.
bool is_same_at_depths(const Positions& points, const Terraces& depth, const Terraces& other) {
  std::vector<std::vector<std::size_t>> there(depth.depths.size());
  for (const Eigen::Vector3d& p : points)
    if (const auto at = depth.step_of(p), of_other = other.step_of(p); at && of_other)
      there[*at].push_back(*of_other);
  std::vector<std::size_t>& most =
      *std::max_element(there.begin(), there.end(), [](auto& a, auto& b) { return a.size() < b.size(); });
  const auto values = double(other.depths.size()), drawn = double(most.size());
  std::sort(most.begin(), most.end());
  most.erase(std::unique(most.begin(), most.end()), most.end());
  return drawn > 0 && 2 * double(most.size()) > values * (1 - std::exp(-drawn / values));
}

/// What of these is depth: nothing where two are those of a grid; of points that several hold, as a camera's
/// columns do, the first.
std::vector<Terraces> of_depth(std::vector<Terraces> all, const Positions& some) {
  for (std::size_t a = 0; a < all.size(); ++a)
    for (std::size_t b = a + 1; b < all.size(); ++b)
      if (is_same_at_depths(some, all[a], all[b])) return {};
  std::vector<Terraces> found;
  Positions free = some;
  for (Terraces& terraces : all) {
    const auto held =
        std::partition(free.begin(), free.end(), [&](const auto& p) { return !terraces.step_of(p); });
    if (!(double(free.end() - held) > kLeastPart * double(some.size()))) continue;
    free.erase(held, free.end());
    found.push_back(std::move(terraces));
  }
  return found;
}

/// Whether they are no depths in steps: told to fewer digits than points are apart; of rounding that cannot
/// be told from detail, as each ring of a laser has it that tells millimetres; or the faces of an exact part,
/// of which fewer than kFewestSteps have points beside those of another; or the profiles of a line scanner,
/// planes through the surface, which faces them nowhere, farther apart than the points of a profile.
bool are_none(const Terraces& terraces, const SpatialIndex& index) {
  std::size_t looked_at = 0, facing = 0;
  std::vector<double> apart;
  std::vector<bool> beside(terraces.depths.size(), false);
  std::vector<Neighbor> near;
  for (const Eigen::Vector3d& p : sample(index.points(), kPlacesOfCloud)) {
    const auto at = terraces.step_of(p);
    if (!at) continue;
    index.nearest(p, int(std::min(kNoMoreALine, index.points().size())), near);
    const Eigen::Vector3d normal = principal_axes(index.points(), near).axes.vectors.col(0);
    ++looked_at;
    facing += std::size_t(std::abs(normal.dot(terraces.ray(p))) > kSameSheet);
    apart.push_back(std::sqrt(near[1].squared_distance));
    for (std::size_t k = 1; k < std::min(kNarrowestPatch, near.size()); ++k)
      if (const auto next = terraces.step_of(index.points()[near[k].index]); next && next != at)
        beside[*at] = true;
  }
  if (apart.empty() || std::size_t(std::count(beside.begin(), beside.end(), true)) < kFewestSteps)
    return true;
  const double spacing = quantile(apart, 0.5);
  return terraces.same > spacing || rounding_noise(terraces.typical) < kNoNoise * spacing ||
         (double(facing) <= kLeastPart * double(looked_at) && terraces.typical > spacing);
}

/// The farthest that a point is from `from`.
double farthest(const Positions& points, const Eigen::Vector3d& from) {
  double most = 0;
  for (const Eigen::Vector3d& p : points) most = std::max(most, (p - from).norm());
  return most;
}

/// What a file rounds coordinates to: to seven digits, or to decimals, which no two coordinates are nearer
/// than.
double rounding_of(const Positions& some) {
  const double digits = kSevenDigits * farthest(some, some.front());
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Eigen::Vector3d& p : some) values.push_back(p[axis]);
    std::sort(values.begin(), values.end());
    for (std::size_t i = 1; i < values.size(); ++i)
      if (const double gap = values[i] - values[i - 1]; gap > digits) least = std::min(least, gap);
  }
  return std::isfinite(least) ? least : digits;
}

}  // namespace

double rounding_noise(double step) {
  return step / std::sqrt(12.0);
}

double Terraces::depth(const Eigen::Vector3d& at) const {
  return scanner ? (at - *scanner).norm() : direction.dot(at);
}

std::size_t Terraces::nearest(double depth) const {
  const auto above = std::size_t(std::lower_bound(depths.begin(), depths.end(), depth) - depths.begin());
  if (above == 0) return 0;
  if (above == depths.size() || depth - depths[above - 1] < depths[above] - depth) return above - 1;
  return above;
}

std::optional<std::size_t> Terraces::step_of(const Eigen::Vector3d& at) const {
  const double d = depth(at);
  const std::size_t step = nearest(d);
  if (!(std::abs(d - depths[step]) <= same)) return {};
  return step;
}

double Terraces::gap(double depth) const {
  const std::size_t at = nearest(depth), low = at > 0 ? at - 1 : 0,
                    high = std::min(depths.size() - 1, at + 1);
  return (depths[high] - depths[low]) / double(high - low);
}

Eigen::Vector3d Terraces::ray(const Eigen::Vector3d& at) const {
  return scanner ? (at - *scanner).normalized() : direction;
}

double Terraces::sigma(const Eigen::Vector3d& at, const Eigen::Vector3d& normal) const {
  return rounding_noise(std::abs(normal.dot(ray(at))) * gap(depth(at)));
}

DepthSteps::DepthSteps(std::vector<Terraces> terraces, const SpatialIndex& index)
    : typical_(terraces.front().typical), terraces_(std::move(terraces)) {
  const Positions some = sample(index.points(), kLookedAt);
  const auto held = std::count_if(some.begin(), some.end(), [&](const Eigen::Vector3d& p) {
    return terraces_.front().step_of(p).has_value();
  });
  if (double(held) < (1 - kLeastPart) * double(some.size())) index_ = &index;
}

bool DepthSteps::exceed(const DepthSteps& other) const {
  return typical_ > (1 + kSame) * other.typical_;
}

double DepthSteps::sigma(const Eigen::Vector3d& at, const Eigen::Vector3d& normal) const {
  if (on_grid()) return rounding_noise(typical_);
  if (index_ == nullptr) return terraces_.front().sigma(at, normal);
  std::vector<Neighbor> near;
  index_->nearest(at, 1, near);
  const Eigen::Vector3d& point = index_->points()[near.front().index];
  const auto of = std::find_if(terraces_.begin(), terraces_.end(),
                               [&](const Terraces& terraces) { return terraces.step_of(point).has_value(); });
  return of != terraces_.end() ? of->sigma(at, normal) : 0;
}

std::optional<DepthSteps> find_depth_steps(const SpatialIndex& index,
                                           const std::optional<Eigen::Vector3d>& scanner) {
  const Positions some = sample(index.points(), kLookedAt);
  const Positions axes = {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};
  std::vector<Terraces> all = terraces_along(axes, some, Steps::of_all, 0);
  for (std::size_t k = 1; k < all.size(); ++k)
    if (is_same_at_depths(some, all.front(), all[k])) return {};
  if (!all.empty()) return without_strays(std::move(all.front()), some, index);
  // Neighbours differ by that; what is rounded in three coordinates lies within twice as much along any line.
  const double rounding = rounding_of(some);
  const auto none = [&](const Terraces& terraces) { return are_none(terraces, index); };
  Terraces shells;
  shells.scanner = scanner;
  if (scanner) {
    shells.same = kSevenDigits * farthest(some, *scanner);
    if (fill(some, Steps::of_all, shells)) return without_strays(std::move(shells), some, index);
    shells.same = std::max(shells.same, 2 * rounding);
  }
  all = of_depth(terraces_along(step_directions(index, rounding), some, Steps::of_part, 2 * rounding), some);
  all.erase(std::remove_if(all.begin(), all.end(), none), all.end());
  if (!all.empty()) return DepthSteps(std::move(all), index);
  if (!scanner || !fill(some, Steps::of_part, shells) || none(shells)) return {};
  return DepthSteps({std::move(shells)}, index);
}

std::optional<DepthSteps> find_grid(std::vector<double> nearest) {
  if (nearest.empty()) return {};
  const double most = quantile(nearest, 0.75), least = quantile(nearest, 0.25);
  if (!(most - least < kSame * least)) return {};
  return DepthSteps(least);
}

}  // namespace rfsmooth::rfs_mesh
