#include "rfs_mesh/connect/edge_swap.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <optional>

#include <Eigen/Geometry>

#include "base/collect.h"
#include "base/parallel.h"
#include "rfs_mesh/connect/ordered_bits.h"
#include "rfs_mesh/corners.h"
#include "rfs_mesh/measure.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Eigen::Vector3d;

/// Faces f = abc and g = bad become adc and dbc (wound as f is, where f runs a -> b).
struct Swap {
  Index a, b, c, d;
  Index f, g;
  std::array<Index, 4> outer;  ///< faces across bc, ca, ad, db; kNone at a rim
  float gain;
};

/// Exactly ordered by gain, then by the lower edge number; larger wins.
std::uint64_t priority(float gain, std::size_t candidate) {
  return std::uint64_t(ordered_bits(gain)) << 32 | (0xffffffffu - std::uint32_t(candidate));
}

class Swapper {
 public:
  Swapper(const Mesh& mesh, const std::vector<Face>& faces, const SwapOptions& options,
          const Context& context)
      : at_(mesh.positions),
        mesh_(mesh),
        faces_(faces),
        options_(options),
        around_(vertex_faces(at_.size(), faces, context)),
        flaps_(3 * faces.size()) {
    for_each_index(context, faces.size(), [&](std::size_t f) {
      for (std::size_t k = 0; k < 3; ++k) flaps_[3 * f + k] = make_flap(Index(f), k);
    });
  }

  /// The swaps of edges from a to higher vertices that pay.
  template <class Emit>
  void propose(Index a, Emit&& emit) const {
    for (const Index f : around_[a])
      for (const Index b : faces_[f]) {
        if (b <= a) continue;
        const Index c = third_corner(faces_[f], a, b);
        const Flap& flap = flaps_[3 * std::size_t(f) + corner_of(faces_[f], c)];
        if (flap.faces != 2 || flap.across < f) continue;  // each edge once: from its lower face
        if (const auto swap = consider(a, b, f, flap)) emit(*swap);
      }
  }

 private:
  /// What lies across the edge opposite a face's corner: each is looked up many times, and found once here.
  struct Flap {
    Index across = kNone;     ///< the other face if there is exactly one
    std::uint32_t faces = 1;  ///< faces at the edge, this one included
    double angle = 0;         ///< dihedral angle with the other face
  };

  Flap make_flap(Index f, std::size_t corner) const {
    const Face& face = faces_[f];
    const Index p = face[(corner + 1) % 3], q = face[(corner + 2) % 3];
    Flap flap;
    for (const Index g : around_[p]) {
      if (g == f || !has_corner(faces_[g], q)) continue;
      flap.across = g;
      ++flap.faces;
    }
    if (flap.faces == 2) flap.angle = angle(p, q, face[corner], third_corner(faces_[flap.across], p, q));
    return flap;
  }

  bool connected(Index c, Index d) const {
    return std::any_of(around_[c].begin(), around_[c].end(),
                       [&](Index f) { return has_corner(faces_[f], d); }) ||
           is_loose(c, d);
  }

  bool is_loose(Index a, Index b) const {
    return std::binary_search(mesh_.loose_edges.begin(), mesh_.loose_edges.end(), edge_between(a, b));
  }

  double angle(Index p, Index q, Index r, Index s) const {
    return dihedral_angle(at_[p], at_[q], at_[r], at_[s]);
  }

  std::optional<Swap> consider(Index a, Index b, Index f, const Flap& middle) const {
    const Index g = middle.across;
    const Index c = third_corner(faces_[f], a, b), d = third_corner(faces_[g], a, b);
    if (c == d || !keeps_shape(a, b, c, d) || connected(c, d) || is_loose(a, b)) return std::nullopt;
    Swap swap{a, b, c, d, f, g, {}, 0};
    double gain = angle(c, d, a, b) - middle.angle;
    // The four outer edges: the corner of the old face across each, and the corner of the new one.
    struct Outer {
      Index p, q, face, before, after;
    };
    const std::array<Outer, 4> outer = {{{b, c, f, a, d}, {c, a, f, b, d}, {a, d, g, b, c}, {d, b, g, a, c}}};
    for (std::size_t k = 0; k < 4; ++k) {
      const auto [p, q, own, before, after] = outer[k];
      const Flap& flap = flaps_[3 * std::size_t(own) + corner_of(faces_[own], before)];
      if (flap.faces > 2) return std::nullopt;
      swap.outer[k] = flap.across;
      if (flap.across != kNone)
        gain += angle(p, q, after, third_corner(faces_[flap.across], p, q)) - flap.angle;
    }
    swap.gain = float(gain);
    if (!(gain > options_.least_gain)) return std::nullopt;
    return swap;
  }

