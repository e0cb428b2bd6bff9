/// A flow around another one: the base of the modifiers. Calls go on to the inner flow unless a modifier
/// overrides them.
///
/// Except `applies_constraints`: a modifier that moves vertices itself can break what the inner flow kept, so
/// a modifier that keeps the constraints overrides it. A flow is for one thread at a time.
#pragma once

#include <memory>
#include <utility>

#include <rfsmooth/flow.h>

namespace rfsmooth::smoothing {

/// Base class of the modifiers.
class WrappedFlow : public Flow {
 public:
  explicit WrappedFlow(std::unique_ptr<Flow> inner) : inner_(std::move(inner)) {}

  void connectivity_changed(const Mesh& mesh, const Context& context) override {
    inner_->connectivity_changed(mesh, context);
  }
  SolverSummary solver() const override { return inner_->solver(); }

 protected:
  std::unique_ptr<Flow> inner_;
};

}  // namespace rfsmooth::smoothing
