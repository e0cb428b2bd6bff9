/// The HC algorithm: a full Laplacian step, then pushed back by the average of the differences.
///
///     p = T q;   b_i = p_i - (alpha o_i + (1 - alpha) q_i);   p_i -= beta b_i + (1 - beta) mean_j b_j
///
/// Vollmer, Mencl, Mueller 1999, section 4. Converges for alpha > 0 and beta > 0.5 (theorem 5.2). With alpha
/// = 0 one step is x - (1 - beta) L^2 x. The paper lists the simultaneous version; in the sequential one the
/// Laplacian half updates in index order and the push-back follows.
#include "rfsmooth/smoothing/constraint.h"
#include "rfsmooth/smoothing/pushback.h"
#include "rfsmooth/smoothing/umbrella_speed.h"

namespace rfsmooth::smoothing {

namespace {

std::unique_ptr<Flow> make(const rfs_mesh::Mesh& mesh, const FlowOptions& options,
                           const Constraints& constraints, const Context&) {
  const Update update = *options.update == "sequential" ? Update::sequential : Update::simultaneous;
  auto laplacian = make_explicit(make_umbrella_speed(false), 1, update);
  if (!constraints.hard.empty())  // so that the difference of a fixed vertex is zero, as in the paper
    laplacian =
        make_constrained(std::move(laplacian), AllowedMoves({constraints.hard, {}}, mesh.positions.size()));
  return make_pushback(std::move(laplacian), mesh, *options.alpha, *options.beta);
}

}  // namespace

FlowEntry flow_hc() {
  FlowOptions defaults;
  defaults.iterations = 10;
  defaults.alpha = 0;   // ten steps are then as strong as 10 (1 - beta) L^2
  defaults.beta = 0.6;  // the paper's bound for convergence is 0.5
  defaults.update = "simultaneous";
  return {"hc",        "Laplacian steps pushed back by the mean difference; keeps size and shape",
          "Vollmer 4", {"iterations", "alpha", "beta", "update"},
          defaults,    make};
}

}  // namespace rfsmooth::smoothing
