/// The measures of the quality benchmark, exact, for one cloud against its truth.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rfsmooth/context.h>

#include "tests/bench/quality/data/closest.h"
#include "tests/bench/quality/data/dataset.h"

namespace rfsmooth::bench {

/// Lengths on the unit sphere (see Sample). Planted outliers are never measured.
struct Measures {
  double chamfer = 0;      ///< mean squared distance to the nearest clean point + the mean of the reverse
  double p2s = 0;          ///< mean squared distance to the true surface
  double p2s_max = 0;      ///< largest distance (not squared) to the true surface
  double normal = 0;       ///< degrees: mean angle of the plane through the 12 nearest points to the true one
  double evenness = 0;     ///< coefficient of variation of nearest-neighbour distances
  double edge_p2s = 0;     ///< p2s of the points within two spacings of an edge of >= 40 degrees; 0 if none
  std::size_t points = 0;  ///< points measured
  std::size_t edge_points = 0;
};

/// Search structures over one sample, built once and used for any number of clouds.
class Truth {
 public:
  explicit Truth(std::shared_ptr<const Sample> sample);

  /// `points` came out of a tool that was given a case of this sample. `source[i]` is the input row of point
  /// i (kNone: unknown), an empty list means row i. Rows that were planted are left out; a point of unknown
  /// row counts as near an edge by its own position, the others by that of their clean point.
  Measures measure(const Positions& points, const std::vector<Index>& source, const Context& context) const;

  const Sample& sample() const { return *sample_; }
  const ClosestTree& surface() const { return surface_; }

 private:
  std::shared_ptr<const Sample> sample_;
  ClosestTree surface_, clean_, edges_;  ///< edges_: the sharp edges, as flat triangles
  std::vector<Eigen::Vector3d> face_normals_;
  std::vector<char> near_edge_;  ///< of each clean point
};

}  // namespace rfsmooth::bench
