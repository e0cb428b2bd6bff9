/// The members of many patches, and how threads add up over each point what its patches say.
///
/// A list of the patches over every point would take as much memory again as the lists of members. Instead
/// the points are taken in ranges and the patches in groups: both lie in memory about as in space, so a group
/// has members in few ranges, and the thread that owns a range reads the groups that have some there. Each
/// point is told by its patches in ascending order, whatever the number of threads.
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

  /// Room for so many members more. Room that is never used is never touched, and takes no memory.
  /// \throw std::length_error for 2^32 members in all.
  void reserve(std::size_t more);

  /// Puts patches behind those before, patch p of kept[p] members; theirs are at `point` and `weight` from
  /// p * stride on. O(members).
  void append(const std::vector<std::size_t>& kept, std::size_t stride, const Index* point,
              const MemberWeight* weight, const Context& context);

  std::size_t patches() const { return start_.size() - 1; }
  std::size_t begin(std::size_t patch) const { return start_[patch]; }  ///< its first member
  std::size_t size(std::size_t patch) const { return start_[patch + 1] - start_[patch]; }
  const Index* point() const { return point_.data(); }           ///< of all members
  const MemberWeight* weight() const { return weight_.data(); }  ///< of all members

  /// Calls add(point, patch, member) for the members of the patches from `first` on, 0 or the first of an
  /// append: for each point in ascending order of patches, for several points at once. O(members).
  template <class Add>
  void for_each_by_point(std::size_t first, Add&& add, const Context& context) const {
    for_each_index(
        context, groups_.size(),
        [&](std::size_t range) {
          const auto before = [](const Group& group, std::size_t patch) { return group.begin < patch; };
          const std::vector<Group>& groups = groups_[range];
          const Index* const point = point_.data();
          for (auto group = std::lower_bound(groups.begin(), groups.end(), first, before);
               group != groups.end(); ++group)
            for (std::size_t p = group->begin; p < group->end; ++p)
              for (std::size_t k = start_[p], end = start_[p + 1]; k < end; ++k)
                if (point[k] / kRange == range) add(std::size_t(point[k]), p, k);
        },
        1);
  }

 private:
  static constexpr std::size_t kRange = 16384;  // points that one thread adds up
  static constexpr std::size_t kGroup = 4096;   // members read together for them
  /// The patches [begin, end).
  struct Group {
    Index begin, end;
  };

  void group(std::size_t first, const Context& context);

  std::vector<Index> start_{0};             ///< patches + 1: where each one's members begin
  RawArray<Index> point_;                   ///< of all members
  RawArray<MemberWeight> weight_;           ///< not 0
  std::vector<std::vector<Group>> groups_;  ///< of each range of points, ascending
};

}  // namespace rfsmooth::smoothing
