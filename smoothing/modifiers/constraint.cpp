#include "smoothing/modifiers/constraint.h"

#include <cmath>
#include <stdexcept>

#include "base/parallel.h"
#include "smoothing/modifiers/wrapped_flow.h"

namespace rfsmooth::smoothing {

using Eigen::Vector3d;

AllowedMoves::AllowedMoves(const Constraints& constraints, std::size_t n) : strength_(constraints.strength) {
  if (!strength_.empty() && strength_.size() != n)
    throw std::invalid_argument("the strengths are not one per vertex");
  bool any_still = false, all_free = true;
  for (const double s : strength_) {
    if (!(s >= 0 && s <= 1)) throw std::invalid_argument("a strength is outside [0, 1]");
    any_still = any_still || s == 0;
    all_free = all_free && s == 1;
  }
  if (all_free) strength_.clear();
  if (constraints.hard.empty() && !any_still) return;
  kind_.assign(n, Kind::free);
  direction_.assign(n, Vector3d::Zero());
  for (const HardConstraint& c : constraints.hard) {
    if (c.vertex >= n) throw std::invalid_argument("a constraint names a vertex that is not there");
    if (kind_[c.vertex] != Kind::free) throw std::invalid_argument("a vertex has two constraints");
    if (c.kind == HardConstraint::Kind::fixed) {
      kind_[c.vertex] = Kind::fixed;
      continue;
    }
    const double length = c.direction.norm();
    if (!(length > 0 && std::isfinite(length)))
      throw std::invalid_argument("a constraint's direction is zero or not finite");
    kind_[c.vertex] = c.kind == HardConstraint::Kind::axis ? Kind::axis : Kind::plane;
    direction_[c.vertex] = c.direction / length;
  }
  for (std::size_t i = 0; i < strength_.size(); ++i)
    if (strength_[i] == 0) kind_[i] = Kind::fixed;
}

Vector3d AllowedMoves::projected(std::size_t i, const Vector3d& move) const {
  switch (kind_[i]) {
    case Kind::free:
      return move;
    case Kind::fixed:
      return Vector3d::Zero();
    case Kind::axis:
      return direction_[i].dot(move) * direction_[i];
    case Kind::plane:
      return move - direction_[i].dot(move) * direction_[i];
  }
  return move;
}

namespace {

class Constrained : public WrappedFlow {
 public:
  Constrained(std::unique_ptr<Flow> inner, AllowedMoves allowed)
      : WrappedFlow(std::move(inner)), allowed_(std::move(allowed)) {}

  void step(Mesh& mesh, const Context& context) override {
    before_ = mesh.positions;
    inner_->step(mesh, context);
    for_each_index(context, before_.size(), [&](std::size_t i) {
      const Vector3d move = allowed_.strength(i) * allowed_(i, mesh.positions[i] - before_[i]);
      mesh.positions[i] = before_[i] + move;
    });
  }

 private:
  AllowedMoves allowed_;
  Positions before_;
};

}  // namespace

std::unique_ptr<Flow> make_constrained(std::unique_ptr<Flow> inner, AllowedMoves allowed) {
  return std::make_unique<Constrained>(std::move(inner), std::move(allowed));
}

}  // namespace rfsmooth::smoothing
