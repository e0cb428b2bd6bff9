/// The automatic flow (automatic.h): strength chosen at every point from the data.
#include <algorithm>
#include <utility>

#include <rfsmooth/flow.h>

#include "base/parallel.h"
#include "rfs_mesh/fit/local_surface.h"
#include "rfs_mesh/noise/noise.h"
#include "smoothing/automatic/automatic.h"
#include "smoothing/automatic/equalize.h"

namespace rfsmooth::smoothing {

namespace {

/// Sigma of a point's own neighbourhood: no point moves farther, whatever the figure for the whole cloud
/// says. Six is the goal, and two measurements of the field differ by a third; 4 costs the development shapes
/// nothing.
constexpr double kMostLocalSigma = 4;

/// Where most of the scatter is shape, a little noise cannot be told from detail: better leave a clean cloud
/// alone. Both numbers from the development shapes, clean and with noise of 0.1 spacings.
double measured(const rfs_mesh::NoiseField& noise, double spacing) {
  constexpr double kLittle = 0.1, kMostlyShape = 0.4;
  return noise.sigma < kLittle * spacing && noise.shape > kMostlyShape ? 0 : noise.sigma;
}

/// Noise of the size `sigma` that varies over the cloud as `noise` does.
rfs_mesh::NoiseField scaled(rfs_mesh::NoiseField noise, double sigma) {
  for (double& local : noise.local) local = noise.sigma > 0 ? local * sigma / noise.sigma : sigma;
  noise.sigma = sigma;
  return noise;
}

class AutomaticFlow : public Flow {
 public:
  explicit AutomaticFlow(const FlowOptions& options)
      : noise_(options.noise), strength_(*options.strength), equalize_(*options.equalize) {}

  void step(Mesh& mesh, const Context& context) override { advance(mesh, true, context); }
  void last_step(Mesh& mesh, const Context& context) override {
    std::vector<Face>().swap(mesh.faces);
    advance(mesh, false, context);
  }

  bool limits_moves() const override { return true; }
  std::optional<AutomaticReport> automatic() const override { return report_; }

 private:
  void advance(Mesh& mesh, bool keep_rings, const Context& context) {
    if (mesh.positions.size() < 2) return;
    double spacing = 0;
    rfs_mesh::NoiseField noise;
    {
      const rfs_mesh::SpatialIndex index(mesh.positions, context);
      spacing = rfs_mesh::mean_spacing(index, context);
      noise = rfs_mesh::measure_noise(index, context);
    }
    const double sigma = noise_ ? noise_->resolve(spacing) : measured(noise, spacing);
    noise = scaled(std::move(noise), strength_ * sigma);
    report_.emplace();
    rfs_mesh::NeighborTable near;
    Positions smooth = automatic_smoothing(mesh, keep_rings, noise, spacing, *report_, near, context);
    mesh.positions.swap(smooth);
    const Positions before = std::move(smooth);
    report_->noise = sigma;
    if (report_->guide_strength > 0)
      move_along_surface(before, sigma, spacing, std::move(near), mesh.positions, context);
    if (strength_ > 0) limit(before, noise.local, mesh.positions, context);
  }

  /// Evens the points out; or takes back what the guide moved them, so that they move along normals only.
  void move_along_surface(const Positions& before, double sigma, double spacing, rfs_mesh::NeighborTable near,
                          Positions& points, const Context& context) {
    if (equalize_) {
      const Equalized moved = equalize(points, before, strength_ * sigma, spacing, std::move(near), context);
      report_->equalized = moved.rms;
      report_->equalized_most = moved.largest;
    } else {
      slide_back(points, before, 1, std::move(near), context);
    }
  }

  /// `local`: sigma times strength.
  void limit(const Positions& before, const std::vector<double>& local, Positions& points,
             const Context& context) const {
    for_each_index(context, points.size(), [&](std::size_t i) {
      const double most = kMostLocalSigma * std::max(1.0, 1 / strength_) * local[i];
      const Eigen::Vector3d move = points[i] - before[i];
      if (const double length = move.norm(); length > most) points[i] = before[i] + most / length * move;
    });
  }

  std::optional<Length> noise_;
  double strength_;
  bool equalize_;
  std::optional<AutomaticReport> report_;
};

std::unique_ptr<Flow> make_auto(const Mesh&, const FlowOptions& options, const Constraints&, const Context&) {
  return std::make_unique<AutomaticFlow>(options);
}

}  // namespace

FlowEntry flow_auto() {
  FlowOptions defaults;
  defaults.iterations = 1;
  defaults.strength = 1;
  defaults.equalize = true;
  return {"auto",
          "strength chosen at every point from the measured noise; the default",
          "Desbrun 2.6, Kobbelt, Stein 1981",
          {"iterations", "strength", "noise", "equalize"},
          defaults,
          make_auto};
}

}  // namespace rfsmooth::smoothing
