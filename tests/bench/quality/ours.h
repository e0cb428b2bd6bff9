/// rfsmooth's own runs in the benchmark.
#pragma once

#include <string>
#include <vector>

#include <rfsmooth/denoise.h>

#include "tests/bench/quality/runs.h"

namespace rfsmooth::bench {

/// A way to call denoise. `options` as the command takes them, without dashes: "flow=hc", "no-equalize".
struct Variant {
  std::string name;
  std::vector<std::string> options;
};

/// The options that the command makes of such words. \throw std::invalid_argument for a name, Failure for a
/// value that it does not have.
DenoiseOptions make_options(const std::vector<std::string>& words);

struct OurResult {
  Positions points;
  DenoiseReport report;
  double seconds = 0;
};

/// \throw std::runtime_error with the message of an error.
OurResult run_ours(const Positions& noisy, const Variant& variant, int threads);

/// The largest and the root mean square distance between corresponding points.
struct Moves {
  double largest = 0, rms = 0;
};
Moves moves(const Positions& before, const Positions& after);

}  // namespace rfsmooth::bench
