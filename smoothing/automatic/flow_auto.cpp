#include "smoothing/automatic/flow_auto.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"
#include "base/quantile.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "smoothing/automatic/along_surface/equalize.h"
#include "smoothing/automatic/along_surface/slide_back.h"
#include "smoothing/automatic/guide/height_field.h"
#include "smoothing/automatic/part_by_part.h"

namespace rfsmooth::smoothing {

namespace {

/// Noise of the size `sigma`, that varies over the cloud as `noise` does, times `strength`. Places whose
/// noise cannot be told from detail stay; so does all of a cloud of which that is true even where points are
/// densest: there, or in a denser part of the cloud, `least` apart. Noise that most places tell is smoothed
/// however small. A strength above 1 acts everywhere: where
/// less was measured than detail may hide, on that much.
rfs_mesh::NoiseField scaled(rfs_mesh::NoiseField noise, double sigma, double strength, double least) {
  const auto of = [&](double s, double hidden) {
    if (strength > 1) return strength * std::max(s, hidden);
    return s > hidden ? strength * s : 0.0;
  };
  const auto hidden_at = [&](std::size_t i) {
    const double told = noise.local_told.empty() ? 0 : noise.local_told[i];
    return (1 - told) * rfs_mesh::kNoNoise *
           (noise.local_spacing.empty() ? noise.spacing : noise.local_spacing[i]);
  };
  const double measured = noise.sigma;
  noise.sigma = of(sigma, rfs_mesh::is_told(noise) ? 0 : rfs_mesh::kNoNoise * least);
  for (std::size_t i = 0; i < noise.local.size(); ++i)
    noise.local[i] = std::max(of(measured > 0 ? noise.local[i] * sigma / measured : sigma, hidden_at(i)),
                              rfs_mesh::kStays * noise.sigma);
  std::vector<double>().swap(noise.local_spacing);  // nobody asks any more
  std::vector<double>().swap(noise.local_told);
  return noise;
}

/// The spacing where points are densest.
double least_spacing(const NoiseModel& noise) {
  const std::vector<double>& spacings = noise.spacing_at_sites;
  return spacings.empty() ? noise.spacing : *std::min_element(spacings.begin(), spacings.end());
}

/// Why everything stays; none: there is something to smooth. \param sigma as scaled
std::optional<NotSmoothed> why_not(std::size_t points, double strength, double sigma) {
  if (strength == 0) return NotSmoothed::no_strength;
  if (points < std::size_t(HeightField::kNear)) return NotSmoothed::too_few_points;
  if (!(sigma > 0)) return NotSmoothed::too_little_noise;
  return {};
}

/// Takes back what a move has beyond kNoiseReach, and all of it of points that stay. \param noise times
/// `strength`; where there are tails, `tail_times` of it.
void limit(const Positions& before, const rfs_mesh::NoiseField& noise, double strength, double tail_times,
           Positions& points, const Context& context) {
  for_each_index(context, points.size(), [&](std::size_t i) {
    const double most =
        rfs_mesh::stays(noise.local[i], noise.sigma)
            ? 0
            : rfs_mesh::kNoiseReach * std::max(1.0, 1 / strength) * tail_times * noise.local[i];
    const Eigen::Vector3d move = points[i] - before[i];
    if (const double length = move.norm(); length > most) points[i] = before[i] + most / length * move;
  });
}

class AutomaticFlow : public Flow {
 public:
  AutomaticFlow(const AutomaticOptions& options, std::optional<AutomaticFindings>* found,
                Statistics* statistics)
      : options_(options), found_(found), statistics_(statistics) {}

  void step(Mesh& mesh, const Context& context) override {
    const auto found = smooth_automatically(mesh, options_, context, Connectivity::kept, statistics_);
    statistics_ = nullptr;  // what a step leaves is another cloud
    if (found_ != nullptr) *found_ = found;
  }

