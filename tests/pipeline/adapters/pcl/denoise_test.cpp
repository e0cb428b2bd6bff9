#include <algorithm>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>
#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/point_types.h>

#include <rfsmooth/pcl/denoise.h>
#include <rfsmooth/pcl/impl/denoise.hpp>

#include "tests/pipeline/adapters/pcl/sheet.h"

namespace {

using rfsmooth::pcl::Denoise;
using rfsmooth::test::expect_same_but_xyz;
using rfsmooth::test::sheet;

template <typename PointT>
Denoise<PointT> quiet_filter() {
  ::pcl::console::setVerbosityLevel(::pcl::console::L_ALWAYS);  // the errors below are expected
  return Denoise<PointT>();
}

template <typename PointT>
class PclDenoise : public ::testing::Test {};
using PointTypes =
    ::testing::Types<::pcl::PointXYZ, ::pcl::PointXYZI, ::pcl::PointXYZRGB, ::pcl::PointXYZRGBA,
                     ::pcl::PointNormal, ::pcl::PointXYZRGBNormal, TimedPoint>;
TYPED_TEST_SUITE(PclDenoise, PointTypes);

TYPED_TEST(PclDenoise, OnlyFiniteCoordinatesChange) {
  const auto cloud = sheet<TypeParam>();
  Denoise<TypeParam> denoise = quiet_filter<TypeParam>();
  denoise.setInputCloud(cloud);
  ::pcl::PointCloud<TypeParam> out;
  denoise.filter(out);
  EXPECT_EQ(denoise.getStatus(), "");
  expect_same_but_xyz(*cloud, out);
  std::size_t moved = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto &a = (*cloud)[i], &b = out[i];
    const bool finite = std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
    if (finite)
      moved += a.x != b.x || a.y != b.y || a.z != b.z;
    else
      EXPECT_EQ(std::memcmp(&a.x, &b.x, 3 * sizeof(float)), 0) << i;
  }
  EXPECT_GT(moved, 2000u);
  EXPECT_EQ(denoise.getReport().finite, 2998u);
}

TYPED_TEST(PclDenoise, InPlaceGivesTheSamePoints) {
  const auto cloud = sheet<TypeParam>();
  Denoise<TypeParam> denoise = quiet_filter<TypeParam>();
  denoise.setInputCloud(cloud);
  ::pcl::PointCloud<TypeParam> out;
  denoise.filter(out);
  denoise.filter(*cloud);
  expect_same_but_xyz(out, *cloud);
  for (std::size_t i = 0; i < out.size(); ++i) EXPECT_EQ(std::memcmp(&out[i].x, &(*cloud)[i].x, 12), 0) << i;
}

TYPED_TEST(PclDenoise, PointsOutsideTheIndicesStayAndInfluenceNothing) {
  const auto cloud = sheet<TypeParam>();
  const auto indices = ::pcl::make_shared<::pcl::Indices>();
  for (int i = 0; i < 1500; ++i) indices->push_back(i);
  Denoise<TypeParam> denoise = quiet_filter<TypeParam>();
  denoise.setInputCloud(cloud);
  denoise.setIndices(indices);
  ::pcl::PointCloud<TypeParam> out, other;
  denoise.filter(out);
  expect_same_but_xyz(*cloud, out);
  for (std::size_t i = 1500; i < out.size(); ++i)
    EXPECT_EQ(std::memcmp(&out[i].x, &(*cloud)[i].x, 12), 0) << i;
  for (std::size_t i = 1500; i < cloud->size(); ++i) (*cloud)[i].z += 1;
  denoise.filter(other);
  for (std::size_t i = 0; i < 1500; ++i) EXPECT_EQ(std::memcmp(&out[i].x, &other[i].x, 12), 0) << i;
}

