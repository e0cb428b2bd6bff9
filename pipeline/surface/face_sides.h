/// The sides of faces, sorted by their edge: who meets whom across every edge.
#pragma once

#include <algorithm>
#include <numeric>
#include <tuple>
#include <vector>

#include <rfsmooth/mesh.h>

namespace rfsmooth::pipeline {

/// A face and the side it is seen from.
struct FaceSide {
  Index a, b;    ///< the edge, a < b
  Index face;    ///< whose side it is
  bool forward;  ///< the face runs from a to b

  bool same_edge(const FaceSide& other) const { return a == other.a && b == other.b; }
};

/// 3 m sides, ascending by (a, b, face). O(m log m).
inline std::vector<FaceSide> face_sides(const std::vector<Face>& faces) {
  std::vector<FaceSide> sides;
  sides.reserve(3 * faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index p = faces[f][k], q = faces[f][(k + 1) % 3];
      sides.push_back({std::min(p, q), std::max(p, q), Index(f), p < q});
    }
  std::sort(sides.begin(), sides.end(), [](const FaceSide& p, const FaceSide& q) {
    return std::tie(p.a, p.b, p.face) < std::tie(q.a, q.b, q.face);
  });
  return sides;
}

/// Calls visit(first, last) for the sides of every edge, in order of the edges.
template <class Visit>
void for_each_edge(const std::vector<FaceSide>& sides, Visit&& visit) {
  for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
    while (last < sides.size() && sides[last].same_edge(sides[first])) ++last;
    visit(sides.data() + first, sides.data() + last);
  }
}

/// Which corner of `face` is `vertex`, one of its three, counted over all faces.
inline Index corner_of(const std::vector<Face>& faces, Index face, Index vertex) {
  Index k = 0;
  while (faces[face][k] != vertex) ++k;
  return 3 * face + k;
}

/// Disjoint sets; the least member stands for its set.
class Groups {
 public:
  explicit Groups(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), Index{0}); }
  Index of(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(Index i, Index j) {
    i = of(i);
    j = of(j);
    if (i != j) parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<Index> parent_;
};

}  // namespace rfsmooth::pipeline
