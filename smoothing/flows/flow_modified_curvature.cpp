/// Mean curvature flow that also evens the sampling: the umbrella's tangential part is added.
///
///     F = H n + C [U0 - (U0 . n) n]
///
/// Ohtake, Belyaev, Bogaevski 2000, (11), with H n in units of the mean edge length (times h^2). Differs from
/// the paper: it prints (U0 . n) U0; it must be n, since the text calls the bracket the projection of U0 onto
/// the tangent plane. The bracket does not depend on the sign of n, so faces need not agree in orientation.
#include "base/parallel.h"
#include "smoothing/integrators/operator_speed.h"
#include "smoothing/integrators/umbrella_speed.h"
#include "smoothing/operators/surface.h"

namespace rfsmooth {

using namespace smoothing;

namespace {

using Eigen::Vector3d;

class ModifiedCurvatureSpeed : public Speed {
 public:
  ModifiedCurvatureSpeed(double lambda, double tangential, Scheme scheme)
      : curvature_(make_operator_speed(OperatorKind::curvature, lambda, scheme)),
        umbrella_(make_umbrella_speed(UmbrellaWeights::equal)),
        tangential_(tangential) {}

  void evaluate(const Mesh& mesh, Positions& speed, const Context& context) override {
    if (fans_.faces.size() != mesh.positions.size()) fans_ = fans_of(mesh, context);
    curvature_->evaluate(mesh, speed, context);
    umbrella_->evaluate(mesh, even_, context);
    const Positions normal = unsigned_normals(mesh, fans_, context);
    for_each_index(context, speed.size(), [&](std::size_t i) {
      const Vector3d& n = normal[i];
      if (n != Vector3d::Zero()) speed[i] += tangential_ * (even_[i] - even_[i].dot(n) * n);
    });
  }

  void connectivity_changed(const Mesh& mesh, const Context& context) override {
    curvature_->connectivity_changed(mesh, context);
    fans_ = {};
  }

 private:
  std::unique_ptr<Speed> curvature_, umbrella_;
  double tangential_;
  Fans fans_;
  Positions even_;
};

}  // namespace

std::unique_ptr<Flow> ModifiedCurvatureOptions::start(const Mesh&, const Constraints&, const Context&) const {
  return make_explicit(std::make_unique<ModifiedCurvatureSpeed>(lambda, tangential, scheme), lambda);
}

}  // namespace rfsmooth
