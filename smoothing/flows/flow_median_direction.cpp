/// Moves in the umbrella's (median) direction with the normal speed of mean curvature flow: smooths like it
/// and makes edge lengths even.
///
///     m = U0 / |U0|,  cos t = m . H n / |H|
///     F = |H| m / cos t              where cos t > eps
///         2 H n - |H| m / cos t      where cos t < -eps
///         0                          else, and where H or U0 vanishes;  eps = least_cosine
///
/// Ohtake, Belyaev, Bogaevski 2000, (12), (13); H n times h^2. |F| reaches |H| / eps, so a step of the safe
/// scheme is limited to |U0|: beyond the neighbours' mean it would overshoot what the direction is for.
#include <cmath>

#include "base/parallel.h"
#include "smoothing/integrators/operator_speed.h"
#include "smoothing/integrators/umbrella_speed.h"

namespace rfsmooth {

using namespace smoothing;

namespace {

using Eigen::Vector3d;

class MedianDirectionSpeed : public Speed {
 public:
  explicit MedianDirectionSpeed(const MedianDirectionOptions& options)
      : options_(options),
        curvature_(make_operator_speed(OperatorKind::curvature, options.lambda, options.scheme)),
        umbrella_(make_umbrella_speed(UmbrellaWeights::equal)) {}

  void evaluate(const Mesh& mesh, Positions& speed, const Context& context) override {
    curvature_->evaluate(mesh, speed, context);
    umbrella_->evaluate(mesh, median_, context);
    for_each_index(context, speed.size(), [&](std::size_t i) { speed[i] = median(speed[i], median_[i]); });
  }

  void connectivity_changed(const Mesh& mesh, const Context& context) override {
    curvature_->connectivity_changed(mesh, context);
  }

 private:
  Vector3d median(const Vector3d& curvature, const Vector3d& umbrella) const {
    const double H = curvature.norm(), U = umbrella.norm();
    if (!(H > 0 && U > 0)) return Vector3d::Zero();
    const Vector3d m = umbrella / U;
    const double cosine = m.dot(curvature) / H;
    if (std::abs(cosine) <= options_.least_cosine) return Vector3d::Zero();
    const Vector3d along = H / cosine * m;
    Vector3d F = cosine > 0 ? along : Vector3d(2 * curvature - along);
    if (options_.scheme == Scheme::printed) return F;
    const double longest = U / std::max(options_.lambda, 1e-300);
    return F.norm() > longest ? Vector3d(longest / F.norm() * F) : F;
  }

  MedianDirectionOptions options_;
  std::unique_ptr<Speed> curvature_, umbrella_;
  Positions median_;
};

}  // namespace

std::unique_ptr<Flow> MedianDirectionOptions::start(const Mesh&, const Constraints&, const Context&) const {
  return make_explicit(std::make_unique<MedianDirectionSpeed>(*this), lambda);
}

}  // namespace rfsmooth
