/// A ring with noise, and what the automatic flow makes of it with and without the learned step.
#pragma once

#include <rfsmooth/connect.h>

#include "clouds/shapes/sampling.h"
#include "clouds/shapes/shapes.h"
#include "smoothing/automatic/flow_auto.h"

namespace rfsmooth::test {

inline constexpr double kSigma = 0.05;

/// A ring whose tube has a radius of 1.6 sigma.
inline constexpr double kLimb = 0.08;

/// A ring's cloud with noise, as a rough mesh.
inline Mesh noisy_ring(double tube, std::uint64_t seed = 3) {
  Positions points = clouds::sample(*clouds::make_torus(1, tube), 5000, seed);
  clouds::add_noise(points, kSigma, seed + 1);
  return value_or_throw(connect(points, {}, {})).mesh;
}

inline Positions smoothed(Mesh mesh, bool learned, double sigma = kSigma, const Context& context = {}) {
  AutomaticOptions options;
  options.noise = Length{sigma, false};
  options.learned = learned;
  Statistics settled;
  settled.sheets = Statistics::Sheets{0, 1};  // no hidden walls: the step is all there is
  smoothing::smooth_automatically(mesh, options, context, smoothing::Connectivity::kept, &settled);
  return mesh.positions;
}

}  // namespace rfsmooth::test
