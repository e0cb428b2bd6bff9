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
/// dropped and a factor is wrong). Its open problem, a volume-preserving scheme: v_i = -(a . gradA_i) n_i /
/// (2 g_i), n along gradV and g a third of the one-ring's area, equals (a, n) H n in the limit. Where the
/// ring is flat g = |gradV|, and the volume changes by zero to first order for every a, since the gradients
/// of the area sum to zero; on spikes and folds |gradV| vanishes and g does not, and what that leaves of the
/// change is taken off along gradV by all vertices together. A vertex whose explicit limit is below lambda
/// moves by that limit. For m = 0 the direction is the gradient of this scheme's own area. a = 0 on symmetric
/// shapes. Where (a, n) < 0 it is backward diffusion: steps stay few and small.
///
/// The printed scheme takes H n of (37), a of (33) with the area of the whole one-ring (a third of H n), and
/// no limits; its two minus signs are taken together.
///
/// The mesh is oriented first, as far as it can be; an open one keeps its side. Only a closed one keeps its
/// volume; vertices whose edges do not all have two faces stay, so that rough meshes and open ones can be
/// smoothed too, and the log says so. lambda in units of h^2.
#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "base/fail.h"
#include "base/parallel.h"
#include "rfs_mesh/corners.h"
#include "smoothing/integrators/explicit.h"
#include "smoothing/operators/operator.h"
#include "smoothing/operators/surface.h"

namespace rfsmooth {

using namespace smoothing;

namespace {

using Eigen::Vector3d;

class DirectionalSpeed : public Speed {
 public:
  DirectionalSpeed(const Mesh& mesh, int power, const Vector3d& direction, Scheme scheme, double lambda,
                   const Context& context)
      : power_(power), direction_(direction), scheme_(scheme), lambda_(lambda) {
    connectivity_changed(mesh, context);
    warn(context);
  }

  void evaluate(const Mesh& mesh, Positions& speed, const Context& context) override {
    const double h = length_unit(mesh, context);
    const Gradients grad = gradients(mesh, h, context);
    const Vector3d a = choose(mesh, grad, h, context);
    speed.resize(grad.area.size());
    for_each_index(context, speed.size(), [&](std::size_t i) {
      const Vector3d v = h * (scheme_ == Scheme::printed ? printed(grad, i, a) : conserving(grad, i, a));
      speed[i] = v.allFinite() ? v : Vector3d(Vector3d::Zero());
    });
    if (scheme_ == Scheme::safe) restore_volume(grad, a, h, speed, context);
  }

  void connectivity_changed(const Mesh& mesh, const Context& context) override {
    faces_ = oriented_as_far_as_possible(mesh, &unclosed_);
    around_ = vertex_faces(mesh, context);
    interior_ = interior_vertices(mesh, around_, context);
  }

 private:
  /// All in units of h; zero at vertices that stay.
  struct Gradients {
    Positions area, volume;         ///< of the surface's area and volume by each vertex
    std::vector<double> ring;       ///< area of the one-ring
    std::vector<double> stiffness;  ///< sum of the |cotangents| / 2 opposite to the vertex's edges
  };

  Gradients gradients(const Mesh& mesh, double h, const Context& context) const {
    const Positions& x = mesh.positions;
    const std::size_t n = x.size();
    Gradients grad{Positions(n, Vector3d::Zero()), Positions(n, Vector3d::Zero()), std::vector<double>(n, 0),
                   std::vector<double>(n, 0)};
    for_each_index(context, n, [&](std::size_t i) {
      if (!interior_[i]) return;
      for (const Index f : around_[i]) {
        const rfs_mesh::OtherCorners other = rfs_mesh::other_corners(faces_[f], Index(i));
        const Vector3d p = x[other.next] - x[i], q = x[other.last] - x[i];
        const Vector3d cross = p.cross(q);
        const double doubled = cross.norm();
        grad.volume[i] += cross / (6 * h * h);
        grad.ring[i] += doubled / (2 * h * h);
        if (!(doubled > 1e-8 * std::max({p.squaredNorm(), q.squaredNorm(), (q - p).squaredNorm()}))) continue;
        grad.area[i] += 0.5 / h * (cross / doubled).cross(q - p);
        grad.stiffness[i] += 0.5 * (std::abs(p.dot(p - q)) + std::abs(q.dot(q - p))) / doubled;
      }
    });
    return grad;
  }

  /// -(a . gradA) n / (2 g), n along gradV and g the third of the one-ring's area that |gradV| is where the
  /// ring is flat; shortened where a step of lambda would pass the vertex's own limit.
  Vector3d conserving(const Gradients& grad, std::size_t i, const Vector3d& a) const {
    const double g = grad.ring[i] / 3;
    if (!(g > 0) || grad.volume[i] == Vector3d::Zero()) return Vector3d::Zero();
    const Vector3d n = grad.volume[i].normalized();
    const double rate = lambda_ * grad.stiffness[i] * std::abs(a.dot(n)) / (2 * g);
    return -a.dot(grad.area[i]) / (2 * g * std::max(1.0, rate)) * n;
  }

  /// (a, n) H n with H n = -gradA / (2 A), A the area of the one-ring (37).
  static Vector3d printed(const Gradients& grad, std::size_t i, const Vector3d& a) {
    if (!(grad.ring[i] > 0)) return Vector3d::Zero();
    return -a.dot(grad.volume[i].normalized()) / (2 * grad.ring[i]) * grad.area[i];
  }

