/// rfsmooth tiles: the same bytes however the work was done.
#include <algorithm>
#include <atomic>
#include <csignal>
#include <future>
#include <limits>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/cli/support/small_clouds.h"
#include "tests/cli/support/tile_jobs.h"
#include "tests/support/las_bytes.h"
#include "tests/support/sanitized.h"

using ::testing::HasSubstr;
using ::testing::Not;

namespace rfsmooth::test {
namespace {

TEST_F(Tiles, SameBytesForWorkersInAnyOrderAgainAndAfterKillsAndDamage) {
  put("in.ply", strip(0.4).bytes());
  const std::vector<std::string> tiles = settled({"in.ply"}, "one");
  ASSERT_GE(tiles.size(), 4u);
  std::filesystem::copy(at("one"), at("many"), std::filesystem::copy_options::recursive);
  step_of_all("run", "one");
  step({"join", "one", "one.ply"});
  const std::string expected = take("one.ply");
  std::vector<std::string> twice = tiles;
  twice.insert(twice.end(), tiles.begin(), tiles.end());
  std::shuffle(twice.begin(), twice.end(), std::mt19937(3));
  // Four workers are killed at random times, eight of them on the way, though what is there is taken away
  // again.
  constexpr int kKills = 8;
  std::atomic<int> killed = 0;
  const auto kill = [&](std::size_t worker) {
    std::mt19937 random(unsigned(worker) + 1);
    for (std::size_t k = worker; killed < kKills; k += 4) {
      const std::string& tile = twice[k % twice.size()];
      const std::string after = std::to_string(double(1 + random() % 200) / 1000);
      std::error_code ignored;
      std::filesystem::remove(at("many/done/" + tile), ignored);
      killed += run_program("timeout", {"-s", "KILL", after, RFSMOOTH_COMMAND, "tiles", "run", at("many"),
                                        tile, "--threads", "1"})
                            .code == 128 + SIGKILL
                    ? 1
                    : 0;
    }
  };
  const auto finish = [&](std::size_t worker) {
    for (std::size_t k = worker; k < twice.size(); k += 4)
      run_program(RFSMOOTH_COMMAND, {"tiles", "run", at("many"), twice[k], "--threads", "1"});
  };
  const auto in_four = [](const auto& work) {
    std::vector<std::future<void>> workers;
    for (std::size_t w = 0; w < 4; ++w) workers.push_back(std::async(std::launch::async, work, w));
    for (auto& worker : workers) worker.get();
  };
  in_four(kill);
  in_four(finish);
  step({"join", "many", "many.ply"});
  EXPECT_TRUE(take("many.ply") == expected);
  const auto all = nlohmann::json::parse(run({"tiles", "status", "many", "--json"}).out);
  EXPECT_GT(all["halo_share"].get<double>(), 0.1);  // a strip is narrow, and its tiles are short
  EXPECT_LT(all["halo_share"].get<double>(), double(tiles.size()));
  EXPECT_GT(all["seconds"].get<double>(), 0);

  // Half a result, and one with a byte of another: both are found, made again, and nothing else is.
  std::filesystem::resize_file(at("many/done/1"), std::filesystem::file_size(at("many/done/1")) / 2);
  std::string damaged = take("many/done/3");
  damaged[damaged.size() / 2] = char(damaged[damaged.size() / 2] ^ 1);
  put("many/done/3", damaged);
  const auto status = nlohmann::json::parse(run({"tiles", "status", "many", "--json"}).out);
  EXPECT_EQ(status["missing"], nlohmann::json::array({1, 3}));
  const Ran early = run({"tiles", "join", "many", "early.ply"});
  EXPECT_EQ(early.code, 2);
  EXPECT_THAT(early.err, HasSubstr("tile 1"));
  EXPECT_FALSE(there("early.ply"));
  step_of_all("run", "many");
  step({"join", "many", "again.ply"});
  EXPECT_TRUE(take("again.ply") == expected);
}

TEST_F(Tiles, AFolderOfFilesIsOneCloud) {
  const RichCloud all = strip(0.4);
  const auto [first, second] = all.cut_at(all.size() / 3);
  put("all.ply", all.bytes());
  put("a.ply", first.bytes());
  put("b.ply", second.bytes());
  const std::string one = joined({"all.ply"}, "one", "one.ply");
  joined({"a.ply", "b.ply"}, "two", "out");
  const std::string a = take("out/a.ply"), b = take("out/b.ply");
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double x = all.coordinate(one, i, axis);
      const double y =
          i < first.size() ? first.coordinate(a, i, axis) : second.coordinate(b, i - first.size(), axis);
      ASSERT_TRUE(x == y || (std::isnan(x) && std::isnan(y))) << i;
    }
}

// A patch has so many places, however often a scan was merged with itself.
TEST_F(Tiles, WhatLiesAroundATileIsAsWideForCopiesOfAScan) {
  const RichCloud once = strip(0.4);
  RichCloud often = once;
  for (int k = 1; k < 5; ++k) often.xyz.insert(often.xyz.end(), once.xyz.begin(), once.xyz.end());
  const auto share = [&](const std::string& name, const RichCloud& cloud) {
    put(name + ".ply", cloud.bytes());
    joined({name + ".ply"}, name, name + ".out.ply");
    return nlohmann::json::parse(run({"tiles", "status", name, "--json"}).out)["halo_share"].get<double>();
  };
  EXPECT_NEAR(share("often", often), share("once", once), 0.01);
}

// As denoise has it (las_test.cpp), the bytes too: one tile is the whole.
TEST_F(Tiles, ACoarseScaleOfALasFileIsRefinedAsForTheWholeCloud) {
  constexpr double kScale = 0.2;
  std::mt19937_64 engine(9);
  std::normal_distribution<double> noise(0, 0.2);
  LasBytes las;
  las.scale = {kScale, kScale, kScale};
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) {
      las.xyz.push_back({});
      for (std::size_t k = 0; k < 3; ++k) {
        const double at = k == 0 ? i : k == 1 ? j : 0;
        las.xyz.back()[k] = std::int32_t(std::lround((at + noise(engine)) / kScale));
      }
    }
  put("in.las", las.bytes());
  settled({"in.las"}, "job", "1000000");
  step_of_all("run", "job");
  for (const bool keep : {false, true}) {
    const std::vector<std::string> option(keep ? 1 : 0, "--keep-scale");
    std::vector<std::string> whole = {"denoise", "--force", "in.las", "whole.las"},
                             join = {"tiles", "join", "--force", "job", "tiled.las"};
    whole.insert(whole.end(), option.begin(), option.end());
    join.insert(join.end(), option.begin(), option.end());
    EXPECT_EQ(run(whole).code, 0);
    const Ran ran = run(join);
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_TRUE(take("tiled.las") == take("whole.las"));
    EXPECT_THAT(ran.err, HasSubstr("is coarse for noise of"));
    EXPECT_THAT(ran.err, HasSubstr(keep ? "takes back some of the smoothing" : "refined to"));
    EXPECT_EQ(LasBytes::get<double>(take("tiled.las"), 131) < kScale, !keep);
  }
  const Ran other = run({"tiles", "join", "job", "out.ply"});
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.err, HasSubstr("keeps its format"));
}

