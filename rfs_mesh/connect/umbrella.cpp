#include "rfs_mesh/connect/umbrella.h"

#include <algorithm>
#include <cmath>

#include "base/avx2.h"
#include "base/parallel.h"
#include "base/quantile.h"
#include "rfs_mesh/fit/tangent_plane.h"
#include "rfs_mesh/measure.h"

namespace rfsmooth::rfs_mesh {

namespace {

constexpr std::size_t kMostCandidates = 96;  ///< SDG neighbours and nearest ones together

/// Kept in order: nearest neighbours come nearest first and find their place at once.
struct Candidates {
  std::array<Neighbor, kMostCandidates> items;
  std::size_t count = 0;
  void add(const Neighbor& candidate) {
    if (count == items.size()) return;
    std::size_t at = count;
    for (; at > 0 && candidate < items[at - 1]; --at) items[at] = items[at - 1];
    items[at] = candidate;
    ++count;
  }
  void add_new(const Neighbor& candidate) {
    bool known = false;
    for (std::size_t k = 0; k < count; ++k) known |= items[k].index == candidate.index;
    if (!known) add(candidate);
  }
  auto begin() const { return items.begin(); }
  auto end() const { return items.begin() + std::ptrdiff_t(count); }
};

/// A rib and its direction in the tangent plane.
struct Rib {
  double angle;
  Index point;
};

class Opener {
 public:
  Opener(const Terrain& terrain, const Adjacency& graph, const UmbrellaOptions& options)
      : terrain_(terrain),
        at_(terrain.at),
        graph_(graph),
        options_(options),
        cos_normal_(std::cos(radians(options.normal_angle))),
        cos_rib_(std::cos(radians(options.rib_angle))) {}

  Umbrella open(Index v) const {
    if (terrain_.is_between(v)) return {};
    std::array<Rib, kMostRibs> ribs;
    const std::size_t count = choose_ribs(v, ribs);
    Umbrella umbrella;
    umbrella.count = std::uint8_t(count);
    for (std::size_t k = 0; k < count; ++k) umbrella.ribs[k] = ribs[k].point;
    span_faces(v, ribs, umbrella);
    return umbrella;
  }

 private:
  double squared(Index a, Index b) const { return (at_[a] - at_[b]).squaredNorm(); }

  /// The 90th percentile of the lengths of the SDG edges of v and of its neighbours, of the first of them
  /// where there are more than fit.
  RFSMOOTH_AVX2 double long_edge(Index v) const {
    std::array<float, kMostCandidates> squares;
    std::size_t count = 0;
    const auto full = [&] { return count == squares.size(); };
    const auto add = [&](Index a, Index b) { squares[count++] = float(squared(a, b)); };
    for (const Index a : graph_[v]) {
      if (full()) break;
      add(v, a);
      for (const Index b : graph_[a]) {
        if (full()) break;
        if (b != v) add(a, b);
      }
    }
    return count > 0 ? std::sqrt(double(nth_of_few(squares, count, count * 9 / 10))) : 0;
  }

  /// The SDG neighbours of v and k_v nearest ones, nearest first.
  Candidates candidates(Index v) const {
    Candidates found;
    const double radius = options_.fill * long_edge(v);
    int nearest = 0;
    for (const Index q : terrain_.near[v]) {
      if (terrain_.is_between(q)) continue;
      const double d = squared(v, q);
      if (nearest >= options_.most || (nearest >= options_.fewest && d > radius * radius)) break;
      found.add({q, d});
      ++nearest;
    }
    for (const Index q : graph_[v]) found.add_new({q, squared(v, q)});
    return found;
  }

  bool along_surface(Index v, Index q) const {
    return terrain_.is_along(v, q, at_[q] - at_[v], cos_normal_, options_.steepness);
  }

  /// The ribs of v, by angle; how many.
  std::size_t choose_ribs(Index v, std::array<Rib, kMostRibs>& ribs) const {
    const TangentPlane plane(terrain_.surfaces[v].normal);
    std::size_t count = 0;
    std::array<Eigen::Vector2d, kMostRibs> taken;  // unit directions
    for (const Neighbor& c : candidates(v)) {
      if (count == ribs.size()) break;
      if (!(c.squared_distance > 0)) continue;
      const Eigen::Vector2d d = plane.project(at_[c.index] - at_[v]);
      const double length = d.norm(), close = cos_rib_ * length;
      bool free = true;
      for (std::size_t k = 0; k < count; ++k) free = free && !(taken[k].dot(d) > close);
      if (!free || !along_surface(v, c.index)) continue;
      taken[count] = length > 0 ? Eigen::Vector2d(d / length) : Eigen::Vector2d::UnitX();
      ribs[count++] = {direction(d[0], d[1]), c.index};
    }
    std::sort(ribs.begin(), ribs.begin() + std::ptrdiff_t(count), [](const Rib& a, const Rib& b) {
      return a.angle != b.angle ? a.angle < b.angle : a.point < b.point;
    });
    return count;
  }

  void span_faces(Index v, const std::array<Rib, kMostRibs>& ribs, Umbrella& umbrella) const {
    if (umbrella.count < 2) return;
    const double widest = radians(options_.face_angle);
    for (int k = 0; k < umbrella.count; ++k) {
      const Index a = umbrella.ribs[std::size_t(k)], b = umbrella.next(k);
      const double gap =
          turn(ribs[std::size_t(k)].angle, ribs[std::size_t(k + 1 == umbrella.count ? 0 : k + 1)].angle);
      if (gap > 0 && gap <= widest && face_quality(at_[v], at_[a], at_[b]) >= options_.quality)
        umbrella.faces = std::uint16_t(umbrella.faces | 1u << k);
    }
  }

  const Terrain& terrain_;
  const Positions& at_;
  const Adjacency& graph_;
  const UmbrellaOptions& options_;
  double cos_normal_, cos_rib_;
};

}  // namespace

std::vector<Umbrella> open_umbrellas(const Terrain& terrain, const Adjacency& graph,
                                     const UmbrellaOptions& options, const Context& context) {
  std::vector<Umbrella> umbrellas(terrain.at.size());
  const Opener opener(terrain, graph, options);
  for_each_index(
      context, umbrellas.size(), [&](std::size_t v) { umbrellas[v] = opener.open(Index(v)); }, 256);
  return umbrellas;
}

}  // namespace rfsmooth::rfs_mesh
