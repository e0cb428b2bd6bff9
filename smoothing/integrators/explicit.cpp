#include "smoothing/integrators/explicit.h"

#include <utility>

#include "base/parallel.h"

namespace rfsmooth::smoothing {

namespace {

void move_vertex(Mesh& mesh, std::size_t i, const Eigen::Vector3d& step) {
  const Eigen::Vector3d p = mesh.positions[i] + step;
  if (p.allFinite()) mesh.positions[i] = p;
}

/// What the constraints leave of a vertex's step.
Eigen::Vector3d constrained(const AllowedMoves& allowed, std::size_t i, const Eigen::Vector3d& step) {
  return allowed.strength(i) * allowed(i, step);
}

class SimultaneousFlow : public Flow {
 public:
  SimultaneousFlow(std::unique_ptr<Speed> speed, double lambda, std::optional<AllowedMoves> allowed)
      : speed_(std::move(speed)), lambda_(lambda), allowed_(std::move(allowed)) {}

  void step(Mesh& mesh, const Context& context) override {
    speed_->evaluate(mesh, buffer_, context);
    for_each_index(context, buffer_.size(), [&](std::size_t i) {
      const Eigen::Vector3d step = lambda_ * buffer_[i];
      move_vertex(mesh, i, allowed_ ? constrained(*allowed_, i, step) : step);
    });
  }

  void connectivity_changed(const Mesh& mesh, const Context& context) override {
    speed_->connectivity_changed(mesh, context);
  }
  bool applies_constraints() const override { return allowed_.has_value(); }

 private:
  std::unique_ptr<Speed> speed_;
  double lambda_;
  std::optional<AllowedMoves> allowed_;  ///< empty: constraints are for whoever wraps the flow
  Positions buffer_;
};

class SequentialFlow : public Flow {
 public:
  SequentialFlow(std::unique_ptr<VertexSpeed> speed, double lambda, AllowedMoves allowed)
      : speed_(std::move(speed)), lambda_(lambda), allowed_(std::move(allowed)) {}

  void step(Mesh& mesh, const Context& context) override {
    context.check_stop();
    for (Index i = 0; i < mesh.positions.size(); ++i)
      move_vertex(mesh, i, constrained(allowed_, i, lambda_ * speed_->at(mesh, i)));
  }

  void connectivity_changed(const Mesh& mesh, const Context& context) override {
    speed_->connectivity_changed(mesh, context);
  }
  bool applies_constraints() const override { return true; }

 private:
  std::unique_ptr<VertexSpeed> speed_;
  double lambda_;
  AllowedMoves allowed_;
};

}  // namespace

std::unique_ptr<Flow> make_explicit(std::unique_ptr<Speed> speed, double lambda,
                                    std::optional<AllowedMoves> allowed) {
  return std::make_unique<SimultaneousFlow>(std::move(speed), lambda, std::move(allowed));
}

std::unique_ptr<Flow> make_explicit(std::unique_ptr<VertexSpeed> speed, double lambda, Update update,
                                    AllowedMoves allowed) {
  if (update == Update::simultaneous) return make_explicit(std::move(speed), lambda, std::move(allowed));
  return std::make_unique<SequentialFlow>(std::move(speed), lambda, std::move(allowed));
}

}  // namespace rfsmooth::smoothing
