/// Laplacian smoothing and its two anchored variants.
///
///     none:      p = q + lambda U(q)
///     centre:    p = alpha q + (1 - alpha) T q        (a step of lambda = 1 - alpha)
///     original:  p = alpha o + (1 - alpha) T q        (converges for alpha > 0)
///
/// Vollmer, Mencl, Mueller 1999, sections 3.1, 3.2, 3.3; weights of Ohtake, Belyaev, Bogaevski 2000, (3),
/// (4). lambda multiplies the step of every variant.
#include "base/parallel.h"
#include "smoothing/integrators/umbrella_speed.h"

namespace rfsmooth {

using namespace smoothing;

namespace {

using Eigen::Vector3d;

/// F = alpha a + (1 - alpha) T q - q with the anchor a = q or o, from U(q) = T q - q.
class AnchoredSpeed : public VertexSpeed {
 public:
  AnchoredSpeed(std::unique_ptr<VertexSpeed> umbrella, double alpha, Positions original)
      : umbrella_(std::move(umbrella)), alpha_(alpha), original_(std::move(original)) {}

  void evaluate(const Mesh& mesh, Positions& speed, const Context& context) override {
    umbrella_->evaluate(mesh, speed, context);
    for_each_index(context, speed.size(),
                   [&](std::size_t i) { speed[i] = anchored(mesh, Index(i), speed[i]); });
  }

  Vector3d at(const Mesh& mesh, Index i) const override { return anchored(mesh, i, umbrella_->at(mesh, i)); }

 private:
  Vector3d anchored(const Mesh& mesh, Index i, const Vector3d& umbrella) const {
    const Vector3d free = (1 - alpha_) * umbrella;
    return original_.empty() ? free : Vector3d(free + alpha_ * (original_[i] - mesh.positions[i]));
  }

  std::unique_ptr<VertexSpeed> umbrella_;
  double alpha_;
  Positions original_;  ///< empty: the anchor is the centre
};

}  // namespace

std::unique_ptr<Flow> LaplacianOptions::start(const Mesh& mesh, const Constraints& constraints,
                                              const Context&) const {
  auto speed = make_umbrella_speed(weights);
  if (anchor != Anchor::none)
    speed = std::make_unique<AnchoredSpeed>(std::move(speed), alpha,
                                            anchor == Anchor::original ? mesh.positions : Positions{});
  return make_explicit(std::move(speed), lambda, update, AllowedMoves(constraints, mesh.positions.size()));
}

}  // namespace rfsmooth
