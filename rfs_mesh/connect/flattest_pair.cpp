#include "rfs_mesh/connect/flattest_pair.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <memory>

#include <Eigen/Geometry>

#include "base/collect.h"
#include "base/parallel.h"
#include "rfs_mesh/connect/ordered_bits.h"
#include "rfs_mesh/corners.h"
#include "rfs_mesh/fit/tangent_plane.h"
#include "rfs_mesh/measure.h"
#include "rfs_mesh/wings.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// Rounds of mark-then-delete: the first decides nearly everything, the next two give room that freed edges
/// leave back to faces that lost only to deleted ones.
constexpr int kRounds = 3;

/// The cosines of one, two, ... steps that are below 180 degrees.
std::vector<double> cosines_of_steps(double degrees) {
  std::vector<double> cosines;
  for (double angle = degrees; angle < 180; angle += degrees) cosines.push_back(std::cos(radians(angle)));
  return cosines;
}

/// The normal of a face beside an edge, on the side of a turn from the edge into the face.
struct FaceNormal {
  Eigen::Vector3d normal;
  double squared;
};

/// How far two faces are folded at the edge that they share, in steps: 0 = flat. Counted without a branch.
int fold(const FaceNormal& x, const FaceNormal& y, const std::vector<double>& cosines) {
  // Flat faces lie on the two sides of the edge, with opposite turns.
  const double both = std::sqrt(x.squared * y.squared), dot = -x.normal.dot(y.normal);
  if (!(both > 0)) return int(cosines.size()) + 1;
  int steps = 0;
  for (const double cosine : cosines) steps += int(dot <= cosine * both);
  return steps;
}

enum class State : std::uint8_t { contender, kept, out };

/// A face at an edge, as the edge sees it.
struct FaceAt {
  Index face;
  FaceNormal normal;
};

class Chooser {
 public:
  Chooser(const Positions& at, const ProposedFaces& proposed, double same_fold, const Context& context)
      : at_(at),
        cosines_(cosines_of_steps(same_fold)),
        proposed_(proposed),
        context_(context),
        around_(vertex_faces(at.size(), proposed.faces, context)),
        crowded_(new Index[kRoom * around_.items.size()]),
        crowded_size_((at.size() + kBlock - 1) / kBlock),
        quality_(proposed.faces.size()),
        state_(proposed.faces.size(), State::contender),
        lost_(proposed.faces.size()) {
    for_each_index(context, quality_.size(), [&](std::size_t f) {
      const Face& v = proposed.faces[f];
      quality_[f] = float(face_quality(at[v[0]], at[v[1]], at[v[2]]));
    });
    for_blocks(context, at.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      Wings wings;
      Index* const first = crowded_at(begin);
      Index* out = first;
      for (std::size_t a = begin; a < end; ++a) out = list_crowded_edges(Index(a), wings, out);
      crowded_size_[begin / kBlock] = std::size_t(out - first);
    });
  }

  void round() {
    for_blocks(context_, at_.size(), kBlock, [&](std::size_t begin, std::size_t) {
      std::vector<FaceAt> there;
      std::size_t& size = crowded_size_[begin / kBlock];
      Index *to = crowded_at(begin), *edge = to;
      for (const Index* const end = edge + size; edge != end;) {
        Index* const next = edge + kHead + edge[2];
        if (decide(edge, there)) to = std::copy(edge, next, to);
        edge = next;
      }
      size = std::size_t(to - crowded_at(begin));
    });
    for_each_index(context_, state_.size(), [&](std::size_t f) {
      if (state_[f] != State::contender) return;
      const std::uint8_t lost = lost_[f].load(std::memory_order_relaxed);
      lost_[f].store(0, std::memory_order_relaxed);
      state_[f] = lost == 0 ? State::kept : lost == kNoRoom ? State::out : State::contender;
    });
  }

  bool kept(std::size_t f) const { return state_[f] == State::kept; }

  /// Once.
  FlattestPairs result() {
    crowded_.reset();
    std::vector<char> kept_flag(state_.size());
    for_each_index(context_, state_.size(), [&](std::size_t f) { kept_flag[f] = kept(f) ? 1 : 0; });
    FlattestPairs pairs;
    pairs.one_ring = one_ring(around_, proposed_.faces, kept_flag, context_);
    pairs.faces = collect<Face>(context_, proposed_.faces.size(), [&](std::size_t f, auto&& emit) {
      if (kept(f)) emit(proposed_.faces[f]);
    });
    return pairs;
  }

 private:
  static constexpr std::uint8_t kBeaten = 1, kNoRoom = 2;

  static constexpr std::array<std::uint8_t, 4> kAfter = {1, 2, 0, 1};  // of the corner k

  // The edges with more than two faces, block by block of their lower ends; each as its ends, how many faces,
  // and the faces in their order. A face has two edges at a vertex; three of them make one record of six.
  static constexpr std::size_t kBlock = 512, kHead = 3, kRoom = 4;
  Index* crowded_at(std::size_t vertex) {
    return crowded_.get() + kRoom * std::size_t(around_.start[vertex]);
  }

  /// Writes those from a to higher indices to `out`; returns the end.
  Index* list_crowded_edges(Index a, Wings& wings, Index* out) const {
    const auto faces = around_[a];
    wings.reset(a, 2 * faces.size());
    for (const Index f : faces) {
      const Face& v = proposed_.faces[f];
      const std::size_t k = std::size_t(v[1] == a) + 2 * std::size_t(v[2] == a);
      wings.add_if_above(v[kAfter[k]], f);
      wings.add_if_above(v[kAfter[k + 1]], f);
    }
    wings.for_each_crowded([&](Index b, const Index* first, std::size_t count) {
      *out++ = a;
      *out++ = b;
      *out++ = Index(count);
      out = std::copy_n(first, count, out);
    });
    return out;
  }

  /// Marks what loses at one edge. False if nothing can lose there in a later round: faces only go.
  bool decide(const Index* edge, std::vector<FaceAt>& there) {
    const Index a = edge[0], b = edge[1], count = edge[2];
    const Index* const faces = edge + kHead;
    std::size_t kept_count = 0, contenders = 0;
    for (std::size_t i = 0; i < count; ++i) {
      kept_count += std::size_t(state_[faces[i]] == State::kept);
      contenders += std::size_t(state_[faces[i]] == State::contender);
    }
    if (contenders == 0 || kept_count + contenders <= 2) return false;
    if (kept_count >= 2) {
      for (std::size_t i = 0; i < count; ++i)
        if (state_[faces[i]] == State::contender) raise(lost_[faces[i]], kNoRoom);
      return false;
    }
    there.clear();
    std::size_t kept_one = kNone;
    const Eigen::Vector3d along = at_[b] - at_[a];
    for (std::size_t i = 0; i < count; ++i) {
      const Index f = faces[i];
      if (state_[f] == State::out) continue;
      if (kept(f)) kept_one = there.size();
      const Index opposite = third_corner(proposed_.faces[f], a, b);
      const Eigen::Vector3d normal = along.cross(at_[opposite] - at_[a]);
      there.push_back({f, {normal, normal.squaredNorm()}});
    }
    Best best;
    for (std::size_t i = 0; i < there.size(); ++i)
      for (std::size_t j = i + 1; j < there.size(); ++j)
        if (kept_one == kNone || i == kept_one || j == kept_one) best.offer(merit(there[i], there[j]), i, j);
    for (std::size_t i = 0; i < there.size(); ++i)
      if (i != best.first && i != best.second && i != kept_one) raise(lost_[there[i].face], kBeaten);
    return true;
  }

  /// Marks only grow.
  static void raise(std::atomic<std::uint8_t>& mark, std::uint8_t to) {
    keep_first(mark, to, std::greater<>());
  }

  /// How good it is to have this pair of faces at an edge, larger is better: first the flatter, then the one
  /// with more votes, then the one of better quality. Single precision and one number, so that comparing
  /// takes no branches.
  std::uint64_t merit(const FaceAt& x, const FaceAt& y) const {
    const int steps = fold(x.normal, y.normal, cosines_);
    const int votes = proposed_.votes[x.face] + proposed_.votes[y.face];
    const float quality = quality_[x.face] + quality_[y.face];
    return std::uint64_t(0xffff - steps) << 40 | std::uint64_t(votes) << 32 | ordered_bits(quality);
  }

  /// The best pair so far: of equal ones the first.
  struct Best {
    std::uint64_t merit = 0;
    std::size_t first = kNone, second = kNone;
    void offer(std::uint64_t other, std::size_t i, std::size_t j) {
      const bool better = other > merit;
      merit = better ? other : merit;
      first = better ? i : first;
      second = better ? j : second;
    }
  };

  const Positions& at_;
  const std::vector<double> cosines_;
  const ProposedFaces& proposed_;
  const Context& context_;
  Adjacency around_;
  std::unique_ptr<Index[]> crowded_;       // not a vector: of most of it the pages are never touched
  std::vector<std::size_t> crowded_size_;  // of a block's
  std::vector<float> quality_;
  std::vector<State> state_;
  std::vector<std::atomic<std::uint8_t>> lost_;
};

}  // namespace

