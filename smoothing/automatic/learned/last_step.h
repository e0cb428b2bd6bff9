/// The learned last step of the automatic smoother: how far along its normal from where the mixture put it
/// the surface is.
///
/// Where a wall, a leg or an ear is thinner than four or five sigma, quadrics over sheets that the noise has
/// mixed do not hold it, and the mixture must choose between candidates that are all wrong. What the right
/// place is still shows in what is known around the point (features.h): how residuals scatter, how the data
/// lie across the surface, what the scales and the models of two sheets made of it. A small network
/// (network.h), trained on shapes with known surfaces to come as near to them as possible in the mean square,
/// turns that into a step along the normal.
///
/// It is asked where the second, third or fourth scale is worse than the one before, so where there is
/// anything that quadrics do not follow; not where neighbours share their noise, or depths come in
/// steps that are wider than it, nor where there is less of it than kLeastNoise spacings. Trained on shapes
/// that tests/bench/train makes, with noise that is white, along the ray, with tails, and louder in places,
/// also on the rings of a spinning laser. Differs from networks that denoise: it sees nothing but invariants,
/// and moves nothing but a height. It is asked once: asked again about where it led, it made thirteen further
/// meshes no better.
#pragma once

#include <functional>
#include <vector>

#include "smoothing/automatic/learned/features.h"

namespace rfsmooth::smoothing {

/// What the step is given, by point that it is asked for: to train it on (tests/bench/train).
struct LearnedInput {
  std::vector<Index> point;
  std::vector<Features::Row> features;
  Positions place, normal;  ///< P and n
  std::vector<float> unit;  ///< s, world units
};

/// Whether point i may go to `there`.
using MayGo = std::function<bool(std::size_t i, const Eigen::Vector3d& there)>;

/// Moves the points of `place` (n x 3: smoothed.place, which this may be) along their normals. O(n)
/// times the points within 6.5 sigma; parallel, the same bits for any number of threads.
void take_learned_step(HeightField& field, const Positions& data, const Smoothed& smoothed,
                       const rfs_mesh::NoiseField& noise, const MayGo& may_go, Positions& place,
                       const Context& context);

/// What the step would be given. Takes as long as all of the step.
LearnedInput learned_input(HeightField& field, const Positions& data, const Smoothed& smoothed,
                           const rfs_mesh::NoiseField& noise, const Context& context);

}  // namespace rfsmooth::smoothing
