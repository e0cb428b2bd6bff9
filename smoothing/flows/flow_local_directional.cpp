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
    const Adjacency& around = fans_.faces;
    if (around.size() != n) {
      fans_ = fans_of(mesh, context);
      interior_ = interior_vertices(mesh, around, context);
    }
    const Operator op = curvature(mesh, around, context, options_.scheme);
    const std::vector<double> area =
        options_.scheme == Scheme::safe ? op.mass : curvature(mesh, around, context).mass;  // twice the mixed
    const double h2 = op.unit;
    Positions Hn;
    apply(mesh.one_ring, op, mesh.positions, Hn, context);
    const auto gauss = [&](std::size_t i) {
      return interior_[i] != 0 ? h2 * angle_deficit(mesh, around, Index(i)) * 2 / area[i] : 0;
    };
    std::vector<double> pull(n);  // what each vertex weighs in the integral
    for_each_index(context, n, [&](std::size_t i) {
      const double m = options_.power, H2 = h2 * Hn[i].squaredNorm();
      pull[i] = area[i] * std::pow(4 * H2, m) * (m > 0 ? 6 * m * (2 * H2 - gauss(i)) + 2 * H2 : 2 * H2);
    });
    std::vector<char> against;
    const Positions normal = unsigned_normals(mesh, fans_, context, &against);
    /// Whether face number f runs against the normal of its vertex i.
    const auto opposed = [&](Index f, std::size_t i) {
      const auto row = around[i];
      return against[around.start[i] +
                     std::size_t(std::lower_bound(row.begin(), row.end(), f) - row.begin())] != 0;
    };
    speed.assign(n, Vector3d::Zero());
    for_each_index(context, n, [&](std::size_t i) {
      if (interior_[i] == 0) return;
      Vector3d b = Vector3d::Zero();
      const auto part = [&](std::size_t j) { return Vector3d(pull[j] * normal[j]); };
      b += part(i);
      for (const Index j : mesh.one_ring[i]) {
        const auto row = around[i];  // its side is told by the first face that has both
        const Index f = *std::find_if(row.begin(), row.end(),
                                      [&](Index g) { return rfs_mesh::has_corner(mesh.faces[g], j); });
        b += opposed(f, i) == opposed(f, j) ? part(j) : Vector3d(-part(j));
      }
      if (!(b.norm() > 0)) return;
      const double K = gauss(i), H2 = h2 * Hn[i].squaredNorm(), eps = options_.eps;
      const double w = K <= -eps ? 0 : K < eps ? std::abs(K) : (1 + K) / ((1 + H2) * K);
      // inward = -L x
      Vector3d v = -w * h2 * b.normalized().dot(normal[i]) * Hn[i];
      // half an edge at most, so that needles cannot blow the flow up
      const double longest = 0.5 * std::sqrt(h2) / std::max(options_.lambda, 1e-300);
      if (options_.scheme == Scheme::safe && v.norm() > longest) v *= longest / v.norm();
      if (v.allFinite()) speed[i] = v;
    });
  }

  void connectivity_changed(const Mesh&, const Context&) override { fans_ = {}; }

 private:
  LocalDirectionalOptions options_;
  Fans fans_;
  std::vector<char> interior_;
};

}  // namespace

std::unique_ptr<Flow> LocalDirectionalOptions::start(const Mesh&, const Constraints&, const Context&) const {
  return make_explicit(std::make_unique<LocalDirectionalSpeed>(*this), lambda, Update::simultaneous);
}

}  // namespace rfsmooth
