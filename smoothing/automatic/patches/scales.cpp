#include "smoothing/automatic/patches/scales.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/search/thinning.h"
#include "smoothing/automatic/patches/mixture.h"
#include "smoothing/automatic/patches/patches.h"

namespace rfsmooth::smoothing {

namespace {

using rfs_mesh::kNarrowestPatch;

// Chosen on the development shapes (tests/bench/quality) at 10,000 and 50,000 points, noise of 1 to 3 %.
constexpr std::size_t kMostOverlap = 14;  // patches over a point; a thinning leaves 0.4 of them
constexpr double kNarrowest = 52.6;  // m_0 = kNarrowest (sigma/h)^2 if that is more: a radius of 4.5 sigma
constexpr double kWidest = 1600;     // the widest patches of points' own noise; those for walls may be wider
constexpr int kSeeing = 2;           // index of the scale that looks for walls: of 4 m_0 points, 9 sigma

// A subset with a point in so many has a ring of its own among the nearest of every point.
constexpr std::size_t kDense = HeightField::kNear / rfs_mesh::kRing;
constexpr std::size_t kOwnMean = 60;  // from this many members on, patches average; below, near neighbours do
constexpr float kNearEvidence = 10;   // nats per sigma^2 of a near mean
constexpr float kPatchEvidence = 0.25F;  // the same of a patch mean, per member (Leung and Barron's 1/4)
constexpr float kTolerated = 0.15F;      // sigma^2: what a near mean scatters by without meaning anything
constexpr float kFarthest = 1e12F;       // sigma: most that an error counts as, for finite sums of squares

std::vector<float> heights(const HeightField& field, const Context& context) {
  std::vector<float> all(field.size());
  for_each_index(context, field.size(), [&](std::size_t i) { all[i] = field.local()[i].height; });
  return all;
}

/// (sigma / sigma_i)^2, 0 of points that stay; empty if it is the same everywhere and none stays.
std::vector<float> precisions(const rfs_mesh::NoiseField& noise, const Context& context) {
  const std::vector<double>& local = noise.local;
  const double first = local.front();
  if (!rfs_mesh::stays(first, noise.sigma) &&
      std::all_of(local.begin(), local.end(), [&](double s) { return s == first; }))
    return {};
  std::vector<float> precision(local.size());
  for_each_index(context, local.size(), [&](std::size_t i) {
    const double share = noise.sigma / local[i];
    precision[i] = rfs_mesh::stays(local[i], noise.sigma) ? 0 : float(share * share);
  });
  return precision;
}

/// Makes means of risks, each in the variance of its own point, means with weights 1 / sigma^2 in the
/// variance of the point that they are for. `around`: the same means of the precisions.
void in_own_units(const std::vector<float>& precision, const std::vector<float>& around,
                  std::vector<float>& mean, const Context& context) {
  for_each_index(context, mean.size(),
                 [&](std::size_t i) { mean[i] *= around[i] > 0 ? precision[i] / around[i] : 0; });
}

/// What the patches of one scale say.
struct Scale {
  std::size_t members;
  Prediction prediction;       ///< its `own` of all who share the noise (own_of_all)
  std::vector<float> worse;    ///< n: the risk's difference to the scale before
  std::vector<float> mean;     ///< n: of that, as the patches see it; empty if they are narrow
  std::vector<Index> several;  ///< places that see more than one sheet
};

/// Means over near neighbours for all scales, each in place of `worse`.
void average_near(const HeightField& field, std::vector<Scale>& scales, const Context& context) {
  constexpr std::size_t kColumns = 4;  // with 8 they would be read half as often, but take the most memory
  using Columns = HeightField::Columns<int(kColumns)>;
  for (std::size_t first = 0; first < scales.size(); first += kColumns) {
    const std::size_t count = std::min(kColumns, scales.size() - first);
    std::vector<Columns> near(field.size(), Columns::Zero());
    for (std::size_t s = 0; s < count; ++s) {
      std::vector<float>& worse = scales[first + s].worse;
      for_each_index(context, field.size(), [&](std::size_t i) { near[i][Eigen::Index(s)] = worse[i]; });
      std::vector<float>().swap(worse);
    }
    for (int twice = 0; twice < 2; ++twice) near = field.local_mean(near, context);
    for (std::size_t s = 0; s < count; ++s) {
      std::vector<float>& worse = scales[first + s].worse;
      worse.resize(field.size());
      for_each_index(context, field.size(), [&](std::size_t i) { worse[i] = near[i][Eigen::Index(s)]; });
    }
  }
}

/// Tells the learned step of one of `count` scales.
void tell(const HeightField& field, const Scale& scale, std::size_t which, std::size_t count,
          const rfs_mesh::NoiseField& noise, std::vector<ScalesSay>& told, const Context& context) {
  for (std::size_t t = 0; t < kTold; ++t) {
    if (told_scale(t, count) != which) continue;
    for_each_index(context, told.size(), [&](std::size_t i) {
      const Prediction& said = scale.prediction;
      const float near = scale.worse[i], wide = scale.mean.empty() ? near : scale.mean[i];
      if (said.covered[i] != 0)
        told[i][t] = {Eigen::half((said.height[i] - field.local()[i].height) / learned_unit(noise, i)),
                      Eigen::half(said.own[i]), Eigen::half(near), Eigen::half(wide)};
      else
        told[i][t] = {Eigen::half(std::numeric_limits<float>::quiet_NaN()), Eigen::half(1.0F),
                      Eigen::half(near), Eigen::half(wide)};
    });
  }
}

/// All scales of a field, and what they are mixed with.
struct Rungs {
  std::vector<float> precision;  ///< of precisions()
  std::vector<float> first;      ///< n: the heights that stand for the data; none: the data
  std::vector<Scale> scales;
};

/// Climbs the ladder of scales.
class Ladder {
 public:
  /// `whole`: how the scales of the whole cloud are made; what is not there is entered.
  Ladder(const HeightField& field, const rfs_mesh::NoiseField& noise, Statistics::Pass& whole,
         const Context& context)
      : field_(field),
        noise_(noise),
        whole_(whole),
        context_(context),
        rungs_{precisions(noise, context), {}, {}},
        risk_(field.size(), 1) {}  // of the data themselves: no error, all their own

