/// Fields that the command adds on demand: where they stand, what they say, and that nothing else changes.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/support/cloud_file.h"
#include "tests/cli/support/folder.h"
#include "tests/cli/support/small_clouds.h"

using ::testing::HasSubstr;

namespace rfsmooth::test {
namespace {

namespace io = pipeline::io;

std::string name_of_case(const ::testing::TestParamInfo<std::pair<const char*, const char*>>& test) {
  return std::string(test.param.first) + "_" + test.param.second;
}

class AddedFields : public InFolder {
 protected:
  /// Writes the noisy plane as `name` in an encoding of its format.
  void put_cloud(const std::string& name, const std::string& encoding) const {
    const auto cloud = io::parse_cloud(noisy_plane(20).bytes(), "plane", {}, {});
    io::WriteOptions options;
    options.encoding = io::encoding_by_name(encoding);
    value_or_throw(io::write_cloud(cloud.value(), at(name), options, {}));
  }
};

class EveryEncoding : public AddedFields,
                      public ::testing::WithParamInterface<std::pair<const char*, const char*>> {};

TEST_P(EveryEncoding, DisplacementIsTheLastFieldAndNothingElseChanges) {
  const std::string extension = std::string(".") + GetParam().first;
  put_cloud("in" + extension, GetParam().second);
  const Ran plain = run({"denoise", "in" + extension, "plain" + extension});
  ASSERT_EQ(plain.code, 0) << plain.err;
  const Ran ran = run({"denoise", "--write-displacement", "in" + extension, "out" + extension});
  ASSERT_EQ(ran.code, 0) << ran.err;

  const io::Cloud before = read(at("in" + extension)), without = read(at("plain" + extension)),
                  with = read(at("out" + extension));
  EXPECT_EQ(with.encoding, without.encoding);
  ASSERT_EQ(with.points().fields.size(), without.points().fields.size() + 1);
  const io::Field& added = with.points().fields.back();
  EXPECT_EQ(added.name, "displacement");
  EXPECT_EQ(added.type, io::Scalar::float32);
  for (std::size_t i = 0; i < without.size(); ++i) {
    std::string_view row = without.points().row(i);
    while (without.points().text && std::isspace(static_cast<unsigned char>(row.back())) != 0)
      row.remove_suffix(1);
    ASSERT_EQ(with.points().row(i).substr(0, row.size()), row) << "row " << i;
  }
  const auto xyz = io::positions(before), moved = io::positions(with);
  const auto values = io::field_values(with, with.points().fields.size() - 1);
  double largest = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_FLOAT_EQ(float(values[i]),
                    float(std::hypot(moved[3 * i] - xyz[3 * i], moved[3 * i + 1] - xyz[3 * i + 1],
                                     moved[3 * i + 2] - xyz[3 * i + 2])));
    largest = std::max(largest, values[i]);
  }
  EXPECT_GT(largest, 0);
}

INSTANTIATE_TEST_SUITE_P(Formats, EveryEncoding,
                         ::testing::Values(std::pair{"ply", "ascii"}, std::pair{"ply", "binary"},
                                           std::pair{"ply", "binary_big_endian"}, std::pair{"pcd", "ascii"},
                                           std::pair{"pcd", "binary"}, std::pair{"pcd", "binary_compressed"}),
                         name_of_case);

TEST_F(AddedFields, AFieldOfThatNameIsReplacedInPlace) {
  put("in.ply", noisy_plane(20, "displacement").bytes());
  const Ran ran = run({"denoise", "--write-displacement", "in.ply", "out.ply"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const std::string before = take("in.ply"), after = take("out.ply");
  ASSERT_EQ(after.size(), before.size());
  const std::size_t header = noisy_plane(20, "displacement").header().size();
  EXPECT_EQ(after.substr(0, header), before.substr(0, header));
  const auto values = io::field_values(read(at("out.ply")), 3);
  EXPECT_LT(*std::max_element(values.begin(), values.end()), 2) << "not the old ones, which reach 40";
}

TEST_F(AddedFields, AFieldOfWholeNumbersIsNotOverwritten) {
  std::string bytes = noisy_plane(20).bytes();
  bytes.replace(bytes.find("uint label"), 10, "uint displacement");
  put("in.ply", bytes);
  const Ran ran = run({"denoise", "--write-displacement", "in.ply", "out.ply"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err, HasSubstr("displacement"));
  EXPECT_THAT(ran.err, HasSubstr("uint32"));
  EXPECT_FALSE(there("out.ply"));
}

TEST_F(AddedFields, ColumnsWithoutNamesAreTold) {
  put_cloud("in.ply", "binary");
  ASSERT_EQ(run({"denoise", "in.ply", "named.xyz"}).code, 0);
  std::string rows = take("named.xyz");
  while (rows.front() == '#') rows.erase(0, rows.find('\n') + 1);
  put("in.xyz", rows);
  const std::vector<std::string> more = {"denoise", "--write-displacement", "--normals", "--viewpoint",
                                         "0,0,9"};
  const auto said = [&](const std::string& in, const std::string& out) {
    std::vector<std::string> words = more;
    words.insert(words.end(), {in, out});
    const Ran ran = run(words);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return ran.err;
  };
  EXPECT_THAT(said("in.xyz", "out.xyz"),
              HasSubstr("out.xyz: has no names: column 6 is displacement, 7 nx, 8 ny, 9 nz\n"));
  for (const auto& [in, out] : {std::pair("named.xyz", "a.xyz"), {"in.xyz", "a.csv"}, {"in.ply", "b.xyz"}})
    EXPECT_THAT(said(in, out), ::testing::Not(HasSubstr("column"))) << in;
  const std::string table = take("a.csv");
  EXPECT_EQ(table.substr(0, table.find('\n')), "x,y,z,column_4,column_5,displacement,nx,ny,nz");
}

TEST_F(AddedFields, OffHasNoPlaceForThem) {
  put("in.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2 255 0 0\n");
  const Ran refused = run({"denoise", "--write-displacement", "in.off", "out.off"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("displacement"));
  const Ran dropped = run({"denoise", "--write-displacement", "--drop-unsupported", "in.off", "out.off"});
  ASSERT_EQ(dropped.code, 0) << dropped.err;
  ASSERT_EQ(run({"denoise", "in.off", "plain.off"}).code, 0);
  EXPECT_EQ(take("out.off"), take("plain.off")) << "the faces keep their colours";
  ASSERT_EQ(run({"denoise", "--write-displacement", "in.off", "out.ply", "--drop-unsupported"}).code, 0);
  EXPECT_TRUE(io::find_field(read(at("out.ply")), "displacement").has_value());
}

}  // namespace
}  // namespace rfsmooth::test
