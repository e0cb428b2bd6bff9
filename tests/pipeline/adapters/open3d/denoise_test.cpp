#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/geometry/TriangleMesh.h>

#include <rfsmooth/open3d/denoise.h>

namespace rfsmooth::open3d {
namespace {

using ::open3d::geometry::PointCloud;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// 1,500 points about the unit sphere with noise of about half a spacing; colours, outward normals as good as
/// a noisy cloud has them, and covariances.
PointCloud noisy_sphere() {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal;
  const auto gauss = [&] {
    const double x = normal(engine), y = normal(engine), z = normal(engine);
    return Eigen::Vector3d(x, y, z);
  };
  PointCloud cloud;
  for (int i = 0; i < 1500; ++i) {
    const Eigen::Vector3d at = gauss().normalized();
    cloud.points_.push_back(at + 0.02 * gauss());
    cloud.normals_.push_back((at + 0.4 * gauss()).normalized());
    cloud.colors_.emplace_back(0.001 * (i % 1000), 0.5, 0.25);
  }
  cloud.EstimateCovariances();
  return cloud;
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same(const PointCloud& a, const PointCloud& b) {
  EXPECT_TRUE(same_bytes(a.points_, b.points_));
  EXPECT_TRUE(same_bytes(a.normals_, b.normals_));
  EXPECT_TRUE(same_bytes(a.colors_, b.colors_));
  EXPECT_TRUE(same_bytes(a.covariances_, b.covariances_));
}

/// Mean square distance to the unit sphere.
double error(const PointCloud& cloud) {
  double sum = 0;
  for (const auto& p : cloud.points_) sum += std::pow(p.norm() - 1, 2);
  return sum / double(cloud.points_.size());
}

/// Mean square sine of the angle between the normals and the sphere's.
double normal_error(const PointCloud& cloud) {
  double sum = 0;
  for (std::size_t i = 0; i < cloud.points_.size(); ++i)
    sum += cloud.normals_[i].cross(cloud.points_[i].normalized()).squaredNorm();
  return sum / double(cloud.points_.size());
}

TEST(Open3dDenoise, PointsMoveToTheSurfaceAndColoursStay) {
  const PointCloud before = noisy_sphere();
  PointCloud cloud = before;
  const auto report = denoise(cloud);
  ASSERT_TRUE(report.ok()) << report.error().message;
  EXPECT_EQ(report.value().points, 1500u);
  EXPECT_GT(report.value().moved, 1450u);
  EXPECT_LT(error(cloud), 0.5 * error(before));
  EXPECT_TRUE(same_bytes(cloud.colors_, before.colors_));
  EXPECT_EQ(cloud.points_.size(), before.points_.size());
}

TEST(Open3dDenoise, NormalsBecomeThoseOfTheSmoothedSurfaceOnTheirSide) {
  const PointCloud before = noisy_sphere();
  PointCloud outward = before, inward = before;
  for (auto& normal : inward.normals_) normal = -normal;
  ASSERT_TRUE(denoise(outward).ok());
  ASSERT_TRUE(denoise(inward).ok());
  EXPECT_LT(normal_error(outward), 0.2 * normal_error(before));
  for (std::size_t i = 0; i < outward.points_.size(); ++i) {
    EXPECT_NEAR(outward.normals_[i].norm(), 1, 1e-12) << i;
    EXPECT_GT(outward.normals_[i].dot(outward.points_[i]), 0) << i;
    EXPECT_EQ(inward.normals_[i], -outward.normals_[i]) << i;
  }
}

TEST(Open3dDenoise, NormalsWithoutACommonSideBecomeOutward) {
  PointCloud cloud = noisy_sphere();
  std::mt19937 coin(3);
  for (auto& normal : cloud.normals_)
    if (coin() % 2 == 0) normal = -normal;
  ASSERT_TRUE(denoise(cloud).ok());
  for (std::size_t i = 0; i < cloud.points_.size(); ++i)
    EXPECT_GT(cloud.normals_[i].dot(cloud.points_[i]), 0) << i;
}

TEST(Open3dDenoise, CovariancesAreThoseOfTheSmoothedPoints) {
  PointCloud cloud = noisy_sphere();
  ASSERT_TRUE(denoise(cloud).ok());
  PointCloud again = cloud;
  again.EstimateCovariances();
  EXPECT_TRUE(same_bytes(cloud.covariances_, again.covariances_));
}

TEST(Open3dDenoise, TurnedCovariancesKeepTheirSpreads) {
  PointCloud cloud = noisy_sphere();
  for (std::size_t i = 0; i < cloud.points_.size(); ++i) {  // generalised ICP's discs
    const Eigen::Vector3d n = cloud.normals_[i];
    cloud.covariances_[i] = Eigen::Matrix3d::Identity() - 0.999 * n * n.transpose();
  }
  ASSERT_TRUE(denoise(cloud, {}, {}, Covariances::turned).ok());
  for (std::size_t i = 0; i < cloud.points_.size(); ++i) {
    const Eigen::Vector3d n = cloud.normals_[i];
    const Eigen::Matrix3d expected = Eigen::Matrix3d::Identity() - 0.999 * n * n.transpose();
    EXPECT_LT((cloud.covariances_[i] - expected).norm(), 1e-9) << i;
  }
}

TEST(Open3dDenoise, TurnedCovariancesNeedNoNormals) {
  PointCloud with = noisy_sphere(), without = with;
  without.normals_.clear();
  ASSERT_TRUE(denoise(with, {}, {}, Covariances::turned).ok());
  ASSERT_TRUE(denoise(without, {}, {}, Covariances::turned).ok());
  EXPECT_TRUE(without.normals_.empty());
  for (std::size_t i = 0; i < with.points_.size(); ++i)
    EXPECT_LT((with.covariances_[i] - without.covariances_[i]).norm(), 1e-12) << i;
}

TEST(Open3dDenoise, RowsThatAreNotFiniteKeepAllTheyHaveAndInfluenceNothing) {
  const PointCloud clean = noisy_sphere();
  PointCloud alone = clean, mixed;
  for (std::size_t i = 0; i < clean.points_.size(); ++i) {
    if (i % 100 == 0) {
      mixed.points_.emplace_back(0.5, i % 200 == 0 ? kNan : -HUGE_VAL, 0.5);
      mixed.normals_.emplace_back(kNan, 0, 7);
      mixed.colors_.emplace_back(1, 2, 3);
      mixed.covariances_.push_back(Eigen::Matrix3d::Constant(9));
    }
    mixed.points_.push_back(clean.points_[i]);
    mixed.normals_.push_back(clean.normals_[i]);
    mixed.colors_.push_back(clean.colors_[i]);
    mixed.covariances_.push_back(clean.covariances_[i]);
  }
  const PointCloud before = mixed;
  ASSERT_TRUE(denoise(alone).ok());
  ASSERT_TRUE(denoise(mixed).ok());
  std::size_t k = 0;
  for (std::size_t i = 0; i < mixed.points_.size(); ++i) {
    if (!before.points_[i].allFinite()) {
      EXPECT_EQ(std::memcmp(&mixed.points_[i], &before.points_[i], 24), 0) << i;
      EXPECT_EQ(std::memcmp(&mixed.normals_[i], &before.normals_[i], 24), 0) << i;
      EXPECT_EQ(mixed.covariances_[i], before.covariances_[i]) << i;
      continue;
    }
    EXPECT_EQ(mixed.points_[i], alone.points_[k]) << i;
    EXPECT_EQ(mixed.normals_[i], alone.normals_[k]) << i;
    EXPECT_LT((mixed.covariances_[i] - alone.covariances_[k]).norm(), 1e-12) << i;
    ++k;
  }
}

TEST(Open3dDenoise, ACleanCloudKeepsItsNormalsToTheBit) {
  PointCloud cloud;
  for (int i = 0; i < 900; ++i) {
    cloud.points_.emplace_back(i % 30, int(i / 30), 0);
    cloud.normals_.emplace_back(0, 0.6, 0.8);
    cloud.covariances_.push_back(Eigen::Matrix3d::Constant(i));
  }
  const PointCloud before = cloud;
  const auto report = denoise(cloud);
  ASSERT_TRUE(report.ok());
  EXPECT_EQ(report.value().moved, 0u);
  expect_same(cloud, before);
}

TEST(Open3dDenoise, ArraysThatAreNotOnePerPointAreLeftAlone) {
  PointCloud cloud = noisy_sphere();
  cloud.normals_.resize(7);
  cloud.covariances_.resize(5);
  cloud.colors_.resize(3);
  const PointCloud before = cloud;
  ASSERT_TRUE(denoise(cloud).ok());
  EXPECT_TRUE(same_bytes(cloud.normals_, before.normals_));
  EXPECT_TRUE(same_bytes(cloud.covariances_, before.covariances_));
  EXPECT_TRUE(same_bytes(cloud.colors_, before.colors_));
}

TEST(Open3dDenoise, OutliersGoWithAllTheyHaveWhereAskedFor) {
  PointCloud cloud = noisy_sphere();
  cloud.points_[700] *= 3;
  PointCloud kept = cloud;
  const auto first = denoise(kept);
  ASSERT_TRUE(first.ok());
  EXPECT_EQ(first.value().outliers, 1u);
  EXPECT_EQ(kept.points_[700], cloud.points_[700]);
  EXPECT_EQ(kept.points_.size(), 1500u);

  PointCloud removed = cloud;
  DenoiseOptions options;
  options.outliers = Outliers::remove;
  ASSERT_TRUE(denoise(removed, options).ok());
  ASSERT_EQ(removed.points_.size(), 1499u);
  EXPECT_TRUE(removed.HasNormals() && removed.HasColors() && removed.HasCovariances());
  for (std::size_t i = 0; i < 1499; ++i) {
    EXPECT_EQ(removed.points_[i], kept.points_[i < 700 ? i : i + 1]) << i;
    EXPECT_EQ(removed.colors_[i], cloud.colors_[i < 700 ? i : i + 1]) << i;
    EXPECT_GT(removed.normals_[i].dot(removed.points_[i]), 0) << i;
  }
}

TEST(Open3dDenoise, ErrorsAndCancellingLeaveTheCloudAsItWas) {
  PointCloud empty;
  EXPECT_EQ(denoise(empty).error().code, ErrorCode::no_usable_points);

  const PointCloud before = noisy_sphere();
  PointCloud cloud = before;
  DenoiseOptions options;
  iterations(options.flow.flow) = -1;
  EXPECT_EQ(denoise(cloud, options).error().code, ErrorCode::usage);
  expect_same(cloud, before);

  for (const char* const stage : {"prepare", "smooth", "normals"}) {
    Context context;
    context.progress = [&](std::string_view at, double) { return at != stage; };
    const auto report = denoise(cloud, {}, context);
    ASSERT_FALSE(report.ok()) << stage;
    EXPECT_EQ(report.error().code, ErrorCode::cancelled) << stage;
    expect_same(cloud, before);
  }
}

TEST(Open3dDenoise, SameBytesForAnyNumberOfThreads) {
  PointCloud first;
  for (const int threads : {1, 2, 4, 7}) {
    PointCloud cloud = noisy_sphere();
    Context context;
    context.threads = threads;
    ASSERT_TRUE(denoise(cloud, {}, context).ok());
    if (threads == 1) first = cloud;
    expect_same(cloud, first);
  }
}

TEST(Open3dMesh, TheRoughMeshOfACloudIsThereToLookAt) {
  PointCloud cloud = noisy_sphere();
  cloud.points_[10] = cloud.points_[11];                // one vertex for the two
  cloud.points_[20] = Eigen::Vector3d::Constant(kNan);  // none
  const auto made = rough_mesh(cloud);
  ASSERT_TRUE(made.ok()) << made.error().message;
  const auto& mesh = *made.value();
  ASSERT_EQ(mesh.vertices_.size(), 1498u);
  ASSERT_TRUE(mesh.HasVertexColors());
  ASSERT_TRUE(mesh.HasVertexNormals());
  std::size_t row = 0;
  for (std::size_t i = 0; i < cloud.points_.size(); ++i) {
    if (i == 11 || i == 20) continue;
    EXPECT_EQ(mesh.vertices_[row], cloud.points_[i]) << i;
    EXPECT_EQ(mesh.vertex_colors_[row], cloud.colors_[i]) << i;
    EXPECT_GT(mesh.vertex_normals_[row].dot(cloud.points_[i]), 0) << i;
    ++row;
  }
  EXPECT_GT(mesh.triangles_.size(), 2500u);  // 2 n of a closed surface, but for holes
  std::size_t outward = 0;
  for (const auto& t : mesh.triangles_) {
    const Eigen::Vector3d &a = mesh.vertices_[std::size_t(t[0])], &b = mesh.vertices_[std::size_t(t[1])],
                          &c = mesh.vertices_[std::size_t(t[2])];
    outward += (b - a).cross(c - a).dot(a + b + c) > 0;
  }
  EXPECT_GT(double(outward), 0.99 * double(mesh.triangles_.size()));
}

TEST(Open3dMesh, AMeshKeepsItsVerticesAndTurnsToItsNormals) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  mesh.faces = {{0, 1, 2}, {1, 2, 3}};  // the two disagree
  const auto as_is = to_triangle_mesh(mesh);
  EXPECT_EQ(as_is->vertices_, mesh.positions);
  ASSERT_EQ(as_is->triangles_.size(), 2u);
  EXPECT_EQ(as_is->triangles_[1], Eigen::Vector3i(1, 2, 3));
  EXPECT_FALSE(as_is->HasVertexNormals());

  const Positions up(4, Eigen::Vector3d::UnitZ());
  const auto turned = to_triangle_mesh(mesh, up);
  EXPECT_EQ(turned->triangles_[0], Eigen::Vector3i(0, 1, 2));
  EXPECT_EQ(turned->triangles_[1], Eigen::Vector3i(1, 3, 2));
  EXPECT_EQ(turned->vertex_normals_, up);
  EXPECT_THROW(to_triangle_mesh(mesh, Positions(3)), std::invalid_argument);
}

TEST(Open3dMesh, NothingToConnectIsAnError) {
  EXPECT_EQ(rough_mesh(PointCloud()).error().code, ErrorCode::no_usable_points);
}

}  // namespace
}  // namespace rfsmooth::open3d
