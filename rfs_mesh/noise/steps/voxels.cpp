#include "rfs_mesh/noise/steps/voxels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "base/quantile.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/sample.h"

namespace rfsmooth::rfs_mesh {

namespace {

// Points at each of the places: sixteen voxels across, a bound of the work that all clouds have.
constexpr std::size_t kVoxelPlaces = 48, kVoxelPoints = 256;
// Sizes are looked for from the distance to the eighth point over this up to times this. It is 1.4 voxels in
// one layer, one in two.
constexpr double kAroundEighth = 2;
constexpr std::size_t kOversampled = 4;  // frequencies for each that points so far apart can tell

/// By frequency, from the first on at even steps.
using Spectrum = std::vector<double>;

/// Which distances are asked for, as frequencies.
struct Frequencies {
  double first, step;
  std::size_t count;
  double at(std::size_t f) const { return first + double(f) * step; }
};

/// | mean of e^(2 pi i x f) | along an axis.
Spectrum spectrum(const Positions& points, Eigen::Index axis, const Frequencies& asked) {
  Spectrum cosines(asked.count, 0), sines(asked.count, 0);
  for (const Eigen::Vector3d& p : points) {
    const double x = 2 * M_PI * (p - points.front())[axis];
    Eigen::Vector2d at(std::cos(x * asked.first), std::sin(x * asked.first));
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(x * asked.step).toRotationMatrix();
    for (std::size_t f = 0; f < asked.count; ++f, at = turn * at) {
      cosines[f] += at.x();
      sines[f] += at.y();
    }
  }
  Spectrum clear(asked.count);
  for (std::size_t f = 0; f < asked.count; ++f)
    clear[f] = std::hypot(cosines[f], sines[f]) / double(points.size());
  return clear;
}

Eigen::Vector3d extent_of(const Positions& points) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : points) box.extend(p);
  return box.sizes();
}

/// The mean spectra of the places by axis, of those that lie along it at least half as far as along any: the
/// heights of a plane across it repeat with every distance that is larger than its noise.
std::array<Spectrum, 3> spectra(const std::vector<Positions>& places, const Frequencies& asked,
                                const Context& context) {
  std::vector<Spectrum> of_place(3 * places.size());
  for_each_index(
      context, of_place.size(),
      [&](std::size_t k) {
        const Positions& points = places[k / 3];
        const auto axis = Eigen::Index(k % 3);
        const Eigen::Vector3d extent = extent_of(points);
        if (2 * extent[axis] >= extent.maxCoeff()) of_place[k] = spectrum(points, axis, asked);
      },
      1);
  std::array<Spectrum, 3> mean;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    mean[axis].assign(asked.count, 0);
    double lying_along = 0;  // places
    for (std::size_t k = axis; k < of_place.size(); k += 3) lying_along += double(!of_place[k].empty());
    for (std::size_t k = axis; k < of_place.size(); k += 3)
      for (std::size_t f = 0; f < of_place[k].size(); ++f) mean[axis][f] += of_place[k][f] / lying_along;
  }
  return mean;
}

/// The frequency at which a spectrum is largest, if that stands out: of a tenth of all, twice as large as is
/// usual, and not at an end.
std::optional<std::size_t> peak(Spectrum of) {
  const auto most = std::max_element(of.begin(), of.end());
  const auto at = std::size_t(most - of.begin());
  const double largest = *most;
  if (at < kOversampled || at + kOversampled >= of.size()) return {};
  if (!(largest > kLeastPart && largest > kLouder * quantile(of, 0.5))) return {};
  return at;
}

/// The distance, world units, at which the coordinates along two axes repeat: their peaks are next to each
/// other, and it belongs to the middle of these. Nothing if no two have one.
std::optional<double> repeats_along_two(const std::array<Spectrum, 3>& along, const Frequencies& asked) {
  const std::array<std::optional<std::size_t>, 3> peaks = {peak(along[0]), peak(along[1]), peak(along[2])};
  for (const auto& [a, b] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
    const auto first = peaks[std::size_t(a)], second = peaks[std::size_t(b)];
    if (!first || !second) continue;
    const std::size_t between = std::max(*first, *second) - std::min(*first, *second);
    if (2 * between <= kOversampled) return 2 / (asked.at(*first) + asked.at(*second));
  }
  return {};
}

}  // namespace

std::optional<double> voxel_size(const SpatialIndex& index, double nearest, const Context& context) {
  const std::size_t points = std::min(kVoxelPoints, index.points().size());
  const Positions at = sample(index.points(), kVoxelPlaces);
  std::vector<Positions> around(at.size());
  std::vector<double> ring(at.size()), extents(at.size());
  for_each_index(
      context, at.size(),
      [&](std::size_t s) {
        std::vector<Neighbor> near;
        index.nearest(at[s], int(points), near);
        for (const Neighbor& q : near) around[s].push_back(index.points()[q.index]);
        ring[s] = std::sqrt(near[std::min(kRing, near.size() - 1)].squared_distance);
        extents[s] = extent_of(around[s]).maxCoeff();
      },
      1);
  const double extent = quantile(extents, 0.5), eighth = quantile(ring, 0.5),
               least = std::max(nearest, eighth / kAroundEighth), most = kAroundEighth * eighth;
  // In a row of voxels the points would be no farther apart than that. Places may be denser than most points.
  if (!(nearest > 0 && least < most && extent < double(points) * most)) return {};
  Frequencies asked{1 / most, 1 / (double(kOversampled) * extent), 0};
  asked.count = std::size_t((1 / least - asked.first) / asked.step) + 1;
  return repeats_along_two(spectra(around, asked, context), asked);
}

}  // namespace rfsmooth::rfs_mesh
