#include "smoothing/automatic/guide/height_field.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "base/parallel.h"
#include "smoothing/automatic/guide/guide_normals.h"
#include "smoothing/automatic/rows/weighted_sum.h"

namespace rfsmooth::smoothing {

namespace {

constexpr float kByteUnit = 255, kByteRounded = 0.5F;

}  // namespace

HeightField::HeightField(Positions guide, rfs_mesh::KdTree tree, const rfs_mesh::NeighborTable& near,
                         const Positions& data, const NoiseModel& noise, const Context& context)
    : guide_(std::move(guide)),
      index_(std::in_place, guide_, std::move(tree), context),
      on_lines_(noise.on_lines) {
  if (near.size() != size() || data.size() != size())
    throw std::invalid_argument("HeightField: guide, neighbours and data are not of the same points");
  const std::vector<Eigen::Vector3f> normals = on_lines_
                                                   ? normals_across_lines(guide_, near, noise.piece, context)
                                                   : surface_normals(guide_, near, context);
  near_ = NearRows(near, context);
  local_.resize(size());
  for_each_index(context, size(), [&](std::size_t i) { local_[i].normal = normals[i]; });
  for_each_index(context, size(),
                 [&](std::size_t i) { local_[i].height = float(normal(i).dot(data[i] - guide_[i])); });
}

void HeightField::ready_for_searches(const Context& context) {
  if (index_) return;
  index_.emplace(guide_, rfs_mesh::KdTree(order_), context);
  std::vector<Index>().swap(order_);
}

void HeightField::ready_for_means(const Context& context) {
  if (index_) order_ = index_->tree().order();
  index_.reset();
  if (near_weight_.size() > 0) return;
  near_weight_.resize(size() * near_.width());
  for_each_index(context, size(), [&](std::size_t i) {
    const auto row = near_[i];
    if (row.size() == 0) return;
    const double square = rfs_mesh::kJustBeyond * (guide_[row[row.size() - 1]] - guide_[i]).squaredNorm();
    for (std::size_t k = 0; k < row.size(); ++k) {
      const double away = square > 0 ? (guide_[row[k]] - guide_[i]).squaredNorm() / square : 0;
      const bool same = same_sheet(local_[i].normal.dot(local_[row[k]].normal)) > 0;
      near_weight_[i * row.size() + k] =
          std::uint8_t(same ? kByteUnit * float(std::clamp(1 - away, 0.0, 1.0)) + kByteRounded : 0);
    }
  });
}

std::vector<float> HeightField::local_mean(const std::vector<float>& values, const Context& context) const {
  const std::size_t width = near_.width();
  std::vector<float> mean(values.size());
  for_each_index(context, size(), [&](std::size_t i) {
    const NearRows::Row row = near_[i];
    const auto around =
        weighted_sums<std::uint8_t, 1>(width, row.begin(), near_weight_.data() + i * width, {values.data()});
    mean[i] = (kByteUnit * values[i] + around.sum[0]) / (kByteUnit + around.weights);
  });
  return mean;
}

template <int kCount>
std::vector<HeightField::Columns<kCount>> HeightField::local_mean(const std::vector<Columns<kCount>>& values,
                                                                  const Context& context) const {
  const std::size_t width = near_.width();
  std::vector<Columns<kCount>> mean(values.size());
  for_each_index(context, size(), [&](std::size_t i) {
    const NearRows::Row row = near_[i];
    const std::uint8_t* const weight = near_weight_.data() + i * width;
    Columns<kCount> sum = kByteUnit * values[i];
    unsigned weights = unsigned(kByteUnit);
    for (std::size_t k = 0; k < width; ++k) {
      sum += float(weight[k]) * values[row[k]];
      weights += weight[k];
    }
    mean[i] = sum * (1 / float(weights));
  });
  return mean;
}

template std::vector<HeightField::Columns<4>> HeightField::local_mean(const std::vector<Columns<4>>&,
                                                                      const Context&) const;
template std::vector<HeightField::Columns<8>> HeightField::local_mean(const std::vector<Columns<8>>&,
                                                                      const Context&) const;

}  // namespace rfsmooth::smoothing
