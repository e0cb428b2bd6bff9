/// Text tables as programs write them: cells that are empty, names with units, names in quotes, names that do
/// not match the rows.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/io/io.h"
#include "pipeline/io/point_fields.h"
#include "tests/pipeline/io/as_text.h"

namespace rfsmooth::pipeline::io {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> columns_of(const Cloud& cloud) {
  std::vector<std::string> names;
  for (const Field& field : cloud.points().fields) names.push_back(field.name);
  return names;
}

Cloud table_of(const std::string& text) {
  auto cloud = parse_cloud(text, "in.csv", {}, {});
  EXPECT_TRUE(cloud.ok()) << text << (cloud.ok() ? "" : cloud.error().message);
  return cloud.ok() ? cloud.value() : make_cloud(nullptr, 0);
}

std::string refusal_of(const std::string& text) {
  const auto cloud = parse_cloud(text, "in.csv", {}, {});
  return cloud.ok() ? "read: " + text : cloud.error().message;
}

struct NamedColumns {
  std::string text;
  std::vector<std::string> columns;
};

class NamedTable : public ::testing::TestWithParam<NamedColumns> {};

// Two rows, 1 2 3 and 4 5 6, among other columns.
TEST_P(NamedTable, IsReadByItsNamesAndComesBack) {
  const auto& [text, columns] = GetParam();
  Cloud cloud = table_of(text);
  EXPECT_EQ(columns_of(cloud), columns);
  ASSERT_EQ(positions(cloud), (std::vector<double>{1, 2, 3, 4, 5, 6})) << text;
  EXPECT_EQ(as(cloud, Format::xyz), text);
  expect_that_y_comes_back(cloud, text, "5.25");
  const Cloud ply = table_of(as(cloud, Format::ply));
  EXPECT_EQ(positions(ply), (std::vector<double>{1, 2, 3, 4, 5.25, 6})) << "as PLY";
  EXPECT_EQ(columns_of(ply), columns) << "as PLY";
}

INSTANTIATE_TEST_SUITE_P(
    Tables, NamedTable,
    ::testing::Values(
        NamedColumns{"id,label,x,y,z\n7,,1,2,3\n8,,4,5,6\n", {"id", "label", "x", "y", "z"}},
        NamedColumns{"id;x [m];y [m];z [m]\n7;1;2;3\n8;4;5;6\n", {"id", "x", "y", "z"}},
        NamedColumns{"id\tX (m)\tY (m)\tZ (m)\tpoint class\r\n7\t1\t2\t3\t\r\n8\t4\t5\t6\t\r\n",
                     {"id", "X", "Y", "Z", "point_class"}},
        NamedColumns{"\"Red\",\"X\",\"Y\",\"Z\"\n9,1,2,3\n9,4,5,6", {"Red", "X", "Y", "Z"}},
        NamedColumns{"\"a, b\",\"x\",\"y\",\"z\"\n\"9\",\"1\",\"2\",\"3\"\n\"\",\"4\",\"5\",\"6\"\n",
                     {"a,_b", "x", "y", "z"}},
        NamedColumns{"# a b x y z\n9,8,1,2,3\n9,,4,5,6\n", {"a", "b", "x", "y", "z"}},
        NamedColumns{"# the units of x y z are metres\nt x y z\n9 1 2 3\n9 4 5 6\n", {"t", "x", "y", "z"}}));

// Two rows, 1 2 3 and 4 5 6, whose columns other programs call otherwise than x, y, z.
TEST(Xyz, CoordinatesMayHaveTheNamesOfSurveyorsAndOtherPrograms) {
  for (const std::string text :
       {"Easting Northing Height\n1 2 3\n4 5 6\n", "id,Easting,Northing,Elevation\n7,1,2,3\n8,4,5,6\n",
        "Height;Easting (m);Northing (m)\n3;1;2\n6;4;5\n", "EASTING\tNORTHING\tZ\n1\t2\t3\n4\t5\t6\n",
        "E,N,Z,code\n1,2,3,9\n4,5,6,9\n", "e n h\n1 2 3\n4 5 6\n", "X Y Height\n1 2 3\n4 5 6\n",
        "\"Intensity\",\"Points:0\",\"Points:1\",\"Points:2\"\n9,1,2,3\n9,4,5,6\n",
        "Points_0,Points_1,Points_2\n1,2,3\n4,5,6\n", "//X;Y;Z;Scalar field\n1;2;3;9\n4;5;6;9\n",
        "x_coord,y_coord,z_coord\n1,2,3\n4,5,6\n"}) {
    Cloud cloud = table_of(text);
    ASSERT_EQ(positions(cloud), (std::vector<double>{1, 2, 3, 4, 5, 6})) << text;
    EXPECT_EQ(as(cloud, Format::xyz), text);
    expect_that_y_comes_back(cloud, text, "5.25");
    const Cloud ply = table_of(as(cloud, Format::ply)), pcd = table_of(as(cloud, Format::pcd));
    EXPECT_EQ(positions(ply), (std::vector<double>{1, 2, 3, 4, 5.25, 6})) << "as PLY: " << text;
    EXPECT_EQ(positions(pcd), positions(ply)) << "as PCD: " << text;
  }
  EXPECT_EQ(positions(table_of("Easting Northing Height x y z\n7 8 9 1 2 3\n")),
            (std::vector<double>{1, 2, 3}));
  EXPECT_THAT(refusal_of("Easting Northing Height x\n7 8 9 1\n"), HasSubstr("line 1: expected numbers"));
}

TEST(Xyz, NamesAndWordsThatAreNotReadAreRefusedWithWhatToDo) {
  EXPECT_THAT(refusal_of("lon,lat,alt\n1,2,3\n4,5,6\n"),
              AllOf(HasSubstr("in.csv: line 1: expected numbers, or names with x, y and z among them"),
                    HasSubstr("found 'lon,lat,alt'; call the coordinates so")));
  for (const std::string text : {"x,y,z,class\n1,2,3,ground\n4,5,6,tree\n",
                                 "# scan\n1 2 3 ground\n4 5 6 tree\n", "id;x;y;z\nP1;1;2;3\nP2;4;5;6\n"})
    EXPECT_THAT(refusal_of(text), AllOf(HasSubstr("line 2: expected a value of"),
                                        HasSubstr("columns of text are not read: take them out of the file")))
        << text;
}

TEST(Xyz, AnEmptyCellOfACoordinateIsAPointThatIsNotFiniteAndStays) {
  for (const std::string text :
       {"x,y,z,i\n1,2,,7\n4,5,6,8\n", "1;2;;7\n4;5;6;8\n", "1\t2\t\t7\n4\t5\t6\t8\n", "1,2,\n4,5,6"}) {
    Cloud cloud = table_of(text);
    std::vector<double> xyz = positions(cloud);
    ASSERT_EQ(xyz.size(), 6U) << text;
    EXPECT_TRUE(std::isnan(xyz[2])) << text;
    xyz[2] = 0;
    EXPECT_EQ(xyz, (std::vector<double>{1, 2, 0, 4, 5, 6})) << text;
    EXPECT_EQ(finite_rows(positions(cloud)), 1U);
    set_positions(cloud, positions(cloud).data());
    EXPECT_EQ(as(cloud, Format::xyz), text);
  }
}

TEST(Xyz, AFieldMoreIsACellMore) {
  const auto with_mark = [](const std::string& text) {
    Cloud cloud = table_of(text);
    set_field(cloud, "mark", Scalar::float64, {0.5, 1.5});
    const std::string after = as(cloud, Format::xyz);
    EXPECT_EQ(field_values(table_of(after), cloud.points().fields.size() - 1),
              (std::vector<double>{0.5, 1.5}))
        << after;
    return after;
  };
  EXPECT_EQ(with_mark("\"x\",\"y [m]\",\"z\",\"i\"\n1,2,3,\n4,5,6,7\n"),
            "\"x\",\"y [m]\",\"z\",\"i\",\"mark\"\n1,2,3,,0.5\n4,5,6,7,1.5\n");
  EXPECT_EQ(with_mark("x\ty\tz\ti\r\n1\t2\t3\t\r\n4\t5\t6\t7\r\n"),
            "x\ty\tz\ti\tmark\r\n1\t2\t3\t\t0.5\r\n4\t5\t6\t7\t1.5\r\n");
  EXPECT_EQ(with_mark("\"1\";\"2\";\"3\"\n\"4\";\"5\";\"6\""),
            "\"1\";\"2\";\"3\";\"0.5\"\n\"4\";\"5\";\"6\";\"1.5\"");
}

TEST(Xyz, NamesThatDoNotMatchTheRowsAreRefused) {
  for (const std::string text :
       {"id x y z\n7 1 2 3 9\n8 4 5 6 9\n", "# id x y z\n7 1 2 3 9\n8 4 5 6 9\n", "x,y,z\n7,1,2,3\n8,4,5,6\n",
        "id x [m] y [m] z [m]\n7 1 2 3\n8 4 5 6\n", "X Y Z R G B\n1 2 3\n4 5 6\n"})
    EXPECT_THAT(refusal_of(text), AllOf(HasSubstr("in.csv: line 1: expected names for"), HasSubstr("columns"),
                                        HasSubstr("name every column")))
        << text;
  for (const std::string text : {"# x y z in metres\n1 2 3\n4 5 6\n", "# x y z i\n1 2 3 4 5\n4 5 6 7 8\n",
                                 "# columns: x y z\n1 2 3 4\n4 5 6 4\n"})
    EXPECT_EQ(as(table_of(text), Format::xyz), text) << "an ordinary comment";
}

TEST(Xyz, ARowOfOtherCellsThanTheFirstIsRefused) {
  EXPECT_THAT(refusal_of("1,2,3\n4,5,6,7\n"), HasSubstr("line 2: expected 3 values, found 4"));
  EXPECT_THAT(refusal_of("1,2,3\n\n4,5\n"), HasSubstr("line 3: expected 3 values, found 2"));
  EXPECT_THAT(refusal_of("1,2,3\n4,five,6\n"),
              HasSubstr("line 2: expected a value of 'y' (float64), found 'five'"));
}

TEST(Xyz, ANumberOfPointsThatIsNotTheRowsIsRefused) {
  EXPECT_THAT(refusal_of("3\n1 2 3\n4 5 6\n"),
              AllOf(HasSubstr("line 3: expected 3 points"), HasSubstr("found 2"), HasSubstr("cut off")));
  EXPECT_THAT(refusal_of("# scan\n1\n1,2,3\n4,5,6\n"),
              AllOf(HasSubstr("line 4: expected 1 point "), HasSubstr("found 2")));
}

TEST(Xyz, LinesThatEndInCarriageReturnsAloneAreRefused) {
  for (const std::string text : {"1 2 3\r4 5 6\r", "x y z\r1 2 3\r4 5 6\r", "1,2,3\r4,5,6"})
    EXPECT_THAT(refusal_of(text), AllOf(HasSubstr("line 1"), HasSubstr("CR alone"))) << text;
  const std::string comment = "# scan\rof a room\n1 2 3\n4 5 6\n";
  EXPECT_EQ(as(table_of(comment), Format::xyz), comment) << "other formats' comments may hold a CR";
}

}  // namespace
}  // namespace rfsmooth::pipeline::io
