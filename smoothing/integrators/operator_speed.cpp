#include "smoothing/integrators/operator_speed.h"

#include "base/parallel.h"
#include "smoothing/operators/operator.h"

namespace rfsmooth::smoothing {

namespace {

class OperatorSpeed : public Speed {
 public:
  OperatorSpeed(OperatorKind kind, double lambda, Scheme scheme)
      : source_(kind, false, scheme), lambda_(lambda), scheme_(scheme) {}

  void evaluate(const Mesh& mesh, Positions& speed, const Context& context) override {
    const Operator& op = source_.on(mesh, context);
    apply(op.rows(mesh), op, mesh.positions, speed, context);
    const std::vector<double> sums = weight_sums(op.rows(mesh), op, context);
    for_each_index(context, speed.size(), [&](std::size_t i) {
      const double rate = scheme_ == Scheme::printed ? 0 : lambda_ * op.unit * sums[i] / op.mass[i];
      speed[i] *= -op.unit / std::max(1.0, rate);
    });
  }

  void connectivity_changed(const Mesh&, const Context&) override { source_.connectivity_changed(); }

 private:
  OperatorSource source_;
  double lambda_;
  Scheme scheme_;
};

}  // namespace

std::unique_ptr<Speed> make_operator_speed(OperatorKind kind, double lambda, Scheme scheme) {
  return std::make_unique<OperatorSpeed>(kind, lambda, scheme);
}

}  // namespace rfsmooth::smoothing
