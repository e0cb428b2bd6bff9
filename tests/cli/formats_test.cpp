/// Unusual but legal files, and broken ones, through the real command with the default flow: the bytes that
/// are not coordinates stay, or the exit code and message say what is wrong.
#include <algorithm>
#include <cstdio>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pipeline/io/io.h"
#include "tests/cli/support/folder.h"
#include "tests/cli/support/rich_cloud.h"

using ::testing::AllOf;
using ::testing::HasSubstr;

namespace rfsmooth::test {
namespace {

constexpr std::size_t kPoints = 400;

template <class T>
void add(std::string& out, const T& value, bool big = false) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
  if (big) std::reverse(bytes.begin(), bytes.end());
  out += bytes;
}

class Formats : public InFolder {
 protected:
  /// Denoises `bytes`; the output must have their size.
  std::string denoised(const std::string& name, const std::string& bytes) {
    put(name, bytes);
    const Ran ran = run({"denoise", "--force", name, "out-" + name});
    EXPECT_EQ(ran.code, 0) << ran.err;
    std::string after = ran.code == 0 ? take("out-" + name) : "";
    return after;
  }
  void expect_refused(const std::string& name, const std::string& bytes, const std::string& says) {
    put(name, bytes);
    const Ran ran = run({"denoise", name, "out.ply"});
    EXPECT_EQ(ran.code, 3) << ran.err;
    EXPECT_EQ(ran.out, "");
    EXPECT_THAT(ran.err, AllOf(HasSubstr(name), HasSubstr("expected"), HasSubstr(says)));
    EXPECT_FALSE(there("out.ply"));
  }
};

/// A cloud with what neither XYZ nor LAS holds: a list, another element, and for LAS a row that is not
/// finite.
std::string ply_of_everything() {
  std::string out = "ply\nformat ascii 1.0\nelement vertex 100\n";
  for (const char* property : {"double x", "double y", "double z", "list uchar int seen"})
    out += std::string("property ") + property + "\n";
  out += "element camera 1\nproperty float focus\nend_header\n";
  for (int i = 0; i < 100; ++i)
    out += std::to_string(i % 10) + (i == 7 ? " nan " : " " + std::to_string(i / 10) + " ") + "0." +
           std::to_string(i * i % 7) + (i % 2 ? " 1 5\n" : " 0\n");
  return out + "50\n";
}

TEST_F(Formats, WhatIsDroppedIsSaid) {
  put("in.ply", ply_of_everything());
  for (const char* out : {"out.xyz", "out.las"}) {
    const bool las = std::string(out) == "out.las";
    const Ran ran =
        run({"denoise", "-v", "--drop-unsupported", "in.ply", out, "--report", "r.json", "--force"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    EXPECT_THAT(ran.err, AllOf(HasSubstr(std::string("warning: ") + out + ": left out"),
                               HasSubstr("field 'seen'"), HasSubstr("element 'camera'")));
    std::vector<std::string> dropped = {"field 'seen'", "element 'camera'"};
    if (las) dropped.emplace_back("1 point not finite");
    EXPECT_EQ(nlohmann::json::parse(take("r.json"))["output"]["dropped"], dropped);
    EXPECT_EQ(ran.err.find("kept unchanged") != std::string::npos, !las) << ran.err;
  }
  const Ran kept =
      run({"denoise", "--drop-unsupported", "in.ply", "out.ply", "--report", "r.json", "--force"});
  EXPECT_THAT(kept.err, ::testing::Not(HasSubstr("warning"))) << "PLY holds all of it";
  EXPECT_FALSE(nlohmann::json::parse(take("r.json"))["output"].contains("dropped"));
}

std::string pcd_header(const std::string& fields, const std::string& size, const std::string& type,
                       const std::string& count, const std::string& data) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + size +
         "\nTYPE " + type + "\nCOUNT " + count +
         "\nWIDTH 400\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 400\nDATA " + data + "\n";
}

/// Everything but bytes [from, from + 12) of each row of `row` bytes after `header` must be equal, and some
/// of those must differ.
void expect_only_coordinates_differ(const std::string& before, const std::string& after, std::size_t header,
                                    std::size_t row, std::size_t from, std::size_t end) {
  ASSERT_EQ(after.size(), before.size());
  std::size_t moved = 0;
  for (std::size_t byte = 0; byte < before.size(); ++byte) {
    const std::size_t place = byte < header || byte >= end ? row : (byte - header) % row;
    if (place >= from && place < from + 12)
      moved += before[byte] != after[byte];
    else
      ASSERT_EQ(before[byte], after[byte]) << "byte " << byte;
  }
  EXPECT_GT(moved, kPoints);
}

/// What the name says is what other programs expect in it: cells, and names in the first line.
TEST_F(Formats, TheNameOfATableDecidesWhatPartsItsCells) {
  const std::string pcd =
      "VERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 3\nHEIGHT 1\nDATA ascii\n"
      "1 2 3 9\n1.50 2 3 8\n1 nan 4 7\n";
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float a,b\nend_header\n1 2 3 9\n1.50 2 3 8\n1 nan 4 7\n";
  const std::pair<std::string, std::string> inputs[] = {{"in.pcd", pcd},
                                                        {"in.ply", ply},
                                                        {"words.xyz", "1 2 3\n1.50 2 3\n1 nan 4\n"},
                                                        {"count.pts", "3\n1 2 3\n1.50 2 3\n1 nan 4\n"},
                                                        {"cloud.txt", "//X Y Z\n1 2 3\n1.50 2 3\n1 nan 4\n"},
                                                        {"in.csv", "id,x,y,z\n7,1,2,3\n8,1.50,2,3\n9,1,,4\n"},
                                                        {"semi.csv", "x;y;z\n1;2;3\n1.50;2;3\n1;;4\n"}};
  for (const auto& [name, bytes] : inputs) put(name, bytes);
  const auto written = [&](const std::string& in, const std::string& out) {
    const Ran ran = run({"denoise", "--force", in, out});
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_EQ(run({"info", out}).code, 0) << "read again";
    return take(out);
  };
  EXPECT_EQ(written("in.pcd", "out.csv"), "x,y,z,intensity\n1,2,3,9\n1.50,2,3,8\n1,nan,4,7\n");
  EXPECT_EQ(written("in.pcd", "out.tsv"), "x\ty\tz\tintensity\n1\t2\t3\t9\n1.50\t2\t3\t8\n1\tnan\t4\t7\n");
  EXPECT_EQ(written("in.ply", "out.csv"), "x,y,z,\"a,b\"\n1,2,3,9\n1.50,2,3,8\n1,nan,4,7\n");
  for (const char* words : {"words.xyz", "count.pts"})
    EXPECT_EQ(written(words, "out.csv"), "x,y,z\n1,2,3\n1.50,2,3\n1,nan,4\n") << words;
  EXPECT_EQ(written("cloud.txt", "out.csv"), "X,Y,Z\n1,2,3\n1.50,2,3\n1,nan,4\n");
  EXPECT_EQ(written("in.csv", "out.tsv"), "id\tx\ty\tz\n7\t1\t2\t3\n8\t1.50\t2\t3\n9\t1\t\t4\n");
  for (const char* table : {"in.csv", "semi.csv"}) EXPECT_EQ(written(table, "out.csv"), take(table));
  EXPECT_EQ(written("cloud.txt", "out.txt"), take("cloud.txt"));
}

TEST_F(Formats, WhatTheOutputHasNoRoomForIsRefusedBeforeTheWork) {
  put("in.ply", ply_of_everything());
  std::string rows;
  for (int i = 0; i < 100; ++i)
    rows += std::to_string(i % 10) + " " + std::to_string(i / 10) + " 0." + std::to_string(i * i % 7) + "\n";
  put("in.xyz", rows);
  put("in.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 2 3\n");
  const std::pair<std::vector<std::string>, std::string> cases[] = {
      {{"denoise", "in.ply", "out.xyz"}, "out.xyz: xyz (ascii) cannot carry field 'seen', element 'camera'"},
      {{"denoise", "in.ply", "-", "--format", "xyz"}, "standard output: xyz (ascii) cannot carry"},
      {{"denoise", "--write-displacement", "in.xyz", "out.off"}, "cannot carry field 'displacement'"},
      {{"denoise", "--outliers", "mark", "in.xyz", "out.off"}, "cannot carry field 'outlier'"},
      {{"denoise", "in.xyz", "out.ply", "--encoding", "binary_compressed"}, "ply has no encoding"},
      {{"mesh", "in.xyz", "out.pcd"}, "out.pcd: pcd (ascii) cannot carry element 'face'"},
      {{"mesh", "--stage", "emst", "in.xyz", "out.off"}, "cannot carry element 'edge'"},
      {{"smooth-mesh", "in.off", "out.pcd"}, "cannot carry element 'face'"},
      {{"smooth-mesh", "--refine", "1", "in.off", "out.pcd"}, "cannot carry element 'face'"}};
  for (const auto& [words, says] : cases) {
    std::vector<std::string> typed = words;
    const bool piped = words[2] == "-";
    typed.insert(typed.end(), {"--report", piped ? "r.json" : "-"});
    const Ran ran = run(typed);
    EXPECT_EQ(ran.code, 2) << says;
    EXPECT_THAT(ran.err, HasSubstr(says));
    if (piped) continue;
    const nlohmann::json report = nlohmann::json::parse(ran.out);
    EXPECT_EQ(report["error"]["code"], 2);
    EXPECT_FALSE(report.contains("counts")) << "the work was done: " << says;
  }
  EXPECT_THAT(names(), ::testing::ElementsAre("in.off", "in.ply", "in.xyz"));
}

TEST_F(Formats, WhatAConversionLeavesOutIsNotSaidToBeKept) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex 100\n";
  for (const char* name : {"x", "y", "z", "nx", "ny"}) text += std::string("property double ") + name + "\n";
  text += "end_header\n";
  for (int i = 0; i < 100; ++i)
    text +=
        std::to_string(i % 10) + " " + std::to_string(i / 10) + " 0." + std::to_string(i * i % 7) + " 0 1\n";
  put("in.ply", text + "tail\n");
  const Ran ran = run({"denoise", "--drop-unsupported", "in.ply", "out.off"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(ran.err, AllOf(HasSubstr("field 'nx'"), HasSubstr("5 bytes behind the last row"),
                             HasSubstr("normals are stale"), ::testing::Not(HasSubstr("kept"))));
}

TEST_F(Formats, BlanksInAPlyHeaderStay) {
  const RichCloud cloud = bumpy(kPoints, false);
  std::string header = cloud.header();
  header.replace(header.find("ply\n"), 4, "ply \n");
  header.insert(header.find("element"), " \n\n");
  const std::string bytes = header + cloud.bytes().substr(cloud.header().size());
  expect_only_coordinates_differ(bytes, denoised("in.ply", bytes), header.size(), cloud.row_bytes(), 0,
                                 bytes.size());
}

TEST_F(Formats, PcdPaddingIsKept) {
  // As PCL writes a PointXYZRGBNormal cloud: padding fields called _, some of several bytes.
  const std::string header =
      pcd_header("x y z _ rgb _ label", "4 4 4 1 4 1 4", "F F F U F U U", "1 1 1 4 1 12 1", "binary");
  const RichCloud cloud = bumpy(kPoints, true);
  std::mt19937 engine(1);
  std::string bytes = header;
  for (std::size_t i = 0; i < kPoints; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) add(bytes, float(cloud.xyz[3 * i + axis]));
    for (int k = 0; k < 24; ++k) bytes += char(engine());
  }
  expect_only_coordinates_differ(bytes, denoised("in.pcd", bytes), header.size(), 36, 0, bytes.size());
}

TEST_F(Formats, PcdNegativeCountsAreRefused) {
  for (const char* data : {"ascii", "binary", "binary_compressed"})
    expect_refused("in.pcd", pcd_header("x y z _", "4 4 4 1", "F F F U", "1 1 1 -20", data) + "1 2 3\n",
                   "-20");
}

TEST_F(Formats, PlyListsAndSeveralElementsAreKept) {
  const RichCloud cloud = bumpy(kPoints, false);
  for (const bool big : {false, true}) {
    const std::string header =
        std::string("ply\nformat binary_") + (big ? "big" : "little") +
        "_endian 1.0\ncomment kept\nelement camera 2\nproperty double f\nproperty list uchar short lens\n"
        "element vertex 400\nproperty list uchar int tags\nproperty float x\nproperty float y\nproperty "
        "float z\n"
        "property uchar quality\nelement face 1\nproperty list uchar uint vertex_indices\nend_header\n";
    std::string bytes = header;
    for (int k = 0; k < 2; ++k) {
      add(bytes, 3.5 + k, big);
      bytes += char(k);
      for (int j = 0; j < k; ++j) add(bytes, std::int16_t(-j - 7), big);
    }
    const std::size_t first = bytes.size();
    std::vector<std::size_t> coordinates;
    for (std::size_t i = 0; i < kPoints; ++i) {
      bytes += char(i % 4);
      for (std::size_t j = 0; j < i % 4; ++j) add(bytes, std::int32_t(i * 100 + j), big);
      coordinates.push_back(bytes.size());
      for (std::size_t axis = 0; axis < 3; ++axis) add(bytes, float(cloud.xyz[3 * i + axis]), big);
      bytes += char(i);
    }
    bytes += char(3);
    for (const std::uint32_t corner : {0u, 1u, 2u}) add(bytes, corner, big);
    std::string after = denoised("in.ply", bytes);
    ASSERT_EQ(after.size(), bytes.size());
    EXPECT_NE(after, bytes);
    EXPECT_EQ(after.substr(0, first), bytes.substr(0, first));
    for (const std::size_t at : coordinates) after.replace(at, 12, bytes, at, 12);
    EXPECT_TRUE(after == bytes) << "something else than x, y, z changed";
  }
}

TEST_F(Formats, UpperCaseAndDuplicateFieldNames) {
  // The second X and the second label are fields like any other.
  const std::string header =
      pcd_header("label X Y Z X label", "4 4 4 4 4 4", "U F F F F U", "1 1 1 1 1 1", "binary");
  const RichCloud cloud = bumpy(kPoints, true);
  std::string bytes = header;
  for (std::size_t i = 0; i < kPoints; ++i) {
    add(bytes, std::uint32_t(i));
    for (std::size_t axis = 0; axis < 3; ++axis) add(bytes, float(cloud.xyz[3 * i + axis]));
    add(bytes, float(i) * 7);
    add(bytes, std::uint32_t(i * i));
  }
  expect_only_coordinates_differ(bytes, denoised("in.pcd", bytes), header.size(), 24, 4, bytes.size());
  EXPECT_THAT(run({"denoise", "in.pcd", "again.pcd"}).err, AllOf(HasSubstr("warning"), HasSubstr("X")));
}

TEST_F(Formats, CompressedPcdKeepsItsOtherFields) {
  put("in.pcd", bumpy(kPoints, true).bytes());
  namespace io = pipeline::io;
  io::WriteOptions packed;
  packed.encoding = io::Encoding::binary_compressed;
  const io::Cloud before = io::read_cloud(at("in.pcd"), {}, {}).value();
  ASSERT_TRUE(io::write_cloud(before, at("packed.pcd"), packed, {}).ok());
  ASSERT_EQ(run({"denoise", "packed.pcd", "out.pcd"}).code, 0);
  EXPECT_THAT(take("out.pcd"), HasSubstr("DATA binary_compressed\n"));
  const io::Cloud after = io::read_cloud(at("out.pcd"), {}, {}).value();
  ASSERT_EQ(after.size(), kPoints);
  for (std::size_t i = 0; i < kPoints; ++i)
    EXPECT_EQ(after.points().row(i).substr(12), before.points().row(i).substr(12));
}

TEST_F(Formats, CorruptCompressedStreamsAreRefusedAndNeverCrash) {
  namespace io = pipeline::io;
  io::WriteOptions packed;
  packed.encoding = io::Encoding::binary_compressed;
  const std::string whole =
      io::serialize_cloud(io::parse_cloud(bumpy(12, true).bytes(), "in", {}, {}).value(), packed, {}).value();
  const std::size_t data = whole.find("DATA binary_compressed\n") + 23;
  // The two sizes in front of the stream, then every seventh byte of it.
  std::size_t refused = 0;
  for (std::size_t byte = data; byte < whole.size(); byte += byte < data + 8 ? 1 : 13)
    for (const int flip : {0x01, 0x80, 0xff}) {
      std::string broken = whole;
      broken[byte] = char(broken[byte] ^ flip);
      put("in.pcd", broken);
      const Ran ran = run({"info", "in.pcd"});
      // A changed literal is a legal stream of other values.
      ASSERT_TRUE(ran.code == 0 || ran.code == 3) << "byte " << byte << ": " << ran.err;
      if (ran.code == 0) {
        EXPECT_GE(byte, data + 8) << "a wrong size was believed";
        continue;
      }
      ++refused;
      EXPECT_THAT(ran.err, AllOf(HasSubstr("in.pcd"), HasSubstr("expected")));
    }
  EXPECT_GE(refused, 24u);
  std::string cut = whole.substr(0, whole.size() - 3);
  expect_refused("in.pcd", cut, "found");
}

TEST_F(Formats, AsciiKeepsEnoughDigitsToComeBack) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> noise(0, 0.2);
  std::string rows;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) {
      char row[120];
      std::snprintf(row, sizeof row, "%.17g %.17g %.17g %d\n", 500000 + i + noise(engine),
                    4649776 + j + noise(engine), noise(engine), i);
      rows += row;
    }
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 400\nproperty double x\nproperty double y\n"
      "property double z\nproperty int row\nend_header\n";
  put("in.ply", header + rows);
  ASSERT_EQ(run({"denoise", "in.ply", "ascii.ply"}).code, 0);
  ASSERT_EQ(run({"denoise", "in.ply", "binary.ply", "--encoding", "binary"}).code, 0);
  namespace io = pipeline::io;
  const auto text = io::positions(io::read_cloud(at("ascii.ply"), {}, {}).value());
  const auto bits = io::positions(io::read_cloud(at("binary.ply"), {}, {}).value());
  EXPECT_EQ(text, bits);
  EXPECT_NE(text, io::positions(io::read_cloud(at("in.ply"), {}, {}).value()));
}

