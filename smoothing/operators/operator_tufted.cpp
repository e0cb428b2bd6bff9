#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "rfs_mesh/edge_faces.h"
#include "smoothing/operators/operator.h"

namespace rfsmooth::smoothing {

namespace {

/// Half-edge s of triangle t runs from corner s to corner s + 1; opposite is corner s + 2.
struct HalfEdge {
  Index triangle = kNone;
  int side = 0;
};

/// The tufted cover: every face twice, front and back, sides glued in pairs. Lengths instead of positions.
class Cover {
 public:
  Cover(const Mesh& mesh, double h) {
    const std::size_t n = mesh.faces.size();
    corner_.resize(2 * n);
    length_.resize(2 * n);
    twin_.resize(2 * n);
    for (std::size_t f = 0; f < n; ++f) {
      const Face& v = mesh.faces[f];
      corner_[2 * f] = v;
      corner_[2 * f + 1] = {v[0], v[2], v[1]};
    }
    for (std::size_t t = 0; t < 2 * n; ++t)
      for (std::size_t s = 0; s < 3; ++s)
        length_[t][s] = (mesh.positions[corner_[t][s]] - mesh.positions[corner_[t][(s + 1) % 3]]).norm();
    glue(mesh);
    mollify(h);
  }

  /// Flips sides until no two angles opposite a side sum to more than pi.
  void make_delaunay(const Context& context) {
    std::vector<HalfEdge> queue;
    for (Index t = 0; t < corner_.size(); ++t)
      for (int s = 0; s < 3; ++s) queue.push_back({t, s});
    std::size_t flips = 0;
    const std::size_t most = 100 * queue.size();  // rounding could go in circles; in theory it ends
    for (std::size_t next = 0; next < queue.size() && flips < most; ++next) {
      if (next % 4096 == 0) context.check_stop();
      const HalfEdge here = queue[next], there = twin(here);
      if (here.triangle == there.triangle || cot(here) + cot(there) >= -1e-10) continue;
      if (!flip(here, there)) continue;
      ++flips;
      for (const Index t : {here.triangle, there.triangle})
        for (int s = 0; s < 3; ++s) queue.push_back({t, s});
    }
  }

  std::size_t size() const { return corner_.size(); }
  Index corner(Index t, int s) const { return corner_[t][std::size_t(s % 3)]; }

  /// Cotangent of the angle opposite a side.
  double cot(HalfEdge at) const {
    const double a = length(at.triangle, at.side), b = length(at.triangle, at.side + 1),
                 c = length(at.triangle, at.side + 2);
    const double four = 4 * area(at.triangle);
    return four > 0 ? (b * b + c * c - a * a) / four : 0;
  }

  /// The share of corner s in the mixed area of its triangle.
  double corner_area(Index t, int s) const {
    const double whole = area(t);
    const std::array<double, 3> cots = {cot({t, s + 1}), cot({t, s + 2}), cot({t, s})};  // at s, s+1, s+2
    if (cots[0] < 0) return whole / 2;
    if (cots[1] < 0 || cots[2] < 0) return whole / 4;
    const double ahead = length(t, s), behind = length(t, s + 2);
    return (ahead * ahead * cots[2] + behind * behind * cots[1]) / 8;
  }

 private:
  double& length(Index t, int s) { return length_[t][std::size_t(s % 3)]; }
  double length(Index t, int s) const { return length_[t][std::size_t(s % 3)]; }
  HalfEdge twin(HalfEdge at) const { return twin_[at.triangle][std::size_t(at.side % 3)]; }
  void join(HalfEdge a, HalfEdge b) {
    twin_[a.triangle][std::size_t(a.side % 3)] = b;
    twin_[b.triangle][std::size_t(b.side % 3)] = a;
  }

  /// Kahan's form of Heron's, which does not cancel.
  double area(Index t) const {
    std::array<double, 3> l = length_[t];
    std::sort(l.begin(), l.end(), std::greater<>());
    const double under =
        (l[0] + (l[1] + l[2])) * (l[2] - (l[0] - l[1])) * (l[2] + (l[0] - l[1])) * (l[0] + (l[1] - l[2]));
    return under > 0 ? 0.25 * std::sqrt(under) : 0;
  }

  /// Around every edge the faces are sorted by angle; the side of each that looks at the next is glued to the
  /// side of the next that looks back.
  void glue(const Mesh& mesh) {
    using rfs_mesh::EdgeFace;
    rfs_mesh::for_each_edge(rfs_mesh::edge_faces(mesh.faces),
                            [&](const EdgeFace* first, const EdgeFace* end) {
                              const std::ptrdiff_t count = end - first;
                              std::vector<EdgeFace> turn;
                              if (count > 2) {
                                turn = rfs_mesh::by_angle(mesh, first, end);
                                first = turn.data();
                              }
                              for (std::ptrdiff_t k = 0; k < count; ++k)
                                join(up(first[k]), down(first[(k + 1) % count]));
                            });
  }

