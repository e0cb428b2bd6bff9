#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include <rfsmooth/cloud_file.h>

using namespace rfsmooth;

namespace {

const char* const kFile =
    "ply\nformat ascii 1.0\ncomment a tetrahedron\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nproperty uchar label\nelement face 1\nproperty list uchar int vertex_indices\n"
    "end_header\n0 0 0 7\n1 0 0 8\n0 1 0 9\n0.5 0.5 1.50 10\n4 0 1 2 3\n";

TEST(CloudFile, ComesBackByteForByte) {
  const auto file = CloudFile::parse(kFile, "mesh.ply");
  ASSERT_TRUE(file.ok());
  EXPECT_EQ(file.value().format(), Format::ply);
  EXPECT_EQ(file.value().encoding(), Encoding::ascii);
  EXPECT_EQ(file.value().size(), 4U);
  EXPECT_EQ(file.value().extent(), (std::array<std::size_t, 2>{4, 1}));
  EXPECT_EQ(file.value().serialize().value(), kFile);
}

TEST(CloudFile, OnlyWhatMovedChanges) {
  auto file = CloudFile::parse(kFile, "mesh.ply").value();
  std::vector<double> xyz = file.positions();
  ASSERT_EQ(xyz.size(), 12U);
  EXPECT_EQ(xyz[11], 1.5);
  xyz[3] = 2;
  file.set_positions(xyz.data());
  std::string expected = kFile;
  expected.replace(expected.find("\n1 0 0 8"), 2, "\n2");
  EXPECT_EQ(file.serialize().value(), expected);
}

TEST(CloudFile, FieldsAndFacesAreReadAndWritten) {
  auto file = CloudFile::parse(kFile, "mesh.ply").value();
  EXPECT_EQ(file.field_names(), (std::vector<std::string>{"x", "y", "z", "label"}));
  EXPECT_EQ(file.field("label").value(), (std::vector<double>{7, 8, 9, 10}));
  EXPECT_FALSE(file.field("colour").has_value());
  EXPECT_EQ(file.faces().value(), (std::vector<Face>{{0, 1, 2}, {0, 2, 3}}));
  ASSERT_TRUE(file.set_field("noise", {0, 1, 2, 3}).ok());
  EXPECT_EQ(file.field_names().back(), "noise");
  EXPECT_EQ(file.set_field("label", {0.5, 0, 0, 0}).error().code, ErrorCode::usage);
  EXPECT_THROW((void)file.set_field("noise", {1}), std::invalid_argument);
  const CloudFile copy = file;
  CloudFile turned = file;
  turned.select({3, 2, 1, 0});
  EXPECT_EQ(turned.faces().value(), (std::vector<Face>{{3, 2, 1}, {3, 1, 0}}));
  file.select({0, 3});
  EXPECT_EQ(file.size(), 2U);
  EXPECT_TRUE(file.faces().value().empty());
  EXPECT_EQ(copy.size(), 4U);
  EXPECT_EQ(file.field("noise").value(), (std::vector<double>{0, 3}));
}

/// A cloud that is half changed would be nobody's.
TEST(CloudFile, WhatChangesItInMemoryRunsToItsEnd) {
  auto file = CloudFile::parse(kFile, "mesh.ply").value();
  const std::atomic<bool> stop{true};
  Context context;
  context.stop = &stop;
  context.progress = [](std::string_view, double) { return false; };
  EXPECT_EQ(file.serialize({}, context).error().code, ErrorCode::cancelled);
  std::vector<double> xyz = file.positions(context);
  ASSERT_EQ(xyz.size(), 12U);
  for (double& c : xyz) c += 1;
  file.set_positions(xyz.data(), context);
  EXPECT_EQ(file.positions(), xyz);
  ASSERT_TRUE(file.set_field("noise", {0, 1, 2, 3}, context).ok());
  file.select({0, 3}, context);
  EXPECT_EQ(file.field("noise", context).value(), (std::vector<double>{0, 3}));
}

TEST(CloudFile, AFileOnDiskIsReplacedOnlyWhenAskedTo) {
  const auto path = std::filesystem::temp_directory_path() / "rfsmooth_cloud_file_test.xyz";
  std::filesystem::remove(path);
  const double xyz[] = {0, 0, 0, 1, 2, 3};
  const CloudFile file = CloudFile::of_points(xyz, 2);
  ASSERT_TRUE(file.write(path).ok());
  EXPECT_EQ(file.write(path).error().code, ErrorCode::cannot_write);
  WriteOptions replace;
  replace.force = true;
  EXPECT_TRUE(file.write(path, replace).ok());
  EXPECT_EQ(CloudFile::read(path).value().positions(), std::vector<double>(xyz, xyz + 6));
  std::filesystem::remove(path);
  EXPECT_EQ(CloudFile::read(path).error().code, ErrorCode::input_unreadable);
}

// Text as programs write it that put line ends between lines: behind the last there is none.
const char* const kOpenPly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 0\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n7 8 9";
const char* const kOpenPcd =
    "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 3\nHEIGHT 1\n"
    "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA ascii\n0 0 0\n1 0 0\n7 8 9";
const char* const kOpenOff = "OFF\n3 0 0\n0 0 0\n1 0 0\n7 8 9";
const char* const kOpenFacesFirst =
    "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 3\n"
    "property float x\nproperty float y\nproperty float z\nend_header\n3 0 1 2\n0 0 0\n1 0 0\n7 8 9";

TEST(CloudFile, ALastLineWithoutItsEndGetsOneWhereFacesFollow) {
  const std::vector<Face> faces = {{0, 1, 2}};
  for (const char* text : {kOpenPly, kOpenPcd, kOpenOff, kOpenFacesFirst}) {
    const auto file = CloudFile::parse(text, "open").value();
    EXPECT_EQ(file.serialize().value(), text);
    CloudFile mesh = file;
    mesh.set_faces(faces);
    for (const Format format : {Format::ply, Format::off}) {
      WriteOptions options;
      options.format = format;
      const std::string written = mesh.serialize(options).value();
      const auto back = CloudFile::parse(written, "written");
      ASSERT_TRUE(back.ok()) << back.error().message << "\n" << written;
      EXPECT_EQ(back.value().positions(), file.positions()) << written;
      EXPECT_EQ(back.value().faces().value(), faces) << written;
    }
  }
}

TEST(CloudFile, ALastLineWithoutItsEndMayBeTakenSeveralTimes) {
  auto file = CloudFile::parse("0 0 0\n7 8 9", "open.xyz").value();
  file.select(std::vector<std::size_t>(20, 1));
  const auto back = CloudFile::parse(file.serialize().value(), "written.xyz");
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(back.value().size(), 20U);
}

TEST(CloudFile, ANewFieldHasANameOfOneWord) {
  auto file = CloudFile::parse(kFile, "mesh.ply").value();
  for (const char* name : {"", "dist to plane", "a\nelement face 7", "tab\there", "\x7f"}) {
    const auto done = file.set_field(name, {0, 1, 2, 3});
    ASSERT_FALSE(done.ok()) << name;
    EXPECT_EQ(done.error().code, ErrorCode::usage);
    EXPECT_NE(done.error().message.find("one word"), std::string::npos) << done.error().message;
  }
  EXPECT_EQ(file.serialize().value(), kFile);
  EXPECT_TRUE(file.set_field("H\xc3\xb6he", {0, 1, 2, 3}).ok());
  EXPECT_EQ(CloudFile::parse(file.serialize().value(), "again.ply").value().field_names().back(),
            "H\xc3\xb6he");
}

/// Elements of 1 to 100 rows, of lists or not: text with comments between its rows, or bytes.
std::string elements_of(const std::vector<int>& rows, bool text) {
  std::string header = std::string("ply\nformat ") + (text ? "ascii" : "binary_little_endian") + " 1.0\n",
              body;
  for (std::size_t e = 0; e < rows.size(); ++e) {
    header += "element " + (e == 1 ? "vertex" : "other" + std::to_string(e)) + " " + std::to_string(rows[e]) +
              "\nproperty uchar x\nproperty uchar y\nproperty uchar z\nproperty list uchar uchar l\n";
    for (int i = 0; i < rows[e]; ++i) {
      if (text && i % 7 == 2) body += "# before row " + std::to_string(i) + "\n\n";
      if (text)
        body += std::to_string(i) + " 2 3 " + (i % 2 == 0 ? "0\n" : "2 " + std::to_string(e) + " 5\n");
      else
        body += std::string{char(i), 2, 3} + (i % 2 == 0 ? std::string(1, 0) : std::string{2, char(e), 5});
    }
  }
  return header + "end_header\n" + body;
}

TEST(CloudFile, ElementsOfAnySizesAreReadOneBehindTheOther) {
  for (const bool text : {true, false})
    for (const auto& rows :
         std::vector<std::vector<int>>{{1, 100, 1}, {100, 1, 100}, {5, 5, 5}, {0, 3, 100}}) {
      const std::string bytes = elements_of(rows, text);
      const auto file = CloudFile::parse(bytes, "elements.ply");
      ASSERT_TRUE(file.ok()) << file.error().message;
      EXPECT_EQ(file.value().serialize().value(), bytes);
      const std::vector<double> xyz = file.value().positions();
      ASSERT_EQ(xyz.size(), std::size_t(3 * rows[1]));
      for (int i = 0; i < rows[1]; ++i) EXPECT_EQ(xyz[std::size_t(3 * i)], i);
    }
}

TEST(CloudFile, RowsBeyondThoseThatTheHeaderCountsAreSaid) {
  std::vector<std::string> warnings;
  Context context;
  context.log = [&](LogLevel, const std::string& message) { warnings.emplace_back(message); };
  for (const char* text : {kOpenPly, kOpenPcd, kOpenOff}) {
    ASSERT_TRUE(CloudFile::parse(text + std::string("\n\n# the end\n"), "whole", {}, context).ok());
    EXPECT_TRUE(warnings.empty()) << warnings.front();
    const std::string longer = text + std::string("\n# more\n10 11 12\n");
    const auto file = CloudFile::parse(longer, "longer", {}, context);
    ASSERT_TRUE(file.ok()) << file.error().message;
    EXPECT_EQ(file.value().serialize().value(), longer);
    ASSERT_EQ(warnings.size(), 1U) << text;
    EXPECT_NE(warnings[0].find("longer: 16 bytes behind the last row"), std::string::npos) << warnings[0];
    warnings.clear();
  }
}

TEST(CloudFile, StripsOfTrianglesAreRenumberedAndStayApart) {
  const std::string before =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n"
      "9 9 9\n8 0 1 2 -1 3 2 1 -1\n";
  const std::string after =
      before.substr(0, before.find("0 0 0\n")) + "1 1 0\n0 1 0\n1 0 0\n0 0 0\n8 3 2 1 -1 0 1 2 -1\n";
  for (const Encoding encoding : {Encoding::ascii, Encoding::binary_little_endian}) {
    WriteOptions as;
    as.encoding = encoding;
    const std::string bytes = CloudFile::parse(before, "strips.ply").value().serialize(as).value();
    auto file = CloudFile::parse(bytes, "strips.ply").value();
    file.select({3, 2, 1, 0});
    as.encoding = Encoding::ascii;
    std::string expected = after;
    expected.replace(expected.find("vertex 5"), 8, "vertex 4");
    EXPECT_EQ(file.serialize(as).value(), expected);
  }
}

TEST(CloudFile, StripsOfTrianglesAreCutWhereAPointGoes) {
  const std::string points =
      "\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 2\nproperty uchar id\n"
      "property list int int vertex_indices\nproperty uchar part\nend_header\n";
  const std::string rows = "0 0 0\n0 1 0\n1 0 0\n1 1 0\n2 0 0\n2 1 0\n3 0 0\n";
  const std::string before = "ply\nformat ascii 1.0\nelement vertex 7" + points + rows +
                             "1 12 0 1 2 3 4 5 6 -1 4 5 6 -1 8\n2 3 0 1 2 9\n";
  struct Case {
    std::size_t gone;
    std::string strips;
  };
  for (const auto& [gone, strips] :
       {Case{3, "1 12 0 1 2 -1 3 4 5 -1 3 4 5 -1 8\n2 3 0 1 2 9\n"},
        Case{2, "1 10 2 2 3 4 5 -1 3 4 5 -1 8\n"},  // the piece begins with a triangle that is turned
        Case{5, "1 6 0 1 2 3 4 -1 8\n2 3 0 1 2 9\n"}})
    for (const Encoding encoding : {Encoding::ascii, Encoding::binary_little_endian}) {
      WriteOptions as;
      as.encoding = encoding;
      const std::string bytes = CloudFile::parse(before, "strips.ply").value().serialize(as).value();
      auto file = CloudFile::parse(bytes, "strips.ply").value();
      std::vector<std::size_t> staying;
      for (std::size_t i = 0; i < 7; ++i)
        if (i != gone) staying.push_back(i);
      file.select(staying);
      as.encoding = Encoding::ascii;
      const std::string after = file.serialize(as).value();
      EXPECT_EQ(after.substr(after.size() - std::min(after.size(), strips.size())), strips) << gone;
    }
}

}  // namespace
