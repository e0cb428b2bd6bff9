#include "smoothing/modifiers/boundary.h"

#include <algorithm>

#include "base/parallel.h"
#include "smoothing/modifiers/constraint.h"
#include "smoothing/modifiers/wrapped_flow.h"
#include "smoothing/operators/operator.h"

namespace rfsmooth::smoothing {

using Eigen::Vector3d;
using rfsmooth::Adjacency;
using rfsmooth::Edge;
using rfsmooth::Mesh;

std::vector<Edge> boundary_edges(const Mesh& mesh) {
  std::vector<Edge> sides;
  sides.reserve(3 * mesh.faces.size());
  for (const Face& f : mesh.faces)
    for (int k = 0; k < 3; ++k) sides.push_back({f[k], f[(k + 1) % 3]});
  const auto key = [](const Edge& e) { return std::pair(std::min(e[0], e[1]), std::max(e[0], e[1])); };
  std::sort(sides.begin(), sides.end(),
            [&](const Edge& a, const Edge& b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  std::vector<Edge> single;
  for (std::size_t s = 0; s < sides.size();) {
    std::size_t end = s + 1;
    while (end < sides.size() && key(sides[end]) == key(sides[s])) ++end;
    if (end == s + 1) single.push_back(sides[s]);
    s = end;
  }
  return single;
}

namespace {

/// The constraints with the boundary vertices fixed too.
Constraints with_fixed_boundary(const Constraints& constraints, const Adjacency& curve) {
  Constraints all = constraints;
  std::vector<char> taken(curve.size(), 0);
  for (const HardConstraint& c : all.hard)
    if (c.vertex < taken.size()) taken[c.vertex] = 1;
  for (HardConstraint& c : all.hard)
    if (c.vertex < taken.size() && curve.degree(c.vertex) > 0) c.kind = HardConstraint::Kind::fixed;
  for (Index i = 0; i < curve.size(); ++i)
    if (curve.degree(i) > 0 && taken[i] == 0)
      all.hard.push_back({i, HardConstraint::Kind::fixed, Vector3d::Zero()});
  return all;
}

/// The boundary smooths itself as a curve, then the flow moves the rest.
class BoundaryCurve : public WrappedFlow {
 public:
  BoundaryCurve(std::unique_ptr<Flow> inner, Adjacency curve, AllowedMoves allowed)
      : WrappedFlow(std::move(inner)), curve_(std::move(curve)), allowed_(std::move(allowed)) {}

  void step(Mesh& mesh, const Context& context) override {
    const Positions& x = mesh.positions;
    const double h = length_unit(mesh, context);
    Positions next = x;
    for_each_index(context, x.size(), [&](std::size_t i) {
      if (curve_.degree(i) != 2) return;
      const Vector3d back = x[curve_[i][0]] - x[i], on = x[curve_[i][1]] - x[i];
      const double d = back.norm(), D = on.norm();
      if (!(d > 0 && D > 0)) return;
      // The scheme's own limit is d D / 2: a quarter of h^2 beyond it would overshoot at short edges.
      const double step = std::min(0.25 * h * h, 0.5 * d * D);
      const Vector3d p = x[i] + allowed_.strength(i) * allowed_(i, step * 2 / (d + D) * (back / d + on / D));
      if (p.allFinite()) next[i] = p;
    });
    mesh.positions.swap(next);
    inner_->step(mesh, context);
  }

 private:
  Adjacency curve_;
  AllowedMoves allowed_;
};

/// The mesh with a virtual vertex over every boundary loop.
class VirtualVertices : public WrappedFlow {
 public:
  VirtualVertices(const Mesh& mesh, const Constraints& constraints, const FlowMaker& make,
                  const Context& context)
      : WrappedFlow(nullptr) {
    close(mesh, context);
    Constraints all = constraints;
    if (!all.strength.empty()) all.strength.resize(closed_.positions.size(), 1);
    inner_ = make(closed_, all);
  }

  void step(Mesh& mesh, const Context& context) override {
    place(mesh);
    inner_->step(closed_, context);
    std::copy_n(closed_.positions.begin(), mesh.positions.size(), mesh.positions.begin());
  }

  void connectivity_changed(const Mesh& mesh, const Context& context) override {
    close(mesh, context);
    WrappedFlow::connectivity_changed(closed_, context);
  }

 private:
  /// Rebuilds closed_; a flow under way keeps its number of vertices, so later loops beyond it stay open.
  void close(const Mesh& mesh, const Context& context) {
    const std::size_t n = mesh.positions.size();
    const std::vector<Edge> edges = boundary_edges(mesh);
    std::vector<Index> root(n);
    for (Index i = 0; i < n; ++i) root[i] = i;
    const auto find = [&](Index i) {
      while (root[i] != i) i = root[i] = root[root[i]];
      return i;
    };
    for (const Edge& e : edges) {
      const Index a = find(e[0]), b = find(e[1]);
      root[std::max(a, b)] = std::min(a, b);
    }
    const std::size_t room = inner_ ? loops_.size() : edges.size();
    loops_.assign(inner_ ? room : 0, {});
    std::vector<Index> loop_of(n, kNone);
    closed_.faces = mesh.faces;
    closed_.loose_edges = mesh.loose_edges;
    std::size_t used = 0;
    for (const Edge& e : edges) {
      const Index r = find(e[0]);
      if (loop_of[r] == kNone) {
        if (used == room) continue;
        loop_of[r] = Index(used++);
        if (!inner_) loops_.emplace_back();
      }
      closed_.faces.push_back({e[1], e[0], Index(n + loop_of[r])});
      loops_[loop_of[r]].push_back(e[0]);
      loops_[loop_of[r]].push_back(e[1]);
    }
    place(mesh);
    rebuild_adjacency(closed_, context);
  }

  /// Every loop vertex is listed twice, so the mean of the list is the barycentre.
  void place(const Mesh& mesh) {
    closed_.positions = mesh.positions;
    for (const std::vector<Index>& loop : loops_) {
      Vector3d sum = Vector3d::Zero();
      for (const Index i : loop) sum += mesh.positions[i];
      closed_.positions.push_back(sum / double(std::max<std::size_t>(1, loop.size())));
    }
  }

  Mesh closed_;
  std::vector<std::vector<Index>> loops_;
};

}  // namespace

std::unique_ptr<Flow> with_boundary_rule(const std::string& rule, const Mesh& mesh,
                                         const Constraints& constraints, const Context& context,
                                         const FlowMaker& make) {
  if (rule == "free") return make(mesh, constraints);
  AllowedMoves allowed(constraints, mesh.positions.size());
  if (rule == "virtual") return std::make_unique<VirtualVertices>(mesh, constraints, make, context);
  Adjacency curve = rfsmooth::make_adjacency(mesh.positions.size(), boundary_edges(mesh), context);
  std::unique_ptr<Flow> inner = make(mesh, with_fixed_boundary(constraints, curve));
  if (rule == "fixed") return inner;
  return std::make_unique<BoundaryCurve>(std::move(inner), std::move(curve), std::move(allowed));
}

}  // namespace rfsmooth::smoothing
