/// The automatic flow: how strongly to smooth is chosen at every point from the data.
///
/// 1. Guide: one implicit fairing of second order on the RFS-mesh, (I + c L^2) g = x with the umbrella and
///    c = 10 (sigma/h)^2, 10 (sigma/h)^4 above one spacing (Desbrun et al. 1999, 2.6; Kobbelt et al. 1998),
///    sigma the noise, h the spacing. The larger the noise is beside the spacing, the more points must be
///    averaged before neighbours on the guide are neighbours on the surface.
///    Points it stranded are landed (stranded.h). The cloud is now a height field z over the guide.
/// 2. Candidates: overlapping quadrics over m = m_0, 2 m_0, 4 m_0, ... points (patches.h), each scale a
///    prediction f_m of every height. The narrowest patch has a radius of 4.5 sigma or more: below that the
///    guide, which was made from the same data, is within its noise.
/// 3. Choice: Stein's unbiased risk (Stein 1981) of each scale at each point,
///        rho_m = (z - f_m)^2 / sigma^2 + 2 df_m/dz - 1,
///    sigma the noise around the point, whose mean over a neighbourhood estimates the mean squared error of
///    f_m there, in units of sigma^2, without knowing the truth. Each scale is compared with the next
///    narrower one over a neighbourhood of its own size (what a patch of m points can see, only a mean over m
///    points can judge), and the scales are mixed with weights exp(-size of the evidence) (Leung and Barron
///    2006) times how well each serves the cloud as a whole (mixture.h): smooth places take wide patches,
///    edges and thin parts narrow ones, and where every patch is worse than the data the data stay.
///    Where the noise differs from place to place, each risk has the weight 1 / sigma^2 in such a mean.
///    Points that stay have no noise, and their risks are left out: divided by it they would be huge.
/// 4. Walls thinner than the noise, which look like one sheet with more of it, are taken apart where the
///    cloud as a whole says that they are walls (hidden_sheets.h); those of a few sigma get their two sheets
///    fitted together (thin_walls.h). Neither is tried where points share their noise: blotches look like
///    sheets. Where patches contradict each other, a learned step goes on from there towards the surface
///    (learned/last_step.h).
/// 5. What is left is told by the scales (Left of mixture.h): an average of twice as many points has half of
///    the variance left, whoever shares the noise, and two such differ by about as much.
///
/// Noise that k neighbours share (rfs_mesh/noise/shared/shared_noise.h) is that of n / k points, each seen k
/// times: scales begin at 16 k points or more, c is k times as large, evidence counts a k-th, and of a
/// prediction that has the share `own` of the point's height k own / (1 + (k - 1) own) is the point's and its
/// neighbours' noise. What such points have of their own beside it is noise for sure: in place of the data
/// the patches of 16 points are the first candidate, so that where every wide patch is worse the points are
/// left calm. Of points on few lines (NoiseModel::piece) the same is done, but no wider patches are tried.
/// Where only places of the cloud share their noise (NoiseModel::shared_at_sites), there evidence and `own`
/// count so, and the scales are those of the cloud.
///
/// Where the nearest points lie along lines (NoiseModel::on_lines), as on the rings of a spinning laser, the
/// guide is faired along them, over the nearest of each point in place of the mesh. Normals are those of
/// the thinned guide, narrow patches are parabolas along the line, points move along their normals only, and
/// neither walls nor tails are looked for.
///
/// Where some points are several times noisier than their neighbours (tails.h), steps 1 to 3 are done twice,
/// the second time with those drawn towards the surface that the others show. Such points are off each by
/// itself; where far points stand together, it is shape, or noise that was missed there, and what their
/// neighbours are off by is taken off first.
///
/// One strength for the whole cloud cannot do this: on the development shapes the best single c differs by
/// 100 times between the flat and the thin parts of one cloud. Points move along the guide's normals from the
/// guide's places, on lines from their own; those that would move more than 5 sigma are strays and stay.
#pragma once

#include <optional>

#include <rfsmooth/flow.h>
#include <rfsmooth/statistics.h>

#include "rfs_mesh/noise/noise.h"
#include "rfs_mesh/search/neighbors.h"
#include "smoothing/automatic/learned/last_step.h"
#include "smoothing/automatic/rows/near_rows.h"

namespace rfsmooth::smoothing {

/// What is smoothed, and how.
struct AutomaticTask {
  Mesh& mesh;                         ///< of at least HeightField::kNear points; they stay where they are
  const rfs_mesh::NoiseField& noise;  ///< along the normal, of positive sigma; local: n, positive
  bool learned = true;                ///< whether the learned step is taken
  bool keep_rings = true;  ///< false: the mesh is left without its one-rings, as soon as they are read
  double strength = 1;     ///< how many times that of the cloud `noise` is; positive
  /// Of no use but to train the learned step (tests/bench/train): if it is there, and `learned`, it gets what
  /// the step would be given, and the step is not taken.
  LearnedInput* for_training = nullptr;
};

/// What the automatic flow measured and chose in a step; a DenoiseReport tells that of the first.
struct AutomaticFindings {
  NoiseSummary measured;
  std::optional<NotSmoothed> not_smoothed;  ///< why not; none: there was something to smooth
  double noise = 0;           ///< measured or stated, standard deviation along the normal, world units
  double guide_strength = 0;  ///< c of the guide's fairing, dimensionless
  double left = 0;            ///< estimate of the noise left, root mean square along the normal, world units
  double equalized = 0;       ///< root mean square move along the surface afterwards, world units
  double equalized_most = 0;  ///< the largest of them
  double tail_times = 1;      ///< noise of the points of the tails over that of the others; 1: none
  std::size_t stranded = 0;   ///< points that the fairing had left beside the surface
};

/// What has become of it.
struct AutomaticResult {
  Positions points;  ///< n x 3: the smoothed places
  NearRows near;     ///< the nearest of every point on the guide (height_field.h)
};

/// O(n log n); about 350 bytes a point beside the mesh. Parallel, the same bits for any number of threads.
/// \param found what was measured and what was equalized are the flow's to enter (flow_auto.cpp). \param
/// whole what is there is taken, the rest entered.
AutomaticResult automatic_smoothing(const AutomaticTask& task, AutomaticFindings& found, Statistics& whole,
                                    const Context& context);

}  // namespace rfsmooth::smoothing