TYPED_TEST(PclDenoise, UnusableInputIsAStatusAndAnEmptyCloud) {
  Denoise<TypeParam> denoise = quiet_filter<TypeParam>();
  auto out = sheet<TypeParam>();
  denoise.filter(*out);
  EXPECT_TRUE(out->empty());
  EXPECT_NE(denoise.getStatus().find("setInputCloud"), std::string::npos);

  const auto cloud = sheet<TypeParam>();
  denoise.setInputCloud(cloud);
  denoise.setIndices(::pcl::make_shared<::pcl::Indices>(::pcl::Indices{0, 3000}));
  denoise.filter(*out);
  EXPECT_TRUE(out->empty());
  EXPECT_NE(denoise.getStatus(), "");

  const auto nan = ::pcl::make_shared<::pcl::PointCloud<TypeParam>>(*cloud);
  for (auto& p : *nan) p.x = NAN;
  Denoise<TypeParam> other = quiet_filter<TypeParam>();
  other.setInputCloud(nan);
  other.filter(*out);
  EXPECT_TRUE(out->empty());
  EXPECT_NE(other.getStatus(), "");

  other.setInputCloud(cloud);
  other.setFlow("no such flow");
  other.filter(*out);
  EXPECT_TRUE(out->empty());
  EXPECT_NE(other.getStatus(), "");
}

/// The sheet with three strays far above it, and their indices.
template <typename PointT>
typename ::pcl::PointCloud<PointT>::Ptr sheet_with_strays(::pcl::Indices& strays) {
  const auto cloud = sheet<PointT>();
  strays = {125, 1300, 2750};
  for (const auto i : strays) (*cloud)[std::size_t(i)].z += 30;
  return cloud;
}

TYPED_TEST(PclDenoise, NothingIsRemovedUnlessAskedFor) {
  ::pcl::Indices strays;
  const auto cloud = sheet_with_strays<TypeParam>(strays);
  Denoise<TypeParam> denoise(true);
  denoise.setInputCloud(cloud);
  ::pcl::PointCloud<TypeParam> out;
  denoise.filter(out);
  EXPECT_EQ(denoise.getReport().outliers, 3u);
  EXPECT_TRUE(denoise.getRemovedIndices()->empty());
  expect_same_but_xyz(*cloud, out);
  for (const auto i : strays)
    EXPECT_EQ(std::memcmp(&out[std::size_t(i)].x, &(*cloud)[std::size_t(i)].x, 12), 0) << i;
}

TYPED_TEST(PclDenoise, RemovedPointsFollowPclsRules) {
  ::pcl::Indices strays;
  const auto cloud = sheet_with_strays<TypeParam>(strays);
  Denoise<TypeParam> denoise(true);
  denoise.setInputCloud(cloud);
  ::pcl::PointCloud<TypeParam> all, out;
  denoise.filter(all);

  denoise.setOutliers(rfsmooth::Outliers::remove);
  denoise.filter(out);
  EXPECT_EQ(*denoise.getRemovedIndices(), strays);
  ASSERT_EQ(out.size(), cloud->size() - 3);
  EXPECT_EQ(out.width, out.size());
  EXPECT_EQ(out.height, 1u);
  std::size_t k = 0;
  for (std::size_t i = 0; i < cloud->size(); ++i)
    if (std::find(strays.begin(), strays.end(), int(i)) == strays.end()) {
      ASSERT_EQ(std::memcmp(&out[k++], &all[i], sizeof(TypeParam)), 0) << i;
    }

  cloud->is_dense = true;
  denoise.setKeepOrganized(true);
  denoise.filter(out);
  EXPECT_EQ(*denoise.getRemovedIndices(), strays);
  EXPECT_EQ(out.width, 60u);
  EXPECT_EQ(out.height, 50u);
  EXPECT_FALSE(out.is_dense);
  for (const auto i : strays) {
    EXPECT_TRUE(std::isnan(out[std::size_t(i)].x) && std::isnan(out[std::size_t(i)].z)) << i;
    EXPECT_EQ(rfsmooth::test::rest(out[std::size_t(i)]), rfsmooth::test::rest((*cloud)[std::size_t(i)])) << i;
  }
  denoise.setUserFilterValue(-1);
  denoise.filter(*cloud);  // in place
  EXPECT_TRUE(cloud->is_dense);
  for (const auto i : strays) EXPECT_EQ((*cloud)[std::size_t(i)].z, -1) << i;

  Denoise<TypeParam> unasked;  // made without `true`: like every PCL filter it keeps no list
  unasked.setInputCloud(sheet_with_strays<TypeParam>(strays));
  unasked.setOutliers(rfsmooth::Outliers::remove);
  unasked.filter(out);
  EXPECT_EQ(out.size(), 2997u);
  EXPECT_TRUE(unasked.getRemovedIndices()->empty());
}

