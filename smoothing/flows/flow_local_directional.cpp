/// Local directional flow: each vertex diffuses with a direction and a weight of its own one-ring; keeps
/// corners and saddles.
///
///     move by lambda w (b_i, n) H n
///     b_i = unit vector along the one-ring's integral of n (2H)^(2m) (6m (2 H^2 - K) + 2 H^2)
///     w = |K|                          where |K| < eps
///         (1 + K) / ((1 + H^2) K)      where K >= eps
///         0                            where K <= -eps (saddles never move)
///
/// Zhao, Xu 2005, (34)-(36). K = angle deficit over the mixed area; the mixed area for H too, else H^2
/// >= K fails (the printed scheme has the one-ring's, as (37) does, and no limit to a step). K, H and eps in
/// units of 1/h (h = mean edge length); the paper's figure has eps 0.05, steps of 0.005. Differs from the
/// paper: (36) is garbled, this is the reading that is consistent; the paper calls the flow volume
/// preserving, only the global one is. Normals of a one-ring are turned to the vertex's side, so faces need
/// not agree in orientation; boundary and non-manifold vertices, where K means nothing, stay.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "rfs_mesh/corners.h"
#include "smoothing/integrators/explicit.h"
#include "smoothing/operators/operator.h"
#include "smoothing/operators/surface.h"

namespace rfsmooth {

using namespace smoothing;

namespace {

using Eigen::Vector3d;

class LocalDirectionalSpeed : public Speed {
 public:
  explicit LocalDirectionalSpeed(const LocalDirectionalOptions& options) : options_(options) {}

  void evaluate(const Mesh& mesh, Positions& speed, const Context& context) override {
    const std::size_t n = mesh.positions.size();
    known_.find(mesh, context);
    const Operator op = curvature(mesh, known_.faces(), context, options_.scheme);
    Positions Hn;
    apply(mesh.one_ring, op, mesh.positions, Hn, context);
    const Curvatures curvatures = curvatures_of(mesh, op, Hn, context);
    std::vector<char> against;
    const Positions normal = unsigned_normals(mesh, known_.fans(), context, &against);
    Positions integrand(n);
    for_each_index(context, n, [&](std::size_t i) { integrand[i] = curvatures.energy[i] * normal[i]; });
    speed.assign(n, Vector3d::Zero());
    for_each_index(context, n, [&](std::size_t i) {
      if (!known_.is_interior(i)) return;
      const Vector3d b = one_ring_integral(mesh, integrand, against, i);
      if (!(b.norm() > 0)) return;
      const double w = weight(curvatures.gauss[i], curvatures.mean_square[i]);
      // inward = -L x
      Vector3d v = -w * op.unit * b.normalized().dot(normal[i]) * Hn[i];
      // half an edge at most, so that needles cannot blow the flow up
      const double longest = 0.5 * std::sqrt(op.unit) / std::max(options_.lambda, 1e-300);
      if (options_.scheme == Scheme::safe && v.norm() > longest) v *= longest / v.norm();
      if (v.allFinite()) speed[i] = v;
    });
  }

  void connectivity_changed(const Mesh&, const Context&) override { known_.forget(); }

 private:
  /// Of each vertex, lengths in h.
  struct Curvatures {
    std::vector<double> gauss, mean_square;  ///< K, H^2
    std::vector<double> energy;              ///< what is integrated, times the vertex's area
  };

  /// \param op of H n
  Curvatures curvatures_of(const Mesh& mesh, const Operator& op, const Positions& Hn,
                           const Context& context) const {
    const std::size_t n = mesh.positions.size();
    const std::vector<double> area = options_.scheme == Scheme::safe
                                         ? op.mass
                                         : curvature(mesh, known_.faces(), context).mass;  // twice the mixed
    Curvatures of{std::vector<double>(n, 0), std::vector<double>(n), std::vector<double>(n)};
    for_each_index(context, n, [&](std::size_t i) {
      if (known_.is_interior(i))
        of.gauss[i] = op.unit * angle_deficit(mesh, known_.faces(), Index(i)) * 2 / area[i];
      const double m = options_.power, K = of.gauss[i],
                   H2 = of.mean_square[i] = op.unit * Hn[i].squaredNorm();
      of.energy[i] = area[i] * std::pow(4 * H2, m) * (m > 0 ? 6 * m * (2 * H2 - K) + 2 * H2 : 2 * H2);
    });
    return of;
  }

  /// The sum of the integrand over a vertex and its neighbours, each with its normal on the vertex's side.
  Vector3d one_ring_integral(const Mesh& mesh, const Positions& integrand, const std::vector<char>& against,
                             std::size_t i) const {
    const Adjacency& around = known_.faces();
    const auto row = around[i];
    /// Whether face number f runs against the normal of its vertex v.
    const auto opposed = [&](Index f, std::size_t v) { return against[item_of(around, v, f)] != 0; };
    Vector3d sum = integrand[i];
    for (const Index j : mesh.one_ring[i]) {
      // Its side is that of the first face that has both.
      const Index f = *std::find_if(row.begin(), row.end(),
                                    [&](Index g) { return rfs_mesh::has_corner(mesh.faces[g], j); });
      sum += opposed(f, i) == opposed(f, j) ? integrand[j] : Vector3d(-integrand[j]);
    }
    return sum;
  }

  /// w.
  double weight(double K, double H2) const {
    const double eps = options_.eps;
    return K <= -eps ? 0 : K < eps ? std::abs(K) : (1 + K) / ((1 + H2) * K);
  }

  LocalDirectionalOptions options_;
  KnownFans known_;
};

}  // namespace

std::unique_ptr<Flow> LocalDirectionalOptions::start(const Mesh&, const Constraints&, const Context&) const {
  return make_explicit(std::make_unique<LocalDirectionalSpeed>(*this), lambda);
}

}  // namespace rfsmooth
