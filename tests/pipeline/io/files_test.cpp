// Targets on the disk, and the formats' own ways: XYZ, OFF, conversions.
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/stopwatch.h"
#include "pipeline/io/formats/lzf.h"
#include "pipeline/io/io.h"
#include "pipeline/io/mesh_file.h"
#include "pipeline/io/stream/atomic_file.h"
#include "tests/pipeline/io/as_text.h"

using namespace rfsmooth;                // NOLINT(google-build-using-namespace)
using namespace rfsmooth::pipeline::io;  // NOLINT(google-build-using-namespace)
namespace fs = std::filesystem;

namespace {

std::string file_bytes(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

class Folder : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / ("rfsmooth_io_" + std::to_string(::getpid()) + info->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::size_t entries() const { return std::size_t(std::distance(fs::directory_iterator(folder_), {})); }
  static Cloud cloud() {
    const double xyz[] = {1, 2, 3, 4, 5, 6};
    return make_cloud(xyz, 2);
  }
  static Result<Done> write(const fs::path& path, bool force = false, const Context& context = {}) {
    WriteOptions options;
    options.force = force;
    return write_cloud(cloud(), path, options, context);
  }
  fs::path folder_;
};

TEST_F(Folder, WrittenCompleteAndNotReplacedWithoutForce) {
  const fs::path path = folder_ / "a.ply";
  ASSERT_TRUE(check_output(path, {}).ok());
  ASSERT_TRUE(write(path).ok());
  EXPECT_EQ(positions(read_cloud(path, {}, {}).value()), (std::vector<double>{1, 2, 3, 4, 5, 6}));
  std::ofstream(path) << "mine";
  EXPECT_EQ(write(path).error().code, ErrorCode::cannot_write);
  EXPECT_EQ(check_output(path, {}).error().code, ErrorCode::cannot_write);
  EXPECT_EQ(file_bytes(path), "mine");
  fs::permissions(path, fs::perms(0640));
  ASSERT_TRUE(write(path, true).ok());
  EXPECT_EQ(fs::status(path).permissions(), fs::perms(0640));
  EXPECT_EQ(entries(), 1u);
}

TEST_F(Folder, ALinkIsWrittenThrough) {
  fs::create_directories(folder_ / "real");
  fs::create_symlink("real/b.ply", folder_ / "link.ply");
  ASSERT_TRUE(write(folder_ / "link.ply").ok());
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.ply"));
  EXPECT_TRUE(fs::is_regular_file(folder_ / "real/b.ply"));
  EXPECT_FALSE(write(folder_ / "link.ply").ok());
  ASSERT_TRUE(write(folder_ / "link.ply", true).ok());
  fs::create_symlink("round.ply", folder_ / "round.ply");
  EXPECT_EQ(write(folder_ / "round.ply").error().code, ErrorCode::cannot_write);
}

TEST_F(Folder, AFileIsKnownBehindItsLinks) {
  fs::create_directory(folder_ / "other");
  fs::create_symlink("../none.ply", folder_ / "other" / "link.ply");
  const auto behind = file_behind(folder_ / "other" / "link.ply");
  ASSERT_TRUE(behind.has_value());
  EXPECT_EQ(behind->lexically_normal(), folder_ / "none.ply");
  EXPECT_EQ(file_behind(folder_ / "new.ply"), folder_ / "new.ply");
  fs::create_symlink("/dev/stdout", folder_ / "open.ply");
  for (const fs::path& target :
       {fs::path("/dev/stdout"), fs::path("/dev/fd/1"), fs::path("/dev/null"), folder_ / "open.ply"})
    EXPECT_FALSE(file_behind(target).has_value()) << target;
}

TEST_F(Folder, TargetsThatCannotBe) {
  std::ofstream(folder_ / "file") << "x";
  fs::create_directories(folder_ / "dir.ply");
  for (const fs::path& path :
       {folder_ / "missing" / "a.ply", folder_ / "file" / "a.ply", folder_ / "dir.ply"}) {
    EXPECT_EQ(write(path, true).error().code, ErrorCode::cannot_write) << path;
    EXPECT_EQ(check_output(path, {}).error().code, ErrorCode::cannot_write) << path;
  }
  EXPECT_EQ(write(folder_ / "a.stl").error().code, ErrorCode::usage);
  EXPECT_EQ(entries(), 2u);
  EXPECT_TRUE(write("/dev/null").ok());
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(Folder, AFullDiskLeavesNothing) {
  WriteOptions options;
  options.format = Format::ply;
  EXPECT_EQ(write_cloud(cloud(), "/dev/full", options, {}).error().code, ErrorCode::cannot_write);
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(Folder, CancelledLeavesNothing) {
  const std::atomic<bool> stop{true};
  Context context;
  context.stop = &stop;
  EXPECT_EQ(write(folder_ / "a.ply", false, context).error().code, ErrorCode::cancelled);
  EXPECT_EQ(entries(), 0u);
}

TEST_F(Folder, InputsThatAreNotFiles) {
  EXPECT_EQ(read_cloud(folder_, {}, {}).error().code, ErrorCode::input_unreadable);
  EXPECT_NE(read_cloud(folder_, {}, {}).error().message.find("directory"), std::string::npos);
  EXPECT_EQ(read_cloud(folder_ / "no.ply", {}, {}).error().code, ErrorCode::input_unreadable);
}

Cloud parsed_text(const std::string& text) {
  return parse_cloud(text, "in", {}, {}).value();
}

TEST(Xyz, SeparatorsCommentsNamesAndCountsComeBack) {
  for (const std::string text :
       {"1 2 3\n4 5 6\n", "# made by me\n\n1\t2\t3\n// between\n4\t5\t6", "1,2,3\r\n4,5,6\r\n",
        "1; 2; 3\n4; 5; 6\n\n# end\n", "2\n1 2 3 9\n4 5 6 8\n", "//X Y Z R\n1 2 3 9\n4 5 6 8\n",
        "\xEF\xBB\xBFi,x,y,z\n9,1,2,3\n8,4,5,6\n", "x y z\n1 2 3\n4 5 6\n", "+1 2e0 3.\n4 5 6\n"}) {
    Cloud cloud = parsed_text(text);
    EXPECT_EQ(cloud.format, Format::xyz) << text;
    EXPECT_EQ(positions(cloud), (std::vector<double>{1, 2, 3, 4, 5, 6})) << text;
    EXPECT_EQ(as(cloud, Format::xyz), text);
    expect_that_y_comes_back(cloud, text, "5.5");
  }
  EXPECT_EQ(parsed_text("//X Y Z R\n1 2 3 9\n").points().fields[3].name, "R");
  EXPECT_EQ(parsed_text("1 2 3 9\n").points().fields[3].name, "column_4");
}

TEST(Xyz, RowsTakenOutChangeTheCountAndKeepComments) {
  Cloud cloud = parsed_text("3\n1 2 3\n# about the second\n4 5 6\n7 8 9");
  select_points(cloud, {0, 2});
  EXPECT_EQ(as(cloud, Format::xyz), "2\n1 2 3\n# about the second\n7 8 9");
}

// Beside reading, since the time of a machine that does other things says nothing. Going through all rows for
// each comment took a hundred times as long.
TEST(Xyz, RowsTakenOutBetweenManyCommentsTakeNoLongerThanReading) {
  constexpr std::size_t kRows = 200'000;
  std::string text, odd;
  for (std::size_t i = 0; i < kRows; ++i) {
    const std::string comment = "# " + std::to_string(i) + '\n', row = std::to_string(i) + " 2 3\n";
    text += comment + row;
    odd += comment + (i % 2 == 1 ? row : "");
  }
  std::vector<std::size_t> rows;
  for (std::size_t i = 1; i < kRows; i += 2) rows.push_back(i);
  std::vector<StageTime> times;
  Stopwatch watch(times, "reading");
  Cloud cloud = parsed_text(text);
  watch.next("taking out");
  select_points(cloud, rows);
  watch.next("writing");
  EXPECT_TRUE(as(cloud, Format::xyz) == odd);
  EXPECT_LT(times[1].seconds, 3 * times[0].seconds);
}

TEST(Off, VariantsComeBackAndMeshesAreRead) {
  for (const std::string text :
       {"OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n",
        "# c\nOFF 4 1 5\n0 0 0\n1 0 0\n\n1 1 0\n0 1 0\n4 0 1 2 3 0.5 0 0\n",
        "COFF\r\n4 1 0\r\n0 0 0 1 2 3 255\r\n1 0 0 1 2 3 255\r\n1 1 0 1 2 3 255\r\n0 1 0 1 2 3 255\r\n4 0 1 "
        "2 3\r\n",
        "NOFF\n4 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 0 0 1\n4 0 1 2 3\n",
        "STCNOFF\n4 1 0\n0 0 0 0 0 1 9 9 9 0 0\n1 0 0 0 0 1 9 9 9 0 0\n1 1 0 0 0 1 9 9 9 0 0\n0 1 0 0 0 1 9 "
        "9 9 0 0\n4 0 1 2 3\n"}) {
    const Cloud mesh = parsed_text(text);
    const std::vector<Face> two = {{0, 1, 2}, {0, 2, 3}};
    EXPECT_EQ(faces_of(mesh), two);
    EXPECT_EQ(as(mesh, Format::off), text);
    const std::string ply = as(mesh, Format::ply, true);
    EXPECT_EQ(faces_of(parsed_text(ply)), two) << ply;
    const Cloud back = parsed_text(as(parsed_text(ply), Format::off));
    EXPECT_EQ(positions(back), positions(mesh));
    EXPECT_EQ(back.points().fields.size(), mesh.points().fields.size());
  }
  EXPECT_NE(as(parsed_text("OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2 255 0 0\n"), Format::ply)
                .find("colours of the faces"),
            std::string::npos);
}

TEST(Convert, WhatCannotBeCarriedIsNamed) {
  const std::string ply =
      "ply\nformat ascii 1.0\ncomment hello\nelement vertex 2\nproperty float intensity\nproperty float "
      "x\nproperty float y\n"
      "property float z\nproperty list uchar int tags\nelement face 1\nproperty list uchar int "
      "vertex_indices\nend_header\n"
      "7 1 2 3 1 5\n8 4 5 6 0\n3 0 1 0\n";
  const std::string refused = as(parsed_text(ply), Format::pcd);
  EXPECT_NE(refused.find("field 'tags'"), std::string::npos) << refused;
  EXPECT_NE(refused.find("element 'face'"), std::string::npos) << refused;
  EXPECT_EQ(as(parsed_text(ply), Format::pcd, true),
            "# .PCD v0.7 - Point Cloud Data file format\n# hello\nVERSION 0.7\nFIELDS intensity x y z\nSIZE "
            "4 4 4 4\n"
            "TYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA "
            "ascii\n7 1 2 3\n8 4 5 6\n");
  EXPECT_EQ(as(parsed_text(ply), Format::xyz, true), "# hello\n# x y z intensity\n1 2 3 7\n4 5 6 8\n");
  EXPECT_EQ(as(parsed_text(ply), Format::off, true), "OFF\n# hello\n2 1 0\n1 2 3\n4 5 6\n3 0 1 0\n");
}

TEST(Convert, GridAndViewpointTravelThroughPly) {
  const std::string pcd =
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT "
      "1 1 1\nWIDTH 2\n"
      "HEIGHT 2\nVIEWPOINT 1.50 0 0 1 0 0 0\nPOINTS 4\nDATA ascii\n1 2 3\nnan nan nan\n4 5 6\n7 8 9\n";
  const std::string ply = as(parsed_text(pcd), Format::ply);
  EXPECT_NE(ply.find("obj_info num_cols 2\n"), std::string::npos) << ply;
  EXPECT_EQ(as(parsed_text(ply), Format::pcd), pcd);
  EXPECT_NE(as(parsed_text(pcd), Format::xyz).find("grid of 2 x 2"), std::string::npos);
}

TEST(Convert, DigitsBeyondFloatAreNotLostSilently) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
      "z\nend_header\n"
      "512345.123456 0.1 0.100000001\n";
  Cloud cloud = parsed_text(ply);
  WriteOptions binary;
  binary.encoding = Encoding::binary_little_endian;
  const auto refused = serialize_cloud(cloud, binary, {});
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("field 'x'"), std::string::npos);
  EXPECT_EQ(refused.error().message.find("field 'y'"), std::string::npos);
  EXPECT_EQ(refused.error().message.find("field 'z'"), std::string::npos);
  const double moved[] = {512345.123457, 0.1, 0.100000001};
  set_positions(cloud, moved);
  EXPECT_EQ(positions(cloud)[0], 512345.123457);
}

TEST(Coordinates, UpperCaseDuplicatesAndWholeNumbers) {
  const std::string head =
      "VERSION .7\nFIELDS X Y Z X\nSIZE 4 4 4 4\nTYPE I I I I\nWIDTH 1\nPOINTS 1\nDATA ascii\n";
  std::vector<std::string> said;
  Context context;
  context.log = [&](LogLevel, const std::string& text) { said.push_back(text); };
  Cloud cloud = parse_cloud(head + "1 2 3 9\n", "in", {}, context).value();
  EXPECT_EQ(positions(cloud), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(said.size(), 1u);
  const double moved[] = {1.4, 2.6, 3};
  set_positions(cloud, moved, context);
  EXPECT_EQ(said.size(), 2u);
  EXPECT_EQ(as(cloud, Format::pcd), head + "1 3 3 9\n");
}

TEST(Convert, CoordinatesAreNeverLeftOut) {
  const std::string pcd = "FIELDS x y z\nSIZE 4 8 4\nTYPE F I F\nPOINTS 1\nDATA ascii\n1 2 3\n";
  EXPECT_NE(as(parsed_text(pcd), Format::ply).find("field 'y'"), std::string::npos);
  const Cloud ply = parsed_text(as(parsed_text(pcd), Format::ply, true));
  EXPECT_EQ(ply.points().fields[1].type, Scalar::float64);
  EXPECT_EQ(positions(ply), (std::vector<double>{1, 2, 3}));
}

TEST(Mesh, EdgesAndFacesAreWrittenAndRead) {
  const Positions points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Cloud cloud = parsed_text(as(make_mesh_file(points, {{0, 1, 2}}, {{0, 1}, {1, 2}}), Format::ply));
  EXPECT_EQ(faces_of(cloud), (std::vector<Face>{{0, 1, 2}}));
  EXPECT_EQ(edges_of(cloud), (std::vector<Edge>{{0, 1}, {1, 2}}));
}

TEST(Lzf, UnpacksWhatItPacked) {
  std::uint64_t state = 1;
  for (std::size_t n = 0; n < 3000; n = n * 5 / 4 + 1)
    for (const unsigned alphabet : {1u, 2u, 17u, 256u}) {
      std::string in;
      for (std::size_t k = 0; k < n; ++k) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        in += char((state >> 33) % alphabet);
      }
      const Bytes packed = lzf_compress(in);
      EXPECT_LE(packed.size(), n + n / 32 + 2);
      EXPECT_LE(n, packed.size() * kLzfMostGain);
      std::string out(n, 'x');
      EXPECT_TRUE(lzf_decompress({packed.data(), packed.size()}, out.data(), n).ok);
      EXPECT_EQ(out, in);
      for (std::size_t cut = 0; cut < packed.size(); cut += 1 + packed.size() / 16)
        EXPECT_FALSE(lzf_decompress({packed.data(), cut}, out.data(), n).ok);
    }
}

}  // namespace