TEST(PclDenoiseSetters, ReachTheOptions) {
  const auto cloud = sheet<::pcl::PointXYZ>();
  ::pcl::PointCloud<::pcl::PointXYZ> out;
  const auto moved = [&](const auto& set) {
    Denoise<::pcl::PointXYZ> denoise;
    denoise.setInputCloud(cloud);
    set(denoise);
    denoise.filter(out);
    EXPECT_EQ(denoise.getStatus(), "");
    return denoise.getReport().rms_move;
  };
  const double usual = moved([](auto&) {});
  EXPECT_EQ(moved([](auto& denoise) { denoise.setStrength(0); }), 0);
  EXPECT_EQ(moved([](auto& denoise) { denoise.setNoise(0); }), 0);
  EXPECT_LT(moved([](auto& denoise) { denoise.setStrength(0.3); }), usual);
  EXPECT_GT(moved([](auto& denoise) { denoise.setNoise(1); }), usual);
  EXPECT_NE(moved([](auto& denoise) { denoise.setFlow("laplacian"); }), usual);
}

TEST(PclDenoiseThreads, SameBytesForAnyNumber) {
  const auto cloud = sheet<::pcl::PointXYZ>();
  ::pcl::PointCloud<::pcl::PointXYZ> first;
  for (const unsigned threads : {1u, 2u, 4u, 7u}) {
    Denoise<::pcl::PointXYZ> denoise;
    denoise.setNumberOfThreads(threads);
    denoise.setInputCloud(cloud);
    ::pcl::PointCloud<::pcl::PointXYZ> out;
    denoise.filter(out);
    ASSERT_EQ(out.size(), cloud->size());
    if (threads == 1) first = out;
    for (std::size_t i = 0; i < out.size(); ++i)
      ASSERT_EQ(std::memcmp(&out[i], &first[i], 12), 0) << threads << " threads, point " << i;
  }
}

TEST(PclDenoiseCloud2, AnyFieldsSameCoordinatesAsTheTypedFilter) {
  const auto cloud = sheet<TimedPoint>();
  const auto message = ::pcl::make_shared<::pcl::PCLPointCloud2>();
  ::pcl::toPCLPointCloud2(*cloud, *message);
  Denoise<TimedPoint> typed;
  typed.setInputCloud(cloud);
  ::pcl::PointCloud<TimedPoint> expected;
  typed.filter(expected);

  Denoise<::pcl::PCLPointCloud2> untyped;
  untyped.setInputCloud(message);
  ::pcl::PCLPointCloud2 out;
  untyped.filter(out);
  ASSERT_EQ(untyped.getStatus(), "");
  EXPECT_EQ(out.fields.size(), message->fields.size());
  EXPECT_EQ(out.width, 60u);
  EXPECT_EQ(out.height, 50u);
  EXPECT_EQ(out.header.stamp, 123456789u);
  ::pcl::PointCloud<TimedPoint> got;
  ::pcl::fromPCLPointCloud2(out, got);
  for (std::size_t i = 0; i < got.size(); ++i) {
    ASSERT_EQ(std::memcmp(&got[i].x, &expected[i].x, 12), 0) << i;
    ASSERT_EQ(got[i].time, (*cloud)[i].time) << i;
    ASSERT_EQ(got[i].ring, (*cloud)[i].ring) << i;
  }
  const ::pcl::PCLPointCloud2 separate = out;
  untyped.filter(*message);
  EXPECT_EQ(message->data, separate.data) << "in place";
  EXPECT_EQ(untyped.getInputCloud().get(), message.get());
  Denoise<::pcl::PCLPointCloud2> afresh;
  afresh.setInputCloud(message);
  afresh.filter(out);
  untyped.filter(*message);
  EXPECT_EQ(message->data, out.data) << "in place again: from what came of it the first time";
}

