// What goes in comes out: random clouds through every format and encoding.
#include <cmath>

#include <gtest/gtest.h>

#include "pipeline/io/convert/capacity.h"
#include "pipeline/io/convert/convert.h"
#include "pipeline/io/mesh_file.h"
#include "tests/pipeline/io/random_cloud.h"

using namespace rfsmooth;                // NOLINT(google-build-using-namespace)
using namespace rfsmooth::pipeline::io;  // NOLINT(google-build-using-namespace)

namespace {

constexpr int kCases = 300;

std::string written(const Cloud& cloud, Encoding encoding) {
  WriteOptions options;
  options.encoding = encoding;
  return serialize_cloud(cloud, options, {}).value();
}

Cloud parsed(const std::string& bytes) {
  Result<Cloud> cloud = parse_cloud(bytes, "test", {}, {});
  if (!cloud.ok()) throw std::runtime_error(cloud.error().message + "\n" + bytes.substr(0, 2000));
  return std::move(cloud).value();
}

void expect_same_rows(const Cloud& a, const Cloud& b) {
  ASSERT_EQ(a.elements.size(), b.elements.size());
  for (std::size_t e = 0; e < a.elements.size(); ++e) {
    Table s = a.elements[e], t = b.elements[e];
    make_binary(s, {});
    make_binary(t, {});
    EXPECT_EQ(s.name, t.name);
    EXPECT_EQ(s.data, t.data);
    ASSERT_EQ(s.fields.size(), t.fields.size());
    for (std::size_t f = 0; f < s.fields.size(); ++f) {
      EXPECT_EQ(s.fields[f].name, t.fields[f].name);
      EXPECT_EQ(s.fields[f].type, t.fields[f].type);
      EXPECT_EQ(s.fields[f].count, t.fields[f].count);
      EXPECT_EQ(s.fields[f].list_count, t.fields[f].list_count);
    }
  }
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.viewpoint, b.viewpoint);
}

class RoundTrip : public testing::TestWithParam<std::pair<Format, Encoding>> {};

TEST_P(RoundTrip, RandomCloudsComeBack) {
  const auto [format, encoding] = GetParam();
  for (int k = 0; k < kCases; ++k) {
    SCOPED_TRACE(k);
    std::mt19937_64 engine{std::uint64_t(k)};
    const Cloud cloud = random_cloud(format, encoding == Encoding::ascii, engine);
    const std::string bytes = written(cloud, encoding);
    const Cloud again = parsed(bytes);
    EXPECT_EQ(again.encoding, encoding);
    expect_same_rows(cloud, again);
    EXPECT_EQ(written(again, encoding), bytes);
  }
}

