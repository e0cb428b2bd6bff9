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

/// One point with the fields `names` behind x, y, z, all doubles.
io::Cloud cloud_with(const std::vector<std::string>& names, const std::vector<double>& values) {
  const double origin[3] = {0, 0, 0};
  io::Cloud cloud = io::make_cloud(origin, 1);
  for (std::size_t k = 0; k < names.size(); ++k)
    io::append_field(cloud.points(), {names[k], io::Scalar::float64}, &values[k], {});
  return cloud;
}

TEST(NamesOfFields, OfNormalsAndColoursAreKnownInAnyCase) {
  const io::Cloud compare = cloud_with({"R", "G", "B", "Nx", "Ny", "Nz"}, {255, 128, 0, 0, 0.6, 0.8});
  EXPECT_TRUE(io::has_normals(compare));
  EXPECT_EQ(io::normals_of(compare), (std::vector<double>{0, 0.6, 0.8}));
  EXPECT_EQ(io::colors_of(compare), (std::vector<io::Rgb>{{255, 128, 0}}));
  EXPECT_EQ(io::find_field(compare, "red"), 3U);
  EXPECT_TRUE(io::has_normals(cloud_with({"NX", "NY", "NZ"}, {0, 0, 1})));
  EXPECT_TRUE(io::has_normals(cloud_with({"Normal_X", "Normal_Y", "Normal_Z"}, {0, 0, 1})));
  EXPECT_EQ(io::colors_of(cloud_with({"Red", "Green", "Blue"}, {1, 0, 0})),
            (std::vector<io::Rgb>{{255, 0, 0}}));
  EXPECT_TRUE(io::colors_of(cloud_with({"R", "intensity"}, {3, 4})).empty()) << "R alone may be a range";
  EXPECT_FALSE(io::find_field(cloud_with({"MARK"}, {1}), "mark")) << "other names are as they are written";
  EXPECT_EQ(io::find_field(cloud_with({"NX", "nx"}, {1, 2}), "nx"), 4U) << "as written comes first";
}

TEST(ColoursInFloats, AreTakenForWhatTheLargestSays) {
  const auto colour = [](double red, double green, double blue) {
    return io::colors_of(cloud_with({"red", "green", "blue"}, {red, green, blue})).at(0);
  };
  EXPECT_EQ(colour(1, 0.2, 0), (io::Rgb{255, 51, 0}));
  EXPECT_EQ(colour(255, 51, 0), (io::Rgb{255, 51, 0}));
  EXPECT_EQ(colour(65535, 0, 257 * 51), (io::Rgb{255, 0, 51}));
}

}  // namespace
