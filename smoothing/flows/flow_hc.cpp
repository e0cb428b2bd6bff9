/// The HC algorithm: a full Laplacian step, then pushed back by the average of the differences.
///
///     p = T q;   b_i = p_i - (alpha o_i + (1 - alpha) q_i);   p_i -= beta b_i + (1 - beta) mean_j b_j
///
/// Vollmer, Mencl, Mueller 1999, section 4. Converges for alpha > 0 and beta > 0.5 (theorem 5.2). With alpha
/// = 0 one step is x - (1 - beta) L^2 x. The paper lists the simultaneous version; in the sequential one the
/// Laplacian half updates in index order and the push-back follows. Constraints hold in both halves, so that
/// the difference of a fixed vertex is zero, as in the paper.
#include "base/parallel.h"
#include "smoothing/integrators/umbrella_speed.h"
#include "smoothing/modifiers/constraint.h"
#include "smoothing/modifiers/pushback.h"

namespace rfsmooth {

using namespace smoothing;

namespace {

using Eigen::Vector3d;

/// The simultaneous version in two passes over the neighbours and without copies: p_i is b_i plus the anchor,
/// so only b is stored between them.
class SimultaneousHc : public Flow {
 public:
  SimultaneousHc(const Mesh& mesh, double alpha, double beta) : alpha_(alpha), beta_(beta) {
    if (alpha > 0) original_ = mesh.positions;
  }

  void step(Mesh& mesh, const Context& context) override {
    Positions& q = mesh.positions;
    const Adjacency& rows = mesh.one_ring;
    const auto anchor = [&](std::size_t i) {
      return alpha_ > 0 ? Vector3d(alpha_ * original_[i] + (1 - alpha_) * q[i]) : q[i];
    };
    difference_.resize(q.size());
    for_each_index(context, q.size(), [&](std::size_t i) {
      const Index begin = rows.start[i], end = rows.start[i + 1];
      Vector3d sum = Vector3d::Zero();
      for (Index k = begin; k < end; ++k) sum += q[rows.items[k]];
      difference_[i] = begin == end ? sum : Vector3d((1 / double(end - begin)) * sum - anchor(i));
    });
    for_each_index(context, q.size(), [&](std::size_t i) {
      const Index begin = rows.start[i], end = rows.start[i + 1];
      if (begin == end) return;
      Vector3d sum = Vector3d::Zero();
      for (Index k = begin; k < end; ++k) sum += difference_[rows.items[k]];
      const Vector3d p = anchor(i) + (1 - beta_) * (difference_[i] - (1 / double(end - begin)) * sum);
      if (p.allFinite()) q[i] = p;
    });
  }

 private:
  double alpha_, beta_;
  Positions original_, difference_;
};

}  // namespace

std::unique_ptr<Flow> HcOptions::start(const Mesh& mesh, const Constraints& constraints,
                                       const Context&) const {
  if (update == Update::simultaneous && constraints.hard.empty() && constraints.strength.empty())
    return std::make_unique<SimultaneousHc>(mesh, alpha, beta);
  const AllowedMoves allowed(constraints, mesh.positions.size());
  return make_pushback(make_explicit(make_umbrella_speed(UmbrellaWeights::equal), 1, update, allowed), mesh,
                       alpha, beta, allowed);
}

}  // namespace rfsmooth
