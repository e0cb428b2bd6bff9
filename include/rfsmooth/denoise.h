/// The main entry: a cloud in, the same cloud without the noise out.
///
///     working cloud -> outliers set aside -> connect (EMST -> SDG -> RFS-mesh)
///         -> { smooth one step -> swap edges } x iterations
///
/// Vollmer, Mencl, Mueller 1999, section 7: "after each smoothing step" the dihedral angles are improved by
/// edge swaps, so that the rough mesh and the smooth positions find each other.
///
/// Differs from the paper: a point moves at most the median length of its edges in the RFS-mesh, and points
/// that no face reaches stay where they are, as do outliers (outliers.h), which are not connected at all.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <rfsmooth/connect.h>
#include <rfsmooth/context.h>
#include <rfsmooth/flow.h>
#include <rfsmooth/options.h>

namespace rfsmooth {

/// How to denoise: the flow, the swaps between its steps, the rough mesh.
struct DenoiseOptions {
  FlowOptions flow;
  /// What to do about outliers. Those found stay where they are and pull nobody, whichever of the first three
  /// it is: the rows of an array stay, and removing or marking is for the caller, who reads
  /// DenoiseReport::outlier (the command does). smooth: none are looked for.
  std::string outliers = "keep";
  bool swap = true;  ///< alternate each step with a pass of dihedral edge swaps (Vollmer 7)
  ConnectOptions connect;
  SwapOptions swaps;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    FlowOptions::describe(self.flow, visit);
    OptionInfo found{"outliers",
                     "points with no surface near: left in place and out of the smoothing, marked in a field "
                     "'outlier', removed, or smoothed like all others",
                     ""};
    found.choices = {"keep", "mark", "remove", "smooth"};
    visit(found, self.outliers);
    visit(OptionInfo{"swap", "alternate each step with dihedral edge swaps", ""}, self.swap);
    ConnectOptions::describe(self.connect, visit);
    SwapOptions::describe(self.swaps, visit);
  }
};

/// What was measured and done.
struct DenoiseReport {
  DenoiseOptions effective;   ///< the options with every automatically chosen value filled in; gives the same
                              ///< bytes when used again
  std::size_t points = 0;     ///< rows given
  std::size_t finite = 0;     ///< rows worked on
  std::size_t distinct = 0;   ///< distinct positions among them
  std::size_t moved = 0;      ///< rows whose coordinates changed
  std::size_t outliers = 0;   ///< rows with no surface near them
  std::vector<char> outlier;  ///< n: which; empty if there are none
  double spacing = 0;     ///< mean distance to the nearest neighbour, world units; 0 with fewer than 2 points
  double noise = 0;       ///< standard deviation along the normal, as measured before; world units
  double noise_left = 0;  ///< estimate of what is left of it; as before where the flow cannot tell
  double equalized_rms = 0;  ///< how far points went along the surface to lie evenly, root mean square, world
                             ///< units; 0 for flows that do not even them out
  double equalized_largest = 0;  ///< the farthest
  double guide_strength = 0;     ///< of the automatic flow's guide, dimensionless; 0 for other flows
  std::size_t stranded = 0;      ///< points that the automatic flow's fairing had left beside the surface
  double largest_move = 0;       ///< world units
  double rms_move = 0;           ///< over the finite rows, world units
  std::size_t faces = 0, edges = 0, sdg_edges = 0, bridges = 0, faceless = 0, swaps = 0;
  std::vector<StageTime> seconds;  ///< in the order first done
};

/// Smooths n points in place: `xyz` is n x 3, row-major, world units. Rows with a NaN or infinite coordinate
/// stay as they are and influence nothing; rows that share a position move together. Only moved coordinates
/// are written: a row gets its own value plus the displacement of its working point. On an error or cancel
/// `xyz` is untouched. Same bytes out for any number of threads and any order of the rows.
/// `strength`: n, in [0, 1]: 0 = the row stays, 1 = smoothed fully; empty = all 1 (Desbrun et al. 1999, 2.7).
/// Errors: usage, no_usable_points, out_of_memory, cancelled. O(n log n + steps n). \throw
/// std::invalid_argument for strengths of another number or outside [0, 1]. Thread-safe on distinct arrays.
Result<DenoiseReport> denoise(double* xyz, std::size_t n, const DenoiseOptions& options,
                              const Context& context, const std::vector<double>& strength = {});

/// Bytes that `denoise` takes at its peak for n points, the caller's array not counted (an upper bound for
/// scans; measured, see denoise.cpp).
std::size_t denoise_memory(std::size_t n);

}  // namespace rfsmooth
