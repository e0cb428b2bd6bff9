#include "smoothing/modifiers/threshold.h"

#include <algorithm>

#include "base/parallel.h"
#include "smoothing/modifiers/wrapped_flow.h"
#include "smoothing/operators/operator.h"

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
    inner_->step(mesh, context);
    speed_.resize(n);
    for_each_index(context, n, [&](std::size_t i) {
      speed_[i] = (mesh.positions[i] - before_[i]).norm() / rule_.lambda;
    });
    if (steps_++ % rule_.every == 0 || threshold_.size() != n) recompute(mesh, context);
    for_each_index(context, n, [&](std::size_t i) {
      const double excess = speed_[i] - threshold_[i];
      if (excess > 0)
        mesh.positions[i] = before_[i] + excess / speed_[i] * (mesh.positions[i] - before_[i]);
      else
        mesh.positions[i] = before_[i];
    });
  }

  bool applies_constraints() const override { return inner_->applies_constraints(); }

 private:
  void recompute(const Mesh& mesh, const Context& context) {
    threshold_.assign(speed_.size(), rule_.constant * unit_);
    if (rule_.rings == 0) return;
    for_blocks(context, speed_.size(), 1024, [&](std::size_t begin, std::size_t end) {
      std::vector<Index> ring;
      for (std::size_t i = begin; i < end; ++i) {
        ring.assign(1, Index(i));
        for (int r = 0; r < rule_.rings; ++r)
          for (std::size_t at = 0, size = ring.size(); at < size; ++at)
            ring.insert(ring.end(), mesh.one_ring[ring[at]].begin(), mesh.one_ring[ring[at]].end());
        std::sort(ring.begin(), ring.end());
        ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
        double sum = 0;
        for (const Index j : ring) sum += speed_[j];
        threshold_[i] = sum / double(ring.size());
      }
    });
  }

  ThresholdRule rule_;
  double unit_;
  int steps_ = 0;
  Positions before_;
  std::vector<double> speed_, threshold_;
};

}  // namespace

std::unique_ptr<Flow> make_threshold(std::unique_ptr<Flow> inner, const Mesh& mesh, const ThresholdRule& rule,
                                     const Context& context) {
  return std::make_unique<Threshold>(std::move(inner), rule, length_unit(mesh, context));
}

}  // namespace rfsmooth::smoothing