  /// Once.
  Rungs climb() {
    const double share = noise_.sigma / noise_.spacing, as_one = points_as_one(noise_);
    const double narrowest = std::max(double(kNarrowestPatch) * as_one, kNarrowest * share * share);
    // Variance, as k / m, and what shape adds, as m^3, balance at m as k^(1/4).
    const double widest =
        std::max(kWidest * std::sqrt(std::sqrt(noise_.shared)), std::ldexp(narrowest, kSeeing));
    if (as_one > 1) stand_in();
    std::vector<Statistics::Scale>& how = whole_.scales;
    const bool known = !how.empty();
    const double count = known ? double(how.size()) : 1 + std::log2(widest / narrowest);
    double m = narrowest;
    for (std::size_t s = 0; known ? s < how.size() : m <= widest; ++s, m *= 2) {
      context_.report("smooth", 0.1 + 0.9 * double(s) / count);
      if (!known) how.push_back(scale_of(m));
      rungs_.scales.push_back(try_scale(make_way(how[s])));
      if (!known && m >= double(field_.size()) / 2) break;
    }
    return std::move(rungs_);
  }

 private:
  /// Before any scale: the narrowest patches stand for the data, where they say something.
  void stand_in() {
    if (!whole_.narrow) whole_.narrow = scale_of(double(kNarrowestPatch));
    const std::size_t members = make_way(*whole_.narrow);
    const Prediction said =
        Patches(field_, members, seeds_, noise_.local, memory_, context_).take_prediction();
    rungs_.first = heights(field_, context_);
    for_each_index(context_, rungs_.first.size(), [&](std::size_t i) {
      if (said.covered[i] != 0) rungs_.first[i] = said.height[i];
    });
  }

  /// What patches of so many members around the seeds say. Renews the risk.
  Scale try_scale(std::size_t members) {
    const std::vector<double>& sigma = noise_.local;
    const std::vector<float>& precision = rungs_.precision;
    Patches patches(field_, members, seeds_, sigma, memory_, context_);
    Scale scale{members,
                patches.take_prediction(),
                std::vector<float>(field_.size()),
                {},
                patches.with_several_sheets()};
    Prediction& prediction = scale.prediction;
    for_each_index(context_, field_.size(), [&](std::size_t i) {
      float& own = prediction.own[i];
      own = own_of_all(own, float(noise_.as_one_near(i)));
      const float off = (field_.local()[i].height - prediction.height[i]) / float(sigma[i]),
                  e = std::clamp(off, -kFarthest, kFarthest);
      const float risk = prediction.covered[i] != 0 ? e * e + 2 * own - 1 : risk_[i];
      scale.worse[i] = precision.empty() || precision[i] > 0 ? risk - risk_[i] : 0;
      risk_[i] = risk;
    });
    if (averages(members)) {
      scale.mean = scale.worse;
      std::vector<float> around = precision;
      for (int twice = 0; twice < 2; ++twice)
        if (precision.empty())
          patches.average<1>({&scale.mean}, context_);
        else
          patches.average<2>({&scale.mean, &around}, context_);
      if (!precision.empty()) in_own_units(precision, around, scale.mean, context_);
    }
    return scale;
  }

  /// Whether a patch of so many averages the risk, of which `as_one` members are one that errs by itself; but
  /// near neighbours are about kOwnMean, and of fewer such than a ring no mean is taken.
  bool averages(std::size_t members) const {
    const double fewest = double(kOwnMean), as_one = points_as_one(noise_);
    const bool near_tells = fewest >= double(rfs_mesh::kRing) * as_one;
    return double(members) >= (near_tells ? fewest * as_one : fewest);
  }

