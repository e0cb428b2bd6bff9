#include "clouds/scanner/scanner.h"

#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Geometry>

#include "base/parallel.h"

namespace rfsmooth::clouds {

using Eigen::Vector3d;

namespace {

constexpr double kRadians = 0.017453292519943295;
constexpr double kGrazing =
    0.2;  // no real scanner returns from flatter than about 78 degrees with finite noise

struct Ray {
  Vector3d origin, direction;
  Vector3d at(double t) const { return origin + t * direction; }
};

/// A viewpoint and the steps between its rays.
struct View {
  Vector3d eye, forward, right, up;
  double step = 0;  // radians between rays

  Ray ray(double column, double row) const {
    return {eye, (forward + std::tan(column * step) * right - std::tan(row * step) * up).normalized()};
  }
};

/// The range at which the ray meets the shape: sphere tracing by the shape's clearance.
std::optional<double> meet(const Shape& shape, const Ray& ray) {
  const double radius = shape.radius();
  const double nearest = -ray.origin.dot(ray.direction);
  const double squared = ray.origin.squaredNorm() - nearest * nearest;
  if (squared > radius * radius) return std::nullopt;
  const double half_chord = std::sqrt(radius * radius - squared), end = nearest + half_chord;
  double t = std::max(0.0, nearest - half_chord);
  for (int step = 0; step < 2000 && t <= end; ++step) {
    const double clearance = shape.clearance(ray.at(t));
    if (clearance < 1e-10 * radius) return t;
    t += clearance;
  }
  return std::nullopt;
}

std::vector<View> viewpoints(const Shape& shape, const ScannerOptions& options) {
  std::vector<View> views;
  // The whole shape fits, with a margin of a tenth.
  const double field = 2 * std::asin(std::min(1.0, 1.1 * shape.radius() / options.distance));
  for (int k = 0; k < options.views; ++k) {
    const double azimuth = 360.0 * k / options.views * kRadians;
    const double elevation = (k % 2 == 0 ? 1 : -1) * options.elevation * kRadians;
    View view;
    view.eye = options.distance * Vector3d(std::cos(elevation) * std::cos(azimuth),
                                           std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    view.forward = -view.eye.normalized();
    view.right = view.forward.cross(Vector3d::UnitZ()).normalized();
    view.up = view.right.cross(view.forward);
    view.step = field / std::max(options.columns, options.rows);
    views.push_back(view);
  }
  return views;
}

class Scanner {
 public:
  Scanner(const Shape& shape, const ScannerOptions& options) : shape_(shape), options_(options) {}

  Return measure(const View& view, double column, double row, Random& random) const {
    const Ray ray = view.ray(column, row);
    const std::optional<double> range = meet(shape_, ray);
    Return out;
    if (options_.beam > 0) {
      const double mixed = mixed_range(view, column, row, range, random);
      if (mixed > 0) {
        out.kind = ReturnKind::mixed;
        out.measured = ray.at(mixed);
        out.truth = on_surface(out.measured);
        out.intensity = kGrazing;
        return out;
      }
    }
    if (!range) return out;
    out.kind = ReturnKind::surface;
    out.truth = ray.at(*range);
    out.intensity = std::abs(shape_.normal(out.truth).dot(ray.direction));
    if (options_.model == "isotropic") {
      out.measured = out.truth + options_.noise * random.normal3();
    } else {
      const double sigma = options_.noise * std::pow(*range / options_.distance, options_.range_power) /
                           std::max(out.intensity, kGrazing);
      out.measured = ray.at(*range + sigma * random.normal());
    }
    return out;
  }

  Vector3d on_surface(const Vector3d& p) const { return p - shape_.signed_distance(p) * gradient(p); }

 private:
  /// Where the beam straddles a jump in range: somewhere between its ends. 0 = it does not.
  double mixed_range(const View& view, double column, double row, const std::optional<double>& centre,
                     Random& random) const {
    const double half = 0.5 * options_.beam;
    double nearest = std::numeric_limits<double>::infinity(), furthest = 0;
    const auto note = [&](const std::optional<double>& range) {
      const double t = range.value_or(options_.distance + options_.background);
      nearest = std::min(nearest, t);
      furthest = std::max(furthest, t);
    };
    note(centre);
    for (const double dc : {-half, half})
      for (const double dr : {-half, half}) note(meet(shape_, view.ray(column + dc, row + dr)));
    const bool hit = nearest < options_.distance + options_.background;
    // A slanted but whole surface spans a few steps in range; a jump spans more.
    const double jump = 8 * (options_.beam + 1) * view.step * nearest;
    if (!hit || furthest - nearest < jump) return 0;
    // How much of the beam falls on each side is chance; most mixed pixels lie near one of the two surfaces.
    const double share = random.uniform();
    if (share < 0.5) return 0;
    const double u = random.uniform();
    return nearest + u * u * (furthest - nearest);
  }

  /// Direction of steepest growth of the signed distance, by central differences.
  Vector3d gradient(const Vector3d& p) const {
    constexpr double kStep = 1e-6;
    Vector3d g;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d e = kStep * Vector3d::Unit(axis);
      g[axis] = shape_.signed_distance(p + e) - shape_.signed_distance(p - e);
    }
    const double length = g.norm();
    return length > 0 ? Vector3d(g / length) : shape_.normal(p);
  }

  const Shape& shape_;
  const ScannerOptions& options_;
};

}  // namespace

std::vector<Return> scan(const Shape& shape, const ScannerOptions& options, std::uint64_t seed,
                         const Context& context) {
  value_or_throw(validate(options));
  if (options.distance <= shape.radius())
    throw Failure({ErrorCode::usage, "distance: the scanner stands inside the shape; its radius is " +
                                         std::to_string(shape.radius())});
  const Scanner scanner(shape, options);
  const std::vector<View> views = viewpoints(shape, options);
  const std::size_t per_view = std::size_t(options.columns) * std::size_t(options.rows);
  std::vector<Return> returns(views.size() * per_view);
  for_each_index(
      context, returns.size(),
      [&](std::size_t i) {
        const std::size_t view = i / per_view, row = i % per_view / std::size_t(options.columns);
        const std::size_t column = i % std::size_t(options.columns);
        Random random(seed * 0xd1342543de82ef95u + i);
        Return out = scanner.measure(views[view], double(column) - 0.5 * (options.columns - 1),
                                     double(row) - 0.5 * (options.rows - 1), random);
        const double radius = shape.radius();
        if (out.kind != ReturnKind::none) {
          if (random.uniform() < options.outliers) {
            out.kind = ReturnKind::stray;
            out.measured = random.in_box(Vector3d::Constant(-1.3 * radius), Vector3d::Constant(1.3 * radius));
            out.truth = scanner.on_surface(out.measured);
            out.intensity = 0;
          }
          if (random.uniform() < options.dropout * 0.5 * (1 - out.truth[0] / radius)) out = {};
        }
        out.view = int(view);
        returns[i] = out;
      },
      256);
  return returns;
}

}  // namespace rfsmooth::clouds
