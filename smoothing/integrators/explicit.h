/// Explicit integration: p = q + lambda F(q). Simultaneous: all vertices at once. Sequential: in index order,
/// each vertex sees the new positions of those before it. A flow or speed is for one thread at a time.
#pragma once

#include <memory>
#include <optional>

#include <rfsmooth/flow.h>

#include "smoothing/modifiers/constraint.h"

namespace rfsmooth::smoothing {

/// A speed F, in world units per unit of the dimensionless step.
class Speed {
 public:
  virtual ~Speed() = default;
  Speed() = default;
  Speed(const Speed&) = delete;
  Speed& operator=(const Speed&) = delete;

  /// speed[i] = F(q_i), q = mesh.positions.
  virtual void evaluate(const Mesh& mesh, Positions& speed, const Context& context) = 0;

  virtual void connectivity_changed(const Mesh&, const Context&) {}
};

/// A speed that can be asked at one vertex alone, too, as sequential updates do.
class VertexSpeed : public Speed {
 public:
  /// F(q_i).
  virtual Eigen::Vector3d at(const Mesh& mesh, Index i) const = 0;
};

/// A flow that adds lambda F, simultaneously. A vertex whose new position would not be finite stays. With
/// `allowed` every move is constrained at once: for flows of several part steps and for sequential ones,
/// where others see a vertex before the step is over. A fixed vertex never moves (Vollmer 2, V_fix), and a
/// vertex's strength scales lambda (Desbrun 2.7).
std::unique_ptr<Flow> make_explicit(std::unique_ptr<Speed> speed, double lambda,
                                    std::optional<AllowedMoves> allowed = std::nullopt);

/// The same, simultaneously or vertex by vertex.
std::unique_ptr<Flow> make_explicit(std::unique_ptr<VertexSpeed> speed, double lambda, Update update,
                                    AllowedMoves allowed);

}  // namespace rfsmooth::smoothing
