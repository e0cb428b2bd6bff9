#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include <rfsmooth/reconstruct.h>

using namespace rfsmooth;

namespace {

constexpr double kFar = 5e5;  // a scan in map coordinates

/// A grid in the plane, far from the origin, with a row that is not finite and one that comes twice.
std::vector<double> grid_rows(int width, int height) {
  std::vector<double> xyz = {std::nan(""), 0, 0};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) xyz.insert(xyz.end(), {kFar + x, y + 0.5, 0});
  xyz.insert(xyz.end(), {kFar, 0.5, 0});
  return xyz;
}

std::vector<double> grid_rows(int side) {
  return grid_rows(side, side);
}

/// Joins every point to its right and upper neighbour, and those to theirs but at the last corner.
Result<Mesh> join_grid(const SurfaceInput& input, const Context& context) {
  Mesh mesh;
  mesh.positions = input.points;
  const auto at = [&](const Eigen::Vector3d& p) {
    for (Index i = 0; i < input.points.size(); ++i)
      if ((input.points[i] - p).norm() < 0.1) return i;
    return kNone;
  };
  for (Index i = 0; i < input.points.size(); ++i) {
    const Index right = at(input.points[i] + Eigen::Vector3d(1, 0, 0)),
                up = at(input.points[i] + Eigen::Vector3d(0, 1, 0));
    if (right == kNone || up == kNone) continue;
    mesh.faces.push_back({i, right, up});
    const Index across = at(input.points[i] + Eigen::Vector3d(1, 1, 0));
    if (at(input.points[across] + Eigen::Vector3d(1, 0, 0)) != kNone ||
        at(input.points[across] + Eigen::Vector3d(0, 1, 0)) != kNone)
      mesh.faces.push_back({right, across, up});
  }
  rebuild_adjacency(mesh, context);
  return mesh;
}

ReconstructOptions without_denoising() {
  ReconstructOptions options;
  options.denoise = false;
  options.fill_holes.value = 0;
  return options;
}

TEST(Reconstruct, VerticesKnowTheirRowsAndLieInTheWorld) {
  const std::vector<double> xyz = grid_rows(5);
  const auto made = reconstruct(xyz, without_denoising(), {"join", false, join_grid}, {});
  ASSERT_TRUE(made.ok()) << made.error().message;
  const Reconstruction& surface = made.value();
  EXPECT_NEAR(surface.report.spacing, 1, 1e-9);
  EXPECT_EQ(surface.mesh.positions.size(), 24u) << "the last corner has no face";
  ASSERT_EQ(surface.row.size(), 24u);
  for (std::size_t v = 0; v < 24; ++v)
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(surface.mesh.positions[v][Eigen::Index(axis)], xyz[3 * surface.row[v] + axis], 1e-9);
  EXPECT_EQ(surface.report.topology.components, 1u);
}

TEST(Reconstruct, NoiseIsTakenOutFirst) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> noise(0, 0.2);
  std::vector<double> xyz;
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 12; ++x) xyz.insert(xyz.end(), {double(x), double(y), noise(engine)});
  const auto height = [](const ReconstructOptions& options, const std::vector<double>& rows) {
    double sum = 0;
    const auto made = reconstruct(rows, options,
                                  {"all", false,
                                   [](const SurfaceInput& input, const Context&) {
                                     Mesh mesh;
                                     mesh.positions = input.points;
                                     for (Index i = 0; i + 2 < input.points.size(); ++i)
                                       mesh.faces.push_back({i, i + 1, i + 2});
                                     return Result<Mesh>(mesh);
                                   }},
                                  {});
    for (const auto& p : made.value().mesh.positions) sum += p.z() * p.z();
    return sum;
  };
  ReconstructOptions denoising;
  denoising.fill_holes.value = 0;
  EXPECT_LT(height(denoising, xyz), 0.5 * height(without_denoising(), xyz));
}