  /// Takes off the change of volume, to first order, that spikes, folds and limited vertices leave beside the
  /// -a . gradA / 2 that each vertex owes; on a closed surface these add up to zero.
  static void restore_volume(const Gradients& grad, const Vector3d& a, double h, Positions& speed,
                             const Context& context) {
    const double change = sum_over(context, speed.size(), 0.0, [&](std::size_t i) {
      return grad.volume[i].dot(speed[i]) + 0.5 * h * a.dot(grad.area[i]);
    });
    const double size =
        sum_over(context, speed.size(), 0.0, [&](std::size_t i) { return grad.volume[i].squaredNorm(); });
    if (!(size > 0) || !std::isfinite(change / size)) return;
    for_each_index(context, speed.size(), [&](std::size_t i) { speed[i] -= change / size * grad.volume[i]; });
  }

  /// The unit direction; zero on shapes too symmetric to have one.
  Vector3d choose(const Mesh& mesh, const Gradients& grad, double h, const Context& context) const {
    if (direction_ != Vector3d::Zero()) return direction_;
    const bool area = power_ == 0 && scheme_ == Scheme::safe;
    const Positions terms = area ? area_terms(grad, context) : bending_terms(mesh, grad, h, context);
    const Vector3d a =
        sum_over(context, terms.size(), Vector3d(Vector3d::Zero()), [&](std::size_t i) { return terms[i]; });
    // The same sum without directions, to tell a direction from rounding.
    const double size = sum_over(context, terms.size(), 0.0, [&](std::size_t i) { return terms[i].norm(); });
    return a.norm() > 1e-12 * size ? Vector3d(a.normalized()) : Vector3d(Vector3d::Zero());
  }

  /// What each vertex adds to the direction in which the conserving scheme's own area falls.
  static Positions area_terms(const Gradients& grad, const Context& context) {
    Positions terms(grad.area.size(), Vector3d::Zero());
    for_each_index(context, terms.size(), [&](std::size_t i) {
      if (!(grad.ring[i] > 0)) return;
      terms[i] = grad.volume[i].normalized().dot(grad.area[i]) / grad.ring[i] * grad.area[i];
    });
    return terms;
  }

  /// What each vertex adds to a for the energy integral H^(2m) dA; of the printed scheme by (33).
  Positions bending_terms(const Mesh& mesh, const Gradients& grad, double h, const Context& context) const {
    const std::size_t n = mesh.positions.size();
    const Operator op = curvature(mesh, around_, context);
    Positions Hn, field(n), laplacian, terms(n, Vector3d::Zero());
    apply(mesh.one_ring, op, mesh.positions, Hn, context);
    std::vector<double> H(n), K(n), share(n);
    for_each_index(context, n, [&](std::size_t i) {
      share[i] = op.mass[i] / (2 * h * h);
      H[i] = -h * Hn[i].dot(grad.volume[i].normalized());
      if (scheme_ == Scheme::printed)  // the length of the vector of (37); only its square counts
        H[i] = h * Hn[i].norm() * share[i] / std::max(grad.ring[i], share[i]);
      K[i] = angle_deficit(mesh, around_, Index(i)) / share[i];
      field[i] = Vector3d(std::pow(H[i], 2 * power_ - 1), 0, 0);
    });
    apply(mesh.one_ring, op, field, laplacian, context);
    for_each_index(context, n, [&](std::size_t i) {
      const double m = power_, H2 = H[i] * H[i];
      const double lap = -2 * h * h * laplacian[i].x();  // the operator is -Lap/2
      const double inside = scheme_ == Scheme::printed
                                ? -std::pow(4 * H2, m) * (6 * m * (2 * H2 - K[i]) + 2 * H2)
                                : m * H[i] * lap + std::pow(H2, m) * (2 * m * (2 * H2 - K[i]) - 2 * H2);
      const Vector3d t = -inside * share[i] * grad.volume[i].normalized();
      if (t.allFinite()) terms[i] = t;
    });
    return terms;
  }

  void warn(const Context& context) const {
    if (unclosed_.one_sided)
      context.warn(
          "directional: the mesh has only one side, so 'along the direction' has no meaning "
          "where its faces cannot agree");
    if (unclosed_.rim + unclosed_.crowded > 0)
      context.warn(
          fmt::format("directional: the mesh is not closed ({} with one face, {} with more than "
                      "two); their vertices stay and the volume is not kept",
                      counted(unclosed_.rim, "edge"), unclosed_.crowded));
  }

  int power_;
  Vector3d direction_;
  Scheme scheme_;
  double lambda_;
  Unclosed unclosed_;
  std::vector<Face> faces_;
  Adjacency around_;
  std::vector<char> interior_;
};

}  // namespace

std::unique_ptr<Flow> DirectionalOptions::start(const Mesh& mesh, const Constraints&,
                                                const Context& context) const {
  const Eigen::Vector3d unit = direction ? direction->normalized() : Eigen::Vector3d(Eigen::Vector3d::Zero());
  return make_explicit(std::make_unique<DirectionalSpeed>(mesh, power, unit, scheme, lambda, context),
                       lambda);
}

}  // namespace rfsmooth
