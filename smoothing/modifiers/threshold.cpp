#include "smoothing/modifiers/threshold.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "smoothing/modifiers/wrapped_flow.h"
#include "smoothing/operators/operator.h"
#include "smoothing/operators/surface.h"

namespace rfsmooth::smoothing {

using Eigen::Vector3d;

namespace {

class Threshold : public WrappedFlow {
 public:
  Threshold(std::unique_ptr<Flow> inner, const ThresholdRule& rule, double unit)
      : WrappedFlow(std::move(inner)), rule_(rule), unit_(unit) {}

  void step(Mesh& mesh, const Context& context) override {
    before_ = mesh.positions;
    const std::size_t n = before_.size();
    if (steps_++ % rule_.every == 0 || threshold_.size() != n) recompute(mesh, context);
    inner_->step(mesh, context);
    speed_.resize(n);
    for_each_index(context, n, [&](std::size_t i) {
      speed_[i] = (mesh.positions[i] - before_[i]).norm() / rule_.lambda;
    });
    for_each_index(context, n, [&](std::size_t i) {
      const double excess = speed_[i] - threshold_[i];
      if (excess > 0)
        mesh.positions[i] = before_[i] + excess / speed_[i] * (mesh.positions[i] - before_[i]);
      else
        mesh.positions[i] = before_[i];
    });
  }

  void connectivity_changed(const Mesh& mesh, const Context& context) override {
    WrappedFlow::connectivity_changed(mesh, context);
    known_.forget();
  }
  bool applies_constraints() const override { return inner_->applies_constraints(); }

 private:
  /// n: h^2 |H|, the length of the curvature vector times h^2; at rims of its part along the normal.
  std::vector<double> bending(const Mesh& mesh, const Context& context) {
    const std::size_t n = mesh.positions.size();
    known_.find(mesh, context);
    const Operator op = curvature(mesh, known_.faces(), context, rule_.scheme);
    const Positions normal = unsigned_normals(mesh, known_.fans(), context);
    Positions Hn;
    apply(mesh.one_ring, op, mesh.positions, Hn, context);
    std::vector<double> bend(n);
    for_each_index(context, n, [&](std::size_t i) {
      const bool whole = known_.is_interior(i) || rule_.scheme == Scheme::printed;
      bend[i] = op.unit * (whole ? Hn[i].norm() : std::abs(Hn[i].dot(normal[i])));
    });
    return bend;
  }

  void recompute(const Mesh& mesh, const Context& context) {
    threshold_.assign(mesh.positions.size(), rule_.constant * unit_);
    if (rule_.rings == 0) return;
    const std::vector<double> bend = bending(mesh, context);
    for_blocks(context, threshold_.size(), 1024, [&](std::size_t begin, std::size_t end) {
      std::vector<Index> ring;
      for (std::size_t i = begin; i < end; ++i) {
        ring.assign(1, Index(i));
        for (int r = 0; r < rule_.rings; ++r)
          for (std::size_t at = 0, size = ring.size(); at < size; ++at)
            ring.insert(ring.end(), mesh.one_ring[ring[at]].begin(), mesh.one_ring[ring[at]].end());
        std::sort(ring.begin(), ring.end());
        ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
        double sum = 0;
        for (const Index j : ring)
          if (j != i) sum += bend[j];
        threshold_[i] = ring.size() > 1 ? sum / double(ring.size() - 1) : 0;
      }
    });
  }

  ThresholdRule rule_;
  double unit_;
  int steps_ = 0;
  KnownFans known_;
  Positions before_;
  std::vector<double> speed_, threshold_;
};

}  // namespace

std::unique_ptr<Flow> make_threshold(std::unique_ptr<Flow> inner, const Mesh& mesh, const ThresholdRule& rule,
                                     const Context& context) {
  return std::make_unique<Threshold>(std::move(inner), rule, length_unit(mesh, context));
}

}  // namespace rfsmooth::smoothing
