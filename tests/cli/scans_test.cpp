/// Real scans through the real command: everything but the coordinates of finite points comes back bit for
/// bit.
#include "tests/support/scans.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "rfs_mesh/noise/noise.h"
#include "rfs_mesh/points.h"
#include "tests/cli/support/cloud_file.h"
#include "tests/cli/support/folder.h"
#include "tests/support/sanitized.h"

namespace rfsmooth::test {
namespace {

namespace io = pipeline::io;

constexpr const char* kSteps = kSanitized ? "1" : "3";
constexpr std::size_t kMiddle = kSanitized ? 4000 : 12000;  // points of the middle of a scan
/// Scans of larger files are cleaned as a whole only without the sanitizers.
constexpr std::uintmax_t kLargeFile = kSanitized ? 1000000 : std::numeric_limits<std::uintmax_t>::max();
constexpr std::size_t kMiddleOfLarge = 20000;

bool is_coordinate(const io::Cloud& cloud, std::size_t field) {
  return std::find(cloud.xyz.begin(), cloud.xyz.end(), field) != cloud.xyz.end();
}

/// The parts of a row by field: words of text, or bytes.
std::vector<std::string> parts(const io::Table& table, std::size_t row) {
  std::vector<std::string> out;
  std::string_view bytes = table.row(row);
  if (table.text) {
    for (const io::Field& field : table.fields) {
      std::string words;
      for (std::size_t k = 0; k < field.count; ++k)
        words += std::string(io::next_word(bytes, table.separators)) + ' ';
      out.push_back(words);
    }
    return out;
  }
  std::size_t at = 0;
  for (const io::Field& field : table.fields) {
    const std::size_t size = field.count * io::size_of(field.type);
    out.emplace_back(bytes.substr(at, size));
    at += size;
  }
  return out;
}

void expect_only_finite_points_moved(const io::Cloud& before, const io::Cloud& after) {
  ASSERT_EQ(after.size(), before.size());
  EXPECT_EQ(after.width, before.width);
  EXPECT_EQ(after.height, before.height);
  EXPECT_EQ(after.viewpoint, before.viewpoint);
  EXPECT_EQ(after.encoding, before.encoding);
  ASSERT_EQ(after.points().fields.size(), before.points().fields.size());
  for (std::size_t f = 0; f < before.points().fields.size(); ++f) {
    EXPECT_EQ(after.points().fields[f].name, before.points().fields[f].name);
    EXPECT_EQ(after.points().fields[f].type, before.points().fields[f].type);
    EXPECT_EQ(after.points().fields[f].count, before.points().fields[f].count);
  }
  const std::vector<double> old_xyz = io::positions(before), new_xyz = io::positions(after);
  std::size_t moved = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const bool finite = std::isfinite(old_xyz[3 * i]) && std::isfinite(old_xyz[3 * i + 1]) &&
                        std::isfinite(old_xyz[3 * i + 2]);
    const auto old_parts = parts(before.points(), i), new_parts = parts(after.points(), i);
    for (std::size_t f = 0; f < old_parts.size(); ++f)
      ASSERT_TRUE((finite && is_coordinate(before, f)) || new_parts[f] == old_parts[f])
          << "row " << i << " field " << before.points().fields[f].name;
    if (finite) moved += std::memcmp(&old_xyz[3 * i], &new_xyz[3 * i], 3 * sizeof(double)) != 0;
    ASSERT_EQ(finite, std::isfinite(new_xyz[3 * i] + new_xyz[3 * i + 1] + new_xyz[3 * i + 2])) << "row " << i;
  }
  EXPECT_GT(moved, before.size() / 4);
}

/// The `count` points nearest to the finite point in the middle of the file, in their order: a scan's own
/// noise and density at a size that tests have time for.
io::Cloud middle_of(io::Cloud cloud, std::size_t count) {
  const std::vector<double> xyz = io::positions(cloud);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (std::isfinite(xyz[3 * i] + xyz[3 * i + 1] + xyz[3 * i + 2])) rows.push_back(i);
  const Eigen::Vector3d middle(&xyz[3 * rows[rows.size() / 2]]);
  const auto nearer = [&](std::size_t a, std::size_t b) {
    return (Eigen::Map<const Eigen::Vector3d>(&xyz[3 * a]) - middle).squaredNorm() <
           (Eigen::Map<const Eigen::Vector3d>(&xyz[3 * b]) - middle).squaredNorm();
  };
  count = std::min(count, rows.size());
  std::nth_element(rows.begin(), rows.begin() + std::ptrdiff_t(count - 1), rows.end(), nearer);
  rows.resize(count);
  std::sort(rows.begin(), rows.end());
  io::select_points(cloud, rows);
  return cloud;
}

class Scans : public InFolder {
 protected:
  void expect_cleaned(std::string input) {
    const std::string extension = std::filesystem::path(input).extension().string(),
                      output = "out" + extension;
    if (std::filesystem::file_size(input) > kLargeFile) {
      const io::Cloud middle = middle_of(read(input), kMiddleOfLarge);
      input = at("in" + extension);
      value_or_throw(io::write_cloud(middle, input, {}, {}));
    }
    const Ran ran = run({"denoise", "--flow", "hc", "--iterations", kSteps, input, output});
    ASSERT_EQ(ran.code, 0) << ran.err;
    EXPECT_EQ(ran.out, "");
    expect_only_finite_points_moved(read(input), read(at(output)));
  }

