#include "smoothing/automatic/automatic.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "base/collect.h"
#include "base/parallel.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "smoothing/automatic/guide/height_field.h"
#include "smoothing/automatic/guide/stranded.h"
#include "smoothing/automatic/hidden_sheets.h"
#include "smoothing/automatic/learned/last_step.h"
#include "smoothing/automatic/patches/scales.h"
#include "smoothing/automatic/rows/rings_at_rest.h"
#include "smoothing/automatic/tails/tame.h"
#include "smoothing/automatic/thin_walls.h"
#include "smoothing/integrators/solver.h"

namespace rfsmooth::smoothing {

namespace {

// Chosen on the development shapes (tests/bench/quality) at 10,000 and 50,000 points, noise of 1 to 3 %.
constexpr double kGuide = 10;  // c = kGuide (sigma/h)^2, to the fourth power above h

constexpr double kNearlySolved = 1e-3;  // of the noise stays in the guide: less than any height can tell

/// Rings of the nearest points along the lines that the cloud lies on, two to either side: an RFS-mesh has
/// hardly a face there, and where it has one it leads to another line, far away.
Adjacency along_lines(const Positions& points, const Context& context) {
  const rfs_mesh::NeighborTable near =
      rfs_mesh::SpatialIndex(points, context).nearest(int(rfs_mesh::kRing) / 2, context);
  const auto edges = rfsmooth::collect<Edge>(context, points.size(), [&](std::size_t i, auto&& emit) {
    for (const Index j : near[i]) emit(Edge{Index(i), j});
  });
  return make_adjacency(points.size(), edges, context);
}

Positions fair(const Positions& points, const Adjacency& rings, double strength, const Context& context) {
  const Operator op = umbrella(rings, context);
  SolverOptions options;
  options.tolerance = kNearlySolved;
  options.of_start = true;
  Positions x;
  solve({rings, op, {0, strength, 0, 0}, {}, {}}, points, x, AllowedMoves(), options, context);
  return x;
}

/// The guide of the points, faired over their rings, and the heights over it.
std::unique_ptr<HeightField> raise_field(const Positions& points, const Adjacency& rings,
                                         const rfs_mesh::NoiseField& noise, AutomaticFindings& found,
                                         const Context& context) {
  Positions guide = fair(points, rings, found.guide_strength, context);
  Landed landed = land_stranded(points, rings, noise.strays_beyond(1, context), guide, context);
  found.stranded = landed.stranded;
  return std::make_unique<HeightField>(std::move(guide), std::move(landed.tree), landed.near, points, noise,
                                       context);
}

/// c of the guide's fairing.
double strength_of_guide(const rfs_mesh::NoiseField& noise) {
  const double share = noise.sigma / noise.spacing;
  return kGuide * share * share * std::max(1.0, share * share) * points_as_one(noise);
}

/// Points as heights over their guide, and what all scales together make of these.
struct Mixed {
  std::unique_ptr<HeightField> field;
  MixedScales heights;
  Tails tails;
  Positions tamed;                                  ///< if there are tails: the points; else none
  std::optional<rfs_mesh::NoiseField> tamed_noise;  ///< if there are tails
};

/// Steps 1 to 3, twice where there are tails: then the noise is as tamed.
Mixed mix_scales(const AutomaticTask& task, AutomaticFindings& found, Statistics& whole,
                 const Context& context) {
  Mesh& mesh = task.mesh;
  std::optional<Adjacency> lines;
  if (task.noise.on_lines) lines = along_lines(mesh.positions, context);
  const Adjacency& rings = lines ? *lines : mesh.one_ring;
  Mixed mixed;
  const auto smooth = [&](const Positions& points, const rfs_mesh::NoiseField& noise, std::size_t pass) {
    whole.passes.resize(std::max(pass + 1, whole.passes.size()));
    found.guide_strength = strength_of_guide(noise);
    mixed.field.reset();
    mixed.field = raise_field(points, rings, noise, found, context);
    context.report("smooth", 0.1);
    std::optional<RingsAtRest> rest;  // only with tails will they be read again
    if (!task.keep_rings) rest.emplace(std::move(mesh.one_ring), context);
    mixed.heights = smooth_heights(*mixed.field, noise, task.learned, whole.passes[pass], context);
    if (rest) mesh.one_ring = rest->wake(context);
  };
  smooth(mesh.positions, task.noise, 0);
  mixed.tails = tame(*mixed.field, mixed.heights, mesh, task.noise, whole.tails, mixed.tamed, context);
  if (mixed.tails.share > 0) {
    found.tail_times = mixed.tails.times;
    mixed.tamed_noise = tamed(task.noise, mixed.tails);
    smooth(mixed.tamed, *mixed.tamed_noise, 1);
  }
  return mixed;
}

/// What is left between the data and the surface. With tails of the data as they came, for
/// pseudo-observations of one sheet are flatter than a normal distribution, as if of two.
Residuals residuals_of(const HeightField& field, const std::vector<float>& height, const Positions& data,
                       const NoiseModel& noise, double sigma, const Tails& tails, const Context& context) {
  Residuals left{std::vector<float>(field.size()), tails.unit() * sigma, noise.apart, tails.share > 0};
  for_each_index(context, field.size(), [&](std::size_t i) {
    const double at = left.with_tails ? (data[i] - field.guide()[i]).dot(field.normal(i)) : field.height(i),
                 score = tails.normal_score((at - double(height[i])) / sigma);
    left.scores[i] = float(std::clamp(score, -rfs_mesh::kNoiseReach, rfs_mesh::kNoiseReach));
  });
  return left;
}

/// Of the places that see several sheets those where thin walls are looked for: not around points that stay,
/// nor where they share their noise.
std::vector<Index> may_be_walls(std::vector<Index> places, const rfs_mesh::NoiseField& noise) {
  const auto is_none = [&](Index i) {
    return rfs_mesh::stays(noise.local[i], noise.sigma) || noise.as_one_near(i) > 1;
  };
  places.erase(std::remove_if(places.begin(), places.end(), is_none), places.end());
  return places;
}

/// Where a point goes whose smoothed height is `height`.
Eigen::Vector3d place_at(const HeightField& field, std::size_t i, const Eigen::Vector3d& from, float height) {
  // On lines the fairing moved guide points beside their line, too: what counts is the height alone.
  const Eigen::Vector3d foot =
      field.on_lines() ? Eigen::Vector3d(from - field.height(i) * field.normal(i)) : field.guide()[i];
  return foot + double(height) * field.normal(i);
}

}  // namespace

AutomaticResult automatic_smoothing(const AutomaticTask& task, AutomaticFindings& found, Statistics& whole,
                                    const Context& context) {
  Mesh& mesh = task.mesh;
  const std::size_t n = mesh.positions.size();
  Mixed mixed = mix_scales(task, found, whole, context);
  const rfs_mesh::NoiseField& noise = mixed.tamed_noise ? *mixed.tamed_noise : task.noise;
  const double untamed = task.noise.sigma, farther = mixed.tails.share > 0 ? mixed.tails.times : 1;
  HeightField& field = *mixed.field;
  MixedScales& heights = mixed.heights;
  const Positions& data = mixed.tails.share > 0 ? mixed.tamed : mesh.positions;
  if (!task.keep_rings) mesh.one_ring = {};
  std::vector<float>().swap(heights.wide);
  const double of_whole = whole.points ? double(*whole.points) / double(n) : 1;
  const std::vector<float> one_sheet = task.learned ? heights.height : std::vector<float>();
  // A k-th of the evidence never was enough for walls, across lines there is none, and noise that fills
  // voxels evenly looks like two sheets, as depths in steps do.
  const bool own_noise =
      !is_shared(noise) && !noise.on_lines && !noise.on_grid && !rfs_mesh::is_of_steps(noise);
  HiddenSheets hidden;
  if (own_noise && untamed > rfs_mesh::detail(noise.spacing))
    hidden = split_hidden_sheets(
        field, residuals_of(field, heights.height, mesh.positions, noise, untamed, mixed.tails, context),
        heights.height, heights.own, of_whole, whole.sheets, context);
  const auto allowed = [&](std::size_t i, const Eigen::Vector3d& move) {
    return move.allFinite() && move.norm() <= farther * task.noise.stray_beyond(i);
  };
  Positions smooth(n);
  for_each_index(context, n, [&](std::size_t i) {
    const Eigen::Vector3d& from = mesh.positions[i];
    const Eigen::Vector3d move = place_at(field, i, from, heights.height[i]) - from;
    smooth[i] = allowed(i, move) ? from + move : from;
  });
  if (own_noise)
    part_thin_walls(field, data, may_be_walls(std::move(heights.several), noise), heights.members_seeing,
                    noise, smooth, whole.thin_walls, context);
  if (task.learned) {
    const Smoothed smoothed{heights.told, heights.own, one_sheet, smooth,
                            hidden.there() ? hidden.variance : 1};
    const auto may_go = [&](std::size_t i, const Eigen::Vector3d& there) {
      const Eigen::Vector3d& from = mesh.positions[i];
      return smooth[i] != from && allowed(i, there - from);  // strays stay
    };
    if (task.for_training != nullptr)
      *task.for_training = learned_input(field, data, smoothed, noise, context);
    else
      take_learned_step(field, data, smoothed, noise, may_go, smooth, context);
  }
  // What is left is left of the cloud's own noise, whatever it was smoothed as.
  found.left = std::sqrt(heights.left.own / (task.strength * task.strength) + heights.left.wider);
  return {std::move(smooth), field.release_neighbors()};
}

}  // namespace rfsmooth::smoothing
