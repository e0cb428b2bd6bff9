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

class HcLimit : public SolvedFlow {
 public:
  HcLimit(const Mesh& mesh, const HcLimitOptions& options, const Constraints& constraints)
      : SolvedFlow(options), beta_(options.beta), c_((1 - beta_) / options.alpha), original_(mesh.positions) {
    fixed_.assign(mesh.positions.size(), 0);
    for (const HardConstraint& constraint : constraints.hard) fixed_.at(constraint.vertex) = 1;
  }

  void step(Mesh& mesh, const Context& context) override {
    const std::size_t n = mesh.positions.size();
    const Adjacency& rows = mesh.one_ring;
    const auto degree = [&](std::size_t i) { return double(rows.degree(i)); };
    // Isolated vertices get a unit row, fixed ones too: both keep their place.
    const auto still = [&](std::size_t i) { return fixed_[i] != 0 || rows.degree(i) == 0; };
    const Vector3d centre = rfs_mesh::centroid(original_, context);
    // Sum of x over the movable neighbours: (W x)_i.
    const auto movable_sum = [&](const Positions& x, std::size_t i) {
      Vector3d sum = Vector3d::Zero();
      for (const Index j : rows[i])
        if (!fixed_[j]) sum += x[j];
      return sum;
    };
    Positions level(n);
    const Product product = [&](const Positions& x, Positions& y) {
      for_each_index(context, n, [&](std::size_t i) {
        const Vector3d w = movable_sum(x, i);
        level[i] = still(i) ? Vector3d(Vector3d::Zero()) : Vector3d(x[i] - w / degree(i));
        y[i] = still(i) ? x[i] : Vector3d(beta_ * degree(i) * x[i] + (1 - beta_) * w);
      });
      return sum_over(context, n, 0.0, [&](std::size_t i) {
        if (!still(i)) y[i] += c_ * (degree(i) * level[i] - movable_sum(level, i));
        return x[i].dot(y[i]);
      });
    };
    Positions x(n), b(n), original(n), share(n);  // share: of the fixed neighbours in the mean of all, known
    std::vector<double> diagonal(n), mass(n);
    for_each_index(context, n, [&](std::size_t i) {
      original[i] = original_[i] - centre;
      x[i] = still(i) ? Vector3d(Vector3d::Zero()) : Vector3d(mesh.positions[i] - centre);
      share[i].setZero();
      double second = degree(i);
      for (const Index j : rows[i]) {
        if (fixed_[j])
          share[i] += (mesh.positions[j] - centre) / degree(i);
        else
          second += 1 / degree(j);
      }
      if (still(i)) share[i].setZero();
      mass[i] = std::max(1.0, degree(i));
      diagonal[i] = still(i) ? 1 : beta_ * degree(i) + c_ * second;
    });
    for_each_index(context, n, [&](std::size_t i) {
      b[i].setZero();
      if (still(i)) return;
      b[i] = beta_ * degree(i) * original[i] + (1 - beta_) * movable_sum(original, i) +
             c_ * (degree(i) * share[i] - movable_sum(share, i));
    });
    count(conjugate_gradients(product, diagonal, mass, b, x, {}, solver_, context));
    for_each_index(context, n, [&](std::size_t i) {
      if (const Vector3d p = x[i] + centre; !still(i) && p.allFinite()) mesh.positions[i] = p;
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
