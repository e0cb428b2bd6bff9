/// What flows have in common whose steps are solves: the options of the solver, what its solves took,
/// and that constraints are part of the system. A flow is for one thread at a time.
#pragma once

#include "smoothing/integrators/solver.h"

namespace rfsmooth::smoothing {

/// A flow whose steps are solves.
class SolvedFlow : public Flow {
 public:
  SolverSummary solver() const override { return solved_; }
  bool applies_constraints() const override { return true; }

 protected:
  /// \param options of a flow, with `tolerance` and `norm`
  template <class Options>
  explicit SolvedFlow(const Options& options) {
    solver_.tolerance = options.tolerance;
    solver_.linf = options.norm == Norm::linf;
  }

  /// Adds up what a solve took.
  void count(const SolverReport& report) {
    solved_ += {report.iterations, report.residual, report.converged};
  }

  SolverOptions solver_;

 private:
  SolverSummary solved_;
};

}  // namespace rfsmooth::smoothing
