/// What is said of the solves of implicit flows. Thread safe: no state is kept.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include <rfsmooth/flow.h>

#include "pipeline/cli/console/console.h"

namespace rfsmooth::cli {

/// As reports tell it.
nlohmann::ordered_json json_of(const SolverSummary& solver);

/// Warns of solves that stopped before they were done. `name`: of the input.
void tell_solver(const std::string& name, const SolverSummary& solver, Console& console);

}  // namespace rfsmooth::cli
