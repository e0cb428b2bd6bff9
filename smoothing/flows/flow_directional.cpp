/// Directional diffusion: mean curvature flow weighted with the cosine to one direction; keeps the volume of
/// a closed surface.
///
///     dx/dt = (a, n) H n,   H n the inward cotangent vector, |a| = 1
///
/// Zhao, Xu 2005, (3), (33). The direction is the user's, or the one in which E = integral H^(2m) dA falls:
///
///     m = 0:   a ~ + integral 2 n H^2 dA
///     m >= 1:  a ~ - integral n { m H Lap(H^(2m-1)) + H^(2m) (2m (2 H^2 - K) - 2 H^2) } dA,  H < 0 on a
///     sphere
///
/// Differs from the paper: its a = -A and its step P - s (a, n) H n belong together, with one of the two
/// minus signs the area grows; for m >= 1 its (31)-(33) are not the gradient of E (a term in Lap(H^(2m-1)) is
/// dropped and a factor is wrong). Its open problem, a volume-preserving scheme: v_i = -(a . gradA_i) gradV_i
/// / (2 |gradV_i|^2) equals (a, n) H n in the limit, and changes the volume by zero to first order for every
/// a, since the gradients of the area sum to zero. For m = 0 the direction is the gradient of this scheme's
/// own area. a = 0 on symmetric shapes. Where (a, n) < 0 it is backward diffusion: steps stay few and small.
/// The mesh is oriented first, as far as it can be. Only a closed one keeps its volume; vertices whose edges
/// do not all have two faces stay, so that rough meshes and open ones can be smoothed too. lambda in units of
/// h^2.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "base/parallel.h"
#include "smoothing/integrators/explicit.h"
#include "smoothing/operators/operator.h"
#include "smoothing/operators/surface.h"

namespace rfsmooth::smoothing {

namespace {

using Eigen::Vector3d;

class DirectionalSpeed : public Speed {
 public:
  DirectionalSpeed(const Mesh& mesh, int power, const Vector3d& direction, const Context& context)
      : power_(power), direction_(direction) {
    connectivity_changed(mesh, context);
  }

  void evaluate(const Mesh& mesh, Positions& speed, const Context& context) override {
    const Positions& x = mesh.positions;
    const std::size_t n = x.size();
    const double h = length_unit(mesh, context);
    Positions area(n), volume(n);  // gradients, in units of h
    for_each_index(context, n, [&](std::size_t i) {
      area[i].setZero();
      volume[i].setZero();
      if (!interior_[i]) return;
      for (const Index f : around_[i]) {
        const Face& face = faces_[f];
        const int k = face[0] == i ? 0 : face[1] == i ? 1 : 2;
        const Vector3d p = x[face[(k + 1) % 3]] - x[i], q = x[face[(k + 2) % 3]] - x[i];
        const Vector3d cross = p.cross(q);
        volume[i] += cross / (6 * h * h);
        if (cross.norm() > 1e-8 * std::max({p.squaredNorm(), q.squaredNorm(), (q - p).squaredNorm()}))
          area[i] += 0.5 / h * cross.normalized().cross(q - p);
      }
    });
    const Vector3d a = choose(mesh, area, volume, h, context);
    speed.resize(n);
    for_each_index(context, n, [&](std::size_t i) {
      const double size = volume[i].squaredNorm();
      const Vector3d v = size > 0 ? Vector3d(-0.5 * h * a.dot(area[i]) / size * volume[i]) : Vector3d::Zero();
      speed[i] = v.allFinite() ? v : Vector3d(Vector3d::Zero());
    });
  }

  void connectivity_changed(const Mesh& mesh, const Context& context) override {
    faces_ = oriented_as_far_as_possible(mesh);
    around_ = vertex_faces(mesh, context);
    interior_ = interior_vertices(mesh, around_, context);
  }

 private:
  /// The unit direction; zero on shapes too symmetric to have one.
  Vector3d choose(const Mesh& mesh, const Positions& area, const Positions& volume, double h,
                  const Context& context) const {
    if (direction_ != Vector3d::Zero()) return direction_;
    const std::size_t n = area.size();
    const Vector3d zero = Vector3d::Zero();
    Vector3d a;
    double size = 0;  // the same sum without directions, to tell a direction from rounding
    if (power_ == 0) {
      const auto term = [&](std::size_t i) {
        const double v = volume[i].squaredNorm();
        return v > 0 ? Vector3d(volume[i].dot(area[i]) / v * area[i]) : zero;
      };
      a = sum_over(context, n, zero, term);
      size = sum_over(context, n, 0.0, [&](std::size_t i) { return term(i).norm(); });
    } else {
      const Operator op = curvature(mesh, around_, context);
      Positions Hn, field(n), laplacian;
      apply(mesh.one_ring, op, mesh.positions, Hn, context);
      std::vector<double> H(n), K(n), share(n);
      for_each_index(context, n, [&](std::size_t i) {
        const Vector3d normal = volume[i].normalized();
        share[i] = op.mass[i] / (2 * h * h);
        H[i] = -h * Hn[i].dot(normal);
        K[i] = angle_deficit(mesh, around_, Index(i)) / share[i];
        field[i] = Vector3d(std::pow(H[i], 2 * power_ - 1), 0, 0);
      });
      apply(mesh.one_ring, op, field, laplacian, context);
      const auto term = [&](std::size_t i) {
        const double m = power_, H2 = H[i] * H[i];
        const double lap = -2 * h * h * laplacian[i].x();  // the operator is -Lap/2
        const double inside = m * H[i] * lap + std::pow(H2, m) * (2 * m * (2 * H2 - K[i]) - 2 * H2);
        const Vector3d t = -inside * share[i] * volume[i].normalized();
        return t.allFinite() ? t : zero;
      };
      a = sum_over(context, n, zero, term);
      size = sum_over(context, n, 0.0, [&](std::size_t i) { return term(i).norm(); });
    }
    return a.norm() > 1e-12 * size ? Vector3d(a.normalized()) : zero;
  }

  int power_;
  Vector3d direction_;
  std::vector<Face> faces_;
  Adjacency around_;
  std::vector<char> interior_;
};

/// "x,y,z" to a unit vector; empty = zero.
Vector3d parse_direction(const std::string& text) {
  if (text == "auto") return Vector3d::Zero();
  Vector3d d;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &d.x(), &d.y(), &d.z(), &rest) != 3 || !d.allFinite() ||
      !(d.norm() > 0))
    throw Failure({ErrorCode::usage, fmt::format("--direction is '{}'; it must be auto or three numbers "
                                                 "x,y,z, not all zero",
                                                 text)});
  return d.normalized();
}

std::unique_ptr<Flow> make_directional(const Mesh& mesh, const FlowOptions& options, const Constraints&,
                                       const Context& context) {
  return make_explicit(
      std::make_unique<DirectionalSpeed>(mesh, *options.power, parse_direction(*options.direction), context),
      *options.lambda, Update::simultaneous);
}

}  // namespace

FlowEntry flow_directional() {
  FlowOptions defaults;
  defaults.iterations = 4;
  defaults.lambda = 0.05;
  defaults.power = 0;
  defaults.direction = "auto";
  return {"directional",
          "curvature flow along one direction; keeps the volume of closed meshes",
          "Zhao-Xu (3), (33)",
          {"iterations", "lambda", "power", "direction"},
          defaults,
          make_directional};
}

}  // namespace rfsmooth::smoothing