TEST(Reconstruct, ARibbonIsOpenHoweverNarrow) {
  ReconstructOptions options;
  options.denoise = false;  // its edges across are shorter than what fills holes
  const auto made = reconstruct(grid_rows(5, 30), options, {"join", false, join_grid}, {});
  ASSERT_TRUE(made.ok()) << made.error().message;
  EXPECT_EQ(made.value().report.filled, 0u);
  EXPECT_FALSE(made.value().report.topology.closed_manifold());
  EXPECT_EQ(made.value().report.topology.boundary_loops, 1u);
}

TEST(Reconstruct, NormalsFaceTheViewpoint) {
  for (const double side : {1.0, -1.0}) {
    ReconstructOptions options = without_denoising();
    options.normals.viewpoint = Eigen::Vector3d(kFar + 3, 3, side * 50);
    const auto look = [&](const SurfaceInput& input, const Context& context) {
      for (const Eigen::Vector3d& normal : input.normals) EXPECT_GT(side * normal.z(), 0.99);
      return join_grid(input, context);
    };
    ASSERT_TRUE(reconstruct(grid_rows(8), options, {"join", false, look}, {}).ok());
  }
  ReconstructOptions nowhere = without_denoising();
  nowhere.normals.viewpoint = Eigen::Vector3d(std::nan(""), 0, 0);
  EXPECT_EQ(reconstruct(grid_rows(8), nowhere, {"join", false, join_grid}, {}).error().code,
            ErrorCode::usage);
}

TEST(Reconstruct, OutliersAreLeftOutOrSmoothedAndNothingElse) {
  std::vector<double> xyz = grid_rows(20);
  xyz.insert(xyz.end(), {kFar + 10, 10, 30});
  const auto points = [&](Outliers outliers) {
    std::size_t given = 0;
    const auto join = [&](const SurfaceInput& input, const Context&) {
      given = input.points.size();
      Mesh mesh;
      mesh.positions = input.points;
      for (Index i = 0; i + 2 < given; ++i) mesh.faces.push_back({i, i + 1, i + 2});
      return Result<Mesh>(mesh);
    };
    ReconstructOptions options;
    options.fill_holes.value = 0;
    options.denoising.outliers = outliers;
    const auto made = reconstruct(xyz, options, {"all", false, join}, {});
    EXPECT_EQ(made.ok(), given > 0);
    if (!made.ok()) {
      EXPECT_EQ(made.error().code, ErrorCode::usage) << made.error().message;
    }
    return given;
  };
  EXPECT_EQ(ReconstructOptions().denoising.outliers, Outliers::remove);
  EXPECT_EQ(points(Outliers::remove), 400u);
  EXPECT_EQ(points(Outliers::smooth), 401u);
  EXPECT_EQ(points(Outliers::keep), 0u) << "a surface has no place beside it";
  EXPECT_EQ(points(Outliers::mark), 0u);
}

TEST(Reconstruct, ErrorsOfTheMethodAndTheCloudComeThrough) {
  const auto fails = [](const SurfaceInput&, const Context&) -> Result<Mesh> {
    return Error{ErrorCode::no_usable_points, "no surface here"};
  };
  const auto failed = reconstruct(grid_rows(3), without_denoising(), {"fails", false, fails}, {});
  ASSERT_FALSE(failed.ok());
  EXPECT_EQ(failed.error().message, "no surface here");
  const auto empty = [](const SurfaceInput&, const Context&) -> Result<Mesh> { return Mesh{}; };
  EXPECT_EQ(reconstruct(grid_rows(3), without_denoising(), {"empty", false, empty}, {}).error().code,
            ErrorCode::no_usable_points);
  const double nan = std::nan("");
  EXPECT_EQ(reconstruct({nan, nan, nan}, {}, {"join", false, join_grid}, {}).error().code,
            ErrorCode::no_usable_points);
  EXPECT_EQ(reconstruct({0, 0, 0, 1, 0, 0}, {}, {"join", false, join_grid}, {}).error().code,
            ErrorCode::no_usable_points);
}

}  // namespace
