#include "rfs_mesh/noise/steps/depth_steps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include "base/quantile.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/noise/steps/rounding.h"
#include "rfs_mesh/noise/steps/scanner_places.h"
#include "rfs_mesh/noise/steps/step_directions.h"
#include "rfs_mesh/sample.h"

namespace rfsmooth::rfs_mesh {

namespace {

constexpr std::size_t kFewestSteps = 4;  // fewer are the sides of a box
constexpr double kSame = 1e-3;  // of a distance between neighbours, some thousand of which make up the cloud
// Coordinates are whole numbers of what they are rounded to: steps are two of these or more, one is that of
// decimals.
constexpr double kRoundingsOfStep = 2;

/// Whether every depth is a step, or only those that more points share than would by chance.
enum class Steps { of_all, of_part };

/// Whether more depths are the same than by chance: as many as a step has in the mean, and more than as many
/// others nearby would make. \param run of `sorted`, those that are the same.
bool is_step(const std::vector<double>& sorted, std::size_t begin, std::size_t end, double same) {
  const double reach = double(kNeighbourhood) / 2 * same;
  const auto low = std::lower_bound(sorted.begin(), sorted.end(), sorted[begin] - reach),
             high = std::upper_bound(low, sorted.end(), sorted[begin] + same + reach);
  const double count = double(end - begin), mean = (double(high - low) - count) / double(kNeighbourhood);
  return kLeastPart * count >= 1 && count > mean + kNoiseReach * std::sqrt(mean);
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
/// kSampleOfCloud points.
bool measure_gaps(const Positions& some, Terraces& terraces) {
  const std::vector<double>& depths = terraces.depths;
  if (depths.size() < kFewestSteps || double(depths.size()) >= kLeastPart * double(some.size())) return false;
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
         double(gaps.size()) > (kLeastPart + terraces.by_chance()) * double(some.size());
}

/// Fills terraces, which know along what, with the steps that all points have there, or that a part of them
/// has. False if there are none. \param some up to kSampleOfCloud points.
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

/// Those of these that have steps, the largest first. \param all that know along what.
std::vector<Terraces> with_steps(const std::vector<Terraces>& all, const Positions& some, Steps steps) {
  std::vector<Terraces> found;
  for (Terraces terraces : all) {
    if (!fill(some, steps, terraces)) continue;
    const auto after = std::find_if(found.begin(), found.end(),
                                    [&](const auto& other) { return other.typical < terraces.typical; });
    found.insert(after, std::move(terraces));
  }
  return found;
}

/// Whether the commonest depth has most of the steps along another direction: more than half of the different
/// ones that as many random draws from all of them would show. A grid shows all, a camera's columns, which
/// are at other places at any other depth, a quarter or less.
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

/// Those that hold more than a tenth of all points beyond chance and what the ones before them hold: a
/// camera's columns are on its depths already.
std::vector<Terraces> that_hold_more(std::vector<Terraces> all, const Positions& some) {
  std::vector<Terraces> found;
  Positions free = some;
  for (Terraces& terraces : all) {
    const auto held =
        std::partition(free.begin(), free.end(), [&](const auto& p) { return !terraces.step_of(p); });
    const double more = double(free.end() - held) - terraces.by_chance() * double(free.size());
    if (!(more > kLeastPart * double(some.size()))) continue;
    free.erase(held, free.end());
    found.push_back(std::move(terraces));
  }
  return found;
}

/// Whether they are lines on the surface, as the rings of a lathe's part and the profiles of a line scanner
/// are: points have others of those around them on their step, but hardly one has two in two directions.
bool are_lines(const Terraces& terraces, const SpatialIndex& index) {
  std::size_t looked_at = 0, several = 0, wide = 0;
  std::vector<Neighbor> near;
  Positions on;
  for (const Eigen::Vector3d& p : sample(index.points(), kPlacesOfCloud)) {
    const auto at = terraces.step_of(p);
    if (!at) continue;
    index.nearest(p, int(kRing + 1), near);
    on.clear();
    for (const Neighbor& q : near)
      if (q.squared_distance > 0 && terraces.step_of(index.points()[q.index]) == at)
        on.push_back(index.points()[q.index] - p);
    ++looked_at;
    several += std::size_t(on.size() > 1);
    wide += std::size_t(std::any_of(on.begin(), on.end(), [&](const auto& a) {
      return std::any_of(on.begin(), on.end(), [&](const auto& b) { return make_a_plane(a, b); });
    }));
  }
  return double(several) > kLeastPart * double(looked_at) && double(wide) <= kLeastPart * double(several);
}

/// Whether steps are those of a grid: others are the same at every depth. Leaves out others that are the same
/// and less than `least`, which make no difference. \param depth of `all`: with those after it, which are
/// smaller.
bool are_of_grid(const Positions& some, std::vector<Terraces>& all, std::size_t depth, double least) {
  double largest = 0;  // of the same
  const auto same = [&](const Terraces& other) {
    if (!is_same_at_depths(some, all[depth], other)) return false;
    largest = std::max(largest, other.typical);
    return true;
  };
  all.erase(std::remove_if(all.begin() + std::ptrdiff_t(depth + 1), all.end(), same), all.end());
  return largest >= least;
}

/// Whether they are no depths in steps: lines; or told to fewer digits than points are apart; or of rounding
/// that cannot be told from detail, as each ring of a laser has it that tells millimetres; or the faces of an
/// exact part, of which fewer than kFewestSteps have points beside those of another.
bool are_none(const Terraces& terraces, const SpatialIndex& index) {
  std::vector<double> nearest;
  std::vector<bool> beside(terraces.depths.size(), false);
  std::vector<Neighbor> near;
  for (const Eigen::Vector3d& p : sample(index.points(), kPlacesOfCloud)) {
    const auto at = terraces.step_of(p);
    if (!at) continue;
    index.nearest(p, int(kNarrowestPatch), near);
    nearest.push_back(std::sqrt(near[1].squared_distance));
    for (const Neighbor& q : near)
      if (const auto next = terraces.step_of(index.points()[q.index]); next && next != at) beside[*at] = true;
  }
  if (nearest.empty() || std::size_t(std::count(beside.begin(), beside.end(), true)) < kFewestSteps)
    return true;
  const double spacing = quantile(nearest, 0.5);
  return terraces.same > spacing || rounding_noise(terraces.typical) < kNoNoise * spacing ||
         are_lines(terraces, index);
}

}  // namespace

DepthSteps::DepthSteps(std::vector<Terraces> terraces, const SpatialIndex& index)
    : typical_(terraces.front().typical), terraces_(std::move(terraces)) {
  const Positions some = sample(index.points(), kSampleOfCloud);
  const auto held = std::count_if(some.begin(), some.end(), [&](const Eigen::Vector3d& p) {
    return terraces_.front().step_of(p).has_value();
  });
  if (double(held) < (1 - kLeastPart) * double(some.size())) index_ = &index;
}

bool DepthSteps::exceed(const DepthSteps& other) const {
  return typical_ > (1 + kSame) * other.typical_;
}

LocalSteps DepthSteps::at(const Eigen::Vector3d& place) const {
  if (on_grid()) return {place, nullptr, typical_};
  if (index_ == nullptr) return {place, &terraces_.front(), 0};
  std::vector<Neighbor> near;
  index_->nearest(place, int(std::min(kNeighbourhood, index_->points().size())), near);
  const Terraces* of = nullptr;
  double most = kLeastPart * double(near.size());
  for (const Terraces& terraces : terraces_) {
    const auto held = double(std::count_if(near.begin(), near.end(), [&](const Neighbor& q) {
      return terraces.step_of(index_->points()[q.index]).has_value();
    }));
    const double more = held - terraces.by_chance() * double(near.size());
    if (!(more > most)) continue;
    most = more;
    of = &terraces;
  }
  return {place, of, 0};
}

std::optional<DepthSteps> find_depth_steps(const SpatialIndex& index, double rounding, double nearest) {
  const Positions some = sample(index.points(), kSampleOfCloud);
  const Positions axes = {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};
  std::vector<Terraces> planes, shells;
  for (const Eigen::Vector3d& axis : axes) planes.push_back({axis, {}, {}, 0, 0});
  planes = with_steps(planes, some, Steps::of_all);
  // Steps of less are those of decimals, or cannot be told from detail. Decimals no finer than points are
  // from each other put them on a grid.
  const double decimals = rounding < (1 - kSame) * nearest ? (1 - kSame) * kRoundingsOfStep * rounding : 0,
               least = std::max(decimals, kNoNoise * nearest / rounding_noise(1));
  if (!planes.empty() && planes.front().typical < decimals) planes.clear();
  if (!planes.empty() && are_of_grid(some, planes, 0, least)) return {};
  planes.erase(
      std::remove_if(planes.begin(), planes.end(), [&](const auto& of) { return are_lines(of, index); }),
      planes.end());
  if (!planes.empty()) return without_strays(std::move(planes.front()), some, index);
  // Rounding three coordinates moves a difference along any line by at most sqrt(3) of that. Directions are
  // looked for with once as much: most neighbours keep to it, and fewer are level by chance.
  const double same = 2 * rounding;
  for (const Eigen::Vector3d& scanner : scanner_places(index, same))
    shells.push_back({Eigen::Vector3d::Zero(), scanner, {}, std::max(same, seven_digits(some, scanner)), 0});
  shells = with_steps(shells, some, Steps::of_part);
  shells.erase(std::remove_if(shells.begin(), shells.end(), [&](auto& of) { return !fill_in(some, of); }),
               shells.end());
  for (const Eigen::Vector3d& direction : step_directions(index, rounding))
    planes.push_back({direction, {}, {}, same, 0});
  planes = with_steps(planes, some, Steps::of_part);
  for (std::size_t k = 0; k < planes.size(); ++k)
    if (are_of_grid(some, planes, k, least)) planes.clear();
  std::move(planes.begin(), planes.end(), std::back_inserter(shells));
  std::vector<Terraces> all = that_hold_more(std::move(shells), some);
  all.erase(std::remove_if(all.begin(), all.end(), [&](const auto& of) { return are_none(of, index); }),
            all.end());
  if (all.empty()) return {};
  return DepthSteps(std::move(all), index);
}

std::optional<DepthSteps> find_grid(std::vector<double> nearest, double rounding) {
  if (nearest.empty()) return {};
  const double most = quantile(nearest, 0.75), least = quantile(nearest, 0.25);
  if (!(most - least < kSame * least)) return {};
  if (rounding > kSame * least && least > kRoundingsOfStep * rounding) return {};
  return DepthSteps(least);
}

}  // namespace rfsmooth::rfs_mesh