  /// Quality, and normals: neither new face may turn over against the old pair.
  bool keeps_shape(Index a, Index b, Index c, Index d) const {
    const Vector3d &A = at_[a], &B = at_[b], &C = at_[c], &D = at_[d];
    const double old_quality = std::min(face_quality(A, B, C), face_quality(B, A, D));
    const double new_quality = std::min(face_quality(A, D, C), face_quality(D, B, C));
    if (new_quality < std::min(options_.quality, old_quality)) return false;
    const Vector3d old_normal = (B - A).cross(C - A) + (A - B).cross(D - B);
    return (D - A).cross(C - A).dot(old_normal) > 0 && (B - D).cross(C - D).dot(old_normal) > 0;
  }

  const Positions& at_;
  const Mesh& mesh_;
  const std::vector<Face>& faces_;
  const SwapOptions& options_;
  Adjacency around_;
  std::vector<Flap> flaps_;  ///< three a face, by the corner opposite the edge
};

template <class Body>
void for_footprint(const Swap& swap, Body&& body) {
  body(swap.f);
  body(swap.g);
  for (const Index o : swap.outer)
    if (o != kNone) body(o);
}

/// All that are worth while, by their lowest vertex. They are dear to find and few: once, in lists by block.
std::vector<Swap> proposals(const Swapper& swapper, std::size_t n, const Context& context) {
  constexpr std::size_t kGrain = 256;
  std::vector<std::vector<Swap>> blocks((n + kGrain - 1) / kGrain);
  for_blocks(context, n, kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Swap>& block = blocks[begin / kGrain];
    for (std::size_t a = begin; a < end; ++a)
      swapper.propose(Index(a), [&](const Swap& swap) { block.push_back(swap); });
  });
  std::vector<Swap> all;
  for (const std::vector<Swap>& block : blocks) all.insert(all.end(), block.begin(), block.end());
  return all;
}

/// The swaps that are the best one on all of their faces: no two share a face.
std::vector<Swap> independent(const std::vector<Swap>& swaps, std::size_t faces, const Context& context) {
  std::vector<std::atomic<std::uint64_t>> best(faces);
  for_each_index(context, swaps.size(), [&](std::size_t s) {
    for_footprint(swaps[s],
                  [&](Index f) { keep_first(best[f], priority(swaps[s].gain, s), std::greater<>()); });
  });
  return collect<Swap>(context, swaps.size(), [&](std::size_t s, auto&& emit) {
    bool wins = true;
    for_footprint(swaps[s], [&](Index f) { wins = wins && best[f].load() == priority(swaps[s].gain, s); });
    if (wins) emit(swaps[s]);
  });
}

/// Two swaps far apart in the list of faces may want the same new edge; the first keeps it.
void drop_repeated_diagonals(std::vector<Swap>& swaps, const Context& context) {
  struct Diagonal {
    Edge edge;
    std::size_t swap;
  };
  std::vector<Diagonal> diagonals(swaps.size());
  for (std::size_t s = 0; s < swaps.size(); ++s) diagonals[s] = {edge_between(swaps[s].c, swaps[s].d), s};
  parallel_sort(context, diagonals, [](const Diagonal& x, const Diagonal& y) {
    return x.edge != y.edge ? x.edge < y.edge : x.swap < y.swap;
  });
  std::vector<char> repeated(swaps.size(), 0);
  for (std::size_t k = 1; k < diagonals.size(); ++k)
    repeated[diagonals[k].swap] = diagonals[k].edge == diagonals[k - 1].edge;
  std::size_t kept = 0;
  for (std::size_t s = 0; s < swaps.size(); ++s)
    if (!repeated[s]) swaps[kept++] = swaps[s];
  swaps.resize(kept);
}

/// Replaces corner `from` by `to`, keeping the place and so the winding.
void replace_corner(Face& face, Index from, Index to) {
  *std::find(face.begin(), face.end(), from) = to;
}

void apply(const std::vector<Swap>& swaps, std::vector<Face>& faces, const Context& context) {
  for_each_index(context, swaps.size(), [&](std::size_t s) {
    const Swap& swap = swaps[s];
    Face first = faces[swap.f], second = first;
    replace_corner(first, swap.b, swap.d);   // abc -> adc
    replace_corner(second, swap.a, swap.d);  // abc -> dbc
    faces[swap.f] = first;
    faces[swap.g] = second;
  });
}

}  // namespace

std::size_t swap_edges(Mesh& mesh, const SwapOptions& options, const Context& context) {
  std::vector<Face> faces = mesh.faces;
  std::size_t made = 0;
  for (int round = 0; round < options.rounds; ++round) {
    const Swapper swapper(mesh, faces, options, context);
    const std::vector<Swap> candidates = proposals(swapper, mesh.positions.size(), context);
    auto swaps = independent(candidates, faces.size(), context);
    drop_repeated_diagonals(swaps, context);
    if (swaps.empty()) break;
    apply(swaps, faces, context);
    made += swaps.size();
  }
  if (made == 0) return 0;
  mesh.faces.swap(faces);
  try {
    rebuild_adjacency(mesh, context);
  } catch (...) {
    mesh.faces.swap(faces);
    throw;
  }
  return made;
}

}  // namespace rfsmooth::rfs_mesh
