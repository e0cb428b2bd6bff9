/// What each site of a cloud sees without windows (scatter.h), in fits to 24, 48, 96 and 192 points of the
/// dozen to four dozen sites around it (SiteGroups). Without a window scatter is more than the noise: edges
/// and second sheets are in it.
///
/// Two sheets, or layers: sheets_around.h. Not if the residuals of the sites that see two sheets fill their
/// middle nearly as an even distribution does: then the noise itself is flat.
///
/// Bounds: the scatter of nearly all of the dozen nearest sites is one, where their balls hold the slab of
/// noisy points; what the first of 24, 192 and 1,536 points shows that hold it is one that a wider window
/// hardly exceeds. Plain noise is what the first of 24, 48, ... 768 show that hold it, where twice as many
/// show hardly more, which shape would, and where the residuals are distributed as normal noise is, which
/// edges and second sheets are not.
///
/// Floor: shape that a quadric does not follow makes the scatter s(m) grow without an end. Depths in steps
/// (time of flight, stereo, structured light) and noise that neighbours share make it grow, too, but it stops
/// where the neighbourhood is wider than a step. Where s(192) < 1.6 s(24) the scatter is noise: at least
/// s(24) and 0.65 s(192), where s(24) is less than 0.14 of the radius of its ball. Up to 1.9, and 0.2, this
/// fades out. Equal scatter needs no such floor: it is plain noise, or two sheets. Where it is seen
/// to have stopped, and neighbours err together, all of it is (shared_around.h). Counted steps
/// (depth_steps.h) make sure of their rounding, as far as s(1,536) shows it: far from a camera a step is
/// wide, and 192 points lie within it.
///
/// Shared: the points on one step are off the same way. Along a surface a step is a strip, the wider the more
/// squarely it faces the camera: as many share their noise as lie on a disk as wide as the strip, as far as
/// the noise that they had before they were rounded leaves of it. Not along lines, nor on a grid.
///
/// Clouds of fewer than 384 points have neither a floor nor such sharing.
#pragma once

#include <vector>

#include "rfs_mesh/noise/noise_search.h"
#include "rfs_mesh/noise/sites/views/site_view.h"
#include "rfs_mesh/noise/steps/depth_steps.h"

namespace rfsmooth::rfs_mesh {

/// O(sites). Parallel, deterministic. \param places the sites. \param steps null: depths are not in steps.
std::vector<SiteView> look_without_windows(Places& places, const SiteGroups& groups, const NoiseStart& start,
                                           const DepthSteps* steps, const Context& context);

}  // namespace rfsmooth::rfs_mesh
