#include "rfsmooth/rfs_mesh/flattest_pair.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <tuple>

#include <Eigen/Geometry>

#include "rfsmooth/rfs_mesh/collect.h"
#include "rfsmooth/rfs_mesh/measure.h"
#include "rfsmooth/rfs_mesh/parallel.h"
#include "rfsmooth/rfs_mesh/tangent_plane.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// Rounds of mark-then-delete: the first decides nearly everything, the next two give room that freed edges
/// leave back to faces that lost only to deleted ones.
constexpr int kRounds = 3;

/// The cosines of one, two, ... steps up to the first that is not below 180 degrees.
std::vector<double> cosines_of_steps(double degrees) {
  std::vector<double> cosines;
  for (double angle = degrees; cosines.empty() || cosines.back() > -1; angle += degrees)
    cosines.push_back(angle < 180 ? std::cos(radians(angle)) : -1);
  return cosines;
}

/// The normal of a face beside an edge, on the side of a turn from the edge into the face.
struct FaceNormal {
  Eigen::Vector3d normal;
  double squared;
};

/// How far two faces are folded at the edge that they share, in steps: 0 = flat.
int fold(const FaceNormal& x, const FaceNormal& y, const std::vector<double>& cosines) {
  // Flat faces lie on the two sides of the edge, with opposite turns.
  const double both = std::sqrt(x.squared * y.squared), dot = -x.normal.dot(y.normal);
  if (!(both > 0)) return int(cosines.size());
  std::size_t steps = 0;
  while (steps + 1 < cosines.size() && dot <= cosines[steps] * both) ++steps;
  return int(steps);
}

enum class State : std::uint8_t { contender, kept, out };

/// A face at an edge: across it lies `opposite`.
struct Wing {
  Index other_end, face, opposite;
};

/// How good it is to have a pair of faces (or one face) at an edge; larger is better.
struct Merit {
  int flatness = std::numeric_limits<int>::min();  ///< 0 = flat, -1, -2 ... ever more folded
  int votes = 0;
  double quality = 0;
  Index first = kNone, second = kNone;  // the lower indices win the last tie
  friend bool operator<(const Merit& a, const Merit& b) {
    return std::tie(a.flatness, a.votes, a.quality, b.first, b.second) <
           std::tie(b.flatness, b.votes, b.quality, a.first, a.second);
  }
};

class Chooser {
 public:
  Chooser(const Positions& at, const ProposedFaces& proposed, double same_fold, const Context& context)
      : at_(at),
        cosines_(cosines_of_steps(same_fold)),
        proposed_(proposed),
        context_(context),
        around_(vertex_faces(at.size(), proposed.faces, context)),
        quality_(proposed.faces.size()),
        state_(proposed.faces.size(), State::contender),
        lost_(proposed.faces.size()) {
    for_each_index(context, quality_.size(), [&](std::size_t f) {
      const Face& v = proposed.faces[f];
      quality_[f] = float(face_quality(at[v[0]], at[v[1]], at[v[2]]));
    });
  }

  void round() {
    for_blocks(context_, at_.size(), 512, [&](std::size_t begin, std::size_t end) {
      Wings wings;
      for (std::size_t a = begin; a < end; ++a) decide_edges_of(Index(a), wings);
    });
    for_each_index(context_, state_.size(), [&](std::size_t f) {
      const std::uint8_t lost = lost_[f].exchange(0, std::memory_order_relaxed);
      if (state_[f] != State::contender) return;
      state_[f] = lost == 0 ? State::kept : lost == kNoRoom ? State::out : State::contender;
    });
  }

  bool kept(std::size_t f) const { return state_[f] == State::kept; }

 private:
  static constexpr std::uint8_t kBeaten = 1, kNoRoom = 2;

  /// Those of one vertex, and the normals of those at one edge: memory that is kept.
  struct Wings {
    std::vector<Wing> of_vertex;
    std::vector<FaceNormal> normals;
  };

  /// Every edge from a to a higher index.
  void decide_edges_of(Index a, Wings& memory) {
    std::vector<Wing>& wings = memory.of_vertex;
    wings.clear();
    const auto faces = around_[a];
    if (std::none_of(faces.begin(), faces.end(), [&](Index f) { return state_[f] == State::contender; }))
      return;
    for (const Index f : faces) {
      if (state_[f] == State::out) continue;
      const Face& v = proposed_.faces[f];
      for (int k = 0; k < 3; ++k) {
        const Index b = v[std::size_t(k)], c = v[std::size_t(k + 1) % 3], d = v[std::size_t(k + 2) % 3];
        if (b == a) {
          if (c > a) wings.push_back({c, f, d});
          if (d > a) wings.push_back({d, f, c});
        }
      }
    }
    std::sort(wings.begin(), wings.end(), [](const Wing& x, const Wing& y) {
      return std::tie(x.other_end, x.face) < std::tie(y.other_end, y.face);
    });
    for (std::size_t first = 0, last = 0; first < wings.size(); first = last) {
      while (last < wings.size() && wings[last].other_end == wings[first].other_end) ++last;
      if (last - first > 2) decide_edge(a, wings.data() + first, last - first, memory.normals);
    }
  }

