/// Template bodies of rfsmooth/pcl/denoise_surface.h, for point types of your own.
#pragma once

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <pcl/common/io.h>
#include <pcl/impl/pcl_base.hpp>

#include <rfsmooth/pcl/denoise_surface.h>
#include <rfsmooth/pcl/impl/denoise.hpp>

namespace rfsmooth::pcl {

namespace detail {

template <typename PointT>
void set_normal(PointT& point, double x, double y, double z) {
  point.normal_x = float(x);
  point.normal_y = float(y);
  point.normal_z = float(z);
}

}  // namespace detail

template <typename PointInT, typename PointOutT>
std::optional<Eigen::Vector3d> DenoiseSurface<PointInT, PointOutT>::sensor_place(
    const ::pcl::PointCloud<PointInT>& cloud) const {
  const Eigen::Vector3f origin = cloud.sensor_origin_.template head<3>();
  if (!origin.allFinite()) return std::nullopt;
  const bool said = !origin.isZero(0) ||
                    !cloud.sensor_orientation_.coeffs().isApprox(Eigen::Quaternionf::Identity().coeffs(), 0);
  if (said) return origin.template cast<double>();
  if (!cloud.isOrganized()) return std::nullopt;
  ::pcl::Indices all(cloud.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<double> xyz;
  detail::gather(cloud, all, xyz);
  if (!seen_from_origin(xyz.data(), cloud.width, cloud.height)) return std::nullopt;
  return Eigen::Vector3d(0, 0, 0);
}

template <typename PointInT, typename PointOutT>
void DenoiseSurface<PointInT, PointOutT>::process(PointCloudOut& output) {
  if (this->input_) {
    ::pcl::CloudSurfaceProcessing<PointInT, PointOutT>::process(output);
    return;
  }
  fail("no input cloud: call setInputCloud first");
  output = PointCloudOut();
}

template <typename PointInT, typename PointOutT>
void DenoiseSurface<PointInT, PointOutT>::performProcessing(PointCloudOut& output) {
  static_assert(::pcl::traits::has_normal<PointOutT>::value, "the points of the output need normals");
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto& input = *this->input_;
  const ::pcl::Indices& indices = *this->indices_;
  const auto give_up = [&] {
    const auto header = input.header;  // the output may be the input
    output = PointCloudOut();
    output.header = header;
  };
  std::vector<double> xyz;
  if (!detail::gather(input, indices, xyz)) {
    fail("an index is outside the cloud");
    return give_up();
  }
  const std::vector<double> before = xyz;
  std::vector<double> normals(xyz.size());
  const std::optional<Eigen::Vector3d> viewpoint = viewpoint_ ? viewpoint_ : sensor_place(input);
  if (!run(xyz.data(), indices.size())) return give_up();
  const ::pcl::Indices gone = removed(indices);
  std::vector<double> surface = xyz;
  if (!gone.empty())
    for (std::size_t row = 0; row < indices.size(); ++row)
      if (getReport().outlier[row] != 0) surface[3 * row] = kNan;
  if (!run_normals(surface.data(), indices.size(), viewpoint, normals.data())) return give_up();

  if (static_cast<const void*>(&output) != static_cast<const void*>(&input))
    ::pcl::copyPointCloud(input, output);
  if constexpr (!::pcl::traits::has_normal<PointInT>::value) {
    for (PointOutT& point : output) detail::set_normal(point, kNan, kNan, kNan);
  }
  detail::scatter(before, xyz, indices, output);
  for (std::size_t row = 0; row < indices.size(); ++row)
    if (const double* const normal = &normals[3 * row]; std::isfinite(normal[0]))
      detail::set_normal(output[std::size_t(indices[row])], normal[0], normal[1], normal[2]);
  for (const auto i : gone) detail::set_normal(output[std::size_t(i)], kNan, kNan, kNan);
  detail::remove(gone, keep_organized_, user_filter_value_, output);
  for (const PointOutT& point : output)
    if (!std::isfinite(point.normal_x)) output.is_dense = false;
}

}  // namespace rfsmooth::pcl

#define PCL_INSTANTIATE_DenoiseSurface(In, Out) \
  template class PCL_EXPORTS rfsmooth::pcl::DenoiseSurface<In, Out>;
