/// What flows have in common whose steps are solves: the options of the solver, the count of its iterations,
/// and that constraints are part of the system. A flow is for one thread at a time.
#pragma once

#include "smoothing/integrators/solver.h"

namespace rfsmooth::smoothing {

/// A flow whose steps are solves.
class SolvedFlow : public Flow {
 public:
  int solver_iterations() const override { return iterations_; }
  bool applies_constraints() const override { return true; }

 protected:
  /// \param options of a flow, with `tolerance` and `norm`
  template <class Options>
  explicit SolvedFlow(const Options& options) {
    solver_.tolerance = options.tolerance;
    solver_.linf = options.norm == Norm::linf;
  }

  /// Adds up what a solve took.
  void count(const SolverReport& report) { iterations_ += report.iterations; }

  SolverOptions solver_;

 private:
  int iterations_ = 0;
};

}  // namespace rfsmooth::smoothing