  void decide_edge(Index a, const Wing* wings, std::size_t count, std::vector<FaceNormal>& normals) {
    std::size_t kept_count = 0, kept_wing = 0;
    for (std::size_t i = 0; i < count; ++i)
      if (kept(wings[i].face)) {
        ++kept_count;
        kept_wing = i;
      }
    if (kept_count < 2) {
      normals.resize(count);
      const Eigen::Vector3d along = at_[wings->other_end] - at_[a];
      for (std::size_t i = 0; i < count; ++i) {
        normals[i].normal = along.cross(at_[wings[i].opposite] - at_[a]);
        normals[i].squared = normals[i].normal.squaredNorm();
      }
    }
    const auto [first, second] = kept_count == 0   ? best_pair(wings, normals)
                                 : kept_count == 1 ? best_with(kept_wing, wings, normals)
                                                   : std::pair<Index, Index>{kNone, kNone};
    const std::uint8_t mark = kept_count >= 2 ? kNoRoom : kBeaten;
    for (std::size_t i = 0; i < count; ++i) {
      const Index f = wings[i].face;
      if (f != first && f != second && !kept(f)) raise(lost_[f], mark);
    }
  }

  /// Marks only grow, so the order in which threads raise them does not matter.
  static void raise(std::atomic<std::uint8_t>& mark, std::uint8_t to) {
    std::uint8_t now = mark.load(std::memory_order_relaxed);
    while (now < to && !mark.compare_exchange_weak(now, to, std::memory_order_relaxed)) {
    }
  }

  Merit merit(const Wing& x, const FaceNormal& at_x, const Wing& y, const FaceNormal& at_y) const {
    return {-fold(at_x, at_y, cosines_), proposed_.votes[x.face] + proposed_.votes[y.face],
            double(quality_[x.face]) + double(quality_[y.face]), std::min(x.face, y.face),
            std::max(x.face, y.face)};
  }

  std::pair<Index, Index> best_pair(const Wing* wings, const std::vector<FaceNormal>& normals) const {
    Merit best;
    for (std::size_t i = 0; i < normals.size(); ++i)
      for (std::size_t j = i + 1; j < normals.size(); ++j)
        if (const Merit m = merit(wings[i], normals[i], wings[j], normals[j]); best < m) best = m;
    return {best.first, best.second};
  }

  std::pair<Index, Index> best_with(std::size_t kept_wing, const Wing* wings,
                                    const std::vector<FaceNormal>& normals) const {
    Merit best;
    for (std::size_t i = 0; i < normals.size(); ++i)
      if (i != kept_wing)
        if (const Merit m = merit(wings[kept_wing], normals[kept_wing], wings[i], normals[i]); best < m)
          best = m;
    return {best.first, best.second};
  }

  const Positions& at_;
  const std::vector<double> cosines_;
  const ProposedFaces& proposed_;
  const Context& context_;
  Adjacency around_;
  std::vector<float> quality_;
  std::vector<State> state_;
  std::vector<std::atomic<std::uint8_t>> lost_;
};

}  // namespace

ProposedFaces proposed_faces(const std::vector<Umbrella>& umbrellas, const Context& context) {
  struct Vote {
    Face face;
    std::uint8_t votes;
  };
  const auto votes = collect<Vote>(context, umbrellas.size(), [&](std::size_t i, auto&& emit) {
    const Index v = Index(i);
    const Umbrella& umbrella = umbrellas[i];
    for (int k = 0; k < umbrella.count; ++k) {
      if (!umbrella.spans(k)) continue;
      const Index a = umbrella.ribs[std::size_t(k)], b = umbrella.next(k);
      const bool by_a = umbrellas[a].spans(v, b), by_b = umbrellas[b].spans(v, a);
      if ((by_a && a < v) || (by_b && b < v)) continue;  // a lower corner speaks for this face
      emit({{v, a, b}, std::uint8_t(1 + by_a + by_b)});
    }
  });
  ProposedFaces proposed;
  proposed.faces.resize(votes.size());
  proposed.votes.resize(votes.size());
  for_each_index(context, votes.size(), [&](std::size_t f) {
    proposed.faces[f] = votes[f].face;
    proposed.votes[f] = votes[f].votes;
  });
  return proposed;
}

std::vector<Face> keep_flattest_pairs(const Positions& at, const ProposedFaces& proposed, double same_fold,
                                      const Context& context) {
  Chooser chooser(at, proposed, same_fold, context);
  for (int round = 0; round < kRounds; ++round) chooser.round();
  return collect<Face>(context, proposed.faces.size(), [&](std::size_t f, auto&& emit) {
    if (chooser.kept(f)) emit(proposed.faces[f]);
  });
}

}  // namespace rfsmooth::rfs_mesh
