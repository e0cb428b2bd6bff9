// Broken files are refused with one line that says where, what was expected and what was found; never a
// crash.
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include <rfsmooth/cloud_file.h>

#include "pipeline/io/io.h"
#include "tests/fuzz/reader.h"
#include "tests/pipeline/io/random_cloud.h"

using namespace rfsmooth;                // NOLINT(google-build-using-namespace)
using namespace rfsmooth::pipeline::io;  // NOLINT(google-build-using-namespace)

namespace {

const std::string kPly =
    "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kPcd = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";

struct Broken {
  const char* name;
  std::string file;
  const char* says;  // part of the message
};

void PrintTo(const Broken& broken, std::ostream* out) {
  *out << broken.name;
}

class BrokenFile : public testing::TestWithParam<Broken> {};

TEST_P(BrokenFile, IsRefusedAndSaysWhere) {
  const auto cloud = parse_cloud(GetParam().file, "in", {}, {});
  ASSERT_FALSE(cloud.ok());
  EXPECT_EQ(cloud.error().code, ErrorCode::input_unreadable);
  EXPECT_NE(cloud.error().message.find(GetParam().says), std::string::npos) << cloud.error().message;
  EXPECT_NE(cloud.error().message.find("expected"), std::string::npos) << cloud.error().message;
  EXPECT_EQ(cloud.error().message.find('\n'), std::string::npos);
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

const std::string kBinary = with(kPly, "ascii", "binary_little_endian");

INSTANTIATE_TEST_SUITE_P(
    All, BrokenFile,
    testing::Values(
        Broken{"Empty", "", "byte 0"}, Broken{"OnlyMagic", "ply\n", "line 2"},
        Broken{"NoFormat", "ply\nelement vertex 0\nproperty float x\nend_header\n", "line 4"},
        Broken{"BadFormat", with(kPly, "ascii", "asci"), "'asci'"},
        Broken{"BadCount", with(kPly, "vertex 1", "vertex -1"), "'-1'"},
        Broken{"HugeCount", with(kPly, "vertex 1", "vertex 99999999999999999999") + "end_header\n", "line 3"},
        Broken{"FourBillionAscii", with(kPly, "vertex 1", "vertex 4000000000") + "end_header\n1 2 3\n",
               "4000000000"},
        Broken{"FourBillionBinary",
               with(kBinary, "vertex 1", "vertex 4000000000") + "end_header\n123456789012", "4000000000"},
        Broken{"BadType", kPly + "property quad q\nend_header\n1 2 3 4\n", "'quad'"},
        Broken{"FloatListLength", kPly + "property list float int q\nend_header\n1 2 3 0\n", "'float'"},
        Broken{"NoVertex", "ply\nformat ascii 1.0\nelement face 0\nend_header\n", "'face'"},
        Broken{"NoZ", with(kPly, "property float z\n", "") + "end_header\n1 2\n", "'z'"},
        Broken{"ListForX",
               with(kPly, "property float x", "property list uchar float x") + "end_header\n1 1 2 3\n",
               "expected the coordinate 'x' among the points' fields, found 'x' (a list), 'y', 'z'"},
        Broken{"BlankLineFirst", "\n" + kPly + "end_header\n1 2 3\n", "line 1: expected 'ply', found ''"},
        Broken{"PropertyFirst", "ply\nformat ascii 1.0\nproperty float x\nend_header\n", "line 3"},
        Broken{"BadKeyword", kPly + "elephant\nend_header\n", "'elephant'"},
        Broken{"TooFewValues", kPly + "end_header\n1 2\n", "line 8"},
        Broken{"TooManyValues", kPly + "end_header\n1 2 3 4\n", "line 8"},
        Broken{"NotANumber", kPly + "end_header\n1 2 3x\n", "'3x'"},
        Broken{"DecimalComma", kPly + "end_header\n1,5 2 3\n", "'1,5'"},
        Broken{"ColourTooLarge", kPly + "property uchar red\nend_header\n1 2 3 256\n", "'256'"},
        Broken{"NegativeListLength",
               kBinary + "property list char int q\nend_header\n" + std::string(12, '\0') +
                   std::string(1, '\xff'),
               "list 'q'"},
        Broken{
            "LongList",
            kBinary + "property list uint int q\nend_header\n" + std::string(12, '\0') + "\xff\xff\xff\xff",
            "byte"},
        Broken{"NoProperties", kPly + "element odd 3\nend_header\n1 2 3\n", "'odd'"},
        Broken{"PcdNoData", kPcd, "end of the file"}, Broken{"PcdNoPoints", kPcd + "DATA ascii\n", "POINTS"},
        Broken{"PcdBadData", kPcd + "POINTS 1\nDATA zip\n", "'zip'"},
        Broken{"PcdBadSize", with(kPcd, "SIZE 4 4 4", "SIZE 4 4 3") + "POINTS 1\nDATA ascii\n1 2 3\n",
               "SIZE 3"},
        Broken{"PcdSizeCount", with(kPcd, "SIZE 4 4 4", "SIZE 4 4") + "POINTS 1\nDATA ascii\n1 2 3\n",
               "SIZE"},
        Broken{"PcdHugeField", with(kPcd, "COUNT 1 1 1", "COUNT 1 1 4000000000") + "POINTS 1\nDATA binary\n",
               "COUNT"},
        Broken{"PcdZeroField", with(kPcd, "COUNT 1 1 1", "COUNT 1 1 0") + "POINTS 1\nDATA binary\n", "COUNT"},
        Broken{"PcdGrid", kPcd + "WIDTH 2\nHEIGHT 2\nPOINTS 5\nDATA ascii\n1 2 3\n", "POINTS 4"},
        Broken{"PcdOverflow", kPcd + "WIDTH 8589934592\nHEIGHT 8589934592\nDATA binary\n", "WIDTH"},
        Broken{"PcdFourBillion", kPcd + "WIDTH 4000000000\nHEIGHT 1\nPOINTS 4000000000\nDATA binary\n123",
               "4000000000"},
        Broken{"PcdViewpoint", kPcd + "VIEWPOINT 1 2 3\nPOINTS 1\nDATA ascii\n1 2 3\n", "VIEWPOINT"},
        Broken{"CompressedNoSizes", kPcd + "POINTS 1\nDATA binary_compressed\n1234", "8 bytes"},
        Broken{"CompressedShort",
               kPcd + "POINTS 1\nDATA binary_compressed\n" + std::string("\x20\0\0\0\x0c\0\0\0abc", 11),
               "32 bytes"},
        Broken{"CompressedWrongSize",
               kPcd + "POINTS 1\nDATA binary_compressed\n" + std::string("\x02\0\0\0\x08\0\0\0\0a", 10),
               "found 8"},
        Broken{"CompressedTooGood",
               std::string("FIELDS x y z h\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 9997\nPOINTS 1000\nDATA "
                           "binary_compressed\n") +
                   std::string("\x02\0\0\0\0\x5a\x62\x02\0a", 10),
               "cannot hold"},
        Broken{"CompressedBadReference",
               kPcd + "POINTS 1\nDATA binary_compressed\n" + std::string("\x02\0\0\0\x0c\0\0\0\x40\x07", 10),
               "before the start"},
        Broken{"CompressedTooLittle",
               kPcd + "POINTS 1\nDATA binary_compressed\n" + std::string("\x02\0\0\0\x0c\0\0\0\0a", 10),
               "holds less"},
        Broken{"XyzWords", "hello world\n", "found 2 in 'hello world'"},
        Broken{"XyzTwoColumns", "1 2\n3 4\n", "line 1"},
        Broken{"XyzRagged", "1 2 3\n\n# note\n1 2\n", "line 4"},
        Broken{"XyzLong", "1 2 3\n1 2 3 4\n", "line 2"},
        Broken{"XyzDecimalCommas", "1,5 2,5 3,5\n", "commas"},
        Broken{"XyzOnlyComments", "# a\n# b\n", "comments"},
        Broken{"XyzBadNumber", "1 2 3\n1 2 0x3\n", "'0x3'"},
        Broken{"Binary", std::string("\0\1\2\3", 4), "line 1"}, Broken{"OffNoCounts", "OFF\n", "line 2"},
        Broken{"OffBinary", "OFF BINARY\n", "BINARY"}, Broken{"OffFour", "4OFF\n1 0 0\n1 2 3 4\n", "'4OFF'"},
        Broken{"OffBadCount", "OFF\nx 0 0\n", "'x'"},
        Broken{"OffFewVertices", "OFF\n2 0 0\n1 2 3\n", "row 2 of 2"},
        Broken{"OffBadFace", "OFF\n1 1 0\n1 2 3\n3 0 0\n", "line 4"},
        Broken{"OffTwoSigns", "OFF\n1 1 0\n1 2 3\n1 ++0\n", "'++0'"},
        Broken{"TwoSigns", kPly + "property int i\nend_header\n1 2 3 ++4\n", "'++4'"},
        Broken{"OffHuge", "OFF\n4000000000 0 0\n1 2 3\n", "4000000000"}),
    [](const auto& tested) { return std::string(tested.param.name); });

// Every prefix of a small file is either refused, or (ascii: cut inside the last number) still holds all its
// points.
TEST(Truncated, AtEveryByte) {
  std::vector<std::string> files = {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "1 2 3\n4 5 6\n"};
  for (const auto& [format, encoding] :
       {std::pair{Format::ply, Encoding::ascii}, std::pair{Format::ply, Encoding::binary_little_endian},
        std::pair{Format::ply, Encoding::binary_big_endian}, std::pair{Format::pcd, Encoding::ascii},
        std::pair{Format::pcd, Encoding::binary_little_endian},
        std::pair{Format::pcd, Encoding::binary_compressed}})
    for (int k = 0; k < 4; ++k) {
      std::mt19937_64 engine{std::uint64_t(k)};
      WriteOptions options;
      options.encoding = encoding;
      files.push_back(serialize_cloud(random_cloud(format, true, engine), options, {}).value());
    }
  for (const std::string& file : files) {
    const Cloud whole = parse_cloud(file, "in", {}, {}).value();
    for (std::size_t n = 0; n < file.size(); ++n) {
      const auto cloud = parse_cloud(file.substr(0, n), "in", {}, {});
      if (cloud.ok()) {
        EXPECT_TRUE(whole.encoding == Encoding::ascii || whole.size() == 0) << n << " of " << file;
        if (whole.format != Format::xyz) {
          EXPECT_EQ(cloud.value().size(), whole.size()) << n << " of " << file;
        }
      } else {
        EXPECT_EQ(cloud.error().code, ErrorCode::input_unreadable);
        EXPECT_NE(cloud.error().message.find("expected"), std::string::npos) << cloud.error().message;
      }
    }
  }
}

TEST(Mesh, FaceOutsideThePointsIsRefused) {
  const auto file = CloudFile::parse("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "in");
  ASSERT_TRUE(file.ok());
  const auto faces = file.value().faces();
  ASSERT_FALSE(faces.ok());
  EXPECT_EQ(faces.error().code, ErrorCode::input_unreadable);
  EXPECT_NE(faces.error().message.find("face 0"), std::string::npos) << faces.error().message;
}

// What the fuzzers found, and small files of every kind: no input may crash, and what is read is written.
TEST(Corpus, IsReplayed) {
  std::map<std::string, std::size_t> seen, read;  // files of each folder, and those that are clouds
  for (const auto& entry : std::filesystem::recursive_directory_iterator(RFSMOOTH_CORPUS_DIR)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream in(entry.path(), std::ios::binary);
    std::ostringstream bytes;
    bytes << in.rdbuf();
    const std::string content = bytes.str();
    SCOPED_TRACE(entry.path());
    const std::string folder = entry.path().parent_path().filename().string();
    ++seen[folder];
    const auto cloud = parse_cloud(content, "in", {}, {});
    read[folder] += cloud.ok() && name_of(cloud.value().format) == folder ? 1 : 0;
    for (const std::optional<Format> format :
         {std::optional<Format>{}, std::optional{Format::ply}, std::optional{Format::pcd},
          std::optional{Format::xyz}, std::optional{Format::off}, std::optional{Format::las}})
      fuzz::read_write_read(format, reinterpret_cast<const std::uint8_t*>(content.data()), content.size());
  }
  for (const Format format : {Format::ply, Format::pcd, Format::xyz, Format::off, Format::las}) {
    const std::string folder(name_of(format));
    EXPECT_GE(seen[folder], 4u) << folder;
    EXPECT_GE(read[folder], 1u) << folder;
  }
}

}  // namespace
