/// The noise around up to 2,000 sites of a cloud.
///
/// The noise at a site is the mean of the fits at its nearest sites, each with a window of its own
/// (scatter.h) that begins at the noise search_noise found. The mean is of up to 48 fits; but where the dozen
/// nearest show 1.5 times the variance of all, it is of these alone: a loud part beside a calm one. (A dozen
/// that shows less does not speak alone: a flat beside an edge would, and noise that is read too large does
/// little harm.) A window that is too narrow for the noise shows more than it was made for, and opens to
/// that; one that is far too narrow cuts off so many points that no fit says anything. So does one that cuts
/// off the second sheet of a wall; but there what is left in the window scatters as little as the window was
/// made for, while louder noise fills it evenly, at three times that variance, or leaves nothing in it at
/// nearly all of the sites around. A window that is filled evenly gets wider, to the scatter seen in it.
/// Windows open up to eight times; in one sheet by less every time. One that is far wider than the first,
/// opened by ever less and then opens by a tenth more lets another sheet in (the far wall of a pipe), and
/// stays as it was. A site is fitted again while its window or its place changes.
///
/// A site's fits take more points, until their ball is as wide as its noise needs, if its window ends above
/// twice the noise it began with; or the points are denser than elsewhere; or it ends above 1.1 times that
/// noise and the first of 24, 192 and 1,536 points that hold the slab of noisy points show, without a window,
/// less than 1.26 times as much: nothing lies beyond the window. Where search_noise took fewer than 24
/// points, they must also show 1.5 times the variance it found.
///
/// A part that is far louder than the start leaves so few points in a window that the quadric passes through
/// them. Where a tenth of the places and more see plain noise (site_views.h) of more than twice the window,
/// their windows are as wide as that; two sheets that far apart would have been seen. Places that no fit
/// speaks for take the window that is usual around them, then.
///
/// Leaves and twigs fill a ball of any width: what scatters far more than the start by more than a third of
/// the ball's radius, though more points were taken again and again, is no surface. Such a site does not
/// speak, and has what those around it say.
///
/// What a site sees without any window (site_views.h) bounds what it shows in one: two sheets seen there keep
/// windows as narrow as each of them is, nothing is louder than nearly all of the nearest sites see, and
/// depths in steps, shared noise and layers are a floor.
///
/// Shape that a quadric does not follow makes the scatter s(m) grow with the number of neighbours m without
/// an end: s^2(m) = sigma^2 + b m to first order, so sigma^2 = 2 s^2(m) - s^2(2 m), at most 0.6 of s^2(m)
/// taken off. Where noise is shared and m wide, only smooth shape is left at calm places, and that grows by
/// NoiseStart::shape_grows.
#pragma once

#include <vector>

#include "rfs_mesh/noise/noise_search.h"
#include "rfs_mesh/noise/steps/depth_steps.h"

namespace rfsmooth::rfs_mesh {

/// By site.
struct NoiseSites {
  bool in_steps = false;  ///< whether depths come in steps
  Positions at;
  std::vector<double> sigma;     ///< world units
  std::vector<double> shape;     ///< part of s^2(m) taken off as shape, 0 to 0.6
  std::vector<double> area;      ///< of the surface around it, over that where points are sparse: 0 to 1
  std::vector<char> speaks;      ///< whether sigma is of this place; else it is what came nearest to it
  std::vector<double> volume;    ///< scatter around it that is of no surface, as of leaves, world units, and
                                 ///< was not believed; 0: there was none
  std::vector<char> full;        ///< whether the site's own fit fills a window as wide as its group has noise
  std::vector<char> two_sheets;  ///< whether these are seen there
  std::vector<double> open;      ///< what the 24 points around it show without a window, world units
  std::vector<double> most;      ///< what is seen without windows around it, world units; infinite: not known
  std::vector<double> floor;     ///< least noise, of steps, shared noise or layers, or of each of two sheets
                                 ///< where no fit within windows says a thing; world units; 0: none
  std::vector<char> told;        ///< whether the scatter around it stops growing, and is no detail
  std::vector<char> plain;       ///< whether plain noise is seen around it, which is no detail either
  std::vector<char> turned;      ///< SiteView::turned
  std::vector<double> shared;    ///< points that share the noise around it; 1: none
  std::vector<double> per_root;  ///< radius of balls around it over the root of their points, world units
  std::vector<Scatter> fits;     ///< to the m nearest of the site by itself, more where it is far louder

  /// Whether noise is told from detail at a site, in either way.
  bool tells_noise(std::size_t s) const { return told[s] != 0 || plain[s] != 0; }
};

/// Whether points are so close that it is no second sheet beside theirs that makes them so: more than twice
/// as dense as typical ones. \param per_root of NoiseSites, here and of typical ones
inline bool denser(double per_root, double typical) {
  return 2 * per_root * per_root < typical * typical;
}

/// \param at the sites. \param start sigma and m to start from, `least` > 0. O(log n). Parallel,
/// deterministic. \param steps null: depths are not in steps.
NoiseSites listen(const SpatialIndex& index, Positions at, const NoiseStart& start, const DepthSteps* steps,
                  const Context& context);

}  // namespace rfsmooth::rfs_mesh