// Writers leave boxes that are wider than the points, or rounded: where nothing moves they stay.
TEST_F(Tiles, TheBoxOfALasFileStaysWhereThePointsDo) {
  LasBytes las;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) las.xyz.push_back({100 * i, 100 * j, 0});
  std::string bytes = las.bytes();
  const double wider = LasBytes::get<double>(bytes, 179) + 0.5;  // the largest x
  LasBytes::put(bytes, 179, wider);
  put("in.las", bytes);
  EXPECT_EQ(run({"denoise", "in.las", "whole.las"}).code, 0);
  EXPECT_TRUE(take("whole.las") == bytes);
  EXPECT_TRUE(joined({"in.las"}, "job", "tiled.las") == bytes);
}

TEST_F(Tiles, RoundingToWholeNumbersIsSaid) {
  const RichCloud cloud = strip(0.4);
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(cloud.size()) +
                     "\nproperty int x\nproperty int y\nproperty int z\nend_header\n";
  for (const double v : cloud.xyz)
    LasBytes::add(text, std::int32_t(std::isfinite(v) ? std::lround(1000 * v) : 0));
  put("in.ply", text);
  settled({"in.ply"}, "job", "1000000");
  step_of_all("run", "job");
  const Ran ran = run({"tiles", "join", "job", "out.ply"}), whole = run({"denoise", "in.ply", "whole.ply"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  for (const Ran* said : {&ran, &whole})
    EXPECT_THAT(said->err, HasSubstr("whole numbers (int32): new ones are rounded"));
  EXPECT_EQ(ran.err.find("whole numbers (int32)"), ran.err.rfind("whole numbers (int32)")) << "once";
}

// Each has its scale and its box from the results of its own rows; reading those of all inputs for each of
// them took as long as there are inputs.
TEST_F(Tiles, ManyLasFilesAreJoinedAsOneAndInTheTimeOfOne) {
  constexpr int kFiles = kSanitized ? 8 : 100, kWide = kSanitized ? 16 : 200, kColumns = 200;
  constexpr double kScale = 0.01;
  std::mt19937_64 engine(9);
  std::normal_distribution<double> noise(0, 0.3);
  LasBytes all;
  all.scale = {kScale, kScale, kScale};
  for (int i = 0; i < kWide * kColumns; ++i) {
    all.xyz.push_back({});
    const double at[] = {i / kColumns + noise(engine), i % kColumns + noise(engine), noise(engine)};
    for (std::size_t k = 0; k < 3; ++k) all.xyz.back()[k] = std::int32_t(std::lround(at[k] / kScale));
  }
  put("all.las", all.bytes());
  std::vector<std::string> names;
  const std::size_t each = all.xyz.size() / kFiles;
  for (std::size_t f = 0; f < kFiles; ++f) {
    LasBytes part = all;
    const auto first = all.xyz.begin() + std::ptrdiff_t(f * each);
    part.xyz.assign(first, first + std::ptrdiff_t(each));
    names.push_back("part" + std::to_string(f) + ".las");
    put(names.back(), part.bytes());
  }
  const auto smooth = [&](const std::vector<std::string>& inputs, const std::string& job) {
    settled(inputs, job, "3000", "3000", "--flow=laplacian");  // quickly: it is joined that they are for
    EXPECT_GT(tiles_of(job).size(), 1U);
    step_of_all("run", job);
  };
  smooth({"all.las"}, "one");
  smooth(names, "many");
  const Ran one = run({"tiles", "join", "--keep-scale", "one", "one.las"}),
            many = run({"tiles", "join", "--keep-scale", "many", "out"});
  EXPECT_EQ(one.code, 0) << one.err;
  EXPECT_EQ(many.code, 0) << many.err;
  if (!kSanitized) {
    EXPECT_LT(many.processor_seconds, 4 * one.processor_seconds + 0.5);
  }
  const std::string whole = take("one.las");
  EXPECT_FALSE(whole == take("all.las"));
  const std::size_t before = all.points(), row = all.row();
  constexpr std::size_t kPlace = 12;  // bytes of a row
  for (std::size_t f = 0; f < kFiles; ++f) {
    const std::string part = take("out/" + names[f]);
    std::int32_t low = std::numeric_limits<std::int32_t>::max();
    for (std::size_t i = 0; i < each; ++i) {
      low = std::min(low, LasBytes::get<std::int32_t>(part, before + i * row));
      ASSERT_EQ(part.compare(before + i * row, kPlace, whole, before + (f * each + i) * row, kPlace), 0) << f;
    }
    constexpr std::size_t kLowXAt = 187;
    EXPECT_NEAR(LasBytes::get<double>(part, kLowXAt), all.offset[0] + kScale * low, kScale / 10) << f;
  }
}

TEST_F(Tiles, WhatCannotBeDoneIsRefusedWithWhatToDo) {
  put("in.xyz", "1 2 3\n4 5 6\n");
  const Ran text = run({"tiles", "plan", "in.xyz", "job"});
  EXPECT_EQ(text.code, 2);
  EXPECT_THAT(text.err, HasSubstr("binary PLY"));
  put("in.ply", strip(0.4).bytes());
  EXPECT_EQ(run({"tiles", "run", "nothing", "0"}).code, 3);
  EXPECT_EQ(run({"tiles", "plan", "in.ply", "job", "--tile-points", "3000"}).code, 0);
  const Ran other = run({"tiles", "plan", "in.ply", "job", "--tile-points", "3000", "--strength", "0.5"});
  EXPECT_THAT(run({"tiles", "plan", "in.ply", "job", "--tile-points", "3.5"}).err, HasSubstr("or 5M"));
  EXPECT_EQ(other.code, 5);
  EXPECT_THAT(other.err, HasSubstr("other inputs or options"));
  EXPECT_EQ(run({"tiles", "plan", "in.ply", "job", "--tile-points", "3K"}).code, 0) << "the same again";
  const Ran early = run({"tiles", "settle", "job"});
  EXPECT_EQ(early.code, 2);
  EXPECT_THAT(early.err, HasSubstr("tile 0 is not measured"));
  EXPECT_EQ(run({"tiles", "measure", "job", "1000"}).code, 2);
  const Ran later = run({"tiles", "settle", "job", "--strength", "2"});
  EXPECT_EQ(later.code, 2);
  EXPECT_THAT(later.err, HasSubstr("tiles plan"));
}

TEST_F(Tiles, InputsThatJoinCouldNotTellApartAreRefusedByPlan) {
  for (const char* folder : {"a", "b"}) {
    std::filesystem::create_directory(at(folder));
    put(std::string(folder) + "/s.ply", noisy_plane(10).bytes());
  }
  const Ran ran = run({"tiles", "plan", "a/s.ply", "b/s.ply", "job"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err, HasSubstr("a/s.ply and b/s.ply would both be written to OUT/s.ply"));
  EXPECT_FALSE(there("job"));
  EXPECT_FALSE(there("OUT"));
}

TEST_F(Tiles, AFolderOfOtherFilesIsNoJob) {
  put("in.ply", strip(0.3, 40).bytes());
  std::filesystem::create_directory(at("cleaned"));
  put("cleaned/mine.ply", "mine");
  const Ran ran = run({"tiles", "plan", "in.ply", "cleaned"});
  EXPECT_EQ(ran.code, 5);
  EXPECT_EQ(ran.err,
            "rfsmooth: error: cleaned: holds other files (mine.ply); name a folder of its own for the job\n");
  EXPECT_FALSE(there("cleaned/cut"));
  std::filesystem::create_directories(at("empty"));
  std::filesystem::create_directories(at("cut_short/cut"));
  for (const char* folder : {"empty", "cut_short"}) {
    step({"plan", "in.ply", folder});
    step({"plan", "in.ply", folder});  // its own job
  }
}

TEST_F(Tiles, JoinReplacesNoScan) {
  std::filesystem::create_directory(at("scans"));
  const std::string a = noisy_plane(20).bytes(), b = noisy_plane(21).bytes(), other = noisy_plane(5).bytes();
  put("scans/a.ply", a);
  put("scans/b.ply", b);
  put("other.ply", other);
  std::filesystem::create_directory(at("cleaned"));
  put("cleaned/b.ply", other);
  joined({"scans/a.ply"}, "one", "out.ply");
  joined({"scans/a.ply", "scans/b.ply"}, "two", "out");

  const Ran itself = run({"tiles", "join", "--force", "one", "scans/a.ply"});
  EXPECT_EQ(itself.code, 5);
  EXPECT_THAT(itself.err, HasSubstr("scans/a.ply: is a scan of the job; it stays as it is"));
  for (const char* folder : {"scans", "cleaned"})
    EXPECT_EQ(run({"tiles", "join", "--force", "two", folder}).code, 5);
  EXPECT_TRUE(take("scans/a.ply") == a);
  EXPECT_TRUE(take("scans/b.ply") == b);
  EXPECT_FALSE(there("cleaned/a.ply")) << "refused before any file is written";
  EXPECT_TRUE(take("cleaned/b.ply") == other);

  const Ran scan = run({"tiles", "join", "--force", "one", "other.ply"});
  EXPECT_EQ(scan.code, 5);
  EXPECT_THAT(
      scan.err,
      HasSubstr("other.ply: is a cloud that rfsmooth did not write; it stays as it is. Name another"));
  EXPECT_TRUE(take("other.ply") == other);
}

TEST_F(Tiles, JoinReplacesWhatItWroteItself) {
  put("in.ply", noisy_plane(20).bytes());
  const std::string once = joined({"in.ply"}, "job", "out.ply");
  EXPECT_EQ(run({"tiles", "join", "job", "out.ply"}).code, 5);
  const Ran again = run({"tiles", "join", "--force", "job", "out.ply"});
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_TRUE(take("out.ply") == once);
}

TEST_F(Tiles, JoinWritesOneFileToStandardOutput) {
  put("a.ply", noisy_plane(20).bytes());
  put("b.ply", noisy_plane(21).bytes());
  const std::string expected = joined({"a.ply"}, "one", "out.ply");
  const Ran ran = run({"tiles", "join", "one", "-"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(ran.out == expected);
  joined({"a.ply", "b.ply"}, "two", "out");
  const Ran two = run({"tiles", "join", "two", "-"});
  EXPECT_EQ(two.code, 2);
  EXPECT_EQ(two.out, "");
  EXPECT_THAT(two.err, HasSubstr("several inputs need a folder, not standard output (-)"));
  EXPECT_FALSE(there("-"));
}

TEST_F(Tiles, JoinSaysNothingToAReaderThatHasSeenEnough) {
  put("a.ply", noisy_plane(60).bytes());  // 72 KB, more than a pipe holds
  joined({"a.ply"}, "one", "out.ply", "1000000");
  RunSetup setup;
  setup.folder = at("");
  const Ran ran = run_program(
      "bash", {"-c", "{ sleep 0.2; '" RFSMOOTH_COMMAND "' tiles join one -; } | true; exit ${PIPESTATUS[0]}"},
      setup);
  EXPECT_EQ(ran.err, "");
  EXPECT_EQ(ran.code, 5);
}

TEST_F(Tiles, JoinWritesOneFileIntoAFolderToo) {
  put("a.ply", noisy_plane(20).bytes());
  const std::string expected = joined({"a.ply"}, "one", "out.ply");
  const Ran ran = run({"tiles", "join", "one", "cleaned/"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(take("cleaned/a.ply") == expected);
}

// Of rows before the points that the file only promises; 2^64 - 100 of them end before they begin.
TEST_F(Tiles, RowsThatAreNotThereAreRefusedWithTheirElementAndPlace) {
  for (const std::string count : {"40000000", "3000000000", "10000000000000", "18446744073709551516"}) {
    const std::string bytes =
        "ply\nformat binary_little_endian 1.0\nelement pad " + count +
        "\nproperty uchar a\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
        "end_header\n" +
        std::string(50, '\0');
    put("in.ply", bytes);
    RunSetup piped;
    piped.input = bytes;
    for (const Ran& ran :
         {run({"tiles", "plan", "in.ply", "job"}), run({"tiles", "plan", "/dev/stdin", "job"}, piped)}) {
      EXPECT_EQ(ran.code, 3) << ran.err;
      EXPECT_THAT(ran.err, HasSubstr("expected " + count + " rows of element 'pad', 1 byte each, found 50"));
    }
    EXPECT_FALSE(there("job"));
  }
}

TEST_F(Tiles, AJobWhoseListsDoNotFitIsRefusedWithOneLineThatSaysWhich) {
  put("in.ply", strip(0.4).bytes());
  settled({"in.ply"}, "job");
  const auto right = nlohmann::ordered_json::parse(take("job/statistics.json"));
  const auto run_with = [&](const auto& change) {
    auto changed = right;
    change(changed);
    put("job/statistics.json", changed.dump());
    return run({"tiles", "run", "job", "0"});
  };
  const Ran sites = run_with([](auto& job) { job["statistics"]["noise"]["at_sites"].clear(); });
  EXPECT_EQ(sites.code, 3);
  EXPECT_THAT(sites.err, HasSubstr("statistics.json: noise: sigma at 0"));
  EXPECT_EQ(std::count(sites.err.begin(), sites.err.end(), '\n'), 1) << sites.err;
  for (const char* name : {"widest", "halo_radii"}) {
    const Ran none = run_with([&](auto& job) { job[name] = 0; });
    EXPECT_EQ(none.code, 3);
    EXPECT_THAT(none.err, HasSubstr("statistics.json: halo"));
  }
  const Ran tails = run_with([](auto& job) {
    job["statistics"]["tails"] = {{"share", 0.5}, {"times", 0}, {"narrow", 0}, {"together", 1}};
  });
  EXPECT_EQ(tails.code, 3);
  EXPECT_THAT(tails.err, HasSubstr("statistics.json: tails"));
}

TEST_F(Tiles, AFullDiskIsAnErrorAndTheWorkGoesOnWhenThereIsRoom) {
  put("in.ply", noisy_plane(60).bytes());
  std::filesystem::create_directory(at("disk"));
  RunSetup setup;
  setup.folder = at("");
  const std::string script =
      "mount -t tmpfs -o size=220k tmpfs disk || exit 99\n"
      "R='" RFSMOOTH_COMMAND
      "'\n"
      "$R tiles plan --tile-points 2000 in.ply disk/job -q || exit 98\n"
      "n=$($R tiles status disk/job --json | sed -n 's/.*\"tiles\": \\([0-9]*\\).*/\\1/p')\n"
      "$R tiles measure disk/job $(seq 0 $((n - 1))) -q; echo first $?\n"
      "mount -o remount,size=64m disk\n"
      "$R tiles measure disk/job $(seq 0 $((n - 1))) -q; echo then $?\n"
      "$R tiles settle disk/job -q && $R tiles run disk/job $(seq 0 $((n - 1))) -q &&\n"
      "$R tiles join disk/job full.ply -q; echo last $?\n";
  std::vector<std::string> arguments = {"--mount", "sh", "-c", script};
  if (geteuid() != 0) arguments.insert(arguments.begin(), {"--user", "--map-root-user"});
  const Ran ran = run_program("unshare", arguments, setup);
  if (ran.code == 99 || ran.code == 1) GTEST_SKIP() << "mounting is not allowed here";
  EXPECT_EQ(ran.out, "first 5\nthen 0\nlast 0\n") << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("No space left"));
  EXPECT_TRUE(take("full.ply") == joined({"in.ply"}, "job", "plenty.ply", "2000"));
}

}  // namespace
}  // namespace rfsmooth::test