::pcl::PCLPointField field(const char* name, std::size_t offset, std::uint8_t type, std::size_t count) {
  ::pcl::PCLPointField made;
  made.name = name;
  made.offset = std::uint32_t(offset);
  made.datatype = type;
  made.count = std::uint32_t(count);
  return made;
}

/// The sheet as a camera's driver may send it: z before x, an array, rows with padding behind them.
::pcl::PCLPointCloud2::Ptr padded_sheet() {
  const auto points = sheet<::pcl::PointXYZ>();
  auto cloud = ::pcl::make_shared<::pcl::PCLPointCloud2>();
  cloud->width = 60;
  cloud->height = 50;
  cloud->point_step = 23;
  cloud->row_step = 60 * 23 + 17;
  cloud->fields = {
      field("histogram", 0, ::pcl::PCLPointField::UINT8, 7), field("z", 7, ::pcl::PCLPointField::FLOAT32, 1),
      field("x", 11, ::pcl::PCLPointField::FLOAT32, 1), field("y", 19, ::pcl::PCLPointField::FLOAT32, 1)};
  cloud->data.resize(std::size_t(cloud->row_step) * 50);
  for (std::size_t i = 0; i < cloud->data.size(); ++i) cloud->data[i] = std::uint8_t(i * 31);
  for (std::size_t i = 0; i < points->size(); ++i) {
    std::uint8_t* const at = &cloud->data[i / 60 * cloud->row_step + i % 60 * 23];
    std::memcpy(at + 7, &(*points)[i].z, 4);
    std::memcpy(at + 11, &(*points)[i].x, 4);
    std::memcpy(at + 19, &(*points)[i].y, 4);
  }
  return cloud;
}

TEST(PclDenoiseCloud2, PaddingArraysAndFieldsInAnyOrderStay) {
  const auto cloud = padded_sheet();
  const auto points = sheet<::pcl::PointXYZ>();
  Denoise<::pcl::PointXYZ> typed;
  typed.setInputCloud(points);
  ::pcl::PointCloud<::pcl::PointXYZ> expected;
  typed.filter(expected);
  Denoise<::pcl::PCLPointCloud2> denoise;
  denoise.setInputCloud(cloud);
  ::pcl::PCLPointCloud2 out;
  denoise.filter(out);
  ASSERT_EQ(denoise.getStatus(), "");
  auto bytes = cloud->data;  // and nothing else has changed
  for (std::size_t i = 0; i < expected.size(); ++i) {
    std::uint8_t* const at = &bytes[i / 60 * cloud->row_step + i % 60 * 23];
    std::memcpy(at + 7, &expected[i].z, 4);
    std::memcpy(at + 11, &expected[i].x, 4);
    std::memcpy(at + 19, &expected[i].y, 4);
  }
  EXPECT_EQ(out.data, bytes);
  EXPECT_EQ(out.row_step, cloud->row_step);
  EXPECT_EQ(out.point_step, cloud->point_step);
}

