#include "smoothing/integrators/umbrella_speed.h"

#include "base/parallel.h"

namespace rfsmooth::smoothing {

using Eigen::Vector3d;

namespace {

template <UmbrellaWeights kWeights>
class UmbrellaSpeed : public VertexSpeed {
 public:
  void evaluate(const Mesh& mesh, Positions& speed, const Context& context) override {
    speed.resize(mesh.positions.size());
    for_each_index(context, speed.size(), [&](std::size_t i) { speed[i] = of(mesh, Index(i)); });
  }

  Vector3d at(const Mesh& mesh, Index i) const override { return of(mesh, i); }

 private:
  static Vector3d of(const Mesh& mesh, Index i) {
    const Vector3d q = mesh.positions[i];
    const auto row = mesh.one_ring[i];
    Vector3d sum = Vector3d::Zero();
    double total = 0;
    for (const Index j : row) {
      const Vector3d& neighbour = mesh.positions[j];
      if constexpr (kWeights == UmbrellaWeights::inverse_distance) {
        const double length = (neighbour - q).norm();
        if (length == 0) continue;
        sum += (neighbour - q) / length;
        total += 1 / length;
      } else {
        sum += neighbour;
      }
    }
    if constexpr (kWeights == UmbrellaWeights::inverse_distance)
      return total > 0 ? Vector3d(sum / total) : Vector3d::Zero();
    return row.size() > 0 ? Vector3d((1 / double(row.size())) * sum - q) : Vector3d::Zero();
  }
};

}  // namespace

std::unique_ptr<VertexSpeed> make_umbrella_speed(UmbrellaWeights weights) {
  if (weights == UmbrellaWeights::inverse_distance)
    return std::make_unique<UmbrellaSpeed<UmbrellaWeights::inverse_distance>>();
  return std::make_unique<UmbrellaSpeed<UmbrellaWeights::equal>>();
}

}  // namespace rfsmooth::smoothing
