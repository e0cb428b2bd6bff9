/// The automatic flow (automatic.h): strength chosen at every point from the data.
#include "rfsmooth/rfs_mesh/local_surface.h"
#include "rfsmooth/rfs_mesh/noise.h"
#include "rfsmooth/rfs_mesh/parallel.h"
#include "rfsmooth/smoothing/automatic.h"
#include "rfsmooth/smoothing/equalize.h"
#include "rfsmooth/smoothing/flow.h"

namespace rfsmooth::smoothing {

namespace {

/// Sigma: noise has not carried points far along the surface; 1 and 2 sigma cost Chamfer distance where it is
/// small.
constexpr double kMostSigma = 0.5;

class AutomaticFlow : public Flow {
 public:
  explicit AutomaticFlow(const FlowOptions& options)
      : noise_(options.noise), strength_(*options.strength), equalize_(*options.equalize) {}

  void step(rfs_mesh::Mesh& mesh, const Context& context) override {
    if (mesh.positions.size() < 2) return;
    double sigma = 0, spacing = 0;
    {
      const rfs_mesh::SpatialIndex index(mesh.positions, context);
      spacing = mean_spacing(mesh.positions, index.nearest(1, context), context);
      sigma = noise_ ? noise_->resolve(spacing) : rfs_mesh::measure_noise(index, context).sigma;
    }
    report_.emplace();
    mesh.positions = automatic_smoothing(mesh, strength_ * sigma, spacing, *report_, context);
    if (equalize_ && report_->guide_strength > 0) {
      const Equalized moved = equalize(mesh.positions, kMostSigma * strength_ * sigma, context);
      report_->equalized = moved.rms;
      report_->equalized_most = moved.largest;
    }
    report_->noise = sigma;
  }

  bool limits_moves() const override { return true; }
  std::optional<AutomaticReport> automatic() const override { return report_; }

 private:
  std::optional<Length> noise_;
  double strength_;
  bool equalize_;
  std::optional<AutomaticReport> report_;
};

std::unique_ptr<Flow> make(const rfs_mesh::Mesh&, const FlowOptions& options, const Constraints&,
                           const Context&) {
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
          make};
}

}  // namespace rfsmooth::smoothing
