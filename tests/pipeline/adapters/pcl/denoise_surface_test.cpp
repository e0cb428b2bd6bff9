#include <gtest/gtest.h>
#include <pcl/console/print.h>
#include <pcl/point_types.h>

#include <rfsmooth/pcl/denoise_surface.h>
#include <rfsmooth/pcl/impl/denoise_surface.hpp>

#include "tests/pipeline/adapters/pcl/sheet.h"

namespace {

using rfsmooth::pcl::Denoise;
using rfsmooth::pcl::DenoiseSurface;
using rfsmooth::test::sheet;

template <typename PointT>
bool finite(const PointT& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

template <typename PointT>
Eigen::Vector3f normal_of(const PointT& p) {
  return {p.normal_x, p.normal_y, p.normal_z};
}

template <typename In, typename Out>
::pcl::PointCloud<Out> processed(const typename ::pcl::PointCloud<In>::Ptr& cloud) {
  DenoiseSurface<In, Out> denoise;
  denoise.setInputCloud(cloud);
  ::pcl::PointCloud<Out> out;
  denoise.process(out);
  EXPECT_EQ(denoise.getStatus(), "");
  EXPECT_EQ(out.size(), cloud->size());
  return out;
}

template <typename A, typename B>
void expect_same_position(const A& a, const B& b, std::size_t i) {
  EXPECT_EQ(std::memcmp(&a.x, &b.x, 3 * sizeof(float)), 0) << i;
}

template <typename Pair>
class PclDenoiseSurface : public ::testing::Test {};
using Pairs = ::testing::Types<
    std::pair<::pcl::PointXYZ, ::pcl::PointNormal>, std::pair<::pcl::PointXYZI, ::pcl::PointXYZINormal>,
    std::pair<::pcl::PointXYZRGB, ::pcl::PointXYZRGBNormal>,
    std::pair<::pcl::PointXYZRGBA, ::pcl::PointXYZRGBNormal>,
    std::pair<::pcl::PointXYZL, ::pcl::PointXYZLNormal>, std::pair<::pcl::PointNormal, ::pcl::PointNormal>,
    std::pair<::pcl::PointXYZINormal, ::pcl::PointXYZINormal>,
    std::pair<::pcl::PointXYZRGBNormal, ::pcl::PointXYZRGBNormal>, std::pair<TimedPoint, TimedNormal>>;
TYPED_TEST_SUITE(PclDenoiseSurface, Pairs);

TYPED_TEST(PclDenoiseSurface, CoordinatesOfTheFilterAndUnitNormalsOfTheSheet) {
  using In = typename TypeParam::first_type;
  using Out = typename TypeParam::second_type;
  const auto cloud = sheet<In>();
  Denoise<In> filter;
  filter.setInputCloud(cloud);
  ::pcl::PointCloud<In> expected;
  filter.filter(expected);

  const auto out = processed<In, Out>(cloud);
  ASSERT_EQ(out.size(), cloud->size());
  EXPECT_EQ(out.width, 60u);
  EXPECT_EQ(out.height, 50u);
  EXPECT_EQ(out.header.frame_id, "scanner");
  EXPECT_EQ(out.header.stamp, 123456789u);
  EXPECT_EQ(out.sensor_origin_, cloud->sensor_origin_);
  EXPECT_EQ(out.sensor_orientation_.coeffs(), cloud->sensor_orientation_.coeffs());
  double error = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    expect_same_position(out[i], expected[i], i);
    if (!finite((*cloud)[i])) {
      EXPECT_EQ(std::isnan(out[i].normal_x), !::pcl::traits::has_normal<In>::value) << i;
      continue;
    }
    EXPECT_NEAR(normal_of(out[i]).norm(), 1, 1e-6) << i;
    const Eigen::Vector3f truth = Eigen::Vector3f(-0.3f * std::cos(0.1f * out[i].x), 0, 1).normalized();
    error += truth.cross(normal_of(out[i])).squaredNorm();
  }
  EXPECT_LT(std::sqrt(error / double(out.size())),
            0.15);  // radians: noise of 0.23 spacings is left with some
}

TYPED_TEST(PclDenoiseSurface, PointsOutsideTheIndicesKeepWhatTheyHave) {
  using In = typename TypeParam::first_type;
  using Out = typename TypeParam::second_type;
  const auto cloud = sheet<In>();
  const auto indices = ::pcl::make_shared<::pcl::Indices>();
  for (int i = 0; i < 1500; ++i) indices->push_back(i);
  DenoiseSurface<In, Out> denoise;
  denoise.setInputCloud(cloud);
  denoise.setIndices(indices);
  ::pcl::PointCloud<Out> out;
  denoise.process(out);
  EXPECT_EQ(denoise.getStatus(), "");
  ASSERT_EQ(out.size(), cloud->size());
  for (std::size_t i = 1500; i < out.size(); ++i) {
    expect_same_position(out[i], (*cloud)[i], i);
    if constexpr (::pcl::traits::has_normal<In>::value)
      EXPECT_EQ(normal_of(out[i]), normal_of((*cloud)[i])) << i;
    else
      EXPECT_TRUE(std::isnan(out[i].normal_x)) << i;
  }
}

TYPED_TEST(PclDenoiseSurface, UnusableInputIsAStatusAndAnEmptyCloud) {
  using In = typename TypeParam::first_type;
  using Out = typename TypeParam::second_type;
  ::pcl::console::setVerbosityLevel(::pcl::console::L_ALWAYS);  // the errors below are expected
  DenoiseSurface<In, Out> denoise;
  auto out = sheet<Out>();
  denoise.process(*out);
  EXPECT_TRUE(out->empty());
  EXPECT_EQ(out->width * out->height, 0u);
  EXPECT_NE(denoise.getStatus().find("setInputCloud"), std::string::npos);

  const auto cloud = sheet<In>();
  denoise.setInputCloud(cloud);
  denoise.setIndices(::pcl::make_shared<::pcl::Indices>(::pcl::Indices{0, 3000}));
  denoise.process(*out);
  EXPECT_TRUE(out->empty());
  EXPECT_NE(denoise.getStatus(), "");

  const auto nan = ::pcl::make_shared<::pcl::PointCloud<In>>(*cloud);
  for (auto& p : *nan) p.x = NAN;
  DenoiseSurface<In, Out> other;
  other.setInputCloud(nan);
  other.process(*out);
  EXPECT_TRUE(out->empty());
  EXPECT_NE(other.getStatus(), "");
}

TEST(PclDenoiseSurfaceFields, OthersAreCopied) {
  const auto cloud = sheet<TimedPoint>();
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    (*cloud)[i].time = 1e9 + 0.001 * double(i);
    (*cloud)[i].ring = std::uint16_t(i);
  }
  const auto out = processed<TimedPoint, TimedNormal>(cloud);
  for (std::size_t i = 0; i < out.size(); ++i) {
    EXPECT_EQ(out[i].time, (*cloud)[i].time);
    EXPECT_EQ(out[i].ring, (*cloud)[i].ring);
  }
  const auto coloured = sheet<::pcl::PointXYZRGBA>();
  const auto normals = processed<::pcl::PointXYZRGBA, ::pcl::PointXYZRGBNormal>(coloured);
  for (std::size_t i = 0; i < normals.size(); ++i) EXPECT_EQ(normals[i].rgba, (*coloured)[i].rgba);
}

