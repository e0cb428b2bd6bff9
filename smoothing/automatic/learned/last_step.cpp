#include "smoothing/automatic/learned/last_step.h"

#include <cmath>

#include "base/parallel.h"
#include "smoothing/automatic/learned/network.h"

namespace rfsmooth::smoothing {

namespace {

constexpr double kLeastNoise = 0.2;  // spacings: with less noise patches of 16 points are as wide as walls
constexpr std::size_t kBlockOfSites = 256;

/// Whether a patch of 6 to 13 sigma is worse in the mean, over its own width, than the one of half as many
/// points. Where none is, nothing is there that a quadric does not follow, and the mixture has averaged over
/// hundreds of points.
bool may_matter(const ScalesSay& says) {
  return says[1].wide > 0 || says[2].wide > 0 || says[3].wide > 0;
}

/// What a step is worth taking: all of a large one, nothing of those below kLeastStep. The network's small
/// steps are mostly its own error.
float worth_taking(float step) {
  constexpr float kLeastStep = 0.5F;  // s
  return std::abs(step) > kLeastStep ? step - kLeastStep * kLeastStep / step : 0;
}

void write_sites(const HeightField& field, const Features& features, LearnedSites& sites,
                 const Context& context) {
  const std::size_t n = sites.point.size();
  sites.features.resize(n);
  sites.place.resize(n);
  sites.normal.resize(n);
  sites.scale.resize(n);
  for_blocks(context, n, kBlockOfSites, [&](std::size_t begin, std::size_t end) {
    std::vector<rfs_mesh::Neighbor> near;
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t i = sites.point[k];
      features.fill(i, sites.features[k], near);
      sites.place[k] = features.place(i);
      sites.normal[k] = field.normal(i);
      sites.scale[k] = features.scale(i);
    }
  });
}

}  // namespace

std::size_t take_learned_step(const HeightField& field, const Positions& data, const Smoothed& smoothed,
                              const rfs_mesh::NoiseField& noise, double spacing, std::vector<float>& height,
                              LearnedSites* sites, const Context& context) {
  if (noise.shared > 1 || noise.sigma < kLeastNoise * spacing) return 0;
  const Features features(field, data, smoothed, noise, spacing, context);
  std::vector<Index> points;
  for (std::size_t i = 0; i < field.size(); ++i)
    if (may_matter(smoothed.scales[i])) points.push_back(Index(i));
  if (sites != nullptr) {
    sites->point = std::move(points);
    write_sites(field, features, *sites, context);
    return 0;
  }
  const Network network;
  std::vector<float> offset(points.size());
  for_blocks(context, points.size(), kBlockOfSites, [&](std::size_t begin, std::size_t end) {
    std::vector<rfs_mesh::Neighbor> near;
    Features::Row row;
    for (std::size_t k = begin; k < end; ++k) {
      features.fill(points[k], row, near);
      offset[k] = features.scale(points[k]) * worth_taking(network.offset(row));
    }
  });
  for (std::size_t k = 0; k < points.size(); ++k) height[points[k]] += offset[k];
  return points.size();
}

}  // namespace rfsmooth::smoothing
