/// Mean curvature flow, explicit: every vertex along its normal with the speed of its mean curvature. See
/// curvature_speed.h for the formula and where it differs from the papers.
#include "smoothing/integrators/curvature_speed.h"

namespace rfsmooth::smoothing {

namespace {

std::unique_ptr<Flow> make_curvature(const Mesh&, const FlowOptions& options, const Constraints&,
                                     const Context&) {
  return make_explicit(make_curvature_speed(*options.normalised, *options.lambda), *options.lambda,
                       Update::simultaneous);
}

}  // namespace

FlowEntry flow_curvature() {
  FlowOptions defaults;
  defaults.iterations = 10;
  defaults.lambda = 0.25;  // on a regular mesh half of what is stable
  defaults.normalised = false;
  return {"curvature",
          "along the normal by the mean curvature; leaves flat parts and the sampling alone",
          "Desbrun (14), 5.5; Ohtake (7), (8)",
          {"iterations", "lambda", "normalised"},
          defaults,
          make_curvature};
}

}  // namespace rfsmooth::smoothing
