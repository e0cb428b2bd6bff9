#include "smoothing/automatic/learned/last_step.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "smoothing/automatic/learned/network.h"

namespace rfsmooth::smoothing {

namespace {

constexpr double kLeastNoise = 0.2;  // spacings: with less noise patches of 16 points are as wide as walls
constexpr std::size_t kBlockOfPoints = 256;

/// By how much a patch of 6 to 13 sigma in radius (wider where the noise is below half a spacing) is worse in
/// the mean, over its own width, than the one of half as many points, in sigma^2. Where none is, nothing is
/// there that a quadric does not follow, and the mixture has averaged over hundreds of points.
float contradiction(const ScalesSay& says) {
  return std::max({float(says[1].wide), float(says[2].wide), float(says[3].wide), 0.0F});
}

/// The part of a step that is taken: all of it where patches contradict each other by more than chance does,
/// and less and less below, so that what next to nothing decides makes next to no difference.
float faded_in(float contradiction) {
  constexpr float kFaded = 0.005F;  // sigma^2: at 0 a smooth sphere is 8 % worse, at 0.02 rotor gains less
  return std::min(1.0F, contradiction / kFaded);
}

/// What a step is worth taking: all of a large one, nothing of those below kLeastStep.
float worth_taking(float step) {
  constexpr float kLeastStep = 0.1F;  // s: smaller steps are mostly the network's own error
  return std::abs(step) > kLeastStep ? step - kLeastStep * kLeastStep / step : 0;
}

/// The points that the network is asked for.
std::vector<Index> asked_for(const std::vector<ScalesSay>& scales, const rfs_mesh::NoiseField& noise) {
  std::vector<Index> points;
  if (is_shared(noise) || is_of_steps(noise) || noise.sigma < kLeastNoise * noise.spacing) return points;
  for (std::size_t i = 0; i < scales.size(); ++i)
    if (contradiction(scales[i]) > 0 && !(noise.as_one_near(i) > 1)) points.push_back(Index(i));
  return points;
}

/// Calls visit(k, features of points[k]) for all k.
template <class Visit>
void look_at(const std::vector<Index>& points, const Features& features, const Context& context,
             Visit&& visit) {
  for_blocks(context, points.size(), kBlockOfPoints, [&](std::size_t begin, std::size_t end) {
    Surroundings near = features.start();
    Features::Row row;
    for (std::size_t k = begin; k < end; ++k) {
      features.fill(points[k], row, near);
      visit(k, row);
    }
  });
}

}  // namespace

LearnedInput learned_input(HeightField& field, const Positions& data, const Smoothed& smoothed,
                           const rfs_mesh::NoiseField& noise, const Context& context) {
  LearnedInput input;
  input.point = asked_for(smoothed.scales, noise);
  const std::size_t n = input.point.size();
  if (n == 0) return input;
  input.features.resize(n);
  input.place.resize(n);
  input.normal.resize(n);
  input.unit.resize(n);
  const Features features(field, data, smoothed, noise, context);
  look_at(input.point, features, context, [&](std::size_t k, const Features::Row& row) {
    const std::size_t i = input.point[k];
    input.features[k] = row;
    input.place[k] = smoothed.place[i];
    input.normal[k] = field.normal(i);
    input.unit[k] = features.unit(i);
  });
  return input;
}

void take_learned_step(HeightField& field, const Positions& data, const Smoothed& smoothed,
                       const rfs_mesh::NoiseField& noise, const MayGo& may_go, Positions& place,
                       const Context& context) {
  const std::vector<Index> points = asked_for(smoothed.scales, noise);
  if (points.empty()) return;
  const Features features(field, data, smoothed, noise, context);
  const Network network;
  Positions there(points.size());  // neighbours are seen where they were
  look_at(points, features, context, [&](std::size_t k, const Features::Row& row) {
    const std::size_t i = points[k];
    const float part = faded_in(contradiction(smoothed.scales[i])),
                offset = features.unit(i) * part * worth_taking(network.offset(row));
    there[k] = smoothed.place[i] + double(offset) * field.normal(i);
  });
  for_each_index(context, points.size(), [&](std::size_t k) {
    if (may_go(points[k], there[k])) place[points[k]] = there[k];
  });
}

}  // namespace rfsmooth::smoothing
