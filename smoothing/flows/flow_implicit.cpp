/// Implicit fairing: one linear solve per step, stable for any time step.
///
///     (I + dt [(1 - m) L^k + m L]) X = X_n,   k = order, m = mixture
///
/// Desbrun et al. 1999, 2.3-2.6, 4 and 5.4; L = umbrella, scale-dependent umbrella or curvature operator. dt
/// is dimensionless (times h^2 for operators of unit 1/length^2, h^4 for their square). Weights are frozen
/// during a step and, with keep_weights, for all steps. A negative mixture enhances middle frequencies (2.6);
/// it must leave the system positive definite. Soft constraints are a data mass m / s (the paper's variable
/// lambda). Differs from the paper: the symmetric form and conjugate gradients instead of BiCG (see
/// solver.h).
#include <cmath>

#include "base/parallel.h"
#include "smoothing/integrators/solved_flow.h"

namespace rfsmooth {

using namespace smoothing;

namespace {

class ImplicitFlow : public SolvedFlow {
 public:
  ImplicitFlow(const ImplicitOptions& options, AllowedMoves allowed)
      : SolvedFlow(options),
        source_(options.op, options.keep_weights, options.scheme),
        printed_(options.scheme == Scheme::printed && options.order == 2),
        allowed_(std::move(allowed)) {
    const double dt = options.dt, m = options.mixture;
    a_[options.order - 1] = dt * (1 - m);
    a_[0] += dt * m;
  }

  void step(Mesh& mesh, const Context& context) override {
    const Operator& op = source_.on(mesh, context);
    Fairing system{op.rows(mesh), op, a_, {}, {}};
    double unit = 1;
    for (double& a : system.a) a *= unit *= op.unit;
    if (allowed_.has_strengths()) {
      system.data = op.mass;
      for_each_index(context, system.data.size(), [&](std::size_t i) {
        if (const double s = allowed_.strength(i); s > 0) system.data[i] /= s;
      });
    }
    if (printed_ && !allowed_.all_free()) {  // 2.7: "fixed if we impose L(x_i) = 0"
      system.strength.resize(op.mass.size());
      for_each_index(context, system.strength.size(), [&](std::size_t i) {
        system.strength[i] = allowed_(i, Eigen::Vector3d::Ones()).isZero(0) ? 0 : 1;
      });
    }
    const Positions before = mesh.positions;
    count(solve(system, before, mesh.positions, allowed_, solver_, context));
  }

  void connectivity_changed(const Mesh&, const Context&) override { source_.connectivity_changed(); }

 private:
  OperatorSource source_;
  bool printed_;
  AllowedMoves allowed_;
  std::array<double, 4> a_ = {0, 0, 0, 0};
};

/// The least value of 1 + dt [(1 - m) k^order + m k] over eigenvalues k >= 0.
double least_eigenvalue(const ImplicitOptions& options) {
  const double dt = options.dt, m = options.mixture;
  const int order = options.order;
  if (m >= 0) return 1;
  if (order == 1) return 1 + dt * ((1 - m) + m);  // the mixture of L with itself
  const double k = std::pow(-m / (order * (1 - m)), 1.0 / (order - 1));
  return 1 + dt * ((1 - m) * std::pow(k, order) + m * k);
}

}  // namespace

std::unique_ptr<Flow> ImplicitOptions::start(const Mesh& mesh, const Constraints& constraints,
                                             const Context&) const {
  if (!(least_eigenvalue(*this) > 0))
    throw Failure({ErrorCode::usage,
                   "`mixture` is too negative for this `dt` and `order`: the system has no "
                   "stable solution; bring it nearer to zero or shorten dt"});
  return std::make_unique<ImplicitFlow>(*this, AllowedMoves(constraints, mesh.positions.size()));
}

}  // namespace rfsmooth