TEST(PclDenoiseSurfaceInPlace, GivesTheSamePoints) {
  const auto cloud = sheet<::pcl::PointNormal>();
  const auto apart = processed<::pcl::PointNormal, ::pcl::PointNormal>(cloud);
  DenoiseSurface<::pcl::PointNormal, ::pcl::PointNormal> denoise;
  denoise.setInputCloud(cloud);
  denoise.process(*cloud);
  ASSERT_EQ(cloud->size(), apart.size());
  for (std::size_t i = 0; i < apart.size(); ++i)
    EXPECT_EQ(std::memcmp(&(*cloud)[i], &apart[i], sizeof(::pcl::PointNormal)), 0) << i;
}

TEST(PclDenoiseSurfaceSides, TowardsTheViewpointOrTheSensor) {
  const auto cloud = sheet<::pcl::PointXYZ>();
  DenoiseSurface<::pcl::PointXYZ, ::pcl::PointNormal> denoise;
  denoise.setInputCloud(cloud);
  ::pcl::PointCloud<::pcl::PointNormal> out;
  const auto expect_side = [&](float side) {
    denoise.process(out);
    ASSERT_EQ(out.size(), cloud->size());
    std::size_t right = 0, all = 0;
    for (const auto& p : out)
      if (finite(p)) {
        ++all;
        right += side * p.normal_z > 0;
      }
    EXPECT_EQ(right, all);
  };
  denoise.setViewPoint(30, 25, 100);
  expect_side(1);
  denoise.setViewPoint(30, 25, -100);
  expect_side(-1);
  denoise.useSensorOriginAsViewPoint();
  cloud->sensor_origin_ = {30, 25, 100, 0};
  expect_side(1);
  cloud->sensor_origin_ = {30, 25, -100, 0};
  expect_side(-1);
}

