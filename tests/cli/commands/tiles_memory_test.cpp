/// rfsmooth denoise --memory: in tiles where the memory is less.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "pipeline/tiles/in_one_process.h"
#include "tests/cli/support/cloud_file.h"
#include "tests/cli/support/small_clouds.h"
#include "tests/cli/support/tile_jobs.h"
#include "tests/support/sanitized.h"

using ::testing::HasSubstr;
using ::testing::Not;

namespace rfsmooth::test {
namespace {

// Nearly the least that is taken, and a sheet of more points than it holds, 50,300. The sheet is a long one:
// most of a square would be around every tile.
constexpr const char* kLittle = "73M";
constexpr std::uint64_t kLittleBytes = 73'000'000;
constexpr int kTooLong = 2240;

TEST_F(Tiles, DenoiseTakesTilesWhereTheMemoryIsLess) {
  put("in.ply", noisy_sheet(kTooLong, kWide).bytes());
  const Ran ran = run({"denoise", "--memory", kLittle, "in.ply", "out.ply"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(names(), (std::vector<std::string>{"in.ply", "out.ply"})) << "nothing is left";
  const auto how = pipeline::tiles::plan_within(kLittleBytes, false).plan;
  EXPECT_GT(how.sample_points, 50'000U);
  EXPECT_THAT(ran.err, HasSubstr(fmt::format("in tiles of {} points", how.tile_points)));
  EXPECT_LT(how.tile_points, pipeline::tiles::plan_within(10 * kLittleBytes, false).plan.tile_points / 10);
  if (!kSanitized) {  // three more runs of the whole cloud
    EXPECT_TRUE(take("out.ply") == joined({"in.ply"}, "job", "steps.ply", std::to_string(how.tile_points),
                                          std::to_string(how.sample_points)));
    EXPECT_EQ(run({"denoise", "--memory", "1T", "in.ply", "whole.ply"}).code, 0);
    EXPECT_EQ(run({"denoise", "in.ply", "plain.ply"}).code, 0);
    EXPECT_TRUE(take("whole.ply") == take("plain.ply"));
  }
  const Ran wrong = run({"denoise", "--memory", "much", "in.ply", "x.ply"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("'much'"));
  for (const std::vector<std::string>& nonsense :
       {std::vector<std::string>{"--viewpoint", "here"}, {"--viewpoint", "1,2,3"}}) {
    std::vector<std::string> arguments = {"denoise", "--memory", kLittle, "in.ply", "x.ply"};
    arguments.insert(arguments.end(), nonsense.begin(), nonsense.end());
    const Ran refused = run(arguments);
    EXPECT_EQ(refused.code, 2) << refused.err;
    EXPECT_THAT(refused.err, Not(HasSubstr("in tiles of"))) << "refused before any work";
  }
  for (const std::vector<std::string>& of_all :
       {std::vector<std::string>{"--html", "x.html"}, {"--report", "x.json"}}) {
    std::vector<std::string> arguments = {"denoise", "--memory", kLittle, "in.ply", "x.ply"};
    arguments.insert(arguments.end(), of_all.begin(), of_all.end());
    const Ran whole = run(arguments);
    EXPECT_EQ(whole.code, 2);
    EXPECT_THAT(whole.err, HasSubstr(of_all.front() + " needs the whole cloud"));
  }
}

TEST_F(Tiles, TheLeastMemoryIsSaidAndKept) {
  put("in.ply", noisy_plane(500).bytes());
  const auto megabytes = std::size_t(std::ceil(double(pipeline::tiles::least_memory(250'000, false)) / 1e6));
  const std::string least = fmt::format("{}M", megabytes);
  const Ran less = run({"denoise", "--memory", "2M", "in.ply", "out.ply"});
  EXPECT_EQ(less.code, 2);
  EXPECT_THAT(less.err, HasSubstr("--memory " + least + " or more"));
  EXPECT_FALSE(there("out.ply"));
  if (kSanitized) return;  // what takes longest
  const Ran kept = run({"denoise", "--memory", least, "in.ply", "out.ply"});
  EXPECT_EQ(kept.code, 0) << kept.err;
  EXPECT_THAT(kept.err, HasSubstr("in tiles"));
  EXPECT_LE(kept.peak, megabytes * 1'000'000);
}

/// A sheet with normals, of which a share of the rows is not finite.
std::string sheet_with_normals(int rows, int columns, int finite_of_ten) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n",
      rows * columns);
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal(0, 0.2);
  for (int i = 0; i < rows * columns; ++i) {
    const bool finite = i % 10 < finite_of_ten;
    for (const double v : {i / columns + normal(engine), i % columns + normal(engine),
                           finite ? normal(engine) : std::nan(""), 0.0, 0.0, 1.0}) {
      const auto value = float(v);
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
  }
  return bytes;
}

// But for figures of a few digits that seams may change, what is said is the same.
TEST_F(Tiles, DenoiseSaysInTilesWhatItSaysOfTheWholeCloud) {
  if (kSanitized) GTEST_SKIP() << "what is said is asked for without sanitizers";
  put("in.ply", sheet_with_normals(kTooLong, kWide, 10));
  const Ran whole = run({"denoise", "in.ply", "whole.ply"}),
            tiled = run({"denoise", "--memory", kLittle, "in.ply", "tiled.ply"});
  EXPECT_EQ(tiled.code, 0);
  EXPECT_THAT(tiled.err, HasSubstr("in tiles"));
  for (const char* said :
       {"the normals are stale", "53760 points, 53760 finite", "; spacing 0.", "largest move "})
    for (const Ran* ran : {&whole, &tiled}) EXPECT_THAT(ran->err, HasSubstr(said));
  const auto noise_in = [](const std::string& text) {
    const std::size_t at = text.find("noise 0.");
    return at == std::string::npos ? text : text.substr(at, 10);
  };
  EXPECT_EQ(noise_in(tiled.err), noise_in(whole.err));
}

TEST_F(Tiles, WhyNothingWasSmoothedIsSaidInTiles) {
  RichCloud clean;
  for (int i = 0; i < kTooLong * kWide; ++i)
    clean.xyz.insert(clean.xyz.end(), {double(i / kWide), double(i % kWide), 0});
  put("in.ply", clean.bytes());
  const Ran ran = run({"denoise", "--memory", kLittle, "in.ply", "out.ply"});
  EXPECT_EQ(ran.code, 0);
  EXPECT_THAT(ran.err, HasSubstr("in tiles"));
  EXPECT_THAT(ran.err, HasSubstr("too little to smooth"));
  EXPECT_TRUE(take("out.ply") == take("in.ply"));
}

TEST_F(Tiles, ProgressStaysWithinItsRange) {
  put("in.ply", sheet_with_normals(3000, kWide, 1));  // ten times as many rows as points, in two pieces
  Context context;
  std::vector<double> parts;
  context.progress = [&](std::string_view, double part) {
    parts.push_back(part);
    return true;
  };
  pipeline::tiles::smooth_in_tiles({at("in.ply"), at("out.ply")},
                                   pipeline::tiles::plan_within(kLittleBytes, false), {}, std::nullopt,
                                   context);
  ASSERT_FALSE(parts.empty());
  EXPECT_GE(*std::min_element(parts.begin(), parts.end()), 0);
  EXPECT_LE(*std::max_element(parts.begin(), parts.end()), 1);
}

TEST_F(Tiles, RowsThatAreNotFiniteTakeNoMemory) {
  put("in.ply", sheet_with_normals(kTooLong, kWide, 1));  // 5,376 points
  const Ran ran = run({"denoise", "--memory", kLittle, "in.ply", "out.ply"});
  EXPECT_EQ(ran.code, 0);
  EXPECT_THAT(ran.err, Not(HasSubstr("in tiles")));
}

// A scanner's (0, 0, 0) for what it did not see, where it stands.
TEST_F(Tiles, RowsAtOnePlaceTakeNoMemoryAndStayTogether) {
  const BinaryPly plane = noisy_sheet(820, kWide);
  BinaryPly unseen = plane;
  unseen.xyz.clear();
  for (std::size_t i = 0; i < plane.size(); ++i) {
    unseen.xyz.insert(unseen.xyz.end(), {0, 0, 1000, 0, 0, 1000});
    unseen.xyz.insert(unseen.xyz.end(), plane.xyz.begin() + std::ptrdiff_t(3 * i),
                      plane.xyz.begin() + std::ptrdiff_t(3 * i + 3));
  }
  put("in.ply", unseen.bytes());
  const Ran ran = run({"denoise", "--memory", kLittle, "in.ply", "out.ply"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("in tiles"));
  EXPECT_THAT(ran.err, HasSubstr(fmt::format("{0} points, {0} finite; {1} outliers", unseen.size(),
                                             2 * plane.size())));
  const std::string out = take("out.ply");
  double before = 0, after = 0;
  for (std::size_t i = 0; i < unseen.size(); ++i) {
    std::array<float, 3> now{};
    std::memcpy(now.data(), out.data() + unseen.header().size() + i * BinaryPly::kRow, sizeof now);
    if (i % 3 < 2)
      ASSERT_EQ(now, (std::array<float, 3>{0, 0, 1000})) << i;
    else
      after += double(now[2]) * double(now[2]);
    before += i % 3 < 2 ? 0 : double(unseen.xyz[3 * i + 2]) * double(unseen.xyz[3 * i + 2]);
  }
  EXPECT_LT(after, before / 10);
}

// A scan merged with copies of itself: more rows than fit, and fewer places than two tiles have.
TEST_F(Tiles, CopiesOfAScanGoInTilesAndMoveTogether) {
  constexpr std::size_t kCopies = 5;
  const BinaryPly sheet = noisy_sheet(450, kWide);
  BinaryPly merged = sheet;
  for (std::size_t k = 1; k < kCopies; ++k)
    merged.xyz.insert(merged.xyz.end(), sheet.xyz.begin(), sheet.xyz.end());
  put("in.ply", merged.bytes());
  const Ran ran = run({"denoise", "--memory", kLittle, "in.ply", "out.ply"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("in tiles"));
  const std::string out = take("out.ply");
  const auto row = [&](std::size_t i) {
    std::array<float, 3> xyz{};
    std::memcpy(xyz.data(), out.data() + merged.header().size() + i * BinaryPly::kRow, sizeof xyz);
    return xyz;
  };
  double before = 0, after = 0;
  for (std::size_t i = 0; i < merged.size(); ++i) {
    ASSERT_EQ(row(i), row(i % sheet.size())) << i;
    before += double(merged.xyz[3 * i + 2]) * double(merged.xyz[3 * i + 2]);
    after += double(row(i)[2]) * double(row(i)[2]);
  }
  EXPECT_LT(after, before / 10);
}

// What is refused after reading has taken what reading takes.
TEST_F(Tiles, TextIsInMemoryOnce) {
  if (kSanitized) GTEST_SKIP() << "memory is looked at without sanitizers";
  constexpr int kRows = 200'000, kColumns = 60;
  {
    std::ofstream file(at("in.xyz"));  // in pieces: what this test takes counts, too
    for (int i = 0; i < kRows; ++i) {
      file << i / 400 << ' ' << i % 400 << " 0";
      for (int k = 3; k < kColumns; ++k) file << " 1.2345";
      file << '\n';
    }
  }
  const Ran ran = run({"denoise", "--memory", kLittle, "in.xyz", "out.xyz"});
  EXPECT_EQ(ran.code, 6) << ran.err;
  EXPECT_LT(double(ran.peak), 1.7 * double(std::filesystem::file_size(at("in.xyz"))));
}

// There is no place beside them for the tiles.
TEST_F(Tiles, PipesAndOpenFilesGetTheWholeCloud) {
  put("in.ply", noisy_sheet(kTooLong, kWide).bytes());
  for (const char* output : {"-", "/dev/stdout", "/dev/null"}) {
    const Ran ran = run({"denoise", "--memory", kLittle, "in.ply", output});
    EXPECT_EQ(ran.code, 6) << output << ": " << ran.err;
    EXPECT_THAT(ran.err, Not(HasSubstr("in tiles of"))) << output;
    EXPECT_THAT(ran.err, HasSubstr("; into a file it would be smoothed in tiles")) << output;
  }
  put("more.ply", noisy_plane(4).bytes());
  const Ran several = run({"denoise", "--memory", kLittle, "in.ply", "more.ply", "-o", "out/"});
  EXPECT_THAT(several.err, HasSubstr("in.ply: needs about"));
  EXPECT_THAT(several.err, HasSubstr("; as the only input it would be smoothed in tiles"));
}

TEST_F(Tiles, TheFormatOfTheFileIsNoOtherFormat) {
  put("in.ply", noisy_sheet(kTooLong, kWide).bytes());
  const std::vector<std::string> how = {"denoise", "--memory", kLittle, "in.ply", "out.ply"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = how;
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  };
  for (const std::vector<std::string>& other :
       {std::vector<std::string>{"--format", "pcd"}, {"--encoding", "ascii"}}) {
    const Ran ran = with(other);
    EXPECT_EQ(ran.code, 2);
    EXPECT_THAT(ran.err, HasSubstr("another format needs the whole cloud"));
  }
  if (kSanitized) return;  // what takes longest
  const Ran same = with({"--format", "ply", "--encoding", "binary"});
  EXPECT_EQ(same.code, 0) << same.err;
  EXPECT_THAT(same.err, HasSubstr("in tiles of"));
}

TEST_F(Tiles, WhatCannotGoInTilesIsRefusedWhereTheMemoryIsLess) {
  put("in.ply", noisy_sheet(kTooLong, kWide).bytes());
  using pipeline::io::Encoding;
  const pipeline::io::Cloud cloud = read(at("in.ply"));
  const auto write = [&](const char* name, Encoding encoding) {
    pipeline::io::WriteOptions options;
    options.encoding = encoding;
    EXPECT_TRUE(pipeline::io::write_cloud(cloud, at(name), options, {}));
  };
  write("text.ply", Encoding::ascii);
  write("small.pcd", Encoding::binary_compressed);
  for (const std::string input : {"text.ply", "small.pcd"}) {
    const std::string output = "out." + input.substr(input.size() - 3);
    const Ran ran = run({"denoise", "--memory", kLittle, input, output});
    EXPECT_EQ(ran.code, 6) << ran.err;
    EXPECT_THAT(ran.err, HasSubstr("--memory allows 73 MB"));
    EXPECT_THAT(ran.err, HasSubstr("binary PLY"));
    EXPECT_FALSE(there(output));
    if (kSanitized) continue;  // what takes longest
    EXPECT_EQ(run({"denoise", "--memory", "200M", input, output}).code, 0);
  }
}

}  // namespace
}  // namespace rfsmooth::test
