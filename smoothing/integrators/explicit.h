/// Explicit integration: p = q + lambda F(q), all vertices at once (simultaneous) or each seeing the new
/// places of those before it (sequential, in index order). Flows and speeds are for one thread at a time.
#pragma once

#include <memory>

#include <rfsmooth/flow.h>

#include "smoothing/modifiers/constraint.h"

namespace rfsmooth::smoothing {

/// A speed F, evaluated for all vertices on the same positions. F in world units per dimensionless step.
class Speed {
 public:
  virtual ~Speed() = default;
  Speed() = default;
  Speed(const Speed&) = delete;
  Speed& operator=(const Speed&) = delete;

  /// speed[i] = F(q_i), q = mesh.positions.
  virtual void evaluate(const Mesh& mesh, Positions& speed, const Context& context) = 0;

  /// F(q_i) of one vertex, for the sequential update. \throw std::logic_error if the flow has none.
  virtual Eigen::Vector3d at(const Mesh& mesh, Index i);

  virtual void connectivity_changed(const Mesh&, const Context&) {}
};

/// A flow that adds lambda F. Positions that would not be finite stay where they are.
std::unique_ptr<Flow> make_explicit(std::unique_ptr<Speed> speed, double lambda, Update update);

/// The same with every move under the constraints as it is made, for flows of several part steps and for
/// sequential ones, where others see a vertex before the step is over: a fixed vertex never moves
/// (Vollmer 2, V_fix), and lambda times its strength is a vertex's own lambda (Desbrun 2.7).
std::unique_ptr<Flow> make_explicit(std::unique_ptr<Speed> speed, double lambda, Update update,
                                    AllowedMoves allowed);

}  // namespace rfsmooth::smoothing
