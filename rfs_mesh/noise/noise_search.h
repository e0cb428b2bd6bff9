/// The noise of a cloud as one figure to start from, found from below.
///
/// Only points within 3 sigma of a fitted quadric count (scatter.h), and sigma is what is sought. The window
/// opens until what the calmer quarter of the places shows in it is as narrow as a normal distribution would
/// be. Coming from below stops at the noise of one sheet; coming from above would stop at the thickness. m
/// starts at 16, or where 16 are no piece of a surface at the least number that are, and grows until the ball
/// holds a patch of 2 sigma in radius with all of the window above and below it. What the calmer fifth shows
/// without any window is an upper bound, and so is what kernels read (narrow_kernel.h). Noise of about a
/// spacing and more they tell: then windows open from there.
#pragma once

#include "rfs_mesh/fit/places.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/scatter_statistics.h"
#include "rfs_mesh/noise/steps/depth_steps.h"

namespace rfsmooth::rfs_mesh {

/// Times: a window that is so near to what it shows is as wide as that.
constexpr double kSettled = 1.03;

/// The quantile of places that are believed to show noise and no shape, and of a normal variable.
constexpr double kCalmPlaces = 0.25, kCalmDeviate = -0.674;

/// The same where places are believed against most others.
constexpr double kCalmFifth = 0.2, kCalmFifthDeviate = -0.84;

/// Where the search for the noise begins.
struct NoiseStart {
  double sigma = 0;                 ///< world units
  double least = 0;                 ///< what counts as zero; 0: the points coincide
  double most = 0;                  ///< bound
  double of_steps = 0;              ///< NoiseModel::rounding of depths in steps
  double apart = 0;                 ///< NoiseModel::apart
  std::size_t m = kNarrowestPatch;  ///< points of a neighbourhood; along lines it follows them
  double shape_grows = 2;           ///< variance that is shape, from m to 2 m points: at least so many times
  std::size_t piece = kNarrowestPatch;  ///< least m that is a piece of surface and not of a line
  /// Whether noise of about a spacing or more fills the nearest neighbours: its slab is wider than they are.
  bool fills_nearest() const { return m >= kNeighbourhood; }
  bool in_kernels = false;  ///< whether the bound was read in kernels (narrow_kernel.h)
  bool on_lines = false;    ///< whether twice kNarrowestPatch points lie along a line, and `piece` do not
};

/// A fit takes at most one of so many points of the cloud.
constexpr std::size_t kShareOfCloud = 12;

/// Most neighbours of a fit in a cloud.
std::size_t widest_scatter(const SpatialIndex& index);

/// The median distance to the m-th nearest point. \param at places, at least one. O(m) after the index.
double median_radius(const SpatialIndex& index, const Positions& at, std::size_t m);

/// By place: the steps there. Parallel. \param steps null: depths are not in steps.
std::vector<LocalSteps> steps_at(const Places& places, const DepthSteps* steps);

/// By place: what depths in steps add by their rounding along the normal of its fit, world units.
std::vector<double> rounding_at(const std::vector<LocalSteps>& steps, const std::vector<Scatter>& all);

/// Variance that steps make sure of at calm places. \param rounding of rounding_at
double variance_of_steps(const std::vector<double>& rounding, const std::vector<Scatter>& all);

/// How far points scatter that are at two depths which follow each other: by half a step, where rounding adds
/// 1 / sqrt(12) of it.
double two_depths(double rounding);

/// Whether they scatter no more. Nothing that is nearer to each other than a step is two sheets.
bool are_two_depths(double variance, double rounding);

/// How far the ball of a fit must reach for noise sigma: to a patch of 2 sigma with all of the window above
/// and below it. \param narrow radius of the ball of the least m.
double scatter_reach(double sigma, double narrow);

/// Where the search looks: up to 500 of the points, evenly over their order.
Places search_places(const SpatialIndex& index, const Context& context);
/// It would keep a reference to a context that is gone.
Places search_places(const SpatialIndex& index, Context&& context) = delete;

/// Where fits to m points are made: at up to 2,000 of the places, evenly over their order; fewer where m is
/// large and the fits overlap, but at 250.
Positions listening_places(const Positions& places, std::size_t m);

/// By place: start.m; along lines twice kNarrowestPatch where kNarrowestPatch are not on one, since noise
/// makes a strip of it: twice as many on a line are a quarter as broad.
std::vector<std::size_t> points_to_fit(Places& places, const NoiseStart& start);

/// O(log n). Parallel, deterministic. \param places at least one, of a cloud of at least 25 points; they are
/// where they were when it is done. \param steps null: depths are not in steps. \param rounding of the
/// coordinates (steps/rounding.h).
NoiseStart search_noise(Places& places, const DepthSteps* steps, double rounding);

}  // namespace rfsmooth::rfs_mesh
