#include "smoothing/automatic/automatic.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "base/collect.h"
#include "base/parallel.h"
#include "rfs_mesh/levels.h"
#include "smoothing/automatic/hidden_sheets.h"
#include "smoothing/automatic/learned/last_step.h"
#include "smoothing/automatic/left.h"
#include "smoothing/automatic/patches/height_field.h"
#include "smoothing/automatic/patches/scales.h"
#include "smoothing/automatic/stranded.h"
#include "smoothing/automatic/tails/tame.h"
#include "smoothing/automatic/thin_walls.h"
#include "smoothing/integrators/solver.h"

namespace rfsmooth::smoothing {

namespace {

using rfs_mesh::kStray;

// Chosen on the development shapes (tests/bench/quality) at 10,000 and 50,000 points, noise of 1 to 3 %.
constexpr double kGuide = 10;  // c = kGuide (sigma/h)^2, to the fourth power above h

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

Positions fair(const Positions& points, const Adjacency& rings, double strength,
               std::vector<double>& reductions, const Context& context) {
  const Operator op = umbrella(rings, context);
  SolverOptions options;
  options.tolerance = 1e-4;
  options.reductions = reductions;
  Positions x;
  reductions =
      solve({rings, op, {0, strength, 0, 0}, {}, {}}, points, x, AllowedMoves(), options, context).reductions;
  return x;
}

/// The guide of the points, faired over their rings, and the heights over it.
std::unique_ptr<HeightField> raise_field(const Positions& points, const Adjacency& rings,
                                         const rfs_mesh::NoiseField& noise, AutomaticReport& report,
                                         Statistics::Pass& whole, const Context& context) {
  Positions guide = fair(points, rings, report.guide_strength, whole.reductions, context);
  Landed landed = land_stranded(points, rings, kStray * noise.sigma, guide, context);
  report.stranded = landed.stranded;
  return std::make_unique<HeightField>(std::move(guide), std::move(landed.tree), std::move(landed.near),
                                       points, noise.across, context);
}

/// What is left between the data and the surface. With tails of the data as they came, for
/// pseudo-observations of one sheet are flatter than a normal distribution, as if of two.
Residuals residuals_of(const HeightField& field, const std::vector<float>& height, const Positions& data,
                       double sigma, const Tails& tails, const Context& context) {
  Residuals left{std::vector<float>(field.size()), tails.unit() * sigma, tails.share > 0};
  for_each_index(context, field.size(), [&](std::size_t i) {
    const double at = left.with_tails ? (data[i] - field.guide()[i]).dot(field.normal(i)) : field.height(i),
                 score = tails.normal_score((at - double(height[i])) / sigma);
    left.scores[i] = float(std::clamp(score, -rfs_mesh::kNoiseReach, rfs_mesh::kNoiseReach));
  });
  return left;
}

}  // namespace

Positions automatic_smoothing(Mesh& mesh, bool keep_rings, rfs_mesh::NoiseField noise, double spacing,
                              bool learned, AutomaticReport& report, rfs_mesh::NeighborTable& near,
                              const Context& context, Statistics& whole, LearnedSites* sites) {
  const std::size_t n = mesh.positions.size();
  const auto guide_strength = [&] {
    const double share = noise.sigma / spacing;
    return kGuide * share * share * std::max(1.0, share * share) * noise.shared;
  };
  report.guide_strength = guide_strength();
  std::optional<Adjacency> lines;
  if (noise.across) lines = along_lines(mesh.positions, context);
  const Adjacency& rings = lines ? *lines : mesh.one_ring;
  whole.passes.resize(std::max<std::size_t>(1, whole.passes.size()));
  auto field = raise_field(mesh.positions, rings, noise, report, whole.passes[0], context);
  context.report("smooth", 0.1);
  MixedScales pass = smooth_heights(*field, noise, spacing, learned, whole.passes[0], context);
  Positions data = mesh.positions;  // as tamed
  std::vector<double> most = noise.local;
  for (double& limit : most) limit = kStray * std::max(limit, noise.sigma);
  const double measured = noise.sigma;
  const Tails tails = tame(*field, pass, mesh, data, noise, whole.tails, context);
  if (tails.share > 0) {
    report.tail_times = tails.times;
    for (double& limit : most) limit *= tails.times;
    report.guide_strength = guide_strength();
    whole.passes.resize(2);
    field = raise_field(data, rings, noise, report, whole.passes[1], context);
    pass = smooth_heights(*field, noise, spacing, learned, whole.passes[1], context);
  }
  lines.reset();
  if (!keep_rings) mesh.one_ring = {};
  const double of_whole = whole.points ? double(*whole.points) / double(n) : 1;
  const std::vector<float> mixed = learned ? pass.height : std::vector<float>();
  // A k-th of the evidence never was enough for walls, and across lines there is none.
  const bool own_noise = !(noise.shared > 1) && !noise.across;
  HiddenSheets hidden;
  if (own_noise)
    hidden = split_hidden_sheets(*field,
                                 residuals_of(*field, pass.height, mesh.positions, measured, tails, context),
                                 pass.height, pass.own, of_whole, whole.sheets, context);
  const auto allowed = [&](std::size_t i, const Eigen::Vector3d& move) {
    return move.allFinite() && move.norm() <= most[i];
  };
  Positions smooth(n);
  for_each_index(context, n, [&](std::size_t i) {
    const Eigen::Vector3d& from = mesh.positions[i];
    // On lines the fairing moved guide points beside their line, too: what counts is the height alone.
    const Eigen::Vector3d foot =
        field->on_lines() ? Eigen::Vector3d(from - field->height(i) * field->normal(i)) : field->guide()[i];
    const Eigen::Vector3d move = foot + double(pass.height[i]) * field->normal(i) - from;
    smooth[i] = allowed(i, move) ? from + move : from;
  });
  if (own_noise)
    part_thin_walls(*field, data, pass.several, pass.members_seeing, noise, smooth, whole.thin_walls,
                    context);
  if (learned) {
    const auto may_go = [&](std::size_t i, const Eigen::Vector3d& there) {
      const Eigen::Vector3d& from = mesh.positions[i];
      return smooth[i] != from && allowed(i, there - from);  // strays stay
    };
    report.learned = take_learned_step(
        *field, data, {pass.told, pass.own, mixed, smooth, hidden.there() ? hidden.variance : 1}, noise,
        spacing, may_go, smooth, sites, context);
  }
  report.left = noise_left(*field, pass.height, pass.own, noise, context);
  near = field->release_neighbors();
  return smooth;
}

}  // namespace rfsmooth::smoothing
