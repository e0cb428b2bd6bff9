#include "smoothing/operators/surface.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <rfsmooth/flow.h>

#include "rfs_mesh/measure.h"
#include "tests/support/meshes.h"

using namespace rfsmooth;
using namespace rfsmooth::smoothing;
using Eigen::Vector3d;
using rfsmooth::Mesh;

namespace {

/// The largest angle between the lines along two sets of normals, in radians.
double largest_angle(const Positions& a, const Positions& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, std::asin(std::min(1.0, a[i].cross(b[i]).norm())));
  return largest;
}

std::vector<Mesh> oriented_parts() {
  Mesh noisy = support::icosphere(3);
  support::add_noise(noisy, 0.5 * support::mean_edge(noisy), 3);
  return {support::octahedron(), support::cube(1), support::cube(3), support::bracket(), noisy,
          support::bowl(4)};
}

TEST(UnsignedNormals, AreTheNormalsOfTheFileWhereItsFacesAgree) {
  for (const Mesh& mesh : oriented_parts())
    EXPECT_LT(
        largest_angle(unsigned_normals(mesh, fans_of(mesh, {}), {}), rfs_mesh::vertex_normals(mesh, {})),
        1e-12);
}

TEST(UnsignedNormals, DoNotDependOnTheOrderOfTheCornersOfAnyFace) {
  for (const Mesh& mesh : support::all_small()) {
    Mesh mixed = mesh;
    for (std::size_t f = 0; f < mixed.faces.size(); f += 3) std::swap(mixed.faces[f][1], mixed.faces[f][2]);
    const Positions a = unsigned_normals(mesh, fans_of(mesh, {}), {});
    const Positions b = unsigned_normals(mixed, fans_of(mixed, {}), {});
    for (std::size_t i = 0; i < a.size(); ++i)
      EXPECT_LT(std::min((a[i] - b[i]).norm(), (a[i] + b[i]).norm()), 1e-12);
  }
}

TEST(UnsignedNormals, TheSidesOfTheFacesTellWhichNormalsAreOnOneSide) {
  for (Mesh mesh : oriented_parts()) {
    for (std::size_t f = 0; f < mesh.faces.size(); f += 3) std::swap(mesh.faces[f][1], mesh.faces[f][2]);
    const Fans fans = fans_of(mesh, {});
    std::vector<char> against;
    const Positions normal = unsigned_normals(mesh, fans, {}, &against);
    for (Index i = 0; i < normal.size(); ++i) {
      Vector3d sum = Vector3d::Zero();
      for (Index k = fans.faces.start[i]; k < fans.faces.start[i + 1]; ++k)
        sum += (against[k] != 0 ? -1 : 1) *
               rfs_mesh::face_cross(mesh.positions, mesh.faces[fans.faces.items[k]]);
      EXPECT_LT((sum.normalized() - normal[i]).norm(), 1e-12);
    }
  }
}

class EveryFlowOnParts : public testing::TestWithParam<AnyFlow> {};
INSTANTIATE_TEST_SUITE_P(Flows, EveryFlowOnParts, testing::ValuesIn([] {
                           std::vector<AnyFlow> all;
                           for (const AnyFlow& any : flows())
                             if (!std::holds_alternative<AutomaticOptions>(any)) all.push_back(any);
                           return all;
                         }()),
                         [](const auto& flow) {
                           std::string name(name_of(flow.param));
                           for (char& c : name)
                             if (c == '-') c = '_';
                           return name;
                         });

/// The flow's defaults, with every solve down to rounding.
FlowOptions exact(const AnyFlow& flow) {
  FlowOptions o{flow};
  FlowOptions::describe(o, [](const OptionInfo& info, auto& value) {
    if constexpr (std::is_same_v<decltype(value), double&>)
      if (info.name == "tolerance") value = 1e-12;
  });
  return o;
}

/// Right angles are where rounding would decide, if anything were left to it: the smallest turn is enough.
TEST_P(EveryFlowOnParts, CommutesWithRigidMotion) {
  const FlowOptions o = exact(GetParam());
  for (const Mesh& start : {support::octahedron(), support::cube(1), support::cube(3), support::bracket()}) {
    Mesh here = start;
    ASSERT_TRUE(smooth(here, o, {}).ok());
    for (const double angle : {1e-12, 1e-3, 0.25 * M_PI, 0.7}) {
      const Eigen::Matrix3d R =
          Eigen::AngleAxisd(angle, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
      Mesh there = start;
      for (Vector3d& p : there.positions) p = R * p;
      ASSERT_TRUE(smooth(there, o, {}).ok());
      Positions expected = here.positions;
      for (Vector3d& p : expected) p = R * p;
      EXPECT_LT(support::rms_distance(there.positions, expected), 1e-8 * support::mean_edge(start))
          << start.positions.size() << " vertices, turned by " << angle;
    }
  }
}

/// Curvature flows read normals only up to their side, so a file with faces in any order gives the same.
TEST_P(EveryFlowOnParts, TheOrderOfTheCornersOfFacesDoesNotMatterOnClosedParts) {
  const FlowOptions o = exact(GetParam());
  for (Mesh mesh : {support::octahedron(), support::cube(3), support::bracket()}) {
    support::add_noise(mesh, 0.1 * support::mean_edge(mesh), 5);
    Mesh mixed = mesh;
    for (std::size_t f = 0; f < mixed.faces.size(); f += 3) std::swap(mixed.faces[f][1], mixed.faces[f][2]);
    ASSERT_TRUE(smooth(mesh, o, {}).ok());
    ASSERT_TRUE(smooth(mixed, o, {}).ok());
    EXPECT_LT(support::rms_distance(mesh.positions, mixed.positions), 1e-9 * support::mean_edge(mesh));
  }
}

}  // namespace
