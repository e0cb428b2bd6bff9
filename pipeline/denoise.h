/// The main entry: a cloud in, the same cloud without the noise out.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "rfsmooth/rfs_mesh/context.h"
#include "rfsmooth/rfs_mesh/options.h"
#include "rfsmooth/smoothing/flow.h"

namespace rfsmooth::pipeline {

struct DenoiseOptions {
  smoothing::FlowOptions flow;
  bool swap = true;  ///< alternate each step with a pass of dihedral edge swaps (Vollmer 7)

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    smoothing::FlowOptions::describe(self.flow, visit);
    visit(OptionInfo{"swap", "alternate each step with dihedral edge swaps", ""}, self.swap);
  }
};

struct StageTime {
  std::string name;
  double seconds = 0;
};

struct DenoiseReport {
  std::size_t points = 0;    ///< rows given
  std::size_t finite = 0;    ///< rows worked on
  std::size_t distinct = 0;  ///< distinct positions among them
  std::size_t moved = 0;     ///< rows whose coordinates changed
  double spacing = 0;        ///< mean distance to the nearest neighbour, world units
  double largest_move = 0;   ///< world units
  double rms_move = 0;       ///< world units
  std::size_t faces = 0, edges = 0, sdg_edges = 0, bridges = 0, faceless = 0, swaps = 0;
  std::vector<StageTime> seconds;
};

/// Smooths n points in place: `xyz` is n x 3, row-major, world units. Rows with a NaN or infinite coordinate
/// stay as they are and influence nothing; rows that share a position move together. Only moved coordinates
/// are written. On an error or cancel `xyz` is untouched. Same bytes out for any number of threads and any
/// order of the rows. Errors: usage, no_usable_points, out_of_memory, cancelled. Thread-safe on distinct
/// arrays.
Result<DenoiseReport> denoise(double* xyz, std::size_t n, const DenoiseOptions& options,
                              const Context& context);

}  // namespace rfsmooth::pipeline