TEST(PclDenoiseSurfaceSides, TowardsADefaultOriginOnlyWhereTheGridIsSeenFromThere) {
  const auto cloud = sheet<::pcl::PointXYZ>();
  cloud->sensor_origin_.setZero();
  cloud->sensor_orientation_.setIdentity();
  const auto right = [&](float side) {
    std::size_t count = 0;
    for (const auto& p : processed<::pcl::PointXYZ, ::pcl::PointNormal>(cloud))
      count += side * p.normal_z > 0;
    return count;
  };
  for (auto& p : *cloud) p.z += 100;  // as a camera at the origin sees it
  EXPECT_EQ(right(-1), 2998u);
  cloud->width = 3000;  // no grid: outward, as it happens
  cloud->height = 1;
  EXPECT_EQ(right(1), 2998u);
}

TEST(PclDenoiseSurfaceDense, IsToldByTheNormals) {
  const auto holes = sheet<::pcl::PointXYZ>();
  holes->is_dense = true;  // wrongly
  EXPECT_FALSE((processed<::pcl::PointXYZ, ::pcl::PointNormal>(holes).is_dense));
  const auto whole = sheet<::pcl::PointXYZ>();
  for (auto& p : *whole)
    if (!finite(p)) p.x = p.y = p.z = 30;
  whole->is_dense = true;
  EXPECT_TRUE((processed<::pcl::PointXYZ, ::pcl::PointNormal>(whole).is_dense));
}

TEST(PclDenoiseSurfaceOutliers, GoOrStayWithoutANormal) {
  const auto cloud = sheet<::pcl::PointXYZ>();
  (*cloud)[1300].z += 30;
  DenoiseSurface<::pcl::PointXYZ, ::pcl::PointNormal> denoise;
  denoise.setInputCloud(cloud);
  denoise.setOutliers(rfsmooth::Outliers::remove);
  ::pcl::PointCloud<::pcl::PointNormal> out;
  denoise.process(out);
  EXPECT_EQ(out.size(), 2999u);
  EXPECT_EQ(out.height, 1u);
  denoise.setKeepOrganized(true);
  denoise.process(out);
  EXPECT_EQ(out.height, 50u);
  EXPECT_TRUE(std::isnan(out[1300].x) && std::isnan(out[1300].normal_z));
  EXPECT_FALSE(out.is_dense);
}

TEST(PclDenoiseSurfaceThreads, SameBytesForAnyNumber) {
  const auto cloud = sheet<::pcl::PointXYZ>();
  ::pcl::PointCloud<::pcl::PointNormal> first;
  for (const unsigned threads : {1u, 2u, 4u}) {
    DenoiseSurface<::pcl::PointXYZ, ::pcl::PointNormal> denoise;
    denoise.setNumberOfThreads(threads);
    denoise.setInputCloud(cloud);
    ::pcl::PointCloud<::pcl::PointNormal> out;
    denoise.process(out);
    ASSERT_EQ(out.size(), cloud->size());
    if (threads == 1) first = out;
    for (std::size_t i = 0; i < out.size(); ++i)
      ASSERT_EQ(std::memcmp(&out[i], &first[i], sizeof out[i]), 0) << threads << " threads, point " << i;
  }
}

}  // namespace
