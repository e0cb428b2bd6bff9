/// What a mesh measures after every step of a flow (TraceRow in rfsmooth/flow.h), so that one can see it
/// converge, stop or run away.
#pragma once

#include <vector>

#include <rfsmooth/flow.h>

namespace rfsmooth::smoothing {

/// The longest way from a vertex's place in `before` to that in `after` (n each), world units. Parallel.
double largest_move(const Positions& before, const Positions& after, const Context& context);

/// Adds a row per step to a table. One thread at a time.
class Tracer {
 public:
  /// Adds row 0, of the mesh before the first step. \param rows the table, empty, kept by pointer; null: a
  /// trace was not asked for, and nothing is ever measured.
  Tracer(std::vector<TraceRow>* rows, const Mesh& mesh, const Context& context);

  /// Adds the row of the step that was just made on the same vertices; faces may be others. The same bits for
  /// any number of threads; O(n + m log m) for n vertices and m faces, mostly one thread.
  void add(const Mesh& mesh, const Context& context);

 private:
  std::vector<TraceRow>* rows_;
  Positions before_;  ///< where the vertices were in the last row
};

}  // namespace rfsmooth::smoothing