  /// The copy of the face whose side runs from a to b, and the one whose side runs back.
  static HalfEdge up(const rfs_mesh::EdgeFace& e) { return copy(e, e.forward); }
  static HalfEdge down(const rfs_mesh::EdgeFace& e) { return copy(e, !e.forward); }
  static HalfEdge copy(const rfs_mesh::EdgeFace& e, bool front) {
    return front ? HalfEdge{2 * e.face, int(e.corner)} : HalfEdge{2 * e.face + 1, 2 - int(e.corner)};
  }

  /// Lengthens all sides by the same, so that every triangle has room to spare in its inequality.
  void mollify(double h) {
    const double spare = 1e-5 * h;
    double more = 0;
    for (const auto& l : length_)
      for (std::size_t s = 0; s < 3; ++s)
        more = std::max(more, spare - (l[s] + l[(s + 1) % 3] - l[(s + 2) % 3]));
    for (auto& l : length_)
      for (double& side : l) side += more;
  }

  /// Replaces the diagonal i-j of the quadrilateral i, m, j, k by k-m. \return whether it did.
  bool flip(HalfEdge here, HalfEdge there) {
    const Index t = here.triangle, u = there.triangle;
    const int s = here.side, r = there.side;
    const Index i = corner(t, s), j = corner(t, s + 1), k = corner(t, s + 2), m = corner(u, r + 2);
    const double l = length(t, s), jk = length(t, s + 1), ki = length(t, s + 2), im = length(u, r + 1),
                 mj = length(u, r + 2);
    // Unfolded: i at the origin, j at (l, 0), k above, m below.
    const double kx = (l * l + ki * ki - jk * jk) / (2 * l), mx = (l * l + im * im - mj * mj) / (2 * l);
    const double height = 2 * (area(t) + area(u)) / l;
    const double km = std::hypot(kx - mx, height);
    if (!(km > 0) || !std::isfinite(km)) return false;
    const std::array<HalfEdge, 4> old = {HalfEdge{u, r + 1}, {t, s + 2}, {u, r + 2}, {t, s + 1}};
    const std::array<HalfEdge, 4> now = {HalfEdge{t, 0}, {t, 2}, {u, 0}, {u, 1}};
    std::array<HalfEdge, 4> outer;
    for (std::size_t e = 0; e < 4; ++e) {
      outer[e] = twin(old[e]);
      for (std::size_t o = 0; o < 4; ++o)  // two sides of the quadrilateral may be glued to each other
        if (outer[e].triangle == old[o].triangle && outer[e].side % 3 == old[o].side % 3) {
          outer[e] = now[o];
          break;
        }
    }
    corner_[t] = {i, m, k};
    corner_[u] = {m, j, k};
    length_[t] = {im, km, ki};
    length_[u] = {mj, jk, km};
    for (std::size_t e = 0; e < 4; ++e) join(now[e], outer[e]);
    join({t, 1}, {u, 2});
    return true;
  }

  std::vector<std::array<Index, 3>> corner_;
  std::vector<std::array<double, 3>> length_;
  std::vector<std::array<HalfEdge, 3>> twin_;
};

}  // namespace

Operator tufted(const Mesh& mesh, const Context& context) {
  const std::size_t n = mesh.positions.size();
  const double h = length_unit(mesh, context);
  Cover cover(mesh, h);
  cover.make_delaunay(context);

  std::vector<Edge> edges;
  for (Index t = 0; t < cover.size(); ++t)
    for (int s = 0; s < 3; ++s) edges.push_back({cover.corner(t, s), cover.corner(t, s + 1)});
  Operator op;
  op.unit = h * h;
  op.own_rows = rfsmooth::make_adjacency(n, edges, context);
  const Adjacency& rows = *op.own_rows;
  op.weight.assign(rows.items.size(), 0);
  std::vector<double> area(n, 0);
  const auto add = [&](Index i, Index j, double w) { op.weight[item_of(rows, i, j)] += w; };
  for (Index t = 0; t < cover.size(); ++t)
    for (int s = 0; s < 3; ++s) {
      const Index i = cover.corner(t, s), j = cover.corner(t, s + 1);
      area[i] += 0.5 * cover.corner_area(t, s);  // half: the cover is everything twice
      if (i == j) continue;
      const double w = 0.25 * cover.cot({t, s});
      add(i, j, w);
      add(j, i, w);
    }
  for (double& w : op.weight) w = std::max(0.0, w);  // what rounding left below zero
  op.mass.resize(n);
  for (std::size_t i = 0; i < n; ++i) op.mass[i] = area[i] > 0 ? 2 * area[i] : op.unit;
  return op;
}

}  // namespace rfsmooth::smoothing