TEST(PclDenoiseCloud2, UnusableInputIsAStatusAndAnEmptyCloud) {
  const auto expect_refused = [](Denoise<::pcl::PCLPointCloud2>& denoise, const char* what) {
    ::pcl::PCLPointCloud2 out = *padded_sheet();
    denoise.filter(out);
    EXPECT_TRUE(out.data.empty()) << what;
    EXPECT_EQ(out.width * out.height, 0u) << what;
    EXPECT_NE(denoise.getStatus(), "") << what;
  };
  const auto refused = [&](const char* what, const auto& spoil) {
    const auto cloud = padded_sheet();
    spoil(*cloud);
    auto denoise = quiet_filter<::pcl::PCLPointCloud2>();
    denoise.setInputCloud(cloud);
    expect_refused(denoise, what);
  };
  refused("short", [](auto& cloud) { cloud.data.resize(cloud.data.size() - 30); });
  refused("big-endian", [](auto& cloud) { cloud.is_bigendian = 1; });
  refused("no z", [](auto& cloud) { cloud.fields[1].name = "w"; });
  refused("an integer x", [](auto& cloud) { cloud.fields[2].datatype = ::pcl::PCLPointField::INT32; });
  refused("x beyond the point", [](auto& cloud) { cloud.fields[2].offset = 20; });
  refused("no numbers", [](auto& cloud) { std::fill(cloud.data.begin(), cloud.data.end(), 0xFF); });

  auto denoise = quiet_filter<::pcl::PCLPointCloud2>();
  expect_refused(denoise, "no input");
  denoise.setInputCloud(padded_sheet());
  denoise.setIndices(::pcl::make_shared<::pcl::Indices>(::pcl::Indices{0, 3000}));
  expect_refused(denoise, "an index outside");
}

TEST(PclDenoiseCloud2, RemovesAsTheTypedFilterDoes) {
  ::pcl::Indices strays;
  const auto cloud = sheet_with_strays<TimedPoint>(strays);
  const auto message = ::pcl::make_shared<::pcl::PCLPointCloud2>();
  ::pcl::toPCLPointCloud2(*cloud, *message);
  for (const bool keep : {false, true}) {
    Denoise<TimedPoint> typed;
    typed.setOutliers(rfsmooth::Outliers::remove);
    typed.setKeepOrganized(keep);
    typed.setInputCloud(cloud);
    ::pcl::PointCloud<TimedPoint> expected, got;
    typed.filter(expected);
    Denoise<::pcl::PCLPointCloud2> untyped(true);
    untyped.setOutliers(rfsmooth::Outliers::remove);
    untyped.setKeepOrganized(keep);
    untyped.setInputCloud(message);
    ::pcl::PCLPointCloud2 out;
    untyped.filter(out);
    EXPECT_EQ(*untyped.getRemovedIndices(), strays);
    EXPECT_EQ(out.data.size(), std::size_t(out.row_step) * out.height);
    ::pcl::fromPCLPointCloud2(out, got);
    ASSERT_EQ(got.size(), expected.size());
    EXPECT_EQ(got.width, expected.width);
    EXPECT_EQ(got.height, expected.height);
    EXPECT_EQ(bool(out.is_dense), expected.is_dense);
    for (std::size_t i = 0; i < got.size(); ++i) {
      ASSERT_EQ(std::memcmp(&got[i].x, &expected[i].x, 12), 0) << i;
      ASSERT_EQ(got[i].ring, expected[i].ring) << i;
    }
  }
}

TEST(PclDenoiseCloud2, DoublesKeepUtmPrecision) {
  const auto cloud = ::pcl::make_shared<::pcl::PCLPointCloud2>();
  cloud->width = 3000;
  cloud->height = 1;
  cloud->point_step = 28;
  cloud->row_step = 28 * 3000;
  cloud->is_dense = 1;
  const char* const names[] = {"x", "y", "z", "label"};
  for (int f = 0; f < 4; ++f) {
    ::pcl::PCLPointField field;
    field.name = names[f];
    field.offset = std::uint32_t(8 * f);
    field.datatype = f < 3 ? ::pcl::PCLPointField::FLOAT64 : ::pcl::PCLPointField::INT32;
    field.count = 1;
    cloud->fields.push_back(field);
  }
  cloud->data.resize(28 * 3000);
  const auto small = sheet<::pcl::PointXYZ>();
  const double origin[3] = {500000, 4649776, 200};
  for (int i = 0; i < 3000; ++i) {
    const auto& p = (*small)[std::size_t(i)];
    const double xyz[3] = {origin[0] + p.x, origin[1] + p.y, origin[2] + p.z};
    std::memcpy(&cloud->data[std::size_t(28 * i)], xyz, 24);
  }
  Denoise<::pcl::PCLPointCloud2> far;
  far.setInputCloud(cloud);
  ::pcl::PCLPointCloud2 out;
  far.filter(out);
  ASSERT_EQ(far.getStatus(), "");
  Denoise<::pcl::PointXYZ> near;
  near.setInputCloud(small);
  ::pcl::PointCloud<::pcl::PointXYZ> expected;
  near.filter(expected);
  for (int i = 0; i < 3000; ++i) {
    double xyz[3];
    std::memcpy(xyz, &out.data[std::size_t(28 * i)], 24);
    if (!std::isfinite(xyz[0] + xyz[1] + xyz[2])) continue;
    EXPECT_NEAR(xyz[0] - origin[0], expected[std::size_t(i)].x, 1e-5);
    EXPECT_NEAR(xyz[1] - origin[1], expected[std::size_t(i)].y, 1e-5);
    EXPECT_NEAR(xyz[2] - origin[2], expected[std::size_t(i)].z, 1e-5);
  }
}

