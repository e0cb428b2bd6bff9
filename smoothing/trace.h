/// What a mesh measures after every step of a flow, so that one can see it converge, stop or run away.
#pragma once

#include <vector>

#include <rfsmooth/flow.h>

namespace rfsmooth::smoothing {

/// Adds a row per step to a table. One thread at a time.
class Tracer {
 public:
  /// Adds the first row, of the mesh before the first step. Without a table nothing is ever measured.
  Tracer(std::vector<TraceRow>* rows, const Mesh& mesh, const Context& context);

  /// Adds the row of the step that was just made. The same bits for any number of threads; O(n + m log m).
  void add(const Mesh& mesh, const Context& context);

 private:
  std::vector<TraceRow>* rows_;
  Positions before_;
};

}  // namespace rfsmooth::smoothing
