#include "smoothing/modifiers/preserve.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "base/parallel.h"
#include "rfs_mesh/measure.h"
#include "smoothing/modifiers/wrapped_flow.h"
#include "smoothing/operators/surface.h"

namespace rfsmooth::smoothing {

using Eigen::Vector3d;

namespace {

constexpr double kRestored = 1e-9;  // of its size: far above rounding, far below what a user could see

class Preserving : public WrappedFlow {
 public:
  Preserving(std::unique_ptr<Flow> inner, const Mesh& mesh, Preserve invariant, AllowedMoves allowed,
             const Context& context)
      : WrappedFlow(std::move(inner)), invariant_(invariant), allowed_(std::move(allowed)) {
    connect(mesh);
    target_ = measure(mesh.positions, context);
    // Of the terms without their signs: what rounding and "restored" are relative to.
    size_ = measure(mesh.positions, context, true);
  }

  void step(Mesh& mesh, const Context& context) override {
    inner_->step(mesh, context);
    const std::size_t n = mesh.positions.size();
    const Vector3d centre = rfs_mesh::centroid(mesh.positions, context);
    Positions direction(n), moved(n);
    for_each_index(context, n, [&](std::size_t i) {
      const Vector3d d =
          invariant_ == Preserve::height_field ? Vector3d(Vector3d::UnitZ()) : mesh.positions[i] - centre;
      direction[i] = allowed_.strength(i) * allowed_(i, d);
    });
    const auto at = [&](double t) {
      for_each_index(context, n, [&](std::size_t i) { moved[i] = mesh.positions[i] + t * direction[i]; });
      return measure(moved, context);
    };
    // Newton with a numerical slope; the invariant is a cubic (volume), nearly quadratic (area) or linear
    // function of t, and steps change it little, so this ends at rounding within a few rounds.
    double t = 0, value = at(0);
    const double span = invariant_ == Preserve::height_field
                            ? std::abs(target_ - value) / std::max(flat_area(mesh.positions), 1e-300)
                            : 1;
    for (int round = 0; round < 30; ++round) {
      const double gap = target_ - value;
      if (std::abs(gap) <= 1e-14 * size_) break;
      const double probe = 1e-4 * std::max(span, 1e-300);
      const double slope = (at(t + probe) - at(t - probe)) / (2 * probe);
      const double next = t + gap / slope;
      // A t of -1 would shrink the mesh to a point.
      if (!std::isfinite(next) || (invariant_ != Preserve::height_field && std::abs(next) >= 1)) break;
      t = next;
      value = at(t);
    }
    value = at(t);  // the last probe was elsewhere
    if (!(std::abs(target_ - value) <= kRestored * size_)) give_up(value, direction);
    for_each_index(context, n, [&](std::size_t i) {
      if (direction[i] != Vector3d::Zero() && moved[i].allFinite()) mesh.positions[i] = moved[i];
    });
  }

  void connectivity_changed(const Mesh& mesh, const Context& context) override {
    WrappedFlow::connectivity_changed(mesh, context);
    connect(mesh);
  }
  bool applies_constraints() const override { return inner_->applies_constraints(); }

 private:
  void connect(const Mesh& mesh) {
    if (invariant_ == Preserve::volume)
      faces_ = closed_and_oriented(mesh, "keeping the volume");
    else
      faces_ = mesh.faces;
    if (faces_.empty()) throw Failure({ErrorCode::usage, "keeping an area or a volume needs faces"});
  }

  /// The invariant, or the sum of its terms' sizes.
  double measure(const Positions& x, const Context& context, bool sizes = false) const {
    const auto sized = [sizes](double term) { return sizes ? std::abs(term) : term; };
    const Vector3d origin = x[faces_[0][0]];
    const double scale = invariant_ == Preserve::volume ? 1.0 / 6 : 0.5;
    return scale * sum_over(context, faces_.size(), 0.0, [&](std::size_t f) {
             const Vector3d a = x[faces_[f][0]] - origin, b = x[faces_[f][1]] - origin,
                            c = x[faces_[f][2]] - origin;
             if (invariant_ == Preserve::volume) return sized(a.dot(b.cross(c)));
             const Vector3d cross = (b - a).cross(c - a);
             if (invariant_ == Preserve::area) return cross.norm();
             return std::abs(cross.z()) *
                    sized(x[faces_[f][0]].z() + x[faces_[f][1]].z() + x[faces_[f][2]].z()) / 3;
           });
  }

  /// \throw Failure with the numbers and the reason.
  [[noreturn]] void give_up(double value, const Positions& direction) const {
    const auto movable = std::count_if(direction.begin(), direction.end(),
                                       [](const Vector3d& d) { return d != Vector3d::Zero(); });
    const char* const what = invariant_ == Preserve::volume ? "volume"
                             : invariant_ == Preserve::area ? "area"
                                                            : "volume under the height field";
    throw Failure(
        {ErrorCode::usage,
         fmt::format("the {} cannot be kept: a step takes it from {:.6g} to {:.6g}, and the {} of {} "
                     "vertices that the boundary rule and the constraints let move cannot bring it "
                     "back; fix fewer vertices, or do without `preserve`",
                     what, target_, value, movable, direction.size())});
  }

  /// The area of the faces seen from above.
  double flat_area(const Positions& x) const {
    double area = 0;
    for (const Face& f : faces_) area += 0.5 * std::abs(rfs_mesh::face_cross(x, f).z());
    return area;
  }

  Preserve invariant_;
  AllowedMoves allowed_;
  std::vector<Face> faces_;
  double target_ = 0, size_ = 0;
};

}  // namespace

std::unique_ptr<Flow> make_preserving(std::unique_ptr<Flow> inner, const Mesh& mesh, Preserve invariant,
                                      AllowedMoves allowed, const Context& context) {
  return std::make_unique<Preserving>(std::move(inner), mesh, invariant, std::move(allowed), context);
}

}  // namespace rfsmooth::smoothing
