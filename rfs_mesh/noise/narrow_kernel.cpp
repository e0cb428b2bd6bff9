#include "rfs_mesh/noise/narrow_kernel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/linear/symmetric_eigen.h"
#include "base/parallel.h"
#include "base/quantile.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/noise/scatter_statistics.h"
#include "rfs_mesh/sample.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// What a kernel holds, but for the point that it stands on.
struct Kernel {
  Scatter across;     ///< variance of the members across the sheet
  double offset = 0;  ///< how far their mean is from the point, world units
};

Kernel look_around(const SpatialIndex& index, const Eigen::Vector3d& at, double width,
                   std::vector<Neighbor>& near) {
  index.within_unsorted(at, kNoiseReach * width, near);
  const std::size_t stride = 1 + near.size() / kWidestFit;  // where far more are in it, a part says as much
  double weights = 0, squares = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < near.size(); k += stride) {
    const Neighbor& q = near[k];
    if (!(q.squared_distance > 0)) continue;
    const Eigen::Vector3d d = index.points()[q.index] - at;
    const double w = std::exp(-q.squared_distance / (2 * width * width));
    weights += w;
    squares += w * w;
    mean += w * d;
    spread += w * d * d.transpose();
  }
  Kernel seen;
  const double members = squares > 0 ? weights * weights / squares : 0;
  // A plane has three coefficients. Of members whose weights fall off like these it takes two (simulated, 6
  // members and more); the third makes up for the choice of kernels by their offset, which favours calm ones.
  constexpr double kOfPlane = 3;
  if (!(members > kOfPlane + 1)) return seen;
  mean /= weights;
  spread = spread / weights - mean * mean.transpose();
  seen.across.variance = std::max(0.0, symmetric_eigen(spread).values[0]) * members / (members - kOfPlane);
  // Of a normal distribution that a kernel as wide cuts off, a variance scatters as that of twice as many.
  seen.across.freedom = 2 * (members - kOfPlane);
  seen.offset = mean.norm();
  return seen;
}

/// The median of the variances that the outermost of the kernels show.
double outermost_variance(std::vector<Kernel> kernels) {
  const auto outer = kernels.end() - std::ptrdiff_t(std::ceil(kLeastPart * double(kernels.size())));
  std::nth_element(kernels.begin(), outer, kernels.end(),
                   [](const Kernel& a, const Kernel& b) { return a.offset < b.offset; });
  std::vector<Scatter> all;
  for (auto k = outer; k != kernels.end(); ++k) all.push_back(k->across);
  constexpr double kMedianDeviate = 0;
  std::vector<Weighed> seen = comparable(all, std::vector<double>(all.size(), 1), kMedianDeviate);
  return quantile(seen, 0.5);
}

/// What is read in kernels of one width.
struct Reading {
  double freedom = 0;  ///< of the typical kernel
  double sigma = 0;    ///< world units; infinite: more than could be told from points that fill them evenly
};

/// What kernels of one width around all places read. Nothing: they hold too few points.
std::optional<Reading> read_in(const SpatialIndex& index, const Positions& at, double width,
                               const Context& context) {
  std::vector<Kernel> all(at.size());
  for_blocks(context, at.size(), 8, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbor> near;
    for (std::size_t s = begin; s < end; ++s) all[s] = look_around(index, at[s], width, near);
  });
  const double typical = quantile_of(all, 0.5, [](const Kernel& k) { return k.across.freedom; });
  if (typical < double(kRing)) return {};
  all.erase(std::remove_if(all.begin(), all.end(), [](const Kernel& k) { return !says(k.across); }),
            all.end());
  const double lambda = outermost_variance(std::move(all)), square = width * width;
  return Reading{typical, lambda < square ? std::sqrt(lambda * square / (square - lambda))
                                          : std::numeric_limits<double>::infinity()};
}

}  // namespace

std::optional<NoiseInKernels> noise_in_kernels(const SpatialIndex& index, double most,
                                               const Context& context) {
  const Positions at = sample(index.points(), kPlacesOfCloud);
  std::optional<NoiseInKernels> all;
  bool narrower = false;  // whether one was narrower than what it read
  for (double width = kNarrowestWindow * most; width < most; width *= kSameNoise) {
    const std::optional<Reading> read = read_in(index, at, width, context);
    if (!read) continue;
    const bool wide = read->sigma <= width;
    if (wide && !all) all = {read->sigma, {}};
    if (read->freedom < double(kNarrowestPatch)) continue;
    if (wide && narrower) all->sigma = read->sigma;
    if (wide) break;
    narrower = true;
  }
  return all;
}

}  // namespace rfsmooth::rfs_mesh
