#include "smoothing/automatic/patches/patches.h"

#include <algorithm>
#include <stdexcept>

#include "base/collect.h"
#include "base/parallel.h"
#include "rfs_mesh/search/thinning.h"
#include "smoothing/automatic/patches/fit/patch_fit.h"
#include "smoothing/automatic/rows/weighted_sum.h"

namespace rfsmooth::smoothing {

namespace {

constexpr float kCovered = 0.2F * kMemberUnit;  // least weight of the best patch over a point
// Times the seeds given, for places left uncovered, a bound of the work: with 4, the shape rotor
// (tests/bench/quality) is 3 % worse.
constexpr std::size_t kMostForMissing = 8;
constexpr std::size_t kTogether = 64;   // patches fitted in a row: each tells the next how far to look
constexpr std::size_t kWave = 1 << 18;  // members fitted before they are added up, ...
constexpr std::size_t kLeastWave = 8 * kTogether;  // ... of at least so many patches

}  // namespace

/// Patches that are fitted side by side, patch p of them with its members from p * stride on.
struct Patches::Wave {
  Wave(std::size_t patches, std::size_t members)
      : stride(members),
        point(patches * members),
        weight(point.size()),
        height(point.size()),
        own(point.size()) {}
  std::size_t stride, first = 0;  ///< first: where in seeds_ the seed of its first patch is
  std::vector<std::size_t> kept;  ///< members of each
  std::vector<float> say;         ///< of each, as in PatchFit
  std::vector<char> several;      ///< the same
  RawArray<Index> point;          ///< of the members
  RawArray<MemberWeight> weight;  ///< of the members
  RawArray<float> height, own;    ///< of the members, as in PatchFit
};

struct Patches::Sums {
  explicit Sums(std::size_t n) : height(n, 0), own(n, 0), weights(n, 0), well_inside(n, 0) {}
  std::vector<float> height, own, weights;
  std::vector<char> well_inside;  ///< of any patch
};

Patches::Patches(const HeightField& field, std::size_t members, std::vector<Index> seeds,
                 const std::vector<double>& sigma, PatchMembers& memory, const Context& context)
    : field_(field), members_(std::min(members, field.size())), seeds_(std::move(seeds)), memory_(memory) {
  if (members_ == 0 || seeds_.empty()) throw std::invalid_argument("Patches: no seeds, or no members");
  memory_.clear(field_.size());
  around_.assign(field_.size(), 0);
  Sums sums(field_.size());
  fit(0, sigma, sums, context);
  cover_missing(sigma, sums, context);
  std::sort(several_.begin(), several_.end());
  prediction_ = {std::move(sums.height), std::move(sums.own), std::move(sums.well_inside)};
  for_each_index(context, field_.size(), [&](std::size_t i) {
    prediction_.covered[i] = char(sums.weights[i] > 0);
    if (!(sums.weights[i] > 0)) return;
    prediction_.height[i] /= sums.weights[i];
    prediction_.own[i] /= sums.weights[i];
  });
}

/// A place between sheets or at the end of something thin may be in no patch, or only at the rim of one: such
/// places get patches of their own. Where there are many, some of these patches reach most of the others.
/// Where there is no room for more patches, places stay uncovered.
void Patches::cover_missing(const std::vector<double>& sigma, Sums& sums, const Context& context) {
  const std::size_t given = seeds_.size();
  std::size_t before = field_.size() + 1;  // so many were missing
  for (bool last = false; !last;) {
    const std::size_t room = memory_.most_more() / members_, most = std::min(kMostForMissing * given, room);
    if (room == 0) return;
    const auto missing = rfsmooth::collect<Index>(context, field_.size(), [&](std::size_t i, auto&& emit) {
      if (sums.well_inside[i] == 0) emit(Index(i));
    });
    std::vector<Index> more = rfs_mesh::thin(field_.guide(), missing, context);
    last = more.size() <= most || missing.size() >= before;
    before = missing.size();
    while (!last && more.size() > most) more = rfs_mesh::thin(field_.guide(), more, context);
    if (more.size() > room) more.resize(room);
    const std::size_t first = seeds_.size();
    seeds_.insert(seeds_.end(), more.begin(), more.end());
    fit(first, sigma, sums, context);
  }
}

/// Fits the patches of the seeds from `first` on and adds up what they say.
void Patches::fit(std::size_t first, const std::vector<double>& sigma, Sums& sums, const Context& context) {
  const std::size_t last = seeds_.size(),
                    most = std::max(kWave / members_ / kTogether * kTogether, kLeastWave);
  // At first as much again for the places left uncovered: mostly that is enough, and nothing has to be moved,
  // which takes twice the memory.
  const std::size_t largest = (last - first) * members_;
  memory_.reserve(largest, first == 0 ? largest : 0);
  Wave wave(std::min(most, last - first), members_);
  for (wave.first = first; wave.first < last; wave.first += most) {
    const std::size_t count = std::min(most, last - wave.first);
    wave.kept.resize(count);
    wave.say.resize(count);
    wave.several.resize(count);
    fit_wave(wave, sigma, context);
    memory_.append(wave.kept, wave.stride, wave.point.data(), wave.weight.data(), context);
    for (std::size_t p = 0; p < count; ++p)
      if (wave.several[p] != 0) several_.push_back(seeds_[wave.first + p]);
    memory_.for_each_by_point(
        wave.first,
        [&](std::size_t i, std::size_t patch, std::size_t k) {
          const std::size_t p = patch - wave.first, at = p * wave.stride + k - memory_.begin(patch);
          const MemberWeight weight = memory_.weight()[k];
          const float e = float(weight) / kMemberUnit, w = e * wave.say[p];
          sums.height[i] += w * wave.height[at];
          sums.own[i] += w * e * wave.own[at];
          sums.weights[i] += w;
          around_[i] += float(weight);
          if (weight >= kCovered) sums.well_inside[i] = 1;
        },
        context);
  }
}

void Patches::fit_wave(Wave& wave, const std::vector<double>& sigma, const Context& context) const {
  for_blocks(context, wave.kept.size(), kTogether, [&](std::size_t begin, std::size_t end) {
    PatchFit patch(field_, members_);
    for (std::size_t p = begin; p < end; ++p) {
      const Index seed = seeds_[wave.first + p];
      patch.fit(seed, sigma[seed]);
      wave.kept[p] = patch.size();
      wave.say[p] = patch.say();
      wave.several[p] = char(patch.several());
      std::copy_n(patch.point(), patch.size(), wave.point.data() + p * wave.stride);
      std::copy_n(patch.weight(), patch.size(), wave.weight.data() + p * wave.stride);
      std::copy_n(patch.height(), patch.size(), wave.height.data() + p * wave.stride);
      std::copy_n(patch.own(), patch.size(), wave.own.data() + p * wave.stride);
    }
  });
}

template <std::size_t kCount>
void Patches::average(const std::array<std::vector<float>*, kCount>& values, const Context& context) const {
  using One = std::array<float, kCount>;
  std::array<const float*, kCount> from;
  std::transform(values.begin(), values.end(), from.begin(), [](const auto* v) { return v->data(); });
  std::vector<One> of_patch(memory_.patches(), One{});
  for_each_index(
      context, of_patch.size(),
      [&](std::size_t p) {
        const std::size_t begin = memory_.begin(p);
        const auto inside =
            weighted_sums(memory_.size(p), memory_.point() + begin, memory_.weight() + begin, from);
        if (!(inside.weights > 0)) return;
        for (std::size_t c = 0; c < kCount; ++c) of_patch[p][c] = inside.sum[c] / inside.weights;
      },
      kTogether);
  std::vector<One> sum(field_.size(), One{});
  memory_.for_each_by_point(
      0,
      [&](std::size_t i, std::size_t patch, std::size_t k) {
        const auto weight = float(memory_.weight()[k]);
        for (std::size_t c = 0; c < kCount; ++c) sum[i][c] += weight * of_patch[patch][c];
      },
      context);
  for_each_index(context, sum.size(), [&](std::size_t i) {
    if (!(around_[i] > 0)) return;
    for (std::size_t c = 0; c < kCount; ++c) (*values[c])[i] = sum[i][c] / around_[i];
  });
}

template void Patches::average(const std::array<std::vector<float>*, 1>&, const Context&) const;
template void Patches::average(const std::array<std::vector<float>*, 2>&, const Context&) const;

}  // namespace rfsmooth::smoothing
