#include "rfs_mesh/noise/steps/terraces.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "base/quantile.h"
#include "rfs_mesh/levels.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// Depths at whole numbers of one size from a first one.
struct EqualSteps {
  double first, size;
};

/// The steps that nine tenths of these depths are at. Nothing if so many are not, or if they are so near to
/// each other that most depths would be. \param told ascending, at least two. \param same of Terraces
std::optional<EqualSteps> equal_steps(const std::vector<double>& told, double same) {
  std::vector<double> gaps;
  for (std::size_t k = 1; k < told.size(); ++k) gaps.push_back(told[k] - told[k - 1]);
  std::vector<double> sorted = gaps;
  const double typical = quantile(sorted, 0.5);
  if (!(typical > 8 * same)) return {};  // half of all gaps are multiples of it by chance
  const auto single = std::min_element(gaps.begin(), gaps.end(), [&](double a, double b) {
    return std::abs(a - typical) < std::abs(b - typical);
  });
  const auto from = std::size_t(single - gaps.begin());
  EqualSteps steps = {told[from], typical};
  // The farthest depth tells the size to most digits; those between lead to it, one after the other.
  double farthest = 0, equal = 0;
  const auto enter = [&](double depth) {
    const double count = std::round((depth - steps.first) / steps.size);
    if (count == 0 || !(std::abs(depth - steps.first - count * steps.size) <= 2 * same)) return;
    ++equal;
    if (std::abs(count) <= farthest) return;
    farthest = std::abs(count);
    steps.size = (depth - steps.first) / count;
  };
  for (std::size_t k = from + 1; k < told.size(); ++k) enter(told[k]);
  for (std::size_t k = from; k-- > 0;) enter(told[k]);
  if (!(equal > (1 - kLeastPart) * double(gaps.size()))) return {};
  return steps;
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

double Terraces::by_chance() const {
  return 2 * same / typical;
}

Eigen::Vector3d Terraces::ray(const Eigen::Vector3d& at) const {
  return scanner ? (at - *scanner).normalized() : direction;
}

double Terraces::sigma(const Eigen::Vector3d& at, const Eigen::Vector3d& normal) const {
  return rounding_noise(std::abs(normal.dot(ray(at))) * gap(depth(at)));
}

double Terraces::width(const Eigen::Vector3d& at, const Eigen::Vector3d& normal) const {
  return gap(depth(at)) / normal.cross(ray(at)).norm();
}

bool fill_in(const Positions& some, Terraces& terraces) {
  const std::optional<EqualSteps> steps = equal_steps(terraces.depths, terraces.same);
  if (!steps) return false;
  const auto [first, size] = *steps;
  double least = first, most = first;
  for (const Eigen::Vector3d& p : some) {
    least = std::min(least, terraces.depth(p));
    most = std::max(most, terraces.depth(p));
  }
  terraces.depths.clear();
  for (double step = std::ceil((least - first) / size); step <= (most - first) / size; ++step)
    terraces.depths.push_back(first + step * size);
  terraces.typical = size;
  return true;
}

}  // namespace rfsmooth::rfs_mesh
