/// Noise that neighbouring points share: how large it is, and over how many points it reaches.
///
/// Blotches of a depth camera, depths in steps, clumps of photogrammetry and scans that do not quite match
/// have this in common: a small neighbourhood follows the noise and shows little of it, and the scatter s(m)
/// about a quadric through m points grows with m until the neighbourhood is wider than the noise reaches. So
/// does the scatter of a surface that a quadric does not follow, but that grows with the power p = 3 of m
/// where it is smooth, with 1 across edges; places are judged by their calmer quarter, where edges are few.
/// Whatever sum of noise and of shape the scatter is,
///
///     S_p(m) = (2^p s^2(m) - s^2(2 m)) / (2^p - 1)
///
/// is at most the noise's variance if shape grows at least so. Such noise is there if the largest S with
/// p = 1.25 is above the square of what search_noise found by more than that is unsure of: bumps and folds of
/// a statue grow hardly faster, and are no noise. Or if depths in steps (depth_steps.h) make sure of so much.
/// Its variance is then the largest S with p = 3, or that of the steps as far as it is seen.
///
/// Not every m is believed. Those are
///
/// - whose balls hold a slab as thick as their points scatter,
/// - from which on the scatter grows as that of noise does (growths.h),
/// - with residuals at 2 m that are neither those of two sheets nor of waves in rows,
/// - nor of stones,
/// - and with nearest points that are off the same way at 2 m; at m, too, for p = 1.25.
///
/// None is believed where all growths are those of ground, or where windows from below saw far less than the
/// narrowest m without. Each of these rules is a function of SharedSearch (shared_noise.cpp), with its
/// reason.
///
/// Terraces are steps that points, where calm, scatter no farther than (are_two_depths). A neighbourhood
/// within one sees nothing of the steps, and noise is not normal there: the slab, stones and the nearest
/// points are not asked for.
///
/// How many points share the noise, k, is the number for which
///
///     s^2(m) = sigma^2 g(k / m)
///
/// at the m that sees half of sigma^2, or at a wider one if it says more: of noise that points share beside
/// their own, wide patches follow as much as of noise that the mean of both shares. g is what a quadric
/// through m points leaves of noise that is the mean of independent noise over the k points around each
/// place, computed for a disk of points and the weights of scatter.h.
///
/// S itself sees less than all of such noise,
///
///     S_3(m) = sigma^2 (2^3 g(k / m) - g(k / 2 m)) / (2^3 - 1),
///
/// far less where shape leaves only narrow m: sigma and k are those that agree with it, k at most that of
/// noise which grows from m to 2 m as fast as is seen. Of terraces g is not known: there this is done only if
/// what points err by on their own is more than steps round by, and blurs them.
///
/// For what smooths, a cloud with such noise is one of n / k points with noise of their own, each seen k
/// times.
#pragma once

#include "rfs_mesh/noise/noise_search.h"
#include "rfs_mesh/noise/steps/depth_steps.h"

namespace rfsmooth::rfs_mesh {

constexpr double kGrowthOfSmoothShape = 8;  ///< of its variance about a quadric, from m to 2 m points: 2^3

/// What was found.
struct SharedNoise {
  double sigma = 0;   ///< standard deviation along the normal at calm places, world units; 0: nothing found
  double points = 1;  ///< k
  std::size_t m = 0;  ///< points of a neighbourhood that is wide enough to show it
};

/// O(log n). Parallel, deterministic. \param places at least one, of a cloud of at least 25 points. \param
/// start of the noise that points have of their own (noise_search.h). \param steps null: depths are not in
/// steps.
SharedNoise find_shared_noise(Places& places, const NoiseStart& start, const DepthSteps* steps,
                              const Context& context);

}  // namespace rfsmooth::rfs_mesh
