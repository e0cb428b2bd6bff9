/// Template bodies of rfsmooth/pcl/denoise.h, for point types of your own.
#pragma once

#include <cmath>
#include <vector>

#include <pcl/filters/impl/filter.hpp>
#include <pcl/impl/pcl_base.hpp>

#include <rfsmooth/pcl/denoise.h>

namespace rfsmooth::pcl {

namespace detail {

/// What `at(i, to)` says of the points named by `indices`, n x 3; false if one is out of range.
template <typename At>
bool gather(const ::pcl::Indices& indices, std::size_t size, const At& at, std::vector<double>& xyz) {
  xyz.resize(3 * indices.size());
  for (std::size_t row = 0; row < indices.size(); ++row) {
    if (indices[row] < 0 || std::size_t(indices[row]) >= size) return false;
    at(std::size_t(indices[row]), &xyz[3 * row]);
  }
  return true;
}

/// The coordinates of a cloud's points.
template <typename PointT>
bool gather(const ::pcl::PointCloud<PointT>& cloud, const ::pcl::Indices& indices, std::vector<double>& xyz) {
  const auto at = [&](std::size_t i, double* to) {
    to[0] = cloud[i].x;
    to[1] = cloud[i].y;
    to[2] = cloud[i].z;
  };
  return gather(indices, cloud.size(), at, xyz);
}

/// Writes the coordinates that changed.
template <typename PointT>
void scatter(const std::vector<double>& before, const std::vector<double>& after,
             const ::pcl::Indices& indices, ::pcl::PointCloud<PointT>& cloud) {
  const auto set = [&](float& coordinate, std::size_t k) {
    if (after[k] != before[k] && std::isfinite(after[k])) coordinate = static_cast<float>(after[k]);
  };
  for (std::size_t row = 0; row < indices.size(); ++row) {
    PointT& point = cloud[std::size_t(indices[row])];
    set(point.x, 3 * row);
    set(point.y, 3 * row + 1);
    set(point.z, 3 * row + 2);
  }
}

/// Takes `gone` (ascending) out of the cloud; or, with `keep`, sets its coordinates to `value`.
template <typename PointT>
void remove(const ::pcl::Indices& gone, bool keep, float value, ::pcl::PointCloud<PointT>& cloud) {
  if (gone.empty()) return;
  if (keep) {
    for (const auto i : gone)
      cloud[std::size_t(i)].x = cloud[std::size_t(i)].y = cloud[std::size_t(i)].z = value;
    if (!std::isfinite(value)) cloud.is_dense = false;
    return;
  }
  std::size_t kept = 0, next = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (next < gone.size() && std::size_t(gone[next]) == i)
      ++next;
    else
      cloud[kept++] = cloud[i];
  cloud.resize(kept);  // width = kept, height = 1
}

}  // namespace detail

template <typename PointT>
void Denoise<PointT>::filter(PointCloud& output) {
  if (this->input_) {
    ::pcl::Filter<PointT>::filter(output);
    return;
  }
  fail("no input cloud: call setInputCloud first");
  output = PointCloud();
}

template <typename PointT>
void Denoise<PointT>::applyFilter(PointCloud& output) {
  const PointCloud& input = *this->input_;
  const ::pcl::Indices& indices = *this->indices_;
  this->removed_indices_->clear();
  std::vector<double> xyz;
  if (!detail::gather(input, indices, xyz)) {
    fail("an index is outside the cloud");
    output.clear();
    return;
  }
  const std::vector<double> before = xyz;
  if (!run(xyz.data(), indices.size())) {
    output.clear();
    return;
  }
  output = input;
  detail::scatter(before, xyz, indices, output);
  const ::pcl::Indices gone = removed(indices);
  if (this->extract_removed_indices_) *this->removed_indices_ = gone;
  detail::remove(gone, keep_organized_, user_filter_value_, output);
}

}  // namespace rfsmooth::pcl

#define PCL_INSTANTIATE_Denoise(T) template class PCL_EXPORTS rfsmooth::pcl::Denoise<T>;
