/// The members of many patches, and how threads add up over each point what its patches say.
///
/// A list of the patches over every point would take as much memory again as the lists of members. Instead
/// the points are taken in ranges and the patches in bundles: both lie in memory about as in space, so a
/// bundle has members in few ranges, and the thread that owns a range reads the bundles that have some there.
/// Each point is told by its patches in ascending order, whatever the number of threads.
/// Const functions are thread safe.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/parallel.h"
#include "base/raw_array.h"
#include "rfs_mesh/points.h"

namespace rfsmooth::smoothing {

/// Weights of members in 1/65535.
using MemberWeight = std::uint16_t;
inline constexpr float kMemberUnit = 65535;

/// Which points are in which patch, with what weight. To be used again for the next patches, since the system
/// takes longer to give out so much memory than a pass over it takes.
class PatchMembers {
 public:
  /// No patches, over so many points.
  void clear(std::size_t points);

  /// Room for `more` members, and for `spare` beyond them as far as 32 bits count. Room that is never used is
  /// never touched and takes no memory. Pointers from point() and weight() become invalid. \throw Failure
  /// (usage) if there are to be 2^32 members or more.
  void reserve(std::size_t more, std::size_t spare);

  /// How many members more 32 bits count.
  std::size_t most_more() const { return kNone - start_.back(); }

  /// Puts patches behind those before, patch p of kept[p] members; theirs are at `point` and `weight` from
  /// p * stride on. Room for them has been reserved. O(members).
  void append(const std::vector<std::size_t>& kept, std::size_t stride, const Index* point,
              const MemberWeight* weight, const Context& context);

  std::size_t patches() const { return start_.size() - 1; }
  std::size_t begin(std::size_t patch) const { return start_[patch]; }  ///< its first member
  std::size_t size(std::size_t patch) const { return start_[patch + 1] - start_[patch]; }
  const Index* point() const { return point_.data(); }           ///< of all members
  const MemberWeight* weight() const { return weight_.data(); }  ///< of all members

  /// Calls add(point, patch, member) for the members of the patches from `first` on: 0, or the number of
  /// patches before an append. Each point is told in ascending order of patches; those of one range by one
  /// thread. O(members times the ranges that their bundle has members in): few for narrow patches, all for
  /// patches as large as the cloud.
  template <class Add>
  void for_each_by_point(std::size_t first, Add&& add, const Context& context) const {
    for_each_index(
        context, bundles_.size(),
        [&](std::size_t range) {
          const auto before = [](const Bundle& bundle, std::size_t patch) { return bundle.begin < patch; };
          const std::vector<Bundle>& bundles = bundles_[range];
          const Index* const point = point_.data();
          for (auto bundle = std::lower_bound(bundles.begin(), bundles.end(), first, before);
               bundle != bundles.end(); ++bundle)
            for (std::size_t p = bundle->begin; p < bundle->end; ++p)
              for (std::size_t k = start_[p], end = start_[p + 1]; k < end; ++k)
                if (point[k] / kRange == range) add(std::size_t(point[k]), p, k);
        },
        1);
  }

 private:
  static constexpr std::size_t kRange = 16384;  // points that one thread adds up
  static constexpr std::size_t kBundle = 4096;  // members read together for them
  /// The patches [begin, end).
  struct Bundle {
    Index begin, end;
  };

  void bundle(std::size_t first, const Context& context);

  std::vector<Index> start_{0};               ///< patches + 1: where each one's members begin
  RawArray<Index> point_;                     ///< of all members
  RawArray<MemberWeight> weight_;             ///< not 0
  std::vector<std::vector<Bundle>> bundles_;  ///< of each range of points, ascending
};

}  // namespace rfsmooth::smoothing
