/// Bilaplacian flow, descent of the discrete thin-plate energy.
///
///     p = q - lambda U(U(q))
///
/// Ohtake, Belyaev, Bogaevski 2000, section 2. Differs from the paper: it prints a plus sign, which
/// amplifies; the minus is its own Taubin formula (6) with mu = lambda. Stable for lambda <= 1/2 on any graph
/// (L's eigenvalues lie in [0, 2]). Exactly HC with alpha = 0, beta = 1 - lambda.
#include "base/parallel.h"
#include "smoothing/integrators/explicit.h"
#include "smoothing/operators/operator.h"

namespace rfsmooth {

using namespace smoothing;

namespace {

class BilaplacianSpeed : public Speed {
 public:
  void evaluate(const Mesh& mesh, Positions& speed, const Context& context) override {
    const Operator& op = source_.on(mesh, context);
    apply(op.rows(mesh), op, mesh.positions, once_, context);
    apply(op.rows(mesh), op, once_, speed, context);
    for_each_index(context, speed.size(), [&](std::size_t i) { speed[i] = -speed[i]; });
  }

  void connectivity_changed(const Mesh&, const Context&) override { source_.connectivity_changed(); }

 private:
  OperatorSource source_{OperatorKind::umbrella, false};
  Positions once_;  ///< the operator applied once
};

}  // namespace

std::unique_ptr<Flow> BilaplacianOptions::start(const Mesh&, const Constraints&, const Context&) const {
  return make_explicit(std::make_unique<BilaplacianSpeed>(), lambda);
}

}  // namespace rfsmooth
