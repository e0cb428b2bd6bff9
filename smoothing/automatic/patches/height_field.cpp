#include "smoothing/automatic/patches/height_field.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "base/parallel.h"
#include "smoothing/automatic/patches/guide_normals.h"
#include "smoothing/automatic/patches/weighted_sum.h"

namespace rfsmooth::smoothing {

namespace {

constexpr float kByteUnit = 255, kByteRounded = 0.5F;

}  // namespace

HeightField::HeightField(Positions guide, rfs_mesh::KdTree tree, rfs_mesh::NeighborTable near,
                         const Positions& data, std::optional<std::size_t> across, const Context& context)
    : guide_(std::move(guide)),
      index_(guide_, std::move(tree), context),
      near_(std::move(near)),
      on_lines_(across.has_value()) {
  if (near_.size() != size() || data.size() != size())
    throw std::invalid_argument("HeightField: guide, neighbours and data are not of the same points");
  const std::vector<Eigen::Vector3f> normals = across ? normals_across_lines(guide_, near_, *across, context)
                                                      : surface_normals(guide_, near_, context);
  local_.resize(size());
  for_each_index(context, size(), [&](std::size_t i) { local_[i].normal = normals[i]; });
  for_each_index(context, size(),
                 [&](std::size_t i) { local_[i].height = float(normal(i).dot(data[i] - guide_[i])); });
}

void HeightField::weigh_neighbors(const Context& context) {
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