TEST_F(Formats, CarriageReturnsStay) {
  for (const bool pcd : {false, true}) {
    std::string text;
    for (const char c : bumpy(kPoints, pcd).header())
      text += c == '\n' ? std::string("\r\n") : std::string(1, c);
    const std::string header = text;
    const RichCloud cloud = bumpy(kPoints, pcd);
    const std::string bytes = header + cloud.bytes().substr(cloud.header().size());
    expect_only_coordinates_differ(bytes, denoised(cloud.name(), bytes), header.size(), cloud.row_bytes(), 0,
                                   bytes.size());
  }
}

TEST_F(Formats, AbsurdTypesAndCountsAreRefused) {
  expect_refused("in.pcd", pcd_header("x y z", "4 4 3", "F F F", "1 1 1", "ascii"), "SIZE 3");
  expect_refused("in.pcd", pcd_header("x y z", "4 4 4", "F F Q", "1 1 1", "ascii"), "TYPE");
  expect_refused("in.pcd", pcd_header("x y z", "4 4 4", "F F F", "1 1 4000000000", "binary"), "COUNT");
  expect_refused("in.pcd", pcd_header("x y z", "4 4 4", "F F F", "1 1 0", "binary"), "COUNT");
  expect_refused("in.pcd", pcd_header("x y z", "4 4 99999999999999999999", "F F F", "1 1 1", "binary"),
                 "99999999999999999999");
  expect_refused("in.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n1\n",
                 "'quad'");
  expect_refused("in.ply",
                 "ply\nformat ascii 1.0\nelement vertex 99999999999999999999\nproperty float x\nend_header\n",
                 "line 3");
}

}  // namespace
}  // namespace rfsmooth::test
