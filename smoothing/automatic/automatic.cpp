#include "smoothing/automatic/automatic.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "smoothing/automatic/hidden_sheets.h"
#include "smoothing/automatic/mixture.h"
#include "smoothing/automatic/patches/height_field.h"
#include "smoothing/automatic/patches/patches.h"
#include "smoothing/automatic/patches/thinning.h"
#include "smoothing/automatic/stranded.h"
#include "smoothing/automatic/thin_walls.h"
#include "smoothing/integrators/solver.h"

namespace rfsmooth::smoothing {

namespace {

// Chosen on the development shapes (tests/bench/quality) at 10,000 and 50,000 points, noise of 1 to 3 %.
constexpr std::size_t kMostOverlap = 14;  // patches over a point; a thinning leaves 0.4 of them
constexpr double kGuide = 10;             // c = kGuide (sigma/h)^2, to the fourth power above h
constexpr double kNarrowest = 52.6;       // m_0 = kNarrowest (sigma/h)^2: a radius of 4.5 sigma
constexpr double kFewest = 16;            // m_0 at small noise: a quadric has six unknowns
constexpr double kWidest = 1600;          // the widest patches, and
constexpr double kWidestShare = 4;        // at least this many times m_0
constexpr double kStrayFrom = 5;          // sigma
constexpr std::size_t kSeeing = 2;        // the scale that looks for walls, of 9 sigma: from 0

constexpr double kNoNoise = 0.05;     // spacings: less than this is left alone
constexpr std::size_t kTooFew = 32;   // points
constexpr std::size_t kDense = 4;     // a subset with a point in so many has its own among the nearest
constexpr std::size_t kOwnMean = 60;  // from this many members on, patches average; below, near neighbours do
constexpr float kNearEvidence = 10;   // nats per sigma^2 of a near mean
constexpr float kPatchEvidence = 0.25F;  // the same of a patch mean, per member (Leung and Barron's 1/4)
constexpr float kTolerated = 0.15F;      // sigma^2: what a near mean scatters by without meaning anything

Positions fair(const Mesh& mesh, double strength, const Context& context) {
  const Operator op = umbrella(mesh, context);
  SolverOptions options;
  options.tolerance = 1e-4;
  Positions x;
  solve({mesh.one_ring, op, {0, strength, 0, 0}, {}, {}}, mesh.positions, x, AllowedMoves(), options,
        context);
  return x;
}

std::vector<float> heights(const HeightField& field, const Context& context) {
  std::vector<float> all(field.size());
  for_each_index(context, field.size(), [&](std::size_t i) { all[i] = field.local()[i].height; });
  return all;
}

/// What the patches of one scale say.
struct Scale {
  std::size_t members;
  Prediction prediction;
  std::vector<float> worse;    ///< n: the risk's difference to the scale before
  std::vector<float> mean;     ///< n: of that, as the patches see it; empty if they are narrow
  std::vector<Index> several;  ///< places that see more than one sheet
};

/// `before` holds the risk of the scale before it.
Scale try_scale(const HeightField& field, std::size_t members, const std::vector<Index>& seeds,
                const std::vector<double>& sigma, std::vector<float>& before, Patches::Memory& memory,
                const Context& context) {
  const Patches patches(field, members, seeds, sigma, memory, context);
  Scale scale{
      members, patches.predict(context), std::vector<float>(field.size()), {}, patches.with_several_sheets()};
  const Prediction& prediction = scale.prediction;
  for_each_index(context, field.size(), [&](std::size_t i) {
    const float e = (field.local()[i].height - prediction.height[i]) / float(sigma[i]);
    const float risk = prediction.covered[i] != 0 ? e * e + 2 * prediction.own[i] - 1 : before[i];
    scale.worse[i] = risk - before[i];
    before[i] = risk;
  });
  if (members >= kOwnMean) scale.mean = patches.mean(patches.mean(scale.worse, context), context);
  return scale;
}

/// Means over near neighbours for all scales, each in place of `worse`.
void average_near(const HeightField& field, std::vector<Scale>& scales, const Context& context) {
  constexpr std::size_t kTogether = HeightField::Columns::SizeAtCompileTime;
  for (std::size_t first = 0; first < scales.size(); first += kTogether) {
    const std::size_t count = std::min(kTogether, scales.size() - first);
    std::vector<HeightField::Columns> near(field.size());
    for_each_index(context, field.size(), [&](std::size_t i) {
      near[i].setZero();
      for (std::size_t s = 0; s < count; ++s) near[i][Eigen::Index(s)] = scales[first + s].worse[i];
    });
    near = field.local_mean(field.local_mean(near, context), context);
    for_each_index(context, field.size(), [&](std::size_t i) {
      for (std::size_t s = 0; s < count; ++s) scales[first + s].worse[i] = near[i][Eigen::Index(s)];
    });
  }
}

/// The mixture of the data and all scales, by their evidence.
void mix(const HeightField& field, std::vector<Scale> scales, std::vector<float>& height,
         std::vector<float>& own, const Context& context) {
  // The data themselves are the first candidate: no error against themselves, all their own.
  Mixture mixture(heights(field, context));
  average_near(field, scales, context);
  for (Scale& scale : scales) {
    // A wide patch is judged over its own width, but must not be far off anywhere near the point either: the
    // few points that it misses by sigmas would be outvoted.
    std::vector<float>& gain = scale.worse;
    for_each_index(context, field.size(), [&](std::size_t i) {
      const float near = gain[i];
      const float against = scale.mean.empty() ? kNearEvidence * near
                                               : kPatchEvidence * float(scale.members) * scale.mean[i] +
                                                     kNearEvidence * std::max(0.0F, near - kTolerated);
      gain[i] = scale.prediction.covered[i] != 0 ? -against : std::numeric_limits<float>::quiet_NaN();
    });
    mixture.add(std::move(scale.prediction.height), std::move(scale.prediction.own), std::move(gain),
                context);
    scale = {};
  }
  mixture.average(height, own, context);
}

/// Root mean square error of the smoothed heights (automatic.h, step 5).
double noise_left(const HeightField& field, const std::vector<float>& height, const std::vector<float>& own,
                  const rfs_mesh::NoiseField& noise, const Context& context) {
  // The points that count, their variance, and their risk.
  const Eigen::Vector3d sums = sum_over(context, field.size(), Eigen::Vector3d(0, 0, 0), [&](std::size_t i) {
    const double e = field.height(i) - double(height[i]), share = double(own[i]),
                 square = noise.local[i] * noise.local[i];
    if (!(std::abs(e) <= kStrayFrom * std::max(noise.sigma, noise.local[i]))) return Eigen::Vector3d(0, 0, 0);
    return Eigen::Vector3d(1, share * square, e * e + (2 * share - 1) * square);
  });
  return sums[0] > 0 ? std::sqrt(std::max({0.0, sums[1], sums[2]}) / sums[0]) : noise.sigma;
}

}  // namespace

Positions automatic_smoothing(Mesh& mesh, bool keep_rings, const rfs_mesh::NoiseField& noise, double spacing,
                              AutomaticReport& report, rfs_mesh::NeighborTable& near,
                              const Context& context) {
  near = {};
  const std::size_t n = mesh.positions.size();
  const double sigma = noise.sigma;
  report = {};
  report.left = sigma;
  if (n < kTooFew || !(sigma > kNoNoise * spacing)) return mesh.positions;
  const double share = sigma / spacing;
  report.guide_strength = kGuide * share * share * std::max(1.0, share * share);
  Positions guide = fair(mesh, report.guide_strength, context);
  context.report("smooth", 0.1);
  Landed landed = land_stranded(mesh, kStrayFrom * sigma, guide, context);
  report.stranded = landed.stranded;
  if (!keep_rings) mesh.one_ring = {};
  HeightField field(std::move(guide), std::move(landed.tree), std::move(landed.near), mesh.positions,
                    context);

  std::vector<float> risk(n, 1);  // of the data themselves: no error, all their own
  std::vector<Scale> scales;
  std::optional<Patches::Memory> memory(std::in_place);
  std::vector<Index> seeds;  // empty: all
  const double narrowest = std::max(kFewest, kNarrowest * share * share);
  const double widest = std::max(kWidest, kWidestShare * narrowest);
  for (double m = narrowest; m <= widest; m *= 2) {
    context.report("smooth", 0.1 + 0.9 * std::log(m / narrowest) / std::log(2 * widest / narrowest));
    const std::size_t members = std::min(std::size_t(m), n / 2);
    if (seeds.empty()) seeds = thin_all(field.index(), field.neighbors(), context);
    while (seeds.size() * members > kMostOverlap * n)
      seeds = seeds.size() > n / kDense ? thin_dense(field.index(), field.neighbors(), seeds, context)
                                        : thin(field.guide(), seeds, context);
    scales.push_back(try_scale(field, members, seeds, noise.local, risk, *memory, context));
    if (m >= double(n) / 2) break;
  }

  const Scale& seeing = scales[std::min(kSeeing, scales.size() - 1)];
  const std::size_t members_seeing = seeing.members;
  const std::vector<Index> several = seeing.several;
  std::vector<float> height, own;
  std::vector<float>().swap(risk);
  memory.reset();
  mix(field, std::move(scales), height, own, context);
  split_hidden_sheets(field, sigma, height, own, context);

  Positions smooth = mesh.positions;
  for_each_index(context, n, [&](std::size_t i) {
    const Eigen::Vector3d move = field.guide()[i] + double(height[i]) * field.normal(i) - mesh.positions[i];
    if (move.allFinite() && move.norm() <= kStrayFrom * std::max(sigma, noise.local[i])) smooth[i] += move;
  });
  part_thin_walls(field, mesh.positions, several, members_seeing, noise, smooth, context);
  report.left = noise_left(field, height, own, noise, context);
  near = field.release_neighbors();
  return smooth;
}

}  // namespace rfsmooth::smoothing