ProposedFaces proposed_faces(const std::vector<Umbrella>& umbrellas, const Context& context) {
  // Two bits for each rib: the votes for the face behind it, 0 where another corner votes for it.
  std::vector<std::uint32_t> votes(umbrellas.size());
  static_assert(2 * kMostRibs <= 32);
  for_each_index(context, umbrellas.size(), [&](std::size_t i) {
    const Index v = Index(i);
    const Umbrella& umbrella = umbrellas[i];
    std::uint32_t all = 0;
    for (int k = 0; k < umbrella.count; ++k) {
      if (!umbrella.spans(k)) continue;
      const Index a = umbrella.ribs[std::size_t(k)], b = umbrella.next(k);
      const bool by_a = umbrellas[a].spans(v, b), by_b = umbrellas[b].spans(v, a);
      const bool lower = (by_a && a < v) || (by_b && b < v);  // a lower corner votes for this face
      all |= lower ? 0 : std::uint32_t(1 + int(by_a) + int(by_b)) << (2 * k);
    }
    votes[i] = all;
  });
  const auto visit = [&](std::size_t i, auto&& emit) {
    std::uint32_t left = votes[i];
    for (int k = 0; left != 0; ++k, left >>= 2)
      if ((left & 3) != 0)
        emit(Face{Index(i), umbrellas[i].ribs[std::size_t(k)], umbrellas[i].next(k)}, std::uint8_t(left & 3));
  };
  ProposedFaces proposed;
  proposed.faces = collect<Face>(context, votes.size(), [&](std::size_t i, auto&& emit) {
    visit(i, [&](const Face& face, std::uint8_t) { emit(face); });
  });
  proposed.votes = collect<std::uint8_t>(context, votes.size(), [&](std::size_t i, auto&& emit) {
    visit(i, [&](const Face&, std::uint8_t vote) { emit(vote); });
  });
  return proposed;
}

FlattestPairs keep_flattest_pairs(const Positions& at, const ProposedFaces& proposed, double same_fold,
                                  const Context& context) {
  Chooser chooser(at, proposed, same_fold, context);
  for (int round = 0; round < kRounds; ++round) chooser.round();
  return chooser.result();
}

}  // namespace rfsmooth::rfs_mesh