TEST(PclDenoiseCloud2, WithoutCoordinatesIsAStatus) {
  const auto cloud = ::pcl::make_shared<::pcl::PCLPointCloud2>();
  cloud->width = 1;
  cloud->height = 1;
  Denoise<::pcl::PCLPointCloud2> denoise = quiet_filter<::pcl::PCLPointCloud2>();
  denoise.setInputCloud(cloud);
  ::pcl::PCLPointCloud2 out;
  denoise.filter(out);
  EXPECT_TRUE(out.data.empty());
  EXPECT_NE(denoise.getStatus(), "");
}

TEST(PclDenoiseSettings, WhatIsSetIsWhatOneGets) {
  Denoise<::pcl::PointXYZ> denoise;
  EXPECT_EQ(denoise.getFlow(), "auto");
  EXPECT_EQ(denoise.getOutliers(), rfsmooth::DenoiseOptions().outliers);
  EXPECT_FALSE(denoise.getKeepOrganized());
  EXPECT_EQ(denoise.getNumberOfThreads(), 0);

  denoise.setFlow("hc");
  denoise.setOutliers(rfsmooth::Outliers::remove);
  denoise.setKeepOrganized(true);
  denoise.setNumberOfThreads(3);
  EXPECT_EQ(denoise.getFlow(), "hc");
  EXPECT_EQ(denoise.getOutliers(), rfsmooth::Outliers::remove);
  EXPECT_TRUE(denoise.getKeepOrganized());
  EXPECT_EQ(denoise.getNumberOfThreads(), 3);
  EXPECT_EQ(name_of(denoise.getOptions().flow.flow), "hc") << "one set of options behind all setters";
  EXPECT_EQ(denoise.getOptions().outliers, rfsmooth::Outliers::remove);

  rfsmooth::DenoiseOptions options;
  options.flow.flow = rfsmooth::TaubinOptions();
  options.outliers = rfsmooth::Outliers::smooth;
  denoise.setOptions(options);
  EXPECT_EQ(denoise.getFlow(), "taubin");
  EXPECT_EQ(denoise.getOutliers(), rfsmooth::Outliers::smooth);
  EXPECT_EQ(name_of(denoise.getOptions().flow.flow), "taubin");
}

TEST(PclDenoiseSettings, OptionsSetAsAWholeAreTheOnesThatRun) {
  const auto cloud = sheet<::pcl::PointXYZ>();
  Denoise<::pcl::PointXYZ> one, other;
  one.setInputCloud(cloud);
  other.setInputCloud(cloud);
  one.setFlow("taubin");
  rfsmooth::DenoiseOptions options;
  options.flow.flow = rfsmooth::TaubinOptions();
  other.setOptions(options);
  ::pcl::PointCloud<::pcl::PointXYZ> a, b;
  one.filter(a);
  other.filter(b);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_EQ(std::memcmp(&a[i].x, &b[i].x, 3 * sizeof(float)), 0) << i;
}

}  // namespace
