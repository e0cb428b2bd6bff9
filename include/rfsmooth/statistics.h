/// What `denoise` measures on a cloud as a whole, as a value. Each part that is there is used; each that is
/// not is measured and entered. So the statistics that a run fills in give the same bytes when used again,
/// and parts of a cloud that are smoothed one by one with the statistics of the whole fit together. Plain
/// values: thread safe as those are.
///
/// Ranges are those that `check` asks for. A length is 0 or from 1e-150 to 1e100, a number of neighbours or
/// members below 2^32 - 1.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace rfsmooth {

/// How wide the quadrics are that connecting stands on, and what they show of the noise: at most what
/// NoiseModel says of it.
struct NoiseScale {
  double sigma = 0;            ///< along the normal, world units; a length
  std::size_t neighbours = 0;  ///< m: what a quadric needs; at least 1 where sigma is above 0
  double radius = 0;           ///< median distance to the m-th neighbour, world units; a length
};

/// The noise of a cloud: one figure, and what differs from it from place to place. Measured once, it tells
/// outliers from others, and connecting and smoothing go by it.
struct NoiseModel {
  /// Standard deviation along the normal, world units: typical of the cloud. A length; above 0 there is a
  /// site and a spacing above 0.
  double sigma = 0;
  /// Part of the scatter taken off as shape: 0 to 0.6, above half little is sure. At most 1.
  double shape = 0;
  double spacing = 0;  ///< mean distance to the nearest neighbour, of up to 50,000 points; a length
  /// What points keep from each other: the distance to their nearest of 99 of 100 of these, or the size of
  /// the voxels that the cloud was thinned in; a length.
  double apart = 0;
  double shared = 1;  ///< points that share their noise: 1, each has its own, or more
  /// Nearest points that are a piece of the surface: more than 16 where fewer are on a line or on few lines,
  /// as on the rings of a spinning laser. At least 16.
  std::size_t piece = 16;
  bool on_lines = false;  ///< whether fewer are on one line; there is another at least
  double step = 0;        ///< typical distance between depths that come in steps, a length; 0: none
  bool on_grid = false;   ///< whether the points are on a grid of that step, as voxels' centres are
  double rounding = 0;  ///< what the steps add along the normals of calm places, standard deviation; a length
  /// Places, around the middle of the box, coordinates within 1e100; one where noise and density are even.
  std::vector<Eigen::Vector3d> sites;
  std::vector<double> at_sites;  ///< sigma there, one for each site; lengths
  /// Mean distance to the nearest neighbour there if points are more than twice as dense as on the mean, else
  /// `spacing`; lengths above 0; empty: they are nowhere.
  std::vector<double> spacing_at_sites;
  /// 1 where more neighbours show no more scatter, so that it is no detail, however small; else 0; empty: it
  /// is nowhere so. Where sigma is less than a twentieth of the spacing 1 at all sites, if most show that, or
  /// empty.
  std::vector<double> told_at_sites;
  /// `shared` there, where parts of the cloud differ in that; at least 1; empty: they do not.
  std::vector<double> shared_at_sites;
};

/// What `denoise` measures on a cloud as a whole. Lengths are in world units.
struct Statistics {
  /// The box of the finite points. Its middle is the origin of all that is computed.
  struct Box {
    Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();
  };
  /// Points several times noisier than their neighbours.
  struct Tails {
    double share = 0;   ///< of the points, below 1; 0: none
    double times = 1;   ///< their standard deviation over that of the others, 1 to 10,000
    double narrow = 1;  ///< standard deviation of the others over what was measured for all, above 0
    /// How many times more of the neighbours of far points are far than of all points; 0 or more.
    double together = 0;
  };
  /// A scale of smoothing: patches of so many points, 1 or more, around seeds that are left of so many
  /// thinnings, 1 to 64.
  struct Scale {
    std::size_t members = 0, thinnings = 0;
  };
  /// A pass over all scales; clouds with tails take two.
  struct Pass {
    std::optional<Scale> narrow;  ///< stands for the data where points share their noise
    static constexpr std::size_t kMostScales = 15;
    std::vector<Scale> scales;  ///< ascending, at most kMostScales
    /// Of the cloud that the data and each scale serve best: none, or one more than scales, 0 or more each,
    /// and not all 0.
    std::vector<double> shares;
  };
  /// Walls thinner than the noise.
  struct Sheets {
    double evidence = 0;  ///< nats for two sheets against louder noise, at the best variance; finite
    double variance = 1;  ///< of the noise that leaves, over what was measured; above 0
  };

  std::optional<Box> box;
  std::optional<std::size_t> points;  ///< of the whole cloud: finite, distinct, without outliers; 1 or more
  std::optional<double> reach;        ///< median distance to the eighth neighbour, with outliers; a length
  std::optional<NoiseScale> scale;  ///< of the quadrics that connecting stands on, for the louder parts, too
  std::optional<double> spacing;    ///< mean distance to the nearest neighbour, of all points; a length
  std::optional<NoiseModel> noise;
  std::optional<Tails> tails;
  std::vector<Pass> passes;
  std::optional<Sheets> sheets;
  std::optional<bool> thin_walls;  ///< whether walls of a few sigma are parted

  struct Part;
  /// Of a cloud in which some points are ten times as dense as the others and more, and hardly any in
  /// between: its parts, which are smoothed each by itself, the densest first. None: it is one. They are
  /// measured with the noise.
  std::vector<Part> parts;
};

/// The points of a part of a cloud, and what was measured on these.
struct Statistics::Part {
  /// Radius of the ball of the 24 nearest points around one of these, itself included: at least this, and
  /// less than that of the next part; a length.
  double from = 0;
  Statistics own;  ///< of points, noise, tails, passes, sheets and thin_walls; no parts
};

/// Why these cannot be statistics of any cloud, one line each; empty if they can.
std::vector<std::string> check(const Statistics& statistics);

}  // namespace rfsmooth
