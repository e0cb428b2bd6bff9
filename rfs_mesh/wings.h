/// The faces around a vertex, grouped by edge. Internal to the choice of faces (flattest_pair.h). One object
/// per thread.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

#include <rfsmooth/mesh.h>

namespace rfsmooth::rfs_mesh {

/// Groups the wings of one vertex after the other: the faces at the edges that lead from the vertex to higher
/// indices. A hash table serves that need not be emptied in between. Nothing is sorted and no branch is
/// unpredictable: on noisy points a vertex has some ten wings, and which of them share an edge follows no
/// pattern.
class Wings {
 public:
  Wings() : places_(kPlaces, Place{0, kNone, 0}), wings_(kMost + 1), edge_(kMost + 1) {}

  /// Starts with another vertex that has at most `most` wings.
  void reset(Index vertex, std::size_t most) {
    vertex_ = vertex;
    ++round_;
    count_ = edges_ = 0;
    many_ = most > kMost;
    if (many_ && wings_.size() <= most) wings_.resize(most + 1);
  }

  /// Adds a face at the edge to `other_end` if that is above the vertex, else does nothing. Faces must come
  /// in ascending order.
  void add_if_above(Index other_end, Index face) {
    const bool wanted = other_end > vertex_;
    wings_[count_] = {other_end, face};
    if (!many_) {
      // Without a branch: an unwanted wing looks up a place, too, but leaves it unchanged.
      std::uint32_t at = (other_end * kSpread) >> (32 - kBits);
      while (places_[at].round == round_ && places_[at].other_end != other_end) at = (at + 1) % kPlaces;
      Place& place = places_[at];
      const bool fresh = place.round != round_;
      place.mask = (fresh ? 0 : place.mask) | std::uint64_t(wanted) << count_;
      place.round = wanted ? round_ : place.round;
      place.other_end = wanted ? other_end : place.other_end;
      edge_[edges_] = at;
      edges_ += std::size_t(fresh && wanted);
    }
    count_ += std::size_t(wanted);
  }

  /// Calls `visit(other end, first face, count)` for every edge with more than two faces, in the same order
  /// each time.
  template <class Visit>
  void for_each_crowded(Visit&& visit) {
    if (many_) return for_each_crowded_sorted(visit);
    std::array<Index, kMost> faces;
    for (std::size_t e = 0; e < edges_; ++e) {
      const Place& place = places_[edge_[e]];
      std::uint64_t left = place.mask;
      const std::uint64_t but_one = left & (left - 1);
      if ((but_one & (but_one - 1)) == 0) continue;
      std::size_t count = 0;
      for (; left != 0; left &= left - 1) faces[count++] = wings_[std::size_t(__builtin_ctzll(left))].face;
      visit(place.other_end, faces.data(), count);
    }
  }

 private:
  static constexpr std::size_t kMost = 64;  // wings, one bit of a mask each; more are sorted
  static constexpr int kBits = 8;
  static constexpr std::uint32_t kPlaces = 1u << kBits;
  static constexpr std::uint32_t kSpread = 2654435769;  // 2^32 over the golden ratio

  struct Place {
    std::uint32_t round;  ///< of the vertex that last used this place
    Index other_end;
    std::uint64_t mask;
  };

  struct Wing {
    Index other_end, face;
  };

  template <class Visit>
  void for_each_crowded_sorted(Visit& visit) {
    const auto begin = wings_.begin(), end = begin + std::ptrdiff_t(count_);
    std::sort(begin, end, [](const Wing& x, const Wing& y) {
      return std::tie(x.other_end, x.face) < std::tie(y.other_end, y.face);
    });
    std::vector<Index> faces;
    for (auto first = begin, last = begin; first != end; first = last) {
      faces.clear();
      for (; last != end && last->other_end == first->other_end; ++last) faces.push_back(last->face);
      if (faces.size() > 2) visit(first->other_end, faces.data(), faces.size());
    }
  }

  Index vertex_ = kNone;
  std::uint32_t round_ = 0;
  bool many_ = false;
  std::vector<Place> places_;
  std::vector<Wing> wings_;
  std::vector<std::uint32_t> edge_;  // where in places_ each edge is
  std::size_t count_ = 0, edges_ = 0;
};

}  // namespace rfsmooth::rfs_mesh
