#include "smoothing/automatic/patches/patch_members.h"

#include "base/fail.h"

namespace rfsmooth::smoothing {

void PatchMembers::clear(std::size_t points) {
  start_.assign(1, 0);
  point_.clear();
  weight_.clear();
  bundles_.assign((points + kRange - 1) / kRange, {});
}

void PatchMembers::reserve(std::size_t more, std::size_t spare) {
  if (more > most_more())
    fail(ErrorCode::usage, "2^32 members of patches and more; clouds of so many points go in tiles");
  const std::size_t size = start_.back(), whole = size + more + std::min(spare, most_more() - more);
  for (const std::size_t room : {size, whole}) {  // the first: room that is unused is not moved
    point_.resize(room);
    weight_.resize(room);
  }
}

void PatchMembers::append(const std::vector<std::size_t>& kept, std::size_t stride, const Index* point,
                          const MemberWeight* weight, const Context& context) {
  const std::size_t first = patches();
  for (std::size_t p = 0; p < kept.size(); ++p) {
    std::copy_n(point + p * stride, kept[p], point_.data() + start_.back());
    std::copy_n(weight + p * stride, kept[p], weight_.data() + start_.back());
    start_.push_back(Index(start_.back() + kept[p]));
  }
  bundle(first, context);
}

/// Enters the patches from `first` on with the ranges that they have members in.
void PatchMembers::bundle(std::size_t first, const Context& context) {
  std::vector<Bundle> bundles;
  for (std::size_t p = first; p < patches(); ++p)
    if (bundles.empty() || start_[p + 1] - start_[bundles.back().begin] > kBundle)
      bundles.push_back({Index(p), Index(p + 1)});
    else
      bundles.back().end = Index(p + 1);
  std::vector<std::vector<Index>> ranges(bundles.size());  // that a bundle touches
  for_each_index(
      context, bundles.size(),
      [&](std::size_t g) {
        Index before = kNone;
        for (std::size_t k = start_[bundles[g].begin]; k < start_[bundles[g].end]; ++k) {
          const auto range = Index(point_[k] / kRange);
          if (range == before) continue;
          before = range;
          if (std::find(ranges[g].begin(), ranges[g].end(), range) == ranges[g].end())
            ranges[g].push_back(range);
        }
      },
      16);
  for (std::size_t g = 0; g < bundles.size(); ++g)
    for (const Index range : ranges[g]) bundles_[range].push_back(bundles[g]);
}

}  // namespace rfsmooth::smoothing
