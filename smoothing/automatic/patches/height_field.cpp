#include "smoothing/automatic/patches/height_field.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "base/parallel.h"
#include "rfs_mesh/fit/plane_normal.h"
#include "rfs_mesh/normals/sides.h"
#include "smoothing/automatic/patches/weighted_sum.h"

namespace rfsmooth::smoothing {

namespace {

constexpr float kByteUnit = 255, kByteRounded = 0.5F;

}  // namespace

HeightField::HeightField(Positions guide, rfs_mesh::KdTree tree, rfs_mesh::NeighborTable near,
                         const Positions& data, const Context& context)
    : guide_(std::move(guide)), index_(guide_, std::move(tree), context), near_(std::move(near)) {
  if (near_.size() != size() || data.size() != size())
    throw std::invalid_argument("HeightField: guide, neighbours and data are not of the same points");
  local_.resize(size());
  for_each_index(context, size(), [&](std::size_t i) {
    const auto row = near_[i];
    const Eigen::Vector3d normal = rfs_mesh::plane_normal(
        guide_, i, {row.begin(), row.begin() + std::min(row.size(), rfs_mesh::kNeighbourhood)});
    local_[i].normal = normal.allFinite() ? Eigen::Vector3f(normal.cast<float>()) : Eigen::Vector3f::UnitZ();
  });
  orient(context);
  for_each_index(context, size(),
                 [&](std::size_t i) { local_[i].height = float(normal(i).dot(data[i] - guide_[i])); });
  near_weight_.resize(near_.items.size());
  for_each_index(context, size(), [&](std::size_t i) {
    const auto row = near_[i];
    if (row.size() == 0) return;
    const double square = 1.05 * (guide_[row[row.size() - 1]] - guide_[i]).squaredNorm();
    for (std::size_t k = 0; k < row.size(); ++k) {
      const double away = square > 0 ? (guide_[row[k]] - guide_[i]).squaredNorm() / square : 0;
      const bool same = same_sheet(local_[i].normal.dot(local_[row[k]].normal)) > 0;
      near_weight_[i * row.size() + k] =
          std::uint8_t(same ? kByteUnit * float(std::clamp(1 - away, 0.0, 1.0)) + kByteRounded : 0);
    }
  });
}

void HeightField::orient(const Context& context) {
  const auto linked = [&](std::size_t i) {
    const auto near = near_[i];
    return std::make_pair(near.begin(), near.begin() + std::min(near.size(), rfs_mesh::kRing));
  };
  const auto links = [&](std::size_t begin, std::size_t end, std::vector<rfs_mesh::SideLink>& out) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto [first, last] = linked(i);
      for (auto j = first; j != last; ++j) {
        const auto [back, stop] = linked(*j);
        if (*j < i && std::find(back, stop, Index(i)) != stop) continue;  // the other has this link
        out.push_back({Index(i), *j, local_[i].normal.dot(local_[*j].normal), 1});
      }
    }
  };
  const rfs_mesh::Regions regions = rfs_mesh::grow_regions_in_blocks(size(), links, context);
  for_each_index(context, size(), [&](std::size_t i) {
    if (regions.turned[i] != 0) local_[i].normal = -local_[i].normal;
  });
}

std::vector<float> HeightField::local_mean(const std::vector<float>& values, const Context& context) const {
  const auto width = std::size_t(near_.k);
  std::vector<float> mean(values.size());
  for_each_index(context, size(), [&](std::size_t i) {
    const WeightedSum around =
        weighted_sum(width, near_.items.data() + i * width, near_weight_.data() + i * width, values.data());
    mean[i] = (kByteUnit * values[i] + around.sum) / (kByteUnit + around.weights);
  });
  return mean;
}

std::vector<HeightField::Columns> HeightField::local_mean(const std::vector<Columns>& values,
                                                          const Context& context) const {
  const auto width = std::size_t(near_.k);
  std::vector<Columns> mean(values.size());
  for_each_index(context, size(), [&](std::size_t i) {
    const Index* const row = near_.items.data() + i * width;
    const std::uint8_t* const weight = near_weight_.data() + i * width;
    Columns sum = kByteUnit * values[i];
    unsigned weights = unsigned(kByteUnit);
    for (std::size_t k = 0; k < width; ++k) {
      sum += float(weight[k]) * values[row[k]];
      weights += weight[k];
    }
    mean[i] = sum * (1 / float(weights));
  });
  return mean;
}

}  // namespace rfsmooth::smoothing