  /// What denoise makes of points (3 x n), in coordinates of single precision.
  Eigen::Matrix3Xd denoised(const Eigen::Matrix3Xd& points) const {
    std::string rows;
    for (const auto& p : points.colwise())
      rows += fmt::format("{} {} {}\n", float(p.x()), float(p.y()), float(p.z()));
    put("in.xyz", rows);
    const Ran ran = run({"denoise", "--force", "in.xyz", "out.xyz"});
    EXPECT_EQ(ran.code, 0) << ran.err;
    const std::vector<double> xyz = io::positions(read(at("out.xyz")));
    return Eigen::Map<const Eigen::Matrix3Xd>(xyz.data(), 3, Eigen::Index(xyz.size() / 3));
  }
};

/// The noise around every row, as the library measures it; 0 for rows that are not finite.
std::vector<double> local_noise(const std::vector<double>& xyz) {
  const auto cloud = rfs_mesh::make_working_cloud(xyz.data(), xyz.size() / 3, {}).value();
  const rfs_mesh::SpatialIndex index(cloud.points, {});
  const auto noise = rfs_mesh::spread_noise(rfs_mesh::measure_noise(index, {}), cloud.points, {});
  std::vector<double> by_row(xyz.size() / 3, 0);
  for (std::size_t i = 0; i < by_row.size(); ++i)
    if (cloud.of_input[i] != kNone) by_row[i] = noise.local[cloud.of_input[i]];
  return by_row;
}

/// The automatic flow on the middle of a scan: no point moves more than six times the noise around it (times
/// that of the tails, where there are some), beyond the rounding of the coordinates' own type.
class CalmScans : public Scans {
 protected:
  void expect_small_moves(const std::string& input) {
    const io::Cloud before = middle_of(read(input), kMiddle);
    const std::string extension = std::filesystem::path(input).extension().string();
    ASSERT_TRUE(io::write_cloud(before, at("in" + extension), {}, {}).ok());
    const Ran ran =
        run({"denoise", "--outliers", "smooth", "in" + extension, "out" + extension, "--report", "r.json"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    const auto old_xyz = io::positions(before), new_xyz = io::positions(read(at("out" + extension)));
    const std::vector<double> noise = local_noise(old_xyz);
    const double most = 6.001 * nlohmann::json::parse(take("r.json"))["tail_times"].get<double>();
    for (std::size_t i = 0; i < noise.size(); ++i) {
      double square = 0, rounding = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t k = 3 * i + axis;
        square += std::pow(new_xyz[k] - old_xyz[k], 2);
        const double widest = std::abs(old_xyz[k]) + std::abs(new_xyz[k]);
        if (before.points().fields[before.xyz[axis]].type == io::Scalar::float32)
          rounding += 0x1p-23 * widest;
      }
      ASSERT_LE(std::sqrt(square), most * noise[i] + rounding) << "row " << i;
    }
  }
};

class RawScans : public CalmScans, public ::testing::WithParamInterface<std::string> {};

TEST_P(RawScans, OnlyFinitePointsMove) {
  expect_cleaned(GetParam());
}

/// The default flow: the same file for 1, 2, 3 and 4 threads, and once more.
class DefaultFlow : public RawScans {};

TEST_P(DefaultFlow, SameBytesForOneToFourThreadsAndAgain) {
  if (kSanitized) GTEST_SKIP() << "the same bytes are asked for without sanitizers";
  std::string first;
  for (const char* threads : {"1", "2", "3", "4", "4"}) {
    const Ran ran = run({"denoise", "--force", "--threads", threads, GetParam(), "out.pcd"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    const std::string bytes = take("out.pcd");
    if (first.empty()) {
      first = bytes;
      EXPECT_GT(bytes.size(), 0u);
    }
    EXPECT_TRUE(bytes == first) << threads << " threads";
  }
}

INSTANTIATE_TEST_SUITE_P(Files, DefaultFlow,
                         ::testing::ValuesIn(crops_and({"table_scene_mug_stereo_textured.pcd",
                                                        "mOSD_learn0.pcd", "cturtle.pcd", "room_scan1.pcd",
                                                        "terrain_samp11-utm.pcd"})),
                         name_of_scan);

TEST_P(RawScans, NoPointMovesFarBeyondTheNoiseAroundIt) {
  expect_small_moves(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Files, RawScans,
                         ::testing::ValuesIn(crops_and(
                             {"milk_cartoon_all_small_clorox.pcd", "table_scene_mug_stereo_textured.pcd",
                              "mOSD_learn0.pcd", "cturtle.pcd", "room_scan1.pcd", "terrain_samp11-utm.pcd"})),
                         name_of_scan);

/// building.ply and b9_training.ply of CGAL's data archive (Debian: libcgal-demo).
class CgalData : public CalmScans, public ::testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(RFSMOOTH_CGAL_DATA))
      GTEST_SKIP() << "no archive " << RFSMOOTH_CGAL_DATA
                   << " (install libcgal-demo or set RFSMOOTH_CGAL_DATA)";
    RunSetup setup;
    setup.folder = at("");
    const Ran ran = run_program("tar",
                                {"xzf", RFSMOOTH_CGAL_DATA, "--wildcards",
                                 std::string("*/points_3/") + GetParam(), "--transform", "s|.*/||"},
                                setup);
    ASSERT_EQ(ran.code, 0) << ran.err;
  }
};

TEST_P(CgalData, OnlyFinitePointsMove) {
  expect_cleaned(at(GetParam()));
}

TEST_P(CgalData, NoPointMovesFarBeyondTheNoiseAroundIt) {
  expect_small_moves(at(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Files, CgalData, ::testing::Values("building.ply", "b9_training.ply"),
                         [](const auto& test) { return std::string(test.param, test.index == 0 ? 8 : 11); });

/// Root mean square distance of n x 3 points to the plane through them.
double off_plane(const std::vector<double>& xyz) {
  const Eigen::Map<const Eigen::Matrix3Xd> points(xyz.data(), 3, Eigen::Index(xyz.size() / 3));
  const Eigen::Matrix3Xd d = points.colwise() - points.rowwise().mean();
  const Eigen::Matrix3d spread = d * d.transpose() / double(points.cols());
  return std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues()[0]));
}

TEST_F(Scans, ThePlaneOfAnRgbdScanComesOutFlatter) {
  std::vector<std::string> paths = whole_scans({"mOSD_learn0.pcd"});
  paths.emplace_back(kBoxCrop);
  for (const std::string& path : paths) {
    SCOPED_TRACE(path);
    io::Cloud plane = read(path);
    const std::vector<double> label = io::field_values(plane, io::find_field(plane, "label").value());
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < label.size(); ++i)
      if (label[i] == 1) rows.push_back(i);  // the table
    ASSERT_GT(rows.size(), 4000u);
    io::select_points(plane, rows);
    plane = middle_of(std::move(plane), kMiddle);
    ASSERT_TRUE(io::write_cloud(plane, at("in.pcd"), {}, {}).ok());
    const Ran ran = run({"denoise", "--force", "in.pcd", "out.pcd"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    EXPECT_LT(off_plane(io::positions(read(at("out.pcd")))), off_plane(io::positions(plane)));
  }
}

// A depth camera's steps are along no coordinate any more. Not the same points, for many of its distances
// tie, and the tree through them may go either way.
TEST_F(Scans, OfADepthCameraComeOutAlikeWhereTheyWereTurned) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  for (const auto& [path, part] : {std::pair(kFloorCrop, 0.6), std::pair(kBoxCrop, 0.2)}) {
    SCOPED_TRACE(path);
    const std::vector<double> xyz = io::positions(read(path));
    std::vector<double> finite;
    for (std::size_t i = 0; i < xyz.size(); i += 3)
      if (std::isfinite(xyz[i] + xyz[i + 1] + xyz[i + 2])) finite.insert(finite.end(), &xyz[i], &xyz[i] + 3);
    const Eigen::Map<const Eigen::Matrix3Xd> raw(finite.data(), 3, Eigen::Index(finite.size() / 3));
    ASSERT_GT(raw.cols(), 9000);
    const Eigen::Matrix3Xd here = denoised(raw), there = turn.transpose() * denoised(turn * raw);
    ASSERT_EQ(here.cols(), raw.cols());
    ASSERT_EQ(there.cols(), raw.cols());
    EXPECT_LT((there - here).norm(), part * (here - raw).norm());
  }
}

TEST_F(Scans, UtmDoublesKeepTheirPrecision) {
  // Two grids of 100 x 100 points with steps of 1 mm at UTM coordinates: float could not tell them apart.
  std::string header =
      "ply\nformat ascii 1.0\nelement vertex 10000\nproperty double x\nproperty double y\nproperty double "
      "z\nend_header\n";
  std::string rows;
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j)
      rows += std::to_string(500000 + 0.001 * i) + " " + std::to_string(4649776 + 0.001 * j) + " " +
              std::to_string((i * 7 + j * 3) % 5 * 0.0001) + "\n";
  put("utm.ply", header + rows);
  const Ran ran = run({"denoise", "--flow", "hc", "utm.ply", "out.ply"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto before = io::positions(read(at("utm.ply"))), after = io::positions(read(at("out.ply")));
  double rough = 0, smooth = 0;
  for (std::size_t i = 0; i < before.size(); i += 3) {
    EXPECT_NEAR(after[i], before[i], 0.002);
    EXPECT_NEAR(after[i + 1], before[i + 1], 0.002);
    rough += std::pow(before[i + 2] - 0.0002, 2);
    smooth += std::pow(after[i + 2] - 0.0002, 2);
  }
  EXPECT_LT(smooth, 0.5 * rough);
}

}  // namespace
}  // namespace rfsmooth::test
