#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <rfsmooth/compare.h>

#include "tests/support/threads.h"

using namespace rfsmooth;

namespace {

/// Longitude-latitude sphere of radius 1: closed, fine enough that its area and volume are the sphere's
/// within 0.2 %.
struct SphereMesh {
  std::vector<double> xyz;
  std::vector<Face> faces;
  SphereMesh() {
    const double pi = std::acos(-1.0);
    const Index rows = 80, columns = 160;
    xyz = {0, 0, 1, 0, 0, -1};
    for (Index i = 1; i < rows; ++i)
      for (Index j = 0; j < columns; ++j) {
        const double t = pi * i / rows, u = 2 * pi * j / columns;
        xyz.insert(xyz.end(), {std::sin(t) * std::cos(u), std::sin(t) * std::sin(u), std::cos(t)});
      }
    const auto at = [&](Index i, Index j) { return 2 + (i - 1) * columns + j % columns; };
    for (Index j = 0; j < columns; ++j) {
      faces.push_back({0, at(1, j), at(1, j + 1)});
      faces.push_back({1, at(rows - 1, j + 1), at(rows - 1, j)});
      for (Index i = 1; i + 1 < rows; ++i) {
        faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    }
  }
  MeshView view() const { return {xyz.data(), xyz.size() / 3, faces.data(), faces.size()}; }
};

std::vector<double> random_sphere(std::size_t n, double radius, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<double> xyz;
  while (xyz.size() < 3 * n) {
    const double x = normal(engine), y = normal(engine), z = normal(engine),
                 r = std::sqrt(x * x + y * y + z * z);
    if (r > 1e-3) xyz.insert(xyz.end(), {radius * x / r, radius * y / r, radius * z / r});
  }
  return xyz;
}

CloudView view(const std::vector<double>& xyz) {
  return {xyz.data(), xyz.size() / 3};
}

Truth mesh_truth(const SphereMesh& sphere) {
  Truth truth;
  truth.mesh = sphere.view();
  return truth;
}

Truth cloud_truth(const std::vector<double>& xyz) {
  Truth truth;
  truth.cloud = view(xyz);
  return truth;
}

CompareReport measured(const std::vector<double>& xyz, const Truth& truth) {
  return compare(view(xyz), truth, {}, {}).value();
}

TEST(Compare, ALargerSphereIsOffByTheDifferenceOfRadii) {
  const SphereMesh sphere;
  for (const double radius : {0.9, 1.05}) {
    const CompareReport report = measured(random_sphere(2000, radius, 1), mesh_truth(sphere));
    const Measures& m = report.own_units;
    const double off = std::abs(radius - 1);
    EXPECT_TRUE(report.truth_closed);
    EXPECT_NEAR(*m.p2s_root, off, 1e-3);
    EXPECT_NEAR(*m.p2s_mean_square, off * off, 2e-4);
    EXPECT_NEAR(*m.p2s_max, off, 1e-3);
    EXPECT_NEAR(*m.mean_signed_distance, radius - 1, 1e-3);
    EXPECT_NEAR(*m.shrinkage, 3 * (radius - 1), 5e-3) << "area / volume of the unit sphere is 3";
    EXPECT_FALSE(m.chamfer) << "there is no clean cloud";
  }
}

TEST(Compare, ACloudAgainstItselfIsZero) {
  const std::vector<double> xyz = random_sphere(1000, 1, 2);
  const Measures m = measured(xyz, cloud_truth(xyz)).own_units;
  EXPECT_EQ(*m.chamfer, 0);
  EXPECT_FALSE(m.p2s_root) << "there is no true surface";
  EXPECT_GT(*m.evenness, 0.3) << "random points are uneven: 0.52 for a Poisson process in the plane";
  EXPECT_LT(*m.evenness, 0.7);
}

TEST(Compare, ChamferAndEvennessEqualBruteForce) {
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  std::vector<double> a(3 * 300), b(3 * 200);
  for (double& v : a) v = coordinate(engine);
  for (double& v : b) v = coordinate(engine);
  const auto squared = [](const double* p, const double* q) {
    return (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]);
  };
  const auto nearest = [&](const double* p, const std::vector<double>& to) {
    double best = INFINITY;
    for (std::size_t j = 0; j < to.size(); j += 3)
      if (&to[j] != p) best = std::min(best, squared(p, &to[j]));
    return best;
  };
  double to_clean = 0, from_clean = 0, sum = 0, sum_of_squares = 0;
  for (std::size_t i = 0; i < a.size(); i += 3) {
    to_clean += nearest(&a[i], b) / 300;
    const double d = std::sqrt(nearest(&a[i], a));
    sum += d;
    sum_of_squares += d * d;
  }
  for (std::size_t i = 0; i < b.size(); i += 3) from_clean += nearest(&b[i], a) / 200;
  const double mean = sum / 300;
  const Measures m = measured(a, cloud_truth(b)).own_units;
  EXPECT_NEAR(*m.to_clean, to_clean, 1e-12);
  EXPECT_NEAR(*m.from_clean, from_clean, 1e-12);
  EXPECT_NEAR(*m.chamfer, to_clean + from_clean, 1e-12);
  EXPECT_NEAR(*m.spacing, mean, 1e-12);
  EXPECT_NEAR(*m.evenness, std::sqrt(sum_of_squares / 300 - mean * mean) / mean, 1e-9);
}

TEST(Compare, P2mOfOnePointAndOneTriangle) {
  const std::vector<double> vertices = {0, 0, 0, 3, 0, 0, 0, 3, 0, 9, 9, 9, 9, 9, 9, 9, 9, 9};
  const std::vector<Face> faces = {{0, 1, 2}, {3, 4, 5}};  // the second one is a point
  Truth truth;
  truth.mesh = MeshView{vertices.data(), 6, faces.data(), 2};
  const std::vector<double> point = {1, 1, 2};
  const CompareReport report = measured(point, truth);
  EXPECT_DOUBLE_EQ(*report.own_units.p2s_mean_square, 4);
  EXPECT_DOUBLE_EQ(*report.own_units.faces_to_cloud, (4 + 64 + 64 + 49) / 2.0)
      << "faces count alike, whatever their area";
  EXPECT_DOUBLE_EQ(*report.own_units.p2m, 4 + 181 / 2.0);
  EXPECT_FALSE(report.truth_closed);
  EXPECT_FALSE(report.own_units.shrinkage);
  EXPECT_FALSE(report.own_units.evenness) << "one point has no nearest other point";
}

TEST(Compare, NormalErrorIsTheAngle) {
  const SphereMesh sphere;
  const std::vector<double> xyz = random_sphere(500, 1, 4);
  std::vector<double> inward = xyz;
  for (double& v : inward) v = -v;
  CompareOptions options;
  EXPECT_LT(*compare({xyz.data(), 500, inward.data()}, mesh_truth(sphere), options, {})
                 .value()
                 .own_units.normal_error,
            2);
  options.signed_normals = true;
  EXPECT_GT(*compare({xyz.data(), 500, inward.data()}, mesh_truth(sphere), options, {})
                 .value()
                 .own_units.normal_error,
            178);
  Truth clean;
  clean.cloud = CloudView{xyz.data(), 500, xyz.data()};
  EXPECT_NEAR(*compare({xyz.data(), 500, inward.data()}, clean, options, {}).value().own_units.normal_error,
              180, 1e-9);
}

TEST(Compare, UnitSphereFiguresDoNotDependOnScaleOrPlace) {
  const SphereMesh sphere;
  const std::vector<double> xyz = random_sphere(500, 1.03, 5);
  const CompareReport first = measured(xyz, mesh_truth(sphere));
  const Measures expected = on_unit_sphere(first.own_units, first.radius);
  SphereMesh far = sphere;
  std::vector<double> moved = xyz;
  for (double& v : far.xyz) v = 1000 * v + 5e5;
  for (double& v : moved) v = 1000 * v + 5e5;
  const CompareReport second = measured(moved, mesh_truth(far));
  EXPECT_NEAR(second.radius, 1000, 1e-6);
  const Measures found = on_unit_sphere(second.own_units, second.radius);
  EXPECT_NEAR(*found.p2s_mean_square, *expected.p2s_mean_square, 1e-9);
  EXPECT_NEAR(*found.p2s_max, *expected.p2s_max, 1e-9);
  EXPECT_NEAR(*found.p2m, *expected.p2m, 1e-9);
  EXPECT_NEAR(*found.shrinkage, *expected.shrinkage, 1e-9);
  EXPECT_NEAR(*found.evenness, *expected.evenness, 1e-9);
}

TEST(Compare, SameBitsForAnyNumberOfThreads) {
  const SphereMesh sphere;
  const std::vector<double> xyz = random_sphere(3000, 1.01, 6), clean = random_sphere(2500, 1, 7);
  Truth truth = mesh_truth(sphere);
  truth.cloud = view(clean);
  const auto with_threads = [&](int threads) {
    Context context;
    context.threads = threads;
    return compare(view(xyz), truth, {}, context).value().own_units;
  };
  const Measures one = with_threads(1);
  for (const int threads : test::several_threads()) {
    const Measures m = with_threads(threads);
    EXPECT_EQ(m.p2s_mean_square, one.p2s_mean_square);
    EXPECT_EQ(m.chamfer, one.chamfer);
    EXPECT_EQ(m.p2m, one.p2m);
    EXPECT_EQ(m.mean_signed_distance, one.mean_signed_distance);
    EXPECT_EQ(m.evenness, one.evenness);
  }
}

TEST(Compare, NonFiniteRowsAreLeftOut) {
  std::vector<double> xyz = random_sphere(100, 1, 8);
  const Measures expected = measured(xyz, cloud_truth(xyz)).own_units;
  std::vector<double> gaps = xyz;
  gaps.insert(gaps.begin() + 30, {NAN, 0, 0});
  gaps.insert(gaps.end(), {0, INFINITY, 0});
  const CompareReport report = measured(gaps, cloud_truth(gaps));
  EXPECT_EQ(report.points, 102u);
  EXPECT_EQ(report.finite, 100u);
  EXPECT_EQ(report.truth_points, 100u);
  EXPECT_EQ(report.own_units.chamfer, expected.chamfer);
}

TEST(Compare, SaysWhatIsMissing) {
  const SphereMesh sphere;
  const std::vector<double> xyz = random_sphere(10, 1, 9), nan(9, NAN);
  EXPECT_EQ(compare(view(nan), mesh_truth(sphere), {}, {}).error().code, ErrorCode::no_usable_points);
  EXPECT_EQ(compare(view(xyz), cloud_truth(nan), {}, {}).error().code, ErrorCode::no_usable_points);
  SphereMesh broken = sphere;
  broken.faces[7][1] = 1u << 30;
  EXPECT_EQ(compare(view(xyz), mesh_truth(broken), {}, {}).error().code, ErrorCode::input_unreadable);
  broken = sphere;
  broken.faces.clear();
  EXPECT_EQ(compare(view(xyz), mesh_truth(broken), {}, {}).error().code, ErrorCode::no_usable_points);
  EXPECT_THROW((void)compare(view(xyz), {}, {}, {}), std::invalid_argument);
}

TEST(Compare, CanBeCancelled) {
  const SphereMesh sphere;
  std::atomic<bool> stop{true};
  Context context;
  context.stop = &stop;
  EXPECT_EQ(compare(view(random_sphere(10, 1, 10)), mesh_truth(sphere), {}, context).error().code,
            ErrorCode::cancelled);
}

}  // namespace
