#include "smoothing/integrators/explicit.h"

#include <optional>
#include <stdexcept>

#include "base/parallel.h"

namespace rfsmooth::smoothing {

Eigen::Vector3d Speed::at(const Mesh&, Index) {
  throw std::logic_error("this flow has no sequential update");
}

namespace {

class ExplicitFlow : public Flow {
 public:
  ExplicitFlow(std::unique_ptr<Speed> speed, double lambda, Update update,
               std::optional<AllowedMoves> allowed)
      : speed_(std::move(speed)), lambda_(lambda), update_(update), allowed_(std::move(allowed)) {}

  void step(Mesh& mesh, const Context& context) override {
    const auto move = [&](std::size_t i, const Eigen::Vector3d& speed) {
      Eigen::Vector3d step = lambda_ * speed;
      if (allowed_) step = allowed_->strength(i) * (*allowed_)(i, step);
      const Eigen::Vector3d p = mesh.positions[i] + step;
      if (p.allFinite()) mesh.positions[i] = p;
    };
    if (update_ == Update::sequential) {
      context.check_stop();
      for (Index i = 0; i < mesh.positions.size(); ++i) move(i, speed_->at(mesh, i));
      return;
    }
    speed_->evaluate(mesh, buffer_, context);
    for_each_index(context, buffer_.size(), [&](std::size_t i) { move(i, buffer_[i]); });
  }

  void connectivity_changed(const Mesh& mesh, const Context& context) override {
    speed_->connectivity_changed(mesh, context);
  }
  bool applies_constraints() const override { return allowed_.has_value(); }

 private:
  std::unique_ptr<Speed> speed_;
  double lambda_;
  Update update_;
  std::optional<AllowedMoves> allowed_;  ///< empty: constraints are for whoever wraps the flow
  Positions buffer_;
};

}  // namespace

std::unique_ptr<Flow> make_explicit(std::unique_ptr<Speed> speed, double lambda, Update update) {
  return std::make_unique<ExplicitFlow>(std::move(speed), lambda, update, std::nullopt);
}

std::unique_ptr<Flow> make_explicit(std::unique_ptr<Speed> speed, double lambda, Update update,
                                    AllowedMoves allowed) {
  return std::make_unique<ExplicitFlow>(std::move(speed), lambda, update, std::move(allowed));
}

}  // namespace rfsmooth::smoothing