  /// How patches of about m points are made here: seeds thinned until at most kMostOverlap lie over a point.
  Statistics::Scale scale_of(double m) {
    // Compared as a real number, for m may be larger than any integer.
    const std::size_t n = field_.size(), members = m < double(n) / 2 ? std::size_t(m) : n / 2;
    thin_to(1);
    while (seeds_.size() * members > kMostOverlap * n) thin_to(thinnings_ + 1);
    return {members, thinnings_};
  }

  /// Thins the seeds for a scale; returns its number of points.
  std::size_t make_way(const Statistics::Scale& how) {
    thin_to(how.thinnings);
    return std::min(how.members, field_.size());
  }

  void thin_to(std::size_t thinnings) {
    const NearRows& near = field_.neighbors();
    for (; thinnings_ < thinnings; ++thinnings_)
      if (thinnings_ == 0)
        seeds_ = rfs_mesh::thin_all(field_.guide(), near.first(rfs_mesh::kThinNear, context_), context_);
      else if (seeds_.size() > field_.size() / kDense)
        seeds_ = rfs_mesh::thin_dense(
            field_.index(), near.width(), [&](Index i, Index* row) { near.copy(i, row); }, seeds_, context_);
      else
        seeds_ = rfs_mesh::thin(field_.guide(), seeds_, context_);
  }

  const HeightField& field_;
  const rfs_mesh::NoiseField& noise_;
  Statistics::Pass& whole_;
  const Context& context_;
  Rungs rungs_;
  std::vector<float> risk_;  ///< n: of the last scale
  PatchMembers memory_;
  std::vector<Index> seeds_;
  std::size_t thinnings_ = 0;  ///< of the seeds; 0: there are none yet
};

/// Enters the mixture of all scales by their evidence, and of the data or what stands for them. \param
/// learned whether the learned step will be told. \param shares of Statistics::Pass.
void mix(const HeightField& field, Rungs rungs, const rfs_mesh::NoiseField& noise, bool learned,
         std::vector<double>& shares, MixedScales& mixed, const Context& context) {
  const std::vector<float>& precision = rungs.precision;
  average_near(field, rungs.scales, context);
  if (!precision.empty()) {
    const std::vector<float> around = field.local_mean(field.local_mean(precision, context), context);
    for (Scale& scale : rungs.scales) in_own_units(precision, around, scale.worse, context);
  }
  if (learned) mixed.told.resize(field.size());
  Mixture mixture(rungs.first.empty() ? heights(field, context) : std::move(rungs.first));
  for (std::size_t s = 0; s < rungs.scales.size(); ++s) {
    Scale& scale = rungs.scales[s];
    if (learned) tell(field, scale, s, rungs.scales.size(), noise, mixed.told, context);
    // A wide patch is judged over its own width, but must not be far off anywhere near the point either:
    // the few points that it misses by sigmas would be outvoted.
    std::vector<float>& gain = scale.worse;
    for_each_index(context, field.size(), [&](std::size_t i) {
      const float near = gain[i];
      const float against = scale.mean.empty() ? kNearEvidence * near
                                               : kPatchEvidence * float(scale.members) * scale.mean[i] +
                                                     kNearEvidence * std::max(0.0F, near - kTolerated);
      gain[i] = scale.prediction.covered[i] != 0 ? -against / float(noise.as_one_near(i))
                                                 : std::numeric_limits<float>::quiet_NaN();
    });
    mixture.add(std::move(scale.prediction.height), std::move(scale.prediction.own), std::move(gain),
                context);
    scale = {};
  }
  std::vector<float> say(field.size(), 1);
  // A point counts by its variance, up to that of the figure: it has that much to lose.
  for_each_index(context, precision.size(),
                 [&](std::size_t i) { say[i] = precision[i] > 0 ? std::min(1.0F, 1 / precision[i]) : 0; });
  mixed.left = mixture.average(mixed.height, mixed.own, shares, say, noise.local, context);
}

}  // namespace

MixedScales smooth_heights(HeightField& field, const rfs_mesh::NoiseField& noise, bool learned,
                           Statistics::Pass& whole, const Context& context) {
  Rungs rungs = Ladder(field, noise, whole, context).climb();
  field.ready_for_means(context);
  MixedScales mixed;
  const std::vector<Scale>& scales = rungs.scales;
  const Scale& seeing = scales[std::min(std::size_t(kSeeing), scales.size() - 1)];
  mixed.members_seeing = seeing.members;
  mixed.several = seeing.several;
  // The narrowest that tails do not draw towards themselves: not the first, and of many points.
  const auto of_many = [](const Scale& scale) { return scale.members >= kOwnMean; };
  const auto wide = std::find_if(std::next(scales.begin()), scales.end(), of_many);
  mixed.wide = (wide != scales.end() ? *wide : scales.back()).prediction.height;
  mix(field, std::move(rungs), noise, learned, whole.shares, mixed, context);
  return mixed;
}

}  // namespace rfsmooth::smoothing
