#include "smoothing/automatic/learned/surroundings.h"

#include <algorithm>

namespace rfsmooth::smoothing {

void Surroundings::move_to(const Eigen::Vector3d& centre, double radius) {
  if ((centre - centre_).norm() + radius <= reach_) return;
  constexpr double kWider = 1.5;  // discs grow with its square, and with it what is looked at in vain
  centre_ = centre;
  reach_ = kWider * radius;
  field_.index().within_unsorted(centre, reach_, near_);
  stride_ = std::max<std::size_t>(1, (near_.size() + kMost - 1) / kMost);
  const std::size_t taken = (near_.size() + stride_ - 1) / stride_,
                    n = (taken + kLanes - 1) / kLanes * kLanes;
  for (auto* columns : {&guide, &data, &place, &normal})
    for (Column& column : *columns) column.assign(n, 0);
  residual.assign(n, 0);
  for (std::size_t k = 0; k < taken; ++k) {
    const std::size_t j = near_[k * stride_].index;
    const Packed& one = packed_[j];
    const Eigen::Vector3f there = (field_.guide()[j] - centre).cast<float>();
    for (std::size_t c = 0; c < 3; ++c) {
      guide[c][k] = there[Eigen::Index(c)];
      data[c][k] = one.data[Eigen::Index(c)];
      place[c][k] = one.place[Eigen::Index(c)];
      normal[c][k] = one.normal[Eigen::Index(c)];
    }
    residual[k] = one.residual;
  }
  for (std::size_t k = taken; k < n; ++k) guide[0][k] = float(4 * reach_);
}

}  // namespace rfsmooth::smoothing
