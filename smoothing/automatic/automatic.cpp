#include "smoothing/automatic/automatic.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/depth_steps.h"
#include "rfs_mesh/search/thinning.h"
#include "smoothing/automatic/hidden_sheets.h"
#include "smoothing/automatic/learned/last_step.h"
#include "smoothing/automatic/mixture.h"
#include "smoothing/automatic/patches/height_field.h"
#include "smoothing/automatic/patches/patches.h"
#include "smoothing/automatic/patches/tails.h"
#include "smoothing/automatic/stranded.h"
#include "smoothing/automatic/thin_walls.h"
#include "smoothing/integrators/solver.h"

namespace rfsmooth::smoothing {

namespace {

using rfs_mesh::kNarrowestPatch;
using rfs_mesh::kStray;

// Chosen on the development shapes (tests/bench/quality) at 10,000 and 50,000 points, noise of 1 to 3 %.
constexpr std::size_t kMostOverlap = 14;  // patches over a point; a thinning leaves 0.4 of them
constexpr double kGuide = 10;             // c = kGuide (sigma/h)^2, to the fourth power above h
constexpr double kNarrowest = 52.6;  // m_0 = kNarrowest (sigma/h)^2 if that is more: a radius of 4.5 sigma
constexpr double kWidest = 1600;     // the widest patches, unless those that look for walls are wider
constexpr double kCalm = 0.1;        // of the figure: so much calmer places have no part in the tails
constexpr int kSeeing = 2;           // the scale that looks for walls, of 9 sigma: from 0

constexpr std::size_t kDense = 4;     // a subset with a point in so many has its own among the nearest
constexpr std::size_t kOwnMean = 60;  // from this many members on, patches average; below, near neighbours do
constexpr float kNearEvidence = 10;   // nats per sigma^2 of a near mean
constexpr float kPatchEvidence = 0.25F;  // the same of a patch mean, per member (Leung and Barron's 1/4)
constexpr float kTolerated = 0.15F;      // sigma^2: what a near mean scatters by without meaning anything

Positions fair(const Mesh& mesh, double strength, std::vector<double>& reductions, const Context& context) {
  const Operator op = umbrella(mesh, context);
  SolverOptions options;
  options.tolerance = 1e-4;
  options.reductions = reductions;
  Positions x;
  reductions = solve({mesh.one_ring, op, {0, strength, 0, 0}, {}, {}}, mesh.positions, x, AllowedMoves(),
                     options, context)
                   .reductions;
  return x;
}

std::vector<float> heights(const HeightField& field, const Context& context) {
  std::vector<float> all(field.size());
  for_each_index(context, field.size(), [&](std::size_t i) { all[i] = field.local()[i].height; });
  return all;
}

/// The share of a point's noise that stays in a prediction which has the share `own` of its height: that of
/// all who share the noise (automatic.h).
float own_of_all(float own, float shared) {
  return own * shared / (1 + own * (shared - 1));
}

/// (sigma / sigma_i)^2, 0 of points that stay; empty if the noise is the same everywhere.
std::vector<float> precisions(const rfs_mesh::NoiseField& noise, const Context& context) {
  const std::vector<double>& local = noise.local;
  if (std::all_of(local.begin(), local.end(), [&](double s) { return s == local.front(); })) return {};
  std::vector<float> precision(local.size());
  for_each_index(context, local.size(), [&](std::size_t i) {
    const double share = noise.sigma / local[i];
    precision[i] = rfs_mesh::stays(local[i], noise.sigma) ? 0 : float(share * share);
  });
  return precision;
}

/// From means of risks in units of each point's own noise those of each point: what neighbours tell of the
/// error counts by how well they know it. `around`: the same means of the precisions.
void in_own_units(const std::vector<float>& precision, const std::vector<float>& around,
                  std::vector<float>& mean, const Context& context) {
  for_each_index(context, mean.size(),
                 [&](std::size_t i) { mean[i] *= around[i] > 0 ? precision[i] / around[i] : 0; });
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
                const rfs_mesh::NoiseField& noise, const std::vector<float>& precision,
                std::vector<float>& before, Patches::Memory& memory, const Context& context) {
  const std::vector<double>& sigma = noise.local;
  const auto shared = float(noise.shared);
  const Patches patches(field, members, seeds, sigma, memory, context);
  Scale scale{
      members, patches.predict(context), std::vector<float>(field.size()), {}, patches.with_several_sheets()};
  const Prediction& prediction = scale.prediction;
  for_each_index(context, field.size(), [&](std::size_t i) {
    const float e = (field.local()[i].height - prediction.height[i]) / float(sigma[i]);
    const float of_all = own_of_all(prediction.own[i], shared);
    const float risk = prediction.covered[i] != 0 ? e * e + 2 * of_all - 1 : before[i];
    scale.worse[i] = precision.empty() || precision[i] > 0 ? risk - before[i] : 0;
    before[i] = risk;
  });
  if (double(members) >= double(kOwnMean) * noise.shared) {
    scale.mean = patches.mean(patches.mean(scale.worse, context), context);
    if (!precision.empty()) {
      const std::vector<float> around = patches.mean(patches.mean(precision, context), context);
      in_own_units(precision, around, scale.mean, context);
    }
  }
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

/// What the learned step is told of the scales.
std::vector<ScalesSay> tell(const std::vector<Scale>& scales, std::size_t n, const Context& context) {
  std::vector<ScalesSay> told(n);
  for (std::size_t t = 0; t < kTold; ++t) {
    const Scale& scale = scales[told_scale(t, scales.size())];
    for_each_index(context, n, [&](std::size_t i) {
      const bool covered = scale.prediction.covered[i] != 0;
      const float near = scale.worse[i];
      told[i][t] = {covered ? scale.prediction.height[i] : std::numeric_limits<float>::quiet_NaN(),
                    covered ? scale.prediction.own[i] : 1, near, scale.mean.empty() ? near : scale.mean[i]};
    });
  }
  return told;
}

/// The mixture of all scales by their evidence, and of `first`, the data or what stands for them. `told`: for
/// the learned step; null: not taken.
void mix(const HeightField& field, std::vector<float> first, std::vector<Scale> scales, double shared,
         const std::vector<float>& precision, std::vector<float>& height, std::vector<float>& own,
         std::vector<ScalesSay>* told, std::vector<double>& shares, const Context& context) {
  const auto alone = float(1 / shared);
  Mixture mixture(std::move(first));
  average_near(field, scales, context);
  if (!precision.empty()) {
    const std::vector<float> around = field.local_mean(field.local_mean(precision, context), context);
    for (Scale& scale : scales) in_own_units(precision, around, scale.worse, context);
  }
  if (told != nullptr) *told = tell(scales, field.size(), context);
  for (Scale& scale : scales) {
    // A wide patch is judged over its own width, but must not be far off anywhere near the point either: the
    // few points that it misses by sigmas would be outvoted.
    std::vector<float>& gain = scale.worse;
    for_each_index(context, field.size(), [&](std::size_t i) {
      const float near = gain[i];
      const float against = scale.mean.empty() ? kNearEvidence * near
                                               : kPatchEvidence * float(scale.members) * scale.mean[i] +
                                                     kNearEvidence * std::max(0.0F, near - kTolerated);
      gain[i] = scale.prediction.covered[i] != 0 ? -alone * against : std::numeric_limits<float>::quiet_NaN();
    });
    mixture.add(std::move(scale.prediction.height), std::move(scale.prediction.own), std::move(gain),
                context);
    scale = {};
  }
  std::vector<float> say(field.size(), 1);
  // A point counts by its variance: it has that much to lose.
  for_each_index(context, precision.size(),
                 [&](std::size_t i) { say[i] = precision[i] > 0 ? std::min(1.0F, 1 / precision[i]) : 0; });
  mixture.average(height, own, shares, say, context);
}

/// The variance that the residuals tell, over that which was measured: the median over places of
/// sum e^2 / sigma^2 over sum (1 - own) around each. Half of the cloud is smooth enough for its patches.
double told_by_residuals(const HeightField& field, const std::vector<float>& height,
                         const std::vector<float>& own, const rfs_mesh::NoiseField& noise,
                         const Context& context) {
  constexpr double kSmoothed = 0.5;  // mean of 1 - own: elsewhere the data stayed, and tell nothing
  constexpr double kMostSquare = kStray * kStray;
  const std::size_t n = field.size(), places = std::min(n, rfs_mesh::kSampleOfCloud);
  std::vector<double> told(places, -1);
  for_each_index(context, places, [&](std::size_t place) {
    const std::size_t at = place * n / places;
    Eigen::Vector4d sums = Eigen::Vector4d::Zero();  // of weights, their squares, e^2 / sigma^2, 1 - own
    const auto add = [&](std::size_t i, double weight) {
      const double e = (field.height(i) - double(height[i])) / noise.local[i];
      sums += weight * Eigen::Vector4d(1, weight, std::min(e * e, kMostSquare),
                                       1 - double(own_of_all(own[i], float(noise.shared))));
    };
    add(at, 1);
    for (const Index j : field.neighbors()[at])
      add(j, double(same_sheet(field.local()[at].normal.dot(field.local()[j].normal))));
    if (!(sums[3] > kSmoothed * sums[0])) return;
    // The median of chi-square over its degrees of freedom, by Wilson and Hilferty 1931.
    const double freedom = sums[0] * sums[0] / sums[1];
    told[place] = sums[2] / sums[3] / std::pow(1 - 2 / (9 * freedom), 3);
  });
  told.erase(std::remove(told.begin(), told.end(), -1.0), told.end());
  if (told.empty()) return 1;
  const auto middle = told.begin() + std::ptrdiff_t(told.size() / 2);
  std::nth_element(told.begin(), middle, told.end());
  return *middle;
}

/// Root mean square error of the smoothed heights (automatic.h, step 5).
double noise_left(const HeightField& field, const std::vector<float>& height, const std::vector<float>& own,
                  const rfs_mesh::NoiseField& noise, const Context& context) {
  const double told = told_by_residuals(field, height, own, noise, context);
  // The points that count, their variance, their risk, and their noise.
  const Eigen::Vector4d sums =
      sum_over(context, field.size(), Eigen::Vector4d(0, 0, 0, 0), [&](std::size_t i) {
        const double e = field.height(i) - double(height[i]),
                     share = double(own_of_all(own[i], float(noise.shared))),
                     measured = noise.local[i] * noise.local[i], square = told * measured;
        if (!(std::abs(e) <= kStray * std::max(noise.sigma, noise.local[i])))
          return Eigen::Vector4d(0, 0, 0, 0);
        return Eigen::Vector4d(1, share * square, e * e + (2 * share - 1) * square, measured);
      });
  if (!(sums[0] > 0)) return noise.sigma;
  return std::sqrt(std::min(std::max({0.0, sums[1], sums[2]}), sums[3]) / sums[0]);
}

/// The guide of mesh.positions and the heights over it.
std::unique_ptr<HeightField> raise_field(const Mesh& mesh, double sigma, AutomaticReport& report,
                                         Statistics::Pass& whole, const Context& context) {
  Positions guide = fair(mesh, report.guide_strength, whole.reductions, context);
  Landed landed = land_stranded(mesh, kStray * sigma, guide, context);
  report.stranded = landed.stranded;
  return std::make_unique<HeightField>(std::move(guide), std::move(landed.tree), std::move(landed.near),
                                       mesh.positions, context);
}

/// The ladder of scales.
class Ladder {
 public:
  Ladder(const HeightField& field, const rfs_mesh::NoiseField& noise, const std::vector<float>& precision)
      : field_(field), noise_(noise), precision_(precision) {
    risk_.assign(field.size(), 1);  // of the data themselves: no error, all their own
  }

  /// How patches of about m points are made here: with seeds thinned as far as these allow.
  Statistics::Scale scale_of(double m, const Context& context) {
    const std::size_t n = field_.size(), members = std::min(std::size_t(m), n / 2);
    thin_to(1, context);
    while (seeds_.size() * members > kMostOverlap * n) thin_to(thinnings_ + 1, context);
    return {members, thinnings_};
  }

  void add(const Statistics::Scale& how, const Context& context) {
    const std::size_t members = make_way(how, context);
    scales.push_back(try_scale(field_, members, seeds_, noise_, precision_, risk_, memory_, context));
  }

  /// The heights as the narrowest patches see them; the data where there are none. Before any scale.
  std::vector<float> narrow(const Statistics::Scale& how, const Context& context) {
    std::vector<float> smooth = heights(field_, context);
    const std::size_t members = make_way(how, context);
    const Prediction said = Patches(field_, members, seeds_, noise_.local, memory_, context).predict(context);
    for_each_index(context, smooth.size(), [&](std::size_t i) {
      if (said.covered[i] != 0) smooth[i] = said.height[i];
    });
    return smooth;
  }

  std::vector<Scale> scales;

 private:
  /// Thins the seeds for a scale; returns its number of points.
  std::size_t make_way(const Statistics::Scale& how, const Context& context) {
    thin_to(how.thinnings, context);
    return std::min(how.members, field_.size());
  }

  void thin_to(std::size_t thinnings, const Context& context) {
    for (; thinnings_ < thinnings; ++thinnings_)
      if (thinnings_ == 0)
        seeds_ = rfs_mesh::thin_all(field_.guide(), field_.neighbors(), context);
      else if (seeds_.size() > field_.size() / kDense)
        seeds_ = rfs_mesh::thin_dense(field_.index(), field_.neighbors(), seeds_, context);
      else
        seeds_ = rfs_mesh::thin(field_.guide(), seeds_, context);
  }

  const HeightField& field_;
  const rfs_mesh::NoiseField& noise_;
  const std::vector<float>& precision_;
  std::vector<float> risk_;
  Patches::Memory memory_;
  std::vector<Index> seeds_;
  std::size_t thinnings_ = 0;  ///< 0: the seeds are all points
};

/// What a pass over the scales gives.
struct Pass {
  std::vector<float> height, own;  ///< n: of the mixture, as in Prediction
  std::vector<float> wide;         ///< n: of the scale that looks for tails
  std::vector<ScalesSay> told;     ///< n, or empty without the learned step
  std::vector<Index> several;      ///< places where the scale that looks for walls sees several sheets
  std::size_t members_seeing = 0;  ///< of that scale
};

/// All scales of a field, and in `first` the heights that stand for the data. `whole`: how those of the whole
/// cloud are made; what is not there is entered.
std::vector<Scale> try_scales(const HeightField& field, const rfs_mesh::NoiseField& noise,
                              const std::vector<float>& precision, double spacing, Statistics::Pass& whole,
                              std::vector<float>& first, const Context& context) {
  Ladder ladder(field, noise, precision);
  const double share = noise.sigma / spacing;
  const double narrowest = std::max(double(kNarrowestPatch) * noise.shared, kNarrowest * share * share);
  const double widest = std::max(kWidest, std::ldexp(narrowest, kSeeing));
  if (noise.shared > 1 && !whole.narrow) whole.narrow = ladder.scale_of(double(kNarrowestPatch), context);
  first = whole.narrow ? ladder.narrow(*whole.narrow, context) : heights(field, context);
  const bool known = !whole.scales.empty();
  double m = narrowest;
  for (std::size_t s = 0; known ? s < whole.scales.size() : m <= widest; ++s, m *= 2) {
    context.report("smooth", 0.1 + 0.9 * std::log(m / narrowest) / std::log(2 * widest / narrowest));
    if (!known) whole.scales.push_back(ladder.scale_of(m, context));
    ladder.add(whole.scales[s], context);
    if (!known && m >= double(field.size()) / 2) break;
  }
  return std::move(ladder.scales);
}

Pass smooth_heights(const HeightField& field, const rfs_mesh::NoiseField& noise, double spacing, bool learned,
                    Statistics::Pass& whole, const Context& context) {
  std::vector<float> first;
  const std::vector<float> precision = precisions(noise, context);
  std::vector<Scale> scales = try_scales(field, noise, precision, spacing, whole, first, context);
  Pass pass;
  const Scale& seeing = scales[std::min(std::size_t(kSeeing), scales.size() - 1)];
  pass.members_seeing = seeing.members;
  pass.several = seeing.several;
  for (const Scale& scale : scales) {
    pass.wide = scale.prediction.height;
    if (scale.members >= kOwnMean && &scale != &scales.front()) break;
  }
  mix(field, std::move(first), std::move(scales), noise.shared, precision, pass.height, pass.own,
      learned ? &pass.told : nullptr, whole.shares, context);
  return pass;
}

constexpr float kMostOfOne = 2;  // sigma: what one neighbour's distance counts as in a mean over them

/// How far each point lies off a patch that is wide enough not to follow it, beyond what its neighbours do,
/// too: they all lie off it beside an edge.
std::vector<float> off_neighbours(const HeightField& field, const Pass& pass,
                                  const rfs_mesh::NoiseField& noise, const Context& context) {
  std::vector<float> off(field.size()), at_most(field.size());
  for_each_index(context, off.size(), [&](std::size_t i) {
    off[i] = field.local()[i].height - pass.wide[i];
    const float most = kMostOfOne * float(noise.local[i]);
    at_most[i] = std::clamp(off[i], -most, most);
  });
  at_most = field.local_mean(at_most, context);
  for_each_index(context, off.size(), [&](std::size_t i) { off[i] -= at_most[i]; });
  return off;
}

/// How many times more of the neighbours of points that lie far off do so, too, than of all points. 1 for
/// tails, which are each point's own; beside shape, and where the noise is louder than was measured, far
/// points stand together.
double far_together(const HeightField& field, const std::vector<float>& off, const Context& context) {
  const auto far = [&](std::size_t i) {  // not if unknown
    return double(std::abs(off[i])) > rfs_mesh::kScatterWindow;
  };
  // Points, far ones, their neighbours, and far ones of these.
  const Eigen::Vector4d sums =
      sum_over(context, field.size(), Eigen::Vector4d(0, 0, 0, 0), [&](std::size_t i) {
        Eigen::Vector4d one(1, 0, 0, 0);
        if (!far(i)) return one;
        one[1] = 1;
        for (const Index j : field.neighbors()[i]) one += Eigen::Vector4d(0, 0, 1, far(j) ? 1 : 0);
        return one;
      });
  return sums[2] > 0 ? sums[3] * sums[0] / (sums[1] * sums[2]) : 0;
}

/// Divides by what the neighbours' tell where they are farther off, too, than the noise has it.
void relate_to_neighbours(const HeightField& field, std::vector<float>& relative, std::vector<float>& least,
                          const Context& context) {
  constexpr float kMeanOfNormal = 0.766F;  // the mean of min(|x|, kMostOfOne), x normal
  std::vector<float> typical(field.size());
  for_each_index(context, typical.size(), [&](std::size_t i) {
    typical[i] = std::isnan(relative[i]) ? kMeanOfNormal : std::min(kMostOfOne, std::abs(relative[i]));
  });
  typical = field.local_mean(typical, context);
  for_each_index(context, typical.size(), [&](std::size_t i) {
    const float times = std::max(1.0F, typical[i] / kMeanOfNormal);
    relative[i] /= times;
    least[i] /= times;
  });
}

/// Points of the tails that a first smoothing left beside the surface, since their neighbours are each other,
/// are seen from the surface instead.
void land_hovering(const HeightField& field, const Pass& pass, const Mesh& mesh, const Tails& tails,
                   const rfs_mesh::NoiseField& noise, Positions& data, const Context& context) {
  Positions smooth(field.size());
  for_each_index(context, smooth.size(), [&](std::size_t i) {
    smooth[i] = field.guide()[i] + double(pass.height[i]) * field.normal(i);
  });
  Positions landed = smooth;
  land_stranded_only(mesh, kStray * tails.times * noise.sigma, landed, context);
  for_each_index(context, smooth.size(), [&](std::size_t i) {
    if (landed[i] == smooth[i] || noise.local[i] < kCalm * noise.sigma) return;
    const Eigen::Vector3d off = mesh.positions[i] - landed[i];
    data[i] = landed[i] + tails.weight(off.norm() / noise.local[i]) * off;
  });
}

/// Points of the tails go towards the surface that the others show (tails.h), and the noise down to that of
/// the others. Returns the tails.
Tails tame(const HeightField& field, const Pass& pass, const Mesh& mesh, Positions& data,
           rfs_mesh::NoiseField& noise, std::optional<Statistics::Tails>& whole, const Context& context) {
  if (rfs_mesh::rounding_noise(noise.step) > noise.sigma) return {};  // terraces stand out as tails do
  constexpr float kMostItsOwn = 0.8F;
  constexpr double kByChance = 1.6;  // far points together: tails have 0.7 to 1.1 in ten thousand points
  constexpr double kGroups = 5;      // the same: groups of points that share what they are off by
  const std::vector<float> off = off_neighbours(field, pass, noise, context);
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> relative(off.size(), kUnknown), least(off.size(), kUnknown);
  for_each_index(context, off.size(), [&](std::size_t i) {
    if (noise.local[i] < kCalm * noise.sigma) return;
    const auto sigma = float(noise.local[i]);
    const float e = field.local()[i].height - pass.height[i],
                without = e / (1 - std::clamp(pass.own[i], 0.0F, kMostItsOwn));
    relative[i] = off[i] / sigma;
    // Where the mixture had to be narrow, a wide patch says little.
    least[i] = std::min(std::abs(relative[i]), std::abs(without) / sigma);
  });
  const double together = far_together(field, least, context);
  if (noise.shared > 1 && together > kGroups) return {};
  if (together > kByChance) relate_to_neighbours(field, relative, least, context);
  if (!whole) whole = find_tails(relative, least);
  const Tails tails(*whole);
  if (!(tails.share > 0)) return tails;
  for_each_index(context, off.size(), [&](std::size_t i) {
    if (!std::isnan(relative[i]))
      data[i] -= (1 - tails.weight(double(relative[i]))) * double(off[i]) * field.normal(i);
  });
  land_hovering(field, pass, mesh, tails, noise, data, context);
  if (noise.shared > 1) return tails;  // what points share is not of their tails
  noise.sigma *= tails.noise();
  for (double& local : noise.local) local *= tails.noise();
  return tails;
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
  near = {};
  const std::size_t n = mesh.positions.size();
  report = {};
  report.left = noise.sigma;
  if (n < std::size_t(HeightField::kNear) || !(noise.sigma > 0)) return mesh.positions;
  const auto guide_strength = [&] {
    const double share = noise.sigma / spacing;
    return kGuide * share * share * std::max(1.0, share * share) * noise.shared;
  };
  report.guide_strength = guide_strength();
  whole.passes.resize(std::max<std::size_t>(1, whole.passes.size()));
  auto field = raise_field(mesh, noise.sigma, report, whole.passes[0], context);
  context.report("smooth", 0.1);
  Pass pass = smooth_heights(*field, noise, spacing, learned, whole.passes[0], context);
  Positions data = mesh.positions;  // as tamed
  std::vector<double> most = noise.local;
  for (double& limit : most) limit = kStray * std::max(limit, noise.sigma);
  const double measured = noise.sigma;
  const Tails tails = tame(*field, pass, mesh, data, noise, whole.tails, context);
  if (tails.share > 0) {
    report.tail_times = tails.times;
    for (double& limit : most) limit *= tails.times;
    report.guide_strength = guide_strength();
    mesh.positions.swap(data);
    whole.passes.resize(2);
    field = raise_field(mesh, noise.sigma, report, whole.passes[1], context);
    pass = smooth_heights(*field, noise, spacing, learned, whole.passes[1], context);
    mesh.positions.swap(data);
  }
  if (!keep_rings) mesh.one_ring = {};
  const double of_whole = whole.points ? double(*whole.points) / double(n) : 1;
  const std::vector<float> mixed = learned ? pass.height : std::vector<float>();
  const Tails law = noise.shared > 1 ? Tails() : tails;  // as told: else it counts as noise of all
  const HiddenSheets hidden =
      split_hidden_sheets(*field, residuals_of(*field, pass.height, mesh.positions, measured, law, context),
                          pass.height, pass.own, of_whole, whole.sheets, context);
  const auto allowed = [&](std::size_t i, const Eigen::Vector3d& move) {
    return move.allFinite() && move.norm() <= most[i];
  };
  Positions smooth(n);
  for_each_index(context, n, [&](std::size_t i) {
    const Eigen::Vector3d &from = mesh.positions[i],
                          move = field->guide()[i] + double(pass.height[i]) * field->normal(i) - from;
    smooth[i] = allowed(i, move) ? from + move : from;
  });
  part_thin_walls(*field, data, pass.several, pass.members_seeing, noise, smooth, whole.thin_walls, context);
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
