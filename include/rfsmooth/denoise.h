/// The main entry: a cloud in, the same cloud without the noise out.
///
///     working cloud -> outliers set aside -> connect (EMST -> SDG -> RFS-mesh)
///         -> { smooth one step -> swap edges } x iterations
///
/// Vollmer, Mencl, Mueller 1999, section 7: "after each smoothing step" the dihedral angles are improved by
/// edge swaps, so that the rough mesh and the smooth positions find each other.
///
/// That is how flows run; the default, the automatic smoother, takes one step of its own.
///
/// Differs from the paper: outliers, which are isolated and off the surface around them, are not connected at
/// all and stay where they are. So do points that no face reaches under flows; the automatic smoother puts
/// those near the surface onto it. And a point moves only so far: four times the noise around it (of the
/// noisiest points where noise has heavy tails; more with a strength above 1), or under a flow, which knows
/// of no noise, the median length of its edges.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <rfsmooth/connect.h>
#include <rfsmooth/context.h>
#include <rfsmooth/flow.h>
#include <rfsmooth/options.h>
#include <rfsmooth/statistics.h>

namespace rfsmooth {

/// What becomes of outliers: left in place, marked, removed, or smoothed like all others. Those found stay
/// where they are and pull nobody, whichever of the first three it is: the rows of an array stay, and marking
/// or removing is for the caller, who reads DenoiseReport::outlier. smooth: none are looked for.
enum class Outliers { keep, mark, remove, smooth };

/// How to denoise: the flow, the swaps between its steps, the rough mesh.
struct DenoiseOptions {
  FlowOptions flow;
  Outliers outliers = Outliers::keep;
  bool swap = true;  ///< alternate each step with a pass of dihedral edge swaps (Vollmer 7)
  ConnectOptions connect = {};
  SwapOptions swaps = {};
  /// Of the cloud that these points are a part of, from DenoiseReport: what is there is not measured. With
  /// all that a run filled in, the same points come out with the same bytes.
  std::optional<Statistics> statistics = {};

  /// \param of_outliers what is said of them where not all of that can become of them
  template <class Self, class Visit>
  static void describe(
      Self& self, Visit&& visit,
      const OptionInfo& of_outliers =
          words("outliers",
                "points with no surface near: left in place and out of the smoothing, marked in a field "
                "'outlier', removed, or smoothed like all others",
                {"keep", "mark", "remove", "smooth"})) {
    FlowOptions::describe(self.flow, visit);
    visit(of_outliers, self.outliers);
    visit(OptionInfo{"swap", "alternate each step with dihedral edge swaps", ""}, self.swap);
    ConnectOptions::describe(self.connect, visit);
    SwapOptions::describe(self.swaps, visit);
  }
};

/// What was measured and done.
struct DenoiseReport {
  /// The options that it ran with, which give the same bytes when used again. What was measured stays open in
  /// them: it is another cloud's own there.
  DenoiseOptions effective;
  std::size_t points = 0;     ///< rows given
  std::size_t finite = 0;     ///< rows worked on
  std::size_t distinct = 0;   ///< distinct positions among them
  std::size_t moved = 0;      ///< rows whose coordinates changed
  std::size_t outliers = 0;   ///< rows with no surface near them
  std::vector<char> outlier;  ///< n: which; empty if there are none
  double spacing = 0;  ///< mean distance to the nearest neighbour, world units; 0 with fewer than 2 points
  double noise = 0;    ///< standard deviation along the normal, as stated or measured before; world units
  /// What the cloud shows of its noise, as the automatic smoother measures it, whatever noise is stated.
  NoiseSummary measured;
  /// Estimate of what is left of it, of several steps by the first; as before where nothing was smoothed.
  /// None where nobody can tell: under other flows than the automatic one, modifiers and strengths of the
  /// rows.
  std::optional<double> noise_left;
  std::optional<NotSmoothed> not_smoothed;  ///< why nothing was; none: there was something to smooth
  double equalized_rms = 0;  ///< how far points went along the surface to lie evenly in the first step, root
                             ///< mean square, world units; 0 if they were not evened out
  double equalized_largest = 0;  ///< the farthest
  double guide_strength = 0;     ///< of the automatic smoother's guide, dimensionless; 0 for flows
  double tail_times = 1;  ///< noise of the noisiest points (heavy tails) over that of the others; 1: no tails
  SolverSummary solver;   ///< of implicit flows
  std::size_t stranded = 0;          ///< points that the guide's first fairing left beside the surface
  double largest_move = 0;           ///< world units
  double rms_move = 0;               ///< over the finite rows, world units
  Statistics statistics;             ///< measured, or taken from the options
  std::vector<TraceRow> trace;       ///< of the rough mesh, if asked for (FlowOptions::trace); steps + 1 rows
  std::size_t faces = 0, edges = 0;  ///< of the rough mesh, before any swap
  std::size_t sdg_edges = 0, bridges = 0;  ///< edges of the surface description graph; tree edges left out
  std::size_t faceless = 0;                ///< distinct points that no face reaches
  std::size_t swaps = 0;                   ///< edges swapped, all steps together
  std::vector<StageTime> seconds;          ///< in the order first done
};

/// Smooths n points in place: `xyz` is n x 3, row-major, world units. Rows with a NaN or infinite coordinate
/// stay as they are and influence nothing; rows that share a position move together. Only moved coordinates
/// are written: a row gets its own value plus the displacement of its working point. On an error or cancel
/// `xyz` is untouched. Same bytes out for any number of threads and any order of the rows.
/// `strength`: n, in [0, 1]: 0 = the row stays, 1 = smoothed fully; empty = all 1 (Desbrun et al. 1999, 2.7).
/// Finite points may extend over 1e-100 to 1e100; the same cloud in other units comes out the same in those.
/// At most 300 million points; cut larger clouds into tiles (`rfsmooth tiles`).
/// Errors: usage, no_usable_points, out_of_memory, cancelled. O(n log n + steps n). \throw
/// std::invalid_argument for strengths of another number or outside [0, 1]. Thread-safe on distinct arrays.
Result<DenoiseReport> denoise(double* xyz, std::size_t n, const DenoiseOptions& options,
                              const Context& context, const std::vector<double>& strength = {});

/// Bytes that `denoise` takes at its peak for n points, the caller's array not counted: measured on even
/// clouds, with half as much to spare. Scans full of clutter may take a quarter more. Thread safe.
std::size_t denoise_memory(std::size_t n);

}  // namespace rfsmooth
