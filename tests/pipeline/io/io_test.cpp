#include "pipeline/io/io.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "pipeline/io/table/text.h"

using namespace rfsmooth;                // NOLINT(google-build-using-namespace)
using namespace rfsmooth::pipeline::io;  // NOLINT(google-build-using-namespace)

namespace {

std::string slurp(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

std::string written(const Cloud& cloud, std::optional<Encoding> encoding = {}) {
  WriteOptions options;
  options.encoding = encoding;
  return serialize_cloud(cloud, options, {}).value();
}

Cloud parsed_bytes(const std::string& bytes) {
  return parse_cloud(bytes, "test", {}, {}).value();
}

TEST(Numbers, NonFiniteOnesInEverySpellingAndNothingBehindThem) {
  for (const char* word : {"inf", "INF", "+inf", "infinity", "1.#INF", "1.#INF00"})
    EXPECT_EQ(parse_real(word).value_or(0), HUGE_VAL) << word;
  for (const char* word : {"-inf", "-1.#INF", "-1.#INF0000"})
    EXPECT_EQ(parse_real(word).value_or(0), -HUGE_VAL) << word;
  for (const char* word :
       {"nan", "NaN", "-nan", "nan(0)", "1.#QNAN", "1.#QNAN0", "1.#SNAN", "-1.#IND", "-1.#IND00"})
    EXPECT_TRUE(std::isnan(parse_real(word).value_or(0))) << word;
  for (const char* word :
       {"1.#", "1.#INF,2", "1.#INF3", "1.#QNANP,,", "1.#INDex", "infinite", "nan,", "2.#INF", "--1.#INF"})
    EXPECT_FALSE(parse_real(word).has_value()) << word;
}

// Every scan: the same bytes for a file we wrote, the same values for one that others compressed.
TEST(Scans, ComeBackBitForBit) {
  std::size_t seen = 0;
  for (const std::string folder : {RFSMOOTH_CROPS_DIR, RFSMOOTH_SCANS_DIR}) {
    if (folder.empty()) continue;  // no whole scans
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() != ".pcd" && entry.path().extension() != ".ply") continue;
      SCOPED_TRACE(entry.path());
      ++seen;
      const Cloud cloud = read_cloud(entry.path(), {}, {}).value();
      const std::string ours = written(cloud);
      const Cloud again = parsed_bytes(ours);
      EXPECT_EQ(again.points().data, cloud.points().data);
      EXPECT_EQ(written(again), ours);
      if (cloud.encoding != Encoding::binary_compressed) {
        EXPECT_EQ(ours, slurp(entry.path()));
      }
      Cloud same = cloud;
      set_positions(same, positions(cloud).data());
      EXPECT_EQ(same.points().data, cloud.points().data);
    }
  }
  EXPECT_GE(seen, 3u) << "the crops at least";
}

TEST(Rows, AreFiniteOnlyWithAllThreeCoordinates) {
  const std::vector<double> xyz = {1, 2, 3, -0.0, 1e308, 4};
  EXPECT_EQ(points_of(xyz), (rfsmooth::Positions{{1, 2, 3}, {0, 1e308, 4}}));
  EXPECT_EQ(finite_rows(xyz), 2U);
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL})
    for (std::size_t i = 0; i < 3; ++i) {
      std::vector<double> one = xyz;
      one[i] = bad;
      EXPECT_FALSE(finite_row(one.data()));
      EXPECT_TRUE(finite_row(&one[3]));
      EXPECT_EQ(finite_rows(one), 1U);
    }
}

TEST(Ply, HeaderAndOtherElementsSurvive) {
  const std::string file =
      "ply\r\ncomment first\r\nformat ascii 1.0\r\nobj_info a b\r\nelement camera 1\r\nproperty  float32 "
      "f\r\n"
      "comment mid\r\nelement vertex 2\r\nproperty float x\r\nproperty list uchar int tags\r\ncomment in\r\n"
      "property float y\r\nproperty double z\r\nelement face 1\r\nproperty list uchar int vertex_indices\r\n"
      "end_header\r\n1.50\r\n1 2 7 8 2.0 3\r\n4 0 5.25  6\r\n2 0 1\r\n";
  Cloud cloud = parsed_bytes(file);
  EXPECT_EQ(written(cloud), file);
  EXPECT_EQ(positions(cloud), (std::vector<double>{1, 2, 3, 4, 5.25, 6}));
  const double moved[] = {1, 2, 3.5, 4, 5.25, 6};
  set_positions(cloud, moved);
  std::string expected = file;
  expected.replace(expected.find("2.0 3\r"), 5, "2.0 3.5");
  EXPECT_EQ(written(cloud), expected);
  const Cloud binary = parsed_bytes(written(cloud, Encoding::binary_big_endian));
  EXPECT_EQ(positions(binary), (std::vector<double>(moved, moved + 6)));
  EXPECT_EQ(written(binary, Encoding::binary_little_endian), written(cloud, Encoding::binary_little_endian));
}

}  // namespace
