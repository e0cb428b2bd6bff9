/// Template bodies of rfsmooth/pcl/denoise.h, for point types of your own.
#pragma once

#include <cmath>
#include <vector>

#include <pcl/filters/impl/filter.hpp>
#include <pcl/impl/pcl_base.hpp>

#include "rfsmooth/pcl/denoise.h"

namespace rfsmooth::pcl {

namespace detail {

/// The coordinates named by `indices`, n x 3; false if one is out of range.
template <typename At>
bool gather(const ::pcl::Indices& indices, std::size_t size, const At& at, std::vector<double>& xyz) {
  xyz.resize(3 * indices.size());
  for (std::size_t row = 0; row < indices.size(); ++row) {
    if (indices[row] < 0 || std::size_t(indices[row]) >= size) return false;
    at(std::size_t(indices[row]), &xyz[3 * row]);
  }
  return true;
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
  std::vector<double> xyz;
  const auto at = [&](std::size_t i, double* to) {
    to[0] = input[i].x;
    to[1] = input[i].y;
    to[2] = input[i].z;
  };
  this->removed_indices_->clear();
  if (!detail::gather(indices, input.size(), at, xyz)) {
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
  const auto set = [](float& coordinate, double old_value, double new_value) {
    if (new_value != old_value && std::isfinite(new_value)) coordinate = static_cast<float>(new_value);
  };
  for (std::size_t row = 0; row < indices.size(); ++row) {
    PointT& point = output[std::size_t(indices[row])];
    set(point.x, before[3 * row], xyz[3 * row]);
    set(point.y, before[3 * row + 1], xyz[3 * row + 1]);
    set(point.z, before[3 * row + 2], xyz[3 * row + 2]);
  }
}

}  // namespace rfsmooth::pcl

#define PCL_INSTANTIATE_Denoise(T) template class PCL_EXPORTS rfsmooth::pcl::Denoise<T>;