 private:
  AutomaticOptions options_;
  std::optional<AutomaticFindings>* found_;
  Statistics* statistics_;
};

}  // namespace

double told_noise(const rfs_mesh::NoiseField& noise) {
  constexpr double kMostlyShape = 0.4;  // of the development shapes, clean and with noise of 0.1 spacings
  const double detail = rfs_mesh::detail(noise.spacing);
  if (!(noise.sigma < detail && noise.shape > kMostlyShape)) return noise.sigma;
  std::vector<double> sites = noise.at_sites;
  return !sites.empty() && quantile(sites, 0.9) > rfs_mesh::kLouder * detail ? noise.sigma : 0;
}

NoiseSummary summary_of(const rfs_mesh::NoiseField& noise) {
  NoiseSummary summary{noise.sigma, noise.sigma,   noise.shared,
                       noise.step,  noise.on_grid, noise.piece > rfs_mesh::kNarrowestPatch};
  if (noise.local.empty()) return summary;
  std::vector<double> local = noise.local;
  summary.loudest = quantile(local, 0.9);
  std::vector<double> shared = noise.local_shared;
  if (!shared.empty()) summary.shared = median(shared);
  return summary;
}

std::optional<AutomaticFindings> smooth_automatically(Mesh& mesh, const AutomaticOptions& options,
                                                      const Context& context, Connectivity connectivity,
                                                      Statistics* statistics, LearnedInput* for_training,
                                                      const NoiseModel* of_all) {
  if (connectivity == Connectivity::used_up) std::vector<Face>().swap(mesh.faces);
  if (mesh.positions.size() < 2) return {};
  Statistics own, &whole = statistics != nullptr ? *statistics : own;
  if (!whole.noise) rfs_mesh::known_noise(rfs_mesh::SpatialIndex(mesh.positions, context), whole, context);
  if (!whole.parts.empty() && for_training == nullptr)
    return smooth_part_by_part(mesh, rfs_mesh::spread_noise(*whole.noise, mesh.positions, context), options,
                               whole, context);
  rfs_mesh::NoiseField noise = rfs_mesh::spread_noise(*whole.noise, mesh.positions, context);
  const NoiseSummary summary = summary_of(noise);
  const double sigma = options.noise ? options.noise->resolve(noise.spacing) : told_noise(noise);
  const double least = least_spacing(of_all != nullptr ? *of_all : noise);
  noise = scaled(std::move(noise), sigma, options.strength, least);
  AutomaticFindings found;
  found.noise = sigma;
  found.measured = summary;
  found.left = sigma;
  found.not_smoothed = why_not(mesh.positions.size(), options.strength, noise.sigma);
  if (found.not_smoothed) return found;
  AutomaticResult smooth = automatic_smoothing(
      {mesh, noise, options.learned, connectivity == Connectivity::kept, options.strength, for_training},
      found, whole, context);
  mesh.positions.swap(smooth.points);
  const Positions before = std::move(smooth.points);
  rfs_mesh::NeighborTable near = smooth.near.first(NearRows::kMost, context);
  smooth.near = {};
  if (!noise.on_lines) {  // along lines only the normals are known
    if (options.equalize && !is_shared(noise)) {
      const Equalized moved = equalize(mesh.positions, before, noise, std::move(near), context);
      found.equalized = moved.rms;
      found.equalized_most = moved.largest;
    } else {
      slide_back(mesh.positions, before, std::move(near), context);
    }
  }
  limit(before, noise, options.strength, found.tail_times, mesh.positions, context);
  return found;
}

std::unique_ptr<Flow> make_automatic(const AutomaticOptions& options, std::optional<AutomaticFindings>& found,
                                     Statistics& statistics) {
  return std::make_unique<AutomaticFlow>(options, &found, &statistics);
}

}  // namespace rfsmooth::smoothing

namespace rfsmooth {

using namespace smoothing;

std::unique_ptr<Flow> AutomaticOptions::start(const Mesh&, const Constraints&, const Context&) const {
  return std::make_unique<AutomaticFlow>(*this, nullptr, nullptr);
}

}  // namespace rfsmooth
