#include "pipeline/io/point_fields.h"

#include <cstring>

#include <gtest/gtest.h>

namespace {

namespace io = rfsmooth::pipeline::io;

/// A cloud of one point with a packed colour.
io::Cloud packed_cloud(const std::string& name, io::Scalar type, std::uint32_t bits) {
  const double origin[3] = {0, 0, 0};
  io::Cloud cloud = io::make_cloud(origin, 1, io::Scalar::float32);
  cloud.points().fields.push_back({name, type});
  char bytes[sizeof bits];
  std::memcpy(bytes, &bits, sizeof bits);
  cloud.points().data.insert(cloud.points().data.end(), bytes, bytes + sizeof bits);
  return cloud;
}

TEST(PackedColors, KeepTheirBitsWhereTheFloatIsNoNumber) {
  // PCL writes alpha 255, and red from 128 on: a signalling NaN, which doubles and floats make a quiet one
  // of.
  const io::Cloud cloud = packed_cloud("rgb", io::Scalar::float32, 0xff82407f);
  EXPECT_EQ(io::packed_colors(cloud, 3), std::vector<std::uint32_t>{0xff82407f});
  EXPECT_EQ(io::colors_of(cloud), (std::vector<io::Rgb>{{0x82, 0x40, 0x7f}}));
}

TEST(PackedColors, AreTheSameOfEveryTypeOfFourBytes) {
  for (const io::Scalar type : {io::Scalar::float32, io::Scalar::uint32, io::Scalar::int32}) {
    io::Cloud cloud = packed_cloud("rgba", type, 0x80123456);
    EXPECT_EQ(io::packed_colors(cloud, 3), std::vector<std::uint32_t>{0x80123456}) << io::name_of(type);
    io::make_text(cloud.points(), {});
    EXPECT_EQ(io::packed_colors(cloud, 3), std::vector<std::uint32_t>{0x80123456}) << io::name_of(type);
  }
}

}  // namespace
