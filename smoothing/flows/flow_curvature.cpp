/// Mean curvature flow, explicit: every vertex along its normal with the speed of its mean curvature. See
/// operator_speed.h for the formula and where it differs from the papers.
#include "smoothing/integrators/operator_speed.h"

namespace rfsmooth {

using namespace smoothing;

std::unique_ptr<Flow> CurvatureOptions::start(const Mesh&, const Constraints&, const Context&) const {
  const OperatorKind kind = normalised ? OperatorKind::curvature_normalised : OperatorKind::curvature;
  return make_explicit(make_operator_speed(kind, lambda, scheme), lambda);
}

}  // namespace rfsmooth