TEST_P(RoundTrip, UnmovedPointsKeepTheirBytesAndMovedOnesRound) {
  const auto [format, encoding] = GetParam();
  for (int k = 0; k < kCases; ++k) {
    SCOPED_TRACE(k);
    std::mt19937_64 engine{std::uint64_t(k)};
    const std::string bytes = written(random_cloud(format, encoding == Encoding::ascii, engine), encoding);
    Cloud cloud = parsed(bytes);
    std::vector<double> xyz = positions(cloud);
    set_positions(cloud, xyz.data());
    EXPECT_EQ(written(cloud, encoding), bytes);
    if (xyz.empty()) continue;
    const std::size_t moved = below(engine, xyz.size());
    xyz[moved] = 4649776.2718281828;
    set_positions(cloud, xyz.data());
    const Scalar type = cloud.points().fields[cloud.xyz[moved % 3]].type;
    const std::vector<double> now = positions(parsed(written(cloud, encoding)));
    for (std::size_t i = 0; i < xyz.size(); ++i) {
      if (i != moved) {
        EXPECT_TRUE(now[i] == xyz[i] || (std::isnan(now[i]) && std::isnan(xyz[i])));
      } else if (type == Scalar::float32) {
        EXPECT_EQ(float(now[i]), float(xyz[i]));
      } else {
        EXPECT_EQ(now[i], xyz[i]);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, RoundTrip,
                         testing::Values(std::pair{Format::ply, Encoding::ascii},
                                         std::pair{Format::ply, Encoding::binary_little_endian},
                                         std::pair{Format::ply, Encoding::binary_big_endian},
                                         std::pair{Format::pcd, Encoding::ascii},
                                         std::pair{Format::pcd, Encoding::binary_little_endian},
                                         std::pair{Format::pcd, Encoding::binary_compressed}),
                         [](const auto& tested) {
                           return std::string(name_of(tested.param.first)) + "_" +
                                  std::string(name_of(tested.param.second));
                         });

TEST(Convert, RandomPcdThroughPlyAndBack) {
  for (int k = 0; k < kCases; ++k) {
    SCOPED_TRACE(k);
    std::mt19937_64 engine{std::uint64_t(k)};
    const Cloud cloud = random_cloud(Format::pcd, false, engine);
    WriteOptions to_ply, to_pcd;
    to_ply.format = Format::ply;
    to_pcd.format = Format::pcd;
    bool wide = false;
    for (const Field& f : cloud.points().fields)
      wide = wide || f.type == Scalar::int64 || f.type == Scalar::uint64;
    const auto ply = serialize_cloud(cloud, to_ply, {});
    ASSERT_EQ(ply.ok(), !wide);
    if (wide) {
      EXPECT_EQ(ply.error().code, ErrorCode::usage);
      EXPECT_NE(ply.error().message.find("field 'field"), std::string::npos);
    } else if (cloud.size() > 0) {
      expect_same_rows(cloud, parsed(serialize_cloud(parsed(ply.value()), to_pcd, {}).value()));
    }
    to_ply.drop_unsupported = true;
    EXPECT_EQ(parsed(serialize_cloud(cloud, to_ply, {}).value()).size(), cloud.size());
  }
}

TEST(Convert, DigitsOfCoordinatesAreNoLossBeforeTheyChange) {
  const Cloud cloud = parsed(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "property float i\nend_header\n0.12345678901 0.5 0.12345678901 0.12345678901\n");
  const Encoding bytes = Encoding::binary_little_endian;
  EXPECT_EQ(what_is_lost(cloud, Format::ply, bytes, {}).size(), 3u);
  const std::vector<std::string> others = {"all digits of field 'i' (float32)"};
  EXPECT_EQ(what_will_be_lost(cloud, {}, Format::ply, bytes, {}), others);
  const std::vector<Field> added = {{"displacement", Scalar::float32}};
  EXPECT_EQ(what_will_be_lost(cloud, added, Format::ply, bytes, {}), others) << "PLY has room for it";
  const std::vector<std::string> off = {"field 'i'", "field 'displacement'"};
  EXPECT_EQ(what_will_be_lost(cloud, added, Format::off, Encoding::ascii, {}), off);
}

TEST(Losses, OfAMeshToBeMadeAreThoseOfOneThatIs) {
  const Positions corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (const Format format : {Format::ply, Format::pcd, Format::xyz, Format::off, Format::las}) {
    const auto lost_of = [&](const Cloud& mesh) {
      return what_is_lost(mesh, format, target_encoding(mesh, format, {}), {});
    };
    EXPECT_EQ(lost_of_triangles(format), lost_of(make_mesh_file(corners, {{0, 1, 2}}, {})))
        << name_of(format);
    EXPECT_EQ(lost_of_edges(format), lost_of(make_mesh_file(corners, {}, {{0, 1}}))) << name_of(format);
  }
}

TEST(Edit, FieldsAreAddedAndPointsSelectedInEveryKind) {
  for (const Encoding encoding : {Encoding::ascii, Encoding::binary_little_endian})
    for (const Format format : {Format::ply, Format::pcd})
      for (int k = 0; k < kCases / 3; ++k) {
        SCOPED_TRACE(k);
        std::mt19937_64 engine{std::uint64_t(k)};
        Cloud cloud = parsed(written(random_cloud(format, true, engine), encoding));
        const std::vector<double> before = positions(cloud);
        std::vector<double> mark(cloud.size());
        for (std::size_t i = 0; i < mark.size(); ++i) mark[i] = double(i) + 0.25;
        set_field(cloud, "mark", Scalar::float32, mark);
        std::vector<std::size_t> rows;
        for (std::size_t i = 0; i < cloud.size(); i += 2) rows.push_back(i);
        select_points(cloud, rows);
        const Cloud again = parsed(written(cloud, encoding));
        ASSERT_EQ(again.size(), rows.size());
        const std::vector<double> after = positions(again);
        const std::vector<double> marks = field_values(again, find_field(again, "mark").value());
        for (std::size_t i = 0; i < rows.size(); ++i) {
          EXPECT_EQ(marks[i], mark[rows[i]]);
          for (std::size_t axis = 0; axis < 3; ++axis)
            EXPECT_EQ(after[3 * i + axis], before[3 * rows[i] + axis]);
        }
      }
}

}  // namespace
