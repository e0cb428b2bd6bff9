/// Noise as real scanners make it: laws that the white noise of `add_noise` is the simplest of.
///
/// A law is a table row (laws()); all of them are one sum per point:
///
///     measured = along the ray to a whole step of depth( motion of its scan( truth + noise ) )
///
/// White noise alone flatters every smoother: real scans have loud points among calm ones, neighbours that
/// err together, depths in steps, layers of scans that do not quite meet, and rings of points with nothing
/// between them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/mesh.h>

#include "rfs_mesh/points.h"

namespace rfsmooth::clouds {

/// Where on the surface the points lie.
enum class Spread {
  even,   ///< Poisson-disk
  rings,  ///< where the rays of a spinning scanner meet it: rings farther apart than their points
  clumps  ///< denser towards the centres of clumps, as matched image patches are
};

inline constexpr int kPerClump = 25;       ///< points of a clump, on average
inline constexpr double kEyeDistance = 2;  ///< of the scanner from the centre, along z; x radius of the cloud

/// Lengths in spacings: mean distance to the nearest neighbour on the clean cloud. Zero is without.
struct Law {
  std::string_view name;
  std::string_view says;   ///< for tables and help
  double sigma = 0;        ///< standard deviation of the noise, per coordinate, or along the ray
  bool along_ray = false;  ///< the noise lies on the line to the scanner; else in all directions alike
  double range_power = 0;  ///< sigma is that at the centre and grows with this power of the range
  double loud_share = 0;   ///< this share of the points, anywhere among the others, ...
  double loud_times = 4;   ///< ... has noise of so many sigma
  int correlated = 1;  ///< noise is the sum over this many nearest points (oneself is the first), scaled back
  double half = 1;     ///< one half of the cloud has so many sigma; 0: it is exact
  double clumps = 0;   ///< each clump is off as a whole, standard deviation per coordinate
  int scans = 1;       ///< points come from so many scans, at random, ...
  double between = 0;  ///< ... each moved rigidly, by this standard deviation per coordinate or less
  double step = 0;     ///< depths along z are whole multiples of this
  Spread spread = Spread::even;
  double ring_gap = 20;  ///< between rings, x step along a ring
};

/// The laws that benchmarks go through, white noise first.
const std::vector<Law>& laws();

/// By its name; null if there is none.
const Law* find_law(std::string_view name);

/// The same law with every length longer by a factor.
Law scaled(Law law, double times);

/// Points of a surface, and which clump each is of (empty: there are none).
struct Spots {
  Positions points;
  std::vector<Index> clump;
};

/// About n points of the mesh (exactly n but for rings) as the law spreads them. Rings: a ray meets every
/// sheet on its way, so the far side is there too. Same seed, same bytes. \throw std::invalid_argument if the
/// mesh has no faces.
Spots spread(const Law& law, const Mesh& mesh, std::size_t n, std::uint64_t seed);

/// The middle and the extent of a cloud, and the scanner before it.
struct Frame {
  Eigen::Vector3d centre;  ///< of the bounding box
  Eigen::Vector3d eye;     ///< kEyeDistance radii above the centre, looks down along z
  double radius = 0;       ///< largest distance from the centre
};

/// \throw std::out_of_range if there is no point.
Frame frame_of(const Positions& points);

/// A noisy cloud whose truth is known, row by row.
struct NoisyCloud {
  Positions measured;
  std::vector<char> exact;  ///< n: 1 where the law adds nothing (half); empty: nowhere
  std::vector<Index> scan;  ///< n: which scan a point is of; empty: there is but one
  Eigen::Vector3d eye;      ///< where the scanner stood
};

/// Adds the law's noise to points of a surface, `spacing` being their mean_spacing. Same seed, same bytes.
/// O(n log n).
NoisyCloud add_noise(const Law& law, const Spots& spots, double spacing, std::uint64_t seed);

}  // namespace rfsmooth::clouds
