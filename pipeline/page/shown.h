/// Which points of a cloud a page shows, and in which order.
#pragma once

#include <cstddef>
#include <vector>

#include <rfsmooth/context.h>

namespace rfsmooth::pipeline {

/// What a row is to a page.
enum class RowKind {
  surface,  ///< finite before and after
  outlier,  ///< that, and flagged
  removed,  ///< finite before only
  absent    ///< not finite before: never shown
};

/// n: what the rows are. `outlier`: n flags, or empty.
std::vector<RowKind> kinds_of_rows(const std::vector<double>& before, const std::vector<double>& after,
                                   const std::vector<char>& outlier);

/// n: how far each row moved, world units; NaN if it is not finite on both sides.
std::vector<double> displacements(const std::vector<double>& before, const std::vector<double>& after);

/// The rows that are shown, by kind and, of each kind, along a Morton curve. If more than `most` could be:
/// three quarters of them are taken at even distances along the curve, so that the picture is as dense as the
/// cloud, and the others are those that moved farthest (outliers and removed ones first), so that nothing
/// that was done remains unseen. `before`: n x 3; `moved`: n, as above. \throw Failure (no_usable_points).
/// O(n log n), the same for any number of threads.
std::vector<std::size_t> shown_rows(const std::vector<double>& before, const std::vector<double>& moved,
                                    const std::vector<RowKind>& kinds, std::size_t most,
                                    const Context& context);

}  // namespace rfsmooth::pipeline
