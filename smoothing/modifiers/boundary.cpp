#include "smoothing/modifiers/boundary.h"

#include <algorithm>
#include <variant>

#include "base/disjoint_sets.h"
#include "rfs_mesh/edge_faces.h"
#include "smoothing/integrators/operator_speed.h"
#include "smoothing/modifiers/constraint.h"
#include "smoothing/modifiers/pushback.h"
#include "smoothing/modifiers/wrapped_flow.h"

namespace rfsmooth::smoothing {

using Eigen::Vector3d;

std::vector<Edge> boundary_edges(const Mesh& mesh) {
  using rfs_mesh::EdgeFace;
  std::vector<Edge> single;
  rfs_mesh::for_each_edge(rfs_mesh::edge_faces(mesh.faces), [&](const EdgeFace* first, const EdgeFace* last) {
    if (last - first == 1)
      single.push_back(first->forward ? Edge{first->a, first->b} : Edge{first->b, first->a});
  });
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

/// Flows that solve a system for each step.
bool is_implicit(const AnyFlow& flow) {
  return std::holds_alternative<ImplicitOptions>(flow) ||
         std::holds_alternative<DiscreteFairingOptions>(flow) || std::holds_alternative<HcLimitOptions>(flow);
}

/// The flow along a curve (a mesh of loose edges) that belongs to each flow of a surface.
struct AlongCurve {
  const Mesh& curve;
  const Constraints& constraints;
  const Context& context;

  /// Flows of umbrellas, as they are.
  template <class Umbrellas>
  std::unique_ptr<Flow> start(const Umbrellas& flow) const {
    return flow.start(curve, constraints, context);
  }
  std::unique_ptr<Flow> operator()(const LaplacianOptions& flow) const { return start(flow); }
  std::unique_ptr<Flow> operator()(const HcOptions& flow) const { return start(flow); }
  std::unique_ptr<Flow> operator()(const HcLimitOptions& flow) const { return start(flow); }
  std::unique_ptr<Flow> operator()(const TaubinOptions& flow) const { return start(flow); }
  std::unique_ptr<Flow> operator()(const BilaplacianOptions& flow) const { return start(flow); }

  std::unique_ptr<Flow> operator()(ImplicitOptions flow) const {
    flow.op = OperatorKind::scale_dependent;
    return start(flow);
  }
  std::unique_ptr<Flow> operator()(const DiscreteFairingOptions& flow) const {
    ImplicitOptions implicit;
    implicit.dt = flow.dt;
    implicit.tolerance = flow.tolerance;
    implicit.norm = flow.norm;
    return (*this)(implicit);
  }

  std::unique_ptr<Flow> operator()(const AutomaticOptions&) const {
    return by_speed(0.25);  // no step of its own: half of what is stable on a curve
  }
  template <class Explicit>
  std::unique_ptr<Flow> operator()(const Explicit& flow) const {
    return by_speed(flow.lambda);
  }
  /// Flows without an umbrella: -h^2 L x with L the scale-dependent operator.
  std::unique_ptr<Flow> by_speed(double lambda) const {
    return make_explicit(make_operator_speed(OperatorKind::scale_dependent, lambda, Scheme::safe), lambda,
                         AllowedMoves(constraints, curve.positions.size()));
  }
};

/// The flow of the options along a curve (a mesh of loose edges).
std::unique_ptr<Flow> curve_flow(const FlowOptions& options, const Mesh& curve,
                                 const Constraints& constraints, const Context& context) {
  AllowedMoves allowed(constraints, curve.positions.size());
  std::unique_ptr<Flow> flow = std::visit(AlongCurve{curve, constraints, context}, options.flow);
  if (!flow->applies_constraints()) flow = make_constrained(std::move(flow), allowed);
  const Modifiers& m = options.modifiers;
  if (m.push_back)
    flow = make_pushback(std::move(flow), curve, m.push_alpha, m.push_beta, std::move(allowed));
  return flow;
}

/// The boundary alone, and the constraints on it.
struct Curve {
  Mesh mesh;              ///< its vertices, and its edges as loose ones
  std::vector<Index> of;  ///< the vertices of the whole mesh that they are, ascending
  Constraints constraints;
};

Curve curve_of(const Mesh& mesh, const Adjacency& boundary, const Constraints& constraints,
               const Context& context) {
  Curve curve;
  std::vector<Index> place(boundary.size(), kNone);
  for (Index i = 0; i < boundary.size(); ++i) {
    if (boundary.degree(i) == 0) continue;
    place[i] = Index(curve.of.size());
    curve.of.push_back(i);
    curve.mesh.positions.push_back(mesh.positions[i]);
    if (!constraints.strength.empty()) curve.constraints.strength.push_back(constraints.strength.at(i));
  }
  for (const Edge& e : rfsmooth::edges_of(boundary, context))
    curve.mesh.loose_edges.push_back({place[e[0]], place[e[1]]});
  rebuild_adjacency(curve.mesh, context);
  std::vector<char> taken(curve.of.size(), 0);
  for (HardConstraint c : constraints.hard) {
    if (c.vertex >= place.size() || place[c.vertex] == kNone) continue;
    if (boundary.degree(c.vertex) != 2) c.kind = HardConstraint::Kind::fixed;
    c.vertex = place[c.vertex];
    taken[c.vertex] = 1;
    curve.constraints.hard.push_back(c);
  }
  for (Index k = 0; k < curve.of.size(); ++k)
    if (taken[k] == 0 && boundary.degree(curve.of[k]) != 2)
      curve.constraints.hard.push_back({k, HardConstraint::Kind::fixed, Vector3d::Zero()});
  return curve;
}

/// The boundary follows its own flow; the flow of the rest sees it as fixed.
class BoundaryCurve : public WrappedFlow {
 public:
  /// \param first whether the rest is to see the boundary where it goes to, not where it was.
  BoundaryCurve(std::unique_ptr<Flow> inner, std::unique_ptr<Flow> along, Curve curve, bool first)
      : WrappedFlow(std::move(inner)), along_(std::move(along)), curve_(std::move(curve)), first_(first) {}

  void step(Mesh& mesh, const Context& context) override {
    for (std::size_t k = 0; k < curve_.of.size(); ++k)
      curve_.mesh.positions[k] = mesh.positions[curve_.of[k]];
    along_->step(curve_.mesh, context);
    if (!first_) inner_->step(mesh, context);
    for (std::size_t k = 0; k < curve_.of.size(); ++k)
      mesh.positions[curve_.of[k]] = curve_.mesh.positions[k];
    if (first_) inner_->step(mesh, context);
  }

  SolverSummary solver() const override {
    SolverSummary both = inner_->solver();
    return both += along_->solver();
  }

 private:
  std::unique_ptr<Flow> along_;
  Curve curve_;
  bool first_;
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
    std::copy(mesh.positions.begin(), mesh.positions.end(), closed_.positions.begin());
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
    DisjointSets<Index> rims(n);
    for (const Edge& e : edges) rims.join(e[0], e[1]);
    const std::size_t room = inner_ ? loops_.size() : edges.size();
    loops_.assign(inner_ ? room : 0, {});
    std::vector<Index> loop_of(n, kNone);
    closed_.faces = mesh.faces;
    closed_.loose_edges = mesh.loose_edges;
    std::size_t used = 0;
    for (const Edge& e : edges) {
      const Index r = rims.of(e[0]);
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
    closed_.closing = Index(n);
    rebuild_adjacency(closed_, context);
  }

  /// Every loop vertex is listed twice, so the mean of the list is the barycentre. Virtual vertices that are
  /// there already stay.
  void place(const Mesh& mesh) {
    const Positions before = closed_.positions;
    closed_.positions = mesh.positions;
    for (const std::vector<Index>& loop : loops_) {
      if (closed_.positions.size() < before.size()) {
        closed_.positions.push_back(before[closed_.positions.size()]);
        continue;
      }
      Vector3d sum = Vector3d::Zero();
      for (const Index i : loop) sum += mesh.positions[i];
      closed_.positions.push_back(sum / double(std::max<std::size_t>(1, loop.size())));
    }
  }

  Mesh closed_;
  std::vector<std::vector<Index>> loops_;
};

}  // namespace

std::unique_ptr<Flow> with_boundary_rule(const FlowOptions& options, const Mesh& mesh,
                                         const Constraints& constraints, const Context& context,
                                         const FlowMaker& make) {
  const Boundary rule = options.modifiers.boundary;
  if (rule == Boundary::free) return make(mesh, constraints);
  (void)AllowedMoves(constraints, mesh.positions.size());  // throws for those that do not fit this mesh
  if (rule == Boundary::virtual_vertices)
    return std::make_unique<VirtualVertices>(mesh, constraints, make, context);
  const Adjacency boundary = rfsmooth::make_adjacency(mesh.positions.size(), boundary_edges(mesh), context);
  std::unique_ptr<Flow> inner = make(mesh, with_fixed_boundary(constraints, boundary));
  if (rule == Boundary::fixed) return inner;
  Curve curve = curve_of(mesh, boundary, constraints, context);
  auto along = curve_flow(options, curve.mesh, curve.constraints, context);
  return std::make_unique<BoundaryCurve>(std::move(inner), std::move(along), std::move(curve),
                                         is_implicit(options.flow));
}

}  // namespace rfsmooth::smoothing
