/// A cloud for the tests of the PCL stage, in any point type, one of a user's own among them.
#pragma once

#include <cmath>
#include <cstring>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

/// A point type of a user's own: fields PCL knows nothing about.
struct TimedPoint {
  PCL_ADD_POINT4D;
  double time;
  std::uint16_t ring;
  PCL_MAKE_ALIGNED_OPERATOR_NEW
};

/// The same with a normal.
struct TimedNormal {
  PCL_ADD_POINT4D;
  PCL_ADD_NORMAL4D;
  double time;
  std::uint16_t ring;
  PCL_MAKE_ALIGNED_OPERATOR_NEW
};

POINT_CLOUD_REGISTER_POINT_STRUCT(TimedPoint,
                                  (float, x, x)(float, y, y)(float, z, z)(double, time, time)(std::uint16_t,
                                                                                              ring, ring))
POINT_CLOUD_REGISTER_POINT_STRUCT(TimedNormal,
                                  (float, x, x)(float, y, y)(float, z, z)(float, normal_x, normal_x)(
                                      float, normal_y, normal_y)(float, normal_z,
                                                                 normal_z)(double, time, time)(std::uint16_t,
                                                                                               ring, ring))

namespace rfsmooth::test {

/// An organised 60 x 50 noisy wavy sheet with NaN holes and one infinite coordinate; every byte of a point is
/// set.
template <typename PointT>
typename ::pcl::PointCloud<PointT>::Ptr sheet(double offset = 0) {
  auto cloud = ::pcl::make_shared<::pcl::PointCloud<PointT>>();
  cloud->width = 60;
  cloud->height = 50;
  cloud->is_dense = false;
  cloud->header.frame_id = "scanner";
  cloud->header.stamp = 123456789;
  cloud->header.seq = 7;
  cloud->sensor_origin_ = {1, 2, 3, 0};
  cloud->sensor_orientation_ = Eigen::Quaternionf(0.5f, 0.5f, 0.5f, 0.5f);
  cloud->resize(60 * 50);
  cloud->width = 60;
  cloud->height = 50;
  std::mt19937 engine(11);
  const auto uniform = [&] { return (double(engine()) / 4294967296.0) - 0.5; };
  for (int row = 0; row < 50; ++row)
    for (int column = 0; column < 60; ++column) {
      PointT& p = cloud->at(column, row);
      std::memset(static_cast<void*>(&p), 0x41 + (row + column) % 7, sizeof(PointT));
      p.x = float(offset + column + 0.3 * uniform());
      p.y = float(offset + row + 0.3 * uniform());
      p.z = float(3 * std::sin(0.1 * column) + 0.8 * uniform());
    }
  cloud->at(10, 10).y = NAN;
  cloud->at(20, 30).x = INFINITY;
  return cloud;
}

/// The bytes of a point without its x, y, z.
template <typename PointT>
std::string rest(const PointT& point) {
  PointT copy = point;
  copy.x = copy.y = copy.z = 0;
  return {reinterpret_cast<const char*>(&copy), sizeof(PointT)};
}

template <typename PointT>
void expect_same_but_xyz(const ::pcl::PointCloud<PointT>& in, const ::pcl::PointCloud<PointT>& out) {
  ASSERT_EQ(in.size(), out.size());
  EXPECT_EQ(in.width, out.width);
  EXPECT_EQ(in.height, out.height);
  EXPECT_EQ(in.is_dense, out.is_dense);
  EXPECT_EQ(in.header.frame_id, out.header.frame_id);
  EXPECT_EQ(in.header.stamp, out.header.stamp);
  EXPECT_EQ(in.header.seq, out.header.seq);
  EXPECT_EQ(in.sensor_origin_, out.sensor_origin_);
  EXPECT_EQ(in.sensor_orientation_.coeffs(), out.sensor_orientation_.coeffs());
  for (std::size_t i = 0; i < in.size(); ++i) ASSERT_EQ(rest(in[i]), rest(out[i])) << i;
}

}  // namespace rfsmooth::test
