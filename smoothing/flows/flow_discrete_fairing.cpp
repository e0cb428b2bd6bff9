/// Discrete fairing, approximating: a smoothing spline on the mesh.
///
///     minimise  sum_i (w_i / s_i) |x_i - q_i|^2 + dt E(x)
///
/// Kobbelt 1997; E = the thin-plate energy of divided_difference.h, whose charts come from the first mesh and
/// stay fixed, so each step is one linear solve; s = strength per vertex. dt is dimensionless: in the limit
/// of a regular mesh dt E is 16 times the squared umbrella. The interpolating use, with refinement, is
/// refine.h.
#include "base/parallel.h"
#include "rfs_mesh/measure.h"
#include "smoothing/integrators/solved_flow.h"
#include "smoothing/operators/divided_difference.h"

namespace rfsmooth {

using namespace smoothing;

namespace {

using Eigen::Vector3d;

class DiscreteFairing : public SolvedFlow {
 public:
  DiscreteFairing(const Mesh& mesh, const DiscreteFairingOptions& options, AllowedMoves allowed,
                  const Context& context)
      : SolvedFlow(options),
        chart_(options.chart),
        dt_(options.dt),
        allowed_(std::move(allowed)),
        first_(mesh.positions),
        differences_(mesh, chart_, context) {}

  void step(Mesh& mesh, const Context& context) override {
    const std::size_t n = mesh.positions.size();
    const std::vector<double>& w = differences_.weights();
    std::vector<double> data(n), diagonal = differences_.diagonal(context);
    Positions b(n), x(n);
    const Vector3d centre = rfs_mesh::centroid(mesh.positions, context);
    for_each_index(context, n, [&](std::size_t i) {
      const double s = allowed_.strength(i);
      data[i] = s > 0 ? w[i] / s : w[i];
      diagonal[i] = data[i] + dt_ * diagonal[i];
      x[i] = mesh.positions[i] - centre;
      b[i] = data[i] * x[i];
    });
    const Product product = [&](const Positions& u, Positions& v) {
      differences_.apply(u, v, context);
      return sum_over(context, n, 0.0, [&](std::size_t i) {
        v[i] = data[i] * u[i] + dt_ * v[i];
        return u[i].dot(v[i]);
      });
    };
    const Positions start = x;
    count(conjugate_gradients({product, diagonal, w}, b, x, allowed_, solver_, context));
    for_each_index(context, n, [&](std::size_t i) {
      const Vector3d p = mesh.positions[i] + allowed_(i, x[i] - start[i]);
      if (p.allFinite()) mesh.positions[i] = p;
    });
  }

  void connectivity_changed(const Mesh& mesh, const Context& context) override {
    Mesh first = mesh;
    first.positions = first_;
    differences_ = DividedDifferences(first, chart_, context);
  }

 private:
  Chart chart_;
  double dt_;
  AllowedMoves allowed_;
  Positions first_;
  DividedDifferences differences_;
};

}  // namespace

std::unique_ptr<Flow> DiscreteFairingOptions::start(const Mesh& mesh, const Constraints& constraints,
                                                    const Context& context) const {
  return std::make_unique<DiscreteFairing>(mesh, *this, AllowedMoves(constraints, mesh.positions.size()),
                                           context);
}

}  // namespace rfsmooth
