/// What simultaneous HC converges to, in one solve.
///
///     [B + c (D - W) D^-1 (D - W)] x = B o,   B = beta D + (1 - beta) W,   c = (1 - beta) / alpha
///
/// W = adjacency, D = degrees. Derived from Vollmer, Mencl, Mueller 1999, section 4: the fixed point of the
/// step T x - [beta + (1 - beta) T] (T x - alpha o - (1 - alpha) x). Positive definite for alpha > 0, beta >
/// 1/2 (the conditions of theorem 5.2). Fixed vertices: W over movable ones, full degrees in D, and the right
/// side gains c (D - W) r with r the fixed neighbours' share of T x. Constraints to an axis or a plane, and
/// strengths, are HC's own per-step rules and are refused here.
#include "base/parallel.h"
#include "rfs_mesh/measure.h"
#include "smoothing/integrators/solved_flow.h"

namespace rfsmooth {

using namespace smoothing;

namespace {

using Eigen::Vector3d;

/// The system above, A x = b, of one mesh. Isolated vertices have a unit row, fixed ones too: both stay.
class HcSystem {
 public:
  HcSystem(const Adjacency& rows, const std::vector<char>& fixed, double beta, double c,
           const Context& context)
      : rows_(rows), fixed_(fixed), beta_(beta), c_(c), context_(context), laplacian_(rows.size()) {}

  bool stays(std::size_t i) const { return fixed_[i] != 0 || rows_.degree(i) == 0; }

  /// y = A x; returns x . y.
  double multiply(const Positions& x, Positions& y) {
    for_each_index(context_, rows_.size(), [&](std::size_t i) {
      const Vector3d w = adjacent(x, i);
      laplacian_[i] = stays(i) ? Vector3d(Vector3d::Zero()) : Vector3d(x[i] - w / degree(i));
      y[i] = stays(i) ? x[i] : Vector3d(beta_ * degree(i) * x[i] + (1 - beta_) * w);
    });
    return sum_over(context_, rows_.size(), 0.0, [&](std::size_t i) {
      if (!stays(i)) y[i] += c_ * (degree(i) * laplacian_[i] - adjacent(laplacian_, i));
      return x[i].dot(y[i]);
    });
  }

  std::vector<double> diagonal() const {
    std::vector<double> diagonal(rows_.size(), 1);
    for_each_index(context_, rows_.size(), [&](std::size_t i) {
      if (stays(i)) return;
      double of_square = degree(i);
      for (const Index j : rows_[i])
        if (fixed_[j] == 0) of_square += 1 / degree(j);
      diagonal[i] = beta_ * degree(i) + c_ * of_square;
    });
    return diagonal;
  }

  /// D, in which the norm of the residual is measured.
  std::vector<double> mass() const {
    std::vector<double> mass(rows_.size());
    for_each_index(context_, rows_.size(), [&](std::size_t i) { mass[i] = std::max(1.0, degree(i)); });
    return mass;
  }

  /// b. \param original o. \param at where the fixed vertices are
  Positions right_side(const Positions& original, const Positions& at) const {
    Positions r(rows_.size(), Vector3d::Zero()), b(rows_.size(), Vector3d::Zero());
    for_each_index(context_, rows_.size(), [&](std::size_t i) {
      if (stays(i)) return;
      for (const Index j : rows_[i])
        if (fixed_[j] != 0) r[i] += at[j] / degree(i);
    });
    for_each_index(context_, rows_.size(), [&](std::size_t i) {
      if (stays(i)) return;
      b[i] = beta_ * degree(i) * original[i] + (1 - beta_) * adjacent(original, i) +
             c_ * (degree(i) * r[i] - adjacent(r, i));
    });
    return b;
  }

 private:
  double degree(std::size_t i) const { return double(rows_.degree(i)); }
  /// (W x)_i: over the movable neighbours.
  Vector3d adjacent(const Positions& x, std::size_t i) const {
    Vector3d sum = Vector3d::Zero();
    for (const Index j : rows_[i])
      if (fixed_[j] == 0) sum += x[j];
    return sum;
  }

  const Adjacency& rows_;
  const std::vector<char>& fixed_;
  double beta_, c_;
  const Context& context_;
  Positions laplacian_;  ///< D^-1 (D - W) x
};

class HcLimit : public SolvedFlow {
 public:
  HcLimit(const Mesh& mesh, const HcLimitOptions& options, const Constraints& constraints)
      : SolvedFlow(options), beta_(options.beta), c_((1 - beta_) / options.alpha), original_(mesh.positions) {
    fixed_.assign(mesh.positions.size(), 0);
    for (const HardConstraint& constraint : constraints.hard) fixed_.at(constraint.vertex) = 1;
  }

  void step(Mesh& mesh, const Context& context) override {
    const std::size_t n = mesh.positions.size();
    const Vector3d centre = rfs_mesh::centroid(original_, context);
    HcSystem system(mesh.one_ring, fixed_, beta_, c_, context);
    Positions original(n), at(n), x(n, Vector3d::Zero());
    for_each_index(context, n, [&](std::size_t i) {
      original[i] = original_[i] - centre;
      at[i] = mesh.positions[i] - centre;
      if (!system.stays(i)) x[i] = at[i];
    });
    const Product product = [&](const Positions& from, Positions& to) { return system.multiply(from, to); };
    count(conjugate_gradients({product, system.diagonal(), system.mass()}, system.right_side(original, at), x,
                              {}, solver_, context));
    for_each_index(context, n, [&](std::size_t i) {
      if (const Vector3d p = x[i] + centre; !system.stays(i) && p.allFinite()) mesh.positions[i] = p;
    });
  }

 private:
  double beta_, c_;
  Positions original_;
  std::vector<char> fixed_;
};

}  // namespace

std::unique_ptr<Flow> HcLimitOptions::start(const Mesh& mesh, const Constraints& constraints,
                                            const Context&) const {
  if (!(alpha > 0 && beta > 0.5))
    throw Failure({ErrorCode::usage, "HC has a limit for `alpha` above 0 and `beta` above 0.5 only"});
  for (const HardConstraint& constraint : constraints.hard)
    if (constraint.kind != HardConstraint::Kind::fixed)
      throw Failure({ErrorCode::usage, "hc-limit takes fixed vertices only; use hc, or implicit"});
  for (const double s : constraints.strength)
    if (s != 0 && s != 1)
      throw Failure({ErrorCode::usage, "hc-limit takes strengths of 0 and 1 only; use hc, or implicit"});
  Constraints fixed = constraints;
  for (Index i = 0; i < constraints.strength.size(); ++i)
    if (constraints.strength[i] == 0)
      fixed.hard.push_back({i, HardConstraint::Kind::fixed, Vector3d::Zero()});
  fixed.strength.clear();
  return std::make_unique<HcLimit>(mesh, *this, fixed);
}

}  // namespace rfsmooth
