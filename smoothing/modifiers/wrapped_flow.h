/// A flow around another one, as modifiers are: all it is asked goes on to the inner flow, except what a
/// modifier answers itself.
///
/// `applies_constraints` does not go on: a modifier that moves vertices by itself breaks what the inner flow
/// kept, so one that keeps it says so. A flow is for one thread at a time.
#pragma once

#include <memory>
#include <utility>

#include <rfsmooth/flow.h>

namespace rfsmooth::smoothing {

/// See above.
class WrappedFlow : public Flow {
 public:
  explicit WrappedFlow(std::unique_ptr<Flow> inner) : inner_(std::move(inner)) {}

  void connectivity_changed(const Mesh& mesh, const Context& context) override {
    inner_->connectivity_changed(mesh, context);
  }
  int solver_iterations() const override { return inner_->solver_iterations(); }

 protected:
  std::unique_ptr<Flow> inner_;
};

}  // namespace rfsmooth::smoothing
