/// Mean curvature flow, explicit: every vertex along its normal with the speed of its mean curvature. See
/// curvature_speed.h for the formula and where it differs from the papers.
#include "smoothing/integrators/curvature_speed.h"

namespace rfsmooth {

using namespace smoothing;

std::unique_ptr<Flow> CurvatureOptions::start(const Mesh&, const Constraints&, const Context&) const {
  return make_explicit(make_curvature_speed(normalised, lambda, scheme), lambda, Update::simultaneous);
}

}  // namespace rfsmooth
