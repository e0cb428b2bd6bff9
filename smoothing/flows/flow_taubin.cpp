/// Taubin's pair: a smoothing and a slightly longer inflating umbrella step make one step.
///
///     p = (1 - mu U)(1 + lambda U) q = q - (mu - lambda) U(q) - mu lambda U(U(q)),   mu > lambda > 0
///
/// Ohtake, Belyaev, Bogaevski 2000, (6); Desbrun et al. 1999, 2.1, which prints the second-order term with
/// the wrong sign for its mu < 0. The gain at eigenvalue k of L = -U is (1 - lambda k)(1 + mu k), one at k =
/// 0 and at the pass band 1/lambda - 1/mu.
#include "smoothing/integrators/explicit.h"
#include "smoothing/integrators/umbrella_speed.h"

namespace rfsmooth {

using namespace smoothing;

namespace {

class TaubinFlow : public Flow {
 public:
  TaubinFlow(UmbrellaWeights weights, double lambda, double mu, const AllowedMoves& allowed)
      : shrink_(make_explicit(make_umbrella_speed(weights), lambda, allowed)),
        inflate_(make_explicit(make_umbrella_speed(weights), -mu, allowed)) {}

  void step(Mesh& mesh, const Context& context) override {
    shrink_->step(mesh, context);
    inflate_->step(mesh, context);
  }
  bool applies_constraints() const override { return true; }

 private:
  std::unique_ptr<Flow> shrink_, inflate_;
};

}  // namespace

std::unique_ptr<Flow> TaubinOptions::start(const Mesh& mesh, const Constraints& constraints,
                                           const Context&) const {
  if (!(mu > lambda))
    throw Failure({ErrorCode::usage, "`mu` must be greater than `lambda`: the second step inflates"});
  return std::make_unique<TaubinFlow>(weights, lambda, mu, AllowedMoves(constraints, mesh.positions.size()));
}

}  // namespace rfsmooth
