#include "rfs_mesh/small_holes.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "base/collect.h"
#include "base/parallel.h"
#include "rfs_mesh/corners.h"
#include "rfs_mesh/measure.h"

namespace rfsmooth::rfs_mesh {

namespace {

constexpr double kRightAngle = 1.57079632679489662;

/// An edge with one face, as one of its ends sees it, and the face.
struct RimEdge {
  Index end, other, face;
};

/// What fills a hole, wound against the face beside its first edge.
struct Filling {
  Face face;
  double quality;
};

class Holes {
 public:
  Holes(const Positions& at, double quality, const std::vector<Face>& faces, const Context& context)
      : at_(at), quality_(quality), faces_(faces), around_(vertex_faces(at.size(), faces, context)) {
    rim_ =
        collect<RimEdge>(context, at.size(), [&](std::size_t a, auto&& emit) { find_rim(Index(a), emit); });
    start_.assign(at.size() + 1, 0);
    for (const RimEdge& edge : rim_) ++start_[edge.end + 1];
    for (std::size_t a = 0; a < at.size(); ++a) start_[a + 1] += start_[a];
  }

  /// Every filling whose lowest corner is a; they may want the same edges.
  template <class Emit>
  void find(Index a, Emit&& emit) const {
    for (Index k = start_[a]; k < start_[a + 1]; ++k) {
      const Index b = rim_[k].other;
      if (b < a) continue;
      for (Index l = start_[b]; l < start_[b + 1]; ++l) {
        const Index c = rim_[l].other;
        if (c < b) continue;
        const RimEdge* const last = rim_edge(a, c);
        if (last == nullptr || rim_[k].face == rim_[l].face) continue;  // that face is this triangle
        const double q = face_quality(at_[a], at_[b], at_[c]);
        if (!(q >= quality_) || folded(a, b, c, rim_[k].face) || folded(b, c, a, rim_[l].face) ||
            folded(a, c, b, last->face))
          continue;
        emit(Filling{runs(rim_[k].face, a, b) ? Face{b, a, c} : Face{a, b, c}, q});
      }
    }
  }

 private:
  /// Emits the edges of a that have one face, by their other ends.
  template <class Emit>
  void find_rim(Index a, Emit&& emit) const {
    std::vector<RimEdge> all;
    for (const Index f : around_[a])
      for (const Index b : faces_[f])
        if (b != a) all.push_back({a, b, f});
    std::sort(all.begin(), all.end(), [](const RimEdge& x, const RimEdge& y) {
      return std::tie(x.other, x.face) < std::tie(y.other, y.face);
    });
    for (std::size_t i = 0, end = 0; i < all.size(); i = end) {
      while (end < all.size() && all[end].other == all[i].other) ++end;
      if (end - i == 1) emit(all[i]);
    }
  }

  const RimEdge* rim_edge(Index a, Index b) const {
    for (Index k = start_[a]; k < start_[a + 1]; ++k)
      if (rim_[k].other == b) return &rim_[k];
    return nullptr;
  }

  /// Whether a face over pq with the tip r would be folded onto the one that is there.
  bool folded(Index p, Index q, Index r, Index there) const {
    return dihedral_angle(at_[p], at_[q], at_[r], at_[third_corner(faces_[there], p, q)]) < kRightAngle;
  }

  /// Whether a face at the edge of a and b runs from a to b.
  bool runs(Index face, Index a, Index b) const { return other_corners(faces_[face], a).next == b; }

  const Positions& at_;
  double quality_;
  const std::vector<Face>& faces_;
  Adjacency around_;
  std::vector<Index> start_;
  std::vector<RimEdge> rim_;
};

}  // namespace

void fill_small_holes(const Positions& at, double quality, std::vector<Face>& faces, const Context& context) {
  const Holes holes(at, quality, faces, context);
  std::vector<Filling> fillings =
      collect<Filling>(context, at.size(), [&](std::size_t a, auto&& emit) { holes.find(Index(a), emit); });
  std::sort(fillings.begin(), fillings.end(), [](const Filling& x, const Filling& y) {
    return x.quality != y.quality ? x.quality > y.quality : x.face < y.face;
  });
  std::set<Edge> taken;
  for (const Filling& filling : fillings) {
    std::array<Edge, 3> edges;
    for (std::size_t k = 0; k < 3; ++k) edges[k] = edge_between(filling.face[k], filling.face[(k + 1) % 3]);
    if (std::any_of(edges.begin(), edges.end(), [&](const Edge& e) { return taken.count(e) > 0; })) continue;
    taken.insert(edges.begin(), edges.end());
    faces.push_back(filling.face);
  }
}

}  // namespace rfsmooth::rfs_mesh
