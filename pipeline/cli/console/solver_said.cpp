#include "pipeline/cli/console/solver_said.h"

#include <fmt/format.h>

namespace rfsmooth::cli {

nlohmann::ordered_json json_of(const SolverSummary& solver) {
  return {{"iterations", solver.iterations}, {"residual", solver.residual}, {"converged", solver.converged}};
}

void tell_solver(const std::string& name, const SolverSummary& solver, Console& console) {
  if (solver.converged) return;
  console.warn(
      fmt::format("{}: the solver stopped at a residual of {:.2g}, above --tolerance: the points are not yet "
                  "where the flow puts them (a smaller --dt or a larger --tolerance gets there)",
                  name, solver.residual));
}

}  // namespace rfsmooth::cli
