// LAS: what is not a coordinate stays byte for byte, in every version and point format; broken files;
// conversions.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/io/formats/las/las_scale.h"
#include "pipeline/io/io.h"
#include "tests/support/las_bytes.h"

using namespace rfsmooth;                // NOLINT(google-build-using-namespace)
using namespace rfsmooth::pipeline::io;  // NOLINT(google-build-using-namespace)
using rfsmooth::test::las_bytes;
using rfsmooth::test::las_kinds;
using rfsmooth::test::LasBytes;
using testing::AllOf;
using testing::HasSubstr;

namespace {

Cloud las_cloud(const std::string& bytes) {
  return value_or_throw(parse_cloud(bytes, "in.las", {}, {}));
}

std::string las_text(const Cloud& cloud, std::optional<Format> format = {}, bool drop = false) {
  WriteOptions options;
  options.format = format;
  options.drop_unsupported = drop;
  const auto bytes = serialize_cloud(cloud, options, {});
  return bytes.ok() ? bytes.value() : "refused: " + bytes.error().message;
}

// The file without what moving its points may change: x, y, z, the box and the scale.
std::string masked(std::string bytes, const LasBytes& las) {
  bytes.replace(131, 24, 24, '\0');
  bytes.replace(179, 48, 48, '\0');
  for (std::size_t i = 0; i < las.xyz.size(); ++i) bytes.replace(las.points() + i * las.row(), 12, 12, '\0');
  return bytes;
}

class LasKind : public testing::TestWithParam<std::pair<int, int>> {
 protected:
  LasBytes las_ = las_bytes(GetParam().first, GetParam().second, 20);
};

TEST_P(LasKind, ComesBackByteForByte) {
  const std::string bytes = las_.bytes();
  const Cloud cloud = las_cloud(bytes);
  EXPECT_EQ(cloud.size(), las_.xyz.size());
  EXPECT_EQ(las_text(cloud), bytes);
}

TEST_P(LasKind, MovingThePointsChangesNothingElse) {
  const std::string bytes = las_.bytes();
  Cloud cloud = las_cloud(bytes);
  std::vector<double> xyz = positions(cloud);
  for (std::size_t i = 0; i < las_.xyz.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(xyz[3 * i + k], las_.xyz[i][k] * las_.scale[k] + las_.offset[k]) << i << ' ' << k;
  refine_scale(cloud, 1e-4, xyz.data(), {});
  for (double& v : xyz) v += 0.0123;
  set_positions(cloud, xyz.data());
  const std::string moved = las_text(cloud);
  EXPECT_EQ(masked(moved, las_), masked(bytes, las_));
  const std::vector<double> read = positions(las_cloud(moved));
  for (std::size_t k = 0; k < xyz.size(); ++k) EXPECT_NEAR(read[k], xyz[k], 0.5e-4 + 1e-9);
  for (std::size_t k = 0; k < 3; ++k) {  // the box is that of what is read
    double low = read[k], high = read[k];
    for (std::size_t i = k; i < read.size(); i += 3) {
      low = std::min(low, read[i]);
      high = std::max(high, read[i]);
    }
    EXPECT_EQ(LasBytes::get<double>(moved, 179 + 16 * k), high);
    EXPECT_EQ(LasBytes::get<double>(moved, 187 + 16 * k), low);
  }
}

// The file of the points that are kept is the one that would have been written without the others: only the
// box, which the test's files have from all points, is made of them too.
TEST_P(LasKind, RemovingPointsGivesTheFileWithoutThem) {
  Cloud cloud = las_cloud(las_.bytes());
  select_points(cloud, {1, 4, 7, 13});
  const std::string kept = las_text(cloud);
  ASSERT_EQ(kept.size(), las_.bytes().size() - 16 * las_.row());
  const std::size_t end = las_.points() + 4 * las_.row();
  EXPECT_EQ(kept.substr(end), las_.tail());
  std::size_t row = 0;
  for (const std::size_t i : {1, 4, 7, 13}) {
    EXPECT_EQ(kept.substr(las_.points() + row * las_.row(), las_.row()), las_.point(i));
    ++row;
  }
  const int minor = las_.minor;
  const bool old_counts = minor < 4 || las_.format < 6;
  EXPECT_EQ(LasBytes::get<std::uint32_t>(kept, 107), old_counts ? 4u : 0u);
  const std::uint64_t by_return[] = {3, 0, 0, 1, 0};  // of 1, 4, 7 and 13, which are 1, 4, 1, 1
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(LasBytes::get<std::uint32_t>(kept, 111 + 4 * k), old_counts ? by_return[k] : 0);
    if (minor == 4) {
      EXPECT_EQ(LasBytes::get<std::uint64_t>(kept, 255 + 8 * k), by_return[k]);
    }
  }
  if (minor == 4) {
    EXPECT_EQ(LasBytes::get<std::uint64_t>(kept, 247), 4u);
    EXPECT_EQ(LasBytes::get<std::uint64_t>(kept, 235), end + 7);
  }
  if (minor >= 3 && las_.has_waves()) {
    EXPECT_EQ(LasBytes::get<std::uint64_t>(kept, 227), end + 7);
  }
  EXPECT_EQ(las_text(las_cloud(kept)), kept);
}

TEST_P(LasKind, AddedFieldsAreExtraBytesAndTheOthersStay) {
  Cloud cloud = las_cloud(las_.bytes());
  std::vector<double> values;
  for (std::size_t i = 0; i < cloud.size(); ++i) values.push_back(double(i) / 8);
  set_field(cloud, "displacement", Scalar::float32, values);
  const std::string bytes = las_text(cloud);
  const Cloud again = las_cloud(bytes);
  ASSERT_EQ(again.points().fields.size(), cloud.points().fields.size());
  for (const char* name : {"ring", "range", "intensity", "displacement"}) {
    const auto was = find_field(cloud, name), is = find_field(again, name);
    ASSERT_TRUE(was && is) << name;
    EXPECT_EQ(field_values(cloud, *was), field_values(again, *is)) << name;
  }
  EXPECT_EQ(positions(again), positions(cloud));
  const std::size_t at = LasBytes::get<std::uint32_t>(bytes, 96), row = las_.row() + 4;
  ASSERT_EQ(LasBytes::get<std::uint16_t>(bytes, 105), row);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    EXPECT_EQ(bytes.substr(at + i * row, las_.row()), las_.point(i)) << i;
  EXPECT_EQ(bytes.substr(at + cloud.size() * row), las_.tail());
  if (las_.minor == 4) {
    EXPECT_EQ(LasBytes::get<std::uint64_t>(bytes, 235), at + cloud.size() * row + 7);
  }
}

TEST_P(LasKind, IsRefusedCutAtEveryByteThatIsNamed) {
  las_.xyz.resize(3);
  const std::string bytes = las_.bytes();
  const bool has_waves = las_.minor >= 3 && las_.has_waves();
  const std::size_t named = las_.minor == 4
                                ? bytes.size() - 16  // of the tail only "bytes at the end" is free
                            : has_waves ? las_.end() + 7 + las_.waves().size()
                                        : las_.end();
  for (std::size_t n = 0; n <= bytes.size(); ++n) {
    const auto cloud = parse_cloud(bytes.substr(0, n), "in.las", {}, {});
    EXPECT_EQ(cloud.ok(), n >= named) << n << " of " << named;
    if (cloud.ok()) continue;
    EXPECT_EQ(cloud.error().code, ErrorCode::input_unreadable);
    EXPECT_THAT(cloud.error().message, HasSubstr("in.las: "));
    EXPECT_THAT(cloud.error().message, HasSubstr("expected"));
    EXPECT_EQ(cloud.error().message.find('\n'), std::string::npos);
    if (n >= 5) {
      EXPECT_THAT(cloud.error().message, AllOf(HasSubstr("byte "), HasSubstr("cut short")));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, LasKind, testing::ValuesIn(las_kinds()), [](const auto& tested) {
  return "V1" + std::to_string(tested.param.first) + "Format" + std::to_string(tested.param.second);
});

TEST(Las, HeadersLongerThanTheVersionNeedsAndNoPointsAreKept) {
  for (const std::size_t n : {0, 2}) {
    LasBytes las = las_bytes(2, 3, n);
    las.records = false;
    las.described = las.undescribed = 0;
    std::string bytes = las.bytes();
    bytes.insert(227, "own words");
    LasBytes::put<std::uint16_t>(bytes, 94, 236);
    LasBytes::put<std::uint32_t>(bytes, 96, 236);
    EXPECT_EQ(las_text(las_cloud(bytes)), bytes);
  }
}

TEST(Las, OldCountsAloneAreTakenAndKeptUpToDate) {
  std::string bytes = las_bytes(4, 1, 9).bytes();
  LasBytes::put<std::uint64_t>(bytes, 247, 0);
  Cloud cloud = las_cloud(bytes);
  EXPECT_EQ(cloud.size(), 9u);
  EXPECT_EQ(las_text(cloud), bytes);
  select_points(cloud, {0, 1});
  const std::string kept = las_text(cloud);
  EXPECT_EQ(LasBytes::get<std::uint32_t>(kept, 107), 2u);
  EXPECT_EQ(LasBytes::get<std::uint64_t>(kept, 247), 2u);
}

struct BrokenLas {
  const char* name;
  std::size_t at;
  std::string bytes;
  const char* says;
};

void PrintTo(const BrokenLas& broken, std::ostream* out) {
  *out << broken.name;
}

template <class T>
std::string raw(T value) {
  std::string out;
  LasBytes::add(out, value);
  return out;
}

class LasHeader : public testing::TestWithParam<BrokenLas> {};

TEST_P(LasHeader, ThatLiesIsRefusedWithTheByte) {
  std::string bytes = las_bytes(4, 7, 5).bytes();
  bytes.replace(GetParam().at, GetParam().bytes.size(), GetParam().bytes);
  const auto cloud = parse_cloud(bytes, "in.las", {}, {});
  ASSERT_FALSE(cloud.ok());
  EXPECT_EQ(cloud.error().code, ErrorCode::input_unreadable);
  EXPECT_THAT(cloud.error().message,
              AllOf(HasSubstr("in.las: byte "), HasSubstr(GetParam().says), HasSubstr("; ")));
  EXPECT_EQ(cloud.error().message.find('\n'), std::string::npos);
}

const double kNan = std::numeric_limits<double>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    All, LasHeader,
    testing::Values(
        BrokenLas{"Major", 24, "\2", "byte 24: expected LAS 1.0 to 1.4, found version 2.4"},
        BrokenLas{"Minor", 25, "\5", "found version 1.5"},
        BrokenLas{"PointFormat", 104, "\x0b", "byte 104: expected a point format from 0 to 10, found 11"},
        BrokenLas{"Compressed", 104, "\x87", "byte 104: LAZ is not read; use the Python module"},
        BrokenLas{"HeaderTooShort", 94, raw<std::uint16_t>(227), "byte 94: expected a header of at least"},
        BrokenLas{"PointsInsideTheHeader", 96, raw<std::uint32_t>(300), "byte 96: expected the points behi"},
        BrokenLas{"PointsBehindTheFile", 96, raw<std::uint32_t>(4000000000u), "byte 4000000000"},
        BrokenLas{"RowTooShort", 105, raw<std::uint16_t>(35), "byte 105: expected at least 36 bytes"},
        BrokenLas{"RowZero", 105, raw<std::uint16_t>(0), "byte 105"},
        BrokenLas{"Count", 247, raw<std::uint64_t>(60), "expected 60 points of 44 bytes each, found"},
        BrokenLas{"CountHuge", 247, raw<std::uint64_t>(~0ull), "expected 18446744073709551615 points"},
        BrokenLas{"CountWraps", 247, raw<std::uint64_t>(1ull << 62), "points of 44 bytes each, found"},
        BrokenLas{"ScaleZero", 139, raw(0.0), "byte 139: expected a scale of y other than 0, found 0"},
        BrokenLas{"ScaleNan", 131, raw(kNan), "byte 131: expected a scale of x other than 0, found nan"},
        BrokenLas{"OffsetNan", 171, raw(kNan), "byte 171: expected an offset of z, found nan"},
        BrokenLas{"RecordTooLong", 395, raw<std::uint16_t>(65535), "byte 375: expected variable length re"},
        BrokenLas{"RecordsTooMany", 100, raw<std::uint32_t>(~0u), "variable length record 4 of 4294967295"},
        BrokenLas{"ExtendedInsideThePoints", 235, raw<std::uint64_t>(900), "byte 235: expected the extende"},
        BrokenLas{"ExtendedBehindTheFile", 235, raw<std::uint64_t>(1ull << 60), "expected extended record 1"},
        BrokenLas{"ExtendedTooMany", 243, raw<std::uint32_t>(~0u), "expected extended record 2 of 4294967"}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(Las, ADescriptionOfExtraBytesThatDoesNotFitIsNotFollowed) {
  LasBytes las = las_bytes(4, 6, 5);
  las.records = false;
  std::string bytes = las.bytes();
  bytes[375 + 54 + 2] = 30;  // three doubles in one byte
  Cloud cloud = las_cloud(bytes);
  EXPECT_EQ(cloud.points().fields.back().name, "extra_bytes");
  EXPECT_EQ(cloud.points().fields.back().count, 8u);
  EXPECT_EQ(las_text(cloud), bytes);
  set_field(cloud, "outlier", Scalar::uint8, std::vector<double>(5, 1));
  EXPECT_THAT(las_text(cloud), HasSubstr("refused: LAS: the description of the extra bytes"));
}

TEST(LasScale, RefiningKeepsEveryPointToTheLastDigit) {
  Cloud cloud = las_cloud(las_bytes(2, 3, 20).bytes());
  const std::vector<double> before = positions(cloud);
  const RefinedScale done = refine_scale(cloud, 0.0003, before.data(), {});
  EXPECT_EQ(done.after, (std::array<double, 3>{0.0001, 0.0001, 0.0001}));
  EXPECT_EQ(cloud.points().fields[1].offset, 4649000);
  const std::vector<double> after = positions(cloud);
  ASSERT_EQ(before.size(), 60u);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t k = 0; k < before.size(); ++k)
    EXPECT_NEAR(after[k], before[k], std::abs(before[k]) * 1e-15) << k;  // rounding of the product only
}

TEST(LasScale, OffsetMovesWhere32BitsAskForIt) {
  LasBytes las = las_bytes(2, 3, 20);
  las.offset = {0, 0, 0};
  for (auto& p : las.xyz) p[1] += 464900000;  // 4649 km in centimetres
  Cloud cloud = las_cloud(las.bytes());
  const std::vector<double> before = positions(cloud);
  const RefinedScale done = refine_scale(cloud, 0.0025, before.data(), {});
  EXPECT_EQ(done.after, (std::array<double, 3>{0.001, 0.001, 0.001}));
  EXPECT_NE(done.shift[1], 0);
  EXPECT_EQ(done.shift[0], 0);
  const std::vector<double> after = positions(las_cloud(las_text(cloud)));
  for (std::size_t k = 0; k < before.size(); ++k) EXPECT_NEAR(after[k], before[k], 1e-9) << k;
}

TEST(LasScale, ACloudTooLargeFor32BitsStaysAsItIs) {
  LasBytes las = las_bytes(2, 3, 2);
  las.xyz = {{-2000000000, 0, 0}, {2000000000, 0, 0}};
  Cloud cloud = las_cloud(las.bytes());
  const std::vector<double> before = positions(cloud);
  const RefinedScale done = refine_scale(cloud, 0.001, before.data(), {});
  EXPECT_EQ(done.after[0], 0.01);
  EXPECT_EQ(done.after[1], 0.001);
  EXPECT_GT(done.coarsest(), 0.001);
  EXPECT_EQ(positions(cloud)[3], before[3]);
}

TEST(LasScale, DecimalsStayDecimals) {
  EXPECT_EQ(times_power_of_ten(0.01, -1), 0.001);
  EXPECT_EQ(times_power_of_ten(0.01, -7), 1e-9);
  EXPECT_EQ(times_power_of_ten(0.0025, -2), 0.000025);
  EXPECT_EQ(times_power_of_ten(-1e10, 2), -1e12);
  EXPECT_EQ(decimal_scale(99.0, 1e9), 1e-7);
}

TEST(Las, PointsBeyondTheRangeAreSaid) {
  Cloud cloud = las_cloud(las_bytes(2, 1, 3).bytes());
  std::vector<double> xyz = positions(cloud);
  const double stays = xyz[8];
  xyz[0] = 1e9;
  xyz[8] = kNan;
  std::string said;
  Context context;
  context.log = [&](LogLevel, const std::string& message) { said += message; };
  set_positions(cloud, xyz.data(), context);
  EXPECT_THAT(said, HasSubstr("scale and offset can say: 2 points"));
  EXPECT_EQ(positions(cloud)[8], stays);
  EXPECT_EQ(positions(cloud)[0], 2147483647 * 0.01 + 500000);
}

std::vector<double> values_of(const Cloud& cloud, const char* name) {
  const auto field = find_field(cloud, name);
  EXPECT_TRUE(field) << name;
  return field ? field_values(cloud, *field) : std::vector<double>{};
}

TEST(LasConversion, CarriesFieldsAndNamesWhatIsLost) {
  for (const int format : {3, 7}) {
    const LasBytes las = las_bytes(4, format, 12);
    const Cloud cloud = las_cloud(las.bytes());
    EXPECT_THAT(las_text(cloud, Format::ply),
                AllOf(HasSubstr("refused: ply"), HasSubstr("the coordinate system"),
                      HasSubstr("record 'a company' 77"), HasSubstr("record 'copyist' 9"),
                      HasSubstr("`drop-unsupported`")));
    for (const Format target : {Format::ply, Format::pcd, Format::xyz}) {
      const Cloud plain = las_cloud(las_text(cloud, target, true));
      EXPECT_EQ(plain.format, target);
      EXPECT_EQ(positions(plain), positions(cloud));
      EXPECT_EQ(values_of(plain, "intensity"), values_of(cloud, "intensity"));
      EXPECT_EQ(values_of(plain, "gps_time"), values_of(cloud, "gps_time"));
      EXPECT_EQ(values_of(plain, "green"), values_of(cloud, "green"));
      EXPECT_EQ(values_of(plain, "ring"), values_of(cloud, "ring"));
      EXPECT_EQ(values_of(plain, "return_number")[5], 5);
      EXPECT_EQ(values_of(plain, "number_of_returns")[3], 5);
      EXPECT_EQ(values_of(plain, "classification")[3], format == 3 ? 2 : 200);
      EXPECT_EQ(values_of(plain, "synthetic")[3], format == 3 ? 1 : 0);
      EXPECT_EQ(values_of(plain, "withheld")[3], format == 3 ? 1 : 0);
      EXPECT_EQ(values_of(plain, "key_point")[3], format == 3 ? 0 : 1);
      EXPECT_EQ(values_of(plain, "scan_direction_flag")[3], 1);
      if (format == 7) {
        EXPECT_EQ(values_of(plain, "scanner_channel")[3], 1);
        EXPECT_NEAR(values_of(plain, "scan_angle")[3], -24, 1e-9);
      } else {
        EXPECT_EQ(values_of(plain, "scan_angle_rank")[3], -11);
      }
    }
  }
}

TEST(LasConversion, ScaledFloatsAreWorthTheSameElsewhere) {
  LasBytes las = las_bytes(4, 6, 5);
  las.records = las.behind = false;
  las.undescribed = 4;  // a float64 in the place of the float32 and these
  std::string bytes = las.bytes();
  const std::size_t description = las.header() + 54 + 192;
  bytes[description + 2] = 10;      // float64
  bytes[description + 3] = 8 | 16;  // has a scale and an offset
  LasBytes::put(bytes, description + 112, 0.25);
  LasBytes::put(bytes, description + 136, 100.0);
  for (std::size_t i = 0; i < 5; ++i)
    LasBytes::put(bytes, las.points() + (i + 1) * las.row() - 8, double(i) + 0.5);
  const Cloud cloud = las_cloud(bytes);
  const std::vector<double> expected = {100.125, 100.375, 100.625, 100.875, 101.125};
  ASSERT_EQ(values_of(cloud, "range"), expected);
  for (const Format target : {Format::ply, Format::pcd, Format::xyz})
    EXPECT_EQ(values_of(las_cloud(las_text(cloud, target)), "range"), expected) << int(target);
}

TEST(LasConversion, ThereAndBackKeepsEveryValue) {
  LasBytes las = las_bytes(4, 8, 12);
  las.records = las.behind = false;
  las.undescribed = 0;
  const Cloud cloud = las_cloud(las.bytes());
  for (const Format between : {Format::ply, Format::pcd}) {
    const Cloud back = las_cloud(las_text(las_cloud(las_text(cloud, between)), Format::las));
    ASSERT_EQ(back.format, Format::las);
    for (const char* name :
         {"intensity", "bit_fields", "classification_flags", "classification", "user_data", "scan_angle",
          "point_source_id", "gps_time", "red", "green", "blue", "nir", "ring", "range"})
      EXPECT_EQ(values_of(back, name), values_of(cloud, name)) << name;
    const std::vector<double> a = positions(back), b = positions(cloud);
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 2e-9);
  }
}

TEST(LasConversion, EightBitColoursAreEightBitsElsewhere) {
  for (const int times : {1, 256, 257}) {
    LasBytes las = las_bytes(2, 2, 4);
    las.described = las.undescribed = 0;
    std::string bytes = las.bytes();
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        LasBytes::put(bytes, las.points() + i * 26 + 20 + 2 * c, std::uint16_t(times * int(60 * c + 40 * i)));
    const Cloud ply = las_cloud(las_text(las_cloud(bytes), Format::ply, true));
    const auto red = find_field(ply, "red");
    ASSERT_TRUE(red);
    EXPECT_EQ(ply.points().fields[*red].type, Scalar::uint8);
    EXPECT_EQ(values_of(ply, "blue"), (std::vector<double>{120, 160, 200, 240})) << times;
    EXPECT_EQ(values_of(las_cloud(las_text(ply, Format::las)), "blue")[1], 160 * 256);
  }
}

TEST(LasConversion, OfPcdUnpacksColoursAndKeepsViewpointAndGrid) {
  const std::string pcd =
      "VERSION 0.7\nFIELDS x y z rgb intensity big\nSIZE 4 4 4 4 4 8\nTYPE F F F U F U\nCOUNT 1 1 1 1 1 "
      "1\nWIDTH 2\n"
      "HEIGHT 2\nVIEWPOINT 1 2 3 1 0 0 0\nPOINTS 4\nDATA ascii\n0 0 0 66051 0.5 18446744073709551615\n"
      "1 0 0 0 0.25 0\n0 1 0 0 7 0\n1 1 0 0 1 0\n";
  const Cloud las = las_cloud(las_text(las_cloud(pcd), Format::las));
  EXPECT_EQ(values_of(las, "red")[0], 256);
  EXPECT_EQ(values_of(las, "blue")[0], 3 * 256);
  EXPECT_EQ(values_of(las, "intensity_")[1], 0.25);  // no whole numbers: not what LAS calls intensity
  EXPECT_EQ(values_of(las, "big")[0], 18446744073709551615.0);
  const Cloud back = las_cloud(las_text(las, Format::pcd));
  EXPECT_EQ(back.viewpoint, "1 2 3 1 0 0 0");
  EXPECT_EQ(back.width, 2u);
  EXPECT_EQ(back.height, 2u);
}

TEST(LasConversion, CommentsComeBackWholeHoweverManyRecordsTheyFill) {
  std::string comments, longest;
  for (int i = 0; i < 4000; ++i) comments += "# line " + std::to_string(i) + " of many that fill records\n";
  for (int i = 0; i < 40000; ++i) longest += "\u00e4";  // two bytes each: 65,535 end within one
  const Cloud many = las_cloud(comments + "1 2 3\n4 5 6\n"),
              one = las_cloud("# " + longest + "\n1 2 3\n4 5 6\n");
  const auto back = [](const Cloud& cloud) {
    return las_cloud(las_text(las_cloud(las_text(cloud, Format::las)), Format::ply)).notes;
  };
  const std::vector<Note> lines = back(many), parts = back(one);
  ASSERT_EQ(lines.size(), 4000u);
  for (std::size_t i = 0; i < lines.size(); ++i)
    ASSERT_EQ(lines[i].line, "comment line " + std::to_string(i) + " of many that fill records");
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].line.substr(8) + parts[1].line.substr(8), longest);
  EXPECT_EQ(parts[0].line.size() % 2, 0u);  // no half of a character
}

TEST(LasConversion, PointsThatAreNotFiniteAreNamedAndLeftOut) {
  const Cloud cloud = las_cloud("1 2 3 7\nnan 5 6 8\n4 5 6 9\n");
  EXPECT_THAT(las_text(cloud, Format::las), HasSubstr("1 point not finite"));
  const Cloud las = las_cloud(las_text(cloud, Format::las, true));
  EXPECT_EQ(positions(las), (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(values_of(las, "column_4"), (std::vector<double>{7, 9}));
}

TEST(LasConversion, LargeCoordinatesKeepAMillionthOfTheExtent) {
  std::string text;
  for (int i = 0; i < 50; ++i)
    text +=
        "500000." + std::to_string(1000 + 17 * i) + " 4649776." + std::to_string(3000 + 11 * i) + " 12.5\n";
  const Cloud cloud = las_cloud(text);
  const Cloud las = las_cloud(las_text(cloud, Format::las));
  const std::vector<double> a = positions(cloud), b = positions(las);
  ASSERT_EQ(a.size(), 150u);
  ASSERT_EQ(b.size(), a.size());
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 2e-9) << k;
}

}  // namespace
