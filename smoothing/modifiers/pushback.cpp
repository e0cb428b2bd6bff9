#include "smoothing/modifiers/pushback.h"

#include "base/parallel.h"
#include "smoothing/modifiers/wrapped_flow.h"

namespace rfsmooth::smoothing {

using Eigen::Vector3d;

namespace {

class PushBack : public WrappedFlow {
 public:
  PushBack(std::unique_ptr<Flow> inner, const Mesh& mesh, double alpha, double beta, AllowedMoves allowed)
      : WrappedFlow(std::move(inner)),
        alpha_(alpha),
        beta_(beta),
        allowed_(std::move(allowed)),
        original_(mesh.positions) {}

  void step(Mesh& mesh, const Context& context) override {
    Positions& p = mesh.positions;
    before_ = p;
    inner_->step(mesh, context);
    difference_.resize(p.size());
    for_each_index(context, p.size(), [&](std::size_t i) {
      difference_[i] = p[i] - (alpha_ * original_[i] + (1 - alpha_) * before_[i]);
    });
    const Adjacency& rows = mesh.one_ring;
    for_each_index(context, p.size(), [&](std::size_t i) {
      if (rows.degree(i) == 0) {
        p[i] = before_[i];
        return;
      }
      Vector3d sum = Vector3d::Zero();
      for (const Index j : rows[i]) sum += difference_[j];
      const Vector3d back = beta_ * difference_[i] + (1 - beta_) / double(rows.degree(i)) * sum;
      const Vector3d moved = p[i] - allowed_.strength(i) * allowed_(i, back);
      if (moved.allFinite()) p[i] = moved;
    });
  }

  bool applies_constraints() const override { return true; }

 private:
  double alpha_, beta_;
  AllowedMoves allowed_;
  Positions original_, before_, difference_;
};

}  // namespace

std::unique_ptr<Flow> make_pushback(std::unique_ptr<Flow> inner, const Mesh& mesh, double alpha, double beta,
                                    AllowedMoves allowed) {
  return std::make_unique<PushBack>(std::move(inner), mesh, alpha, beta, std::move(allowed));
}

}  // namespace rfsmooth::smoothing
