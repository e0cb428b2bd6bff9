#include "solids.h"

#include <cmath>
#include <map>

namespace rfsmooth::bench {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// A grid of u x v cells given by `at(i, j)`, i in [0, u], j in [0, v].
template <class At>
rfs_mesh::Mesh grid(int u, int v, At&& at) {
  rfs_mesh::Mesh mesh;
  for (int i = 0; i <= u; ++i)
    for (int j = 0; j <= v; ++j) mesh.positions.push_back(at(i, j));
  const auto id = [v](int i, int j) { return Index(i * (v + 1) + j); };
  for (int i = 0; i < u; ++i)
    for (int j = 0; j < v; ++j) {
      mesh.faces.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
      mesh.faces.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
    }
  return mesh;
}

/// A polygon (given with the triangles of its inside) pulled up to `height`.
rfs_mesh::Mesh prism(const std::vector<Eigen::Vector2d>& outline, const std::vector<rfs_mesh::Face>& inside,
                     double height) {
  rfs_mesh::Mesh mesh;
  const auto n = Index(outline.size());
  for (const double z : {0.0, height})
    for (const auto& p : outline) mesh.positions.emplace_back(p[0], p[1], z);
  for (const auto& f : inside) {
    mesh.faces.push_back({f[0], f[2], f[1]});
    mesh.faces.push_back({f[0] + n, f[1] + n, f[2] + n});
  }
  for (Index i = 0; i < n; ++i) {
    const Index j = (i + 1) % n;
    mesh.faces.push_back({i, j, j + n});
    mesh.faces.push_back({i, j + n, i + n});
  }
  return mesh;
}

}  // namespace

rfs_mesh::Mesh box(double x, double y, double z) {
  return prism({{0, 0}, {x, 0}, {x, y}, {0, y}}, {{0, 1, 2}, {0, 2, 3}}, z);
}

rfs_mesh::Mesh l_part() {
  return prism({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {3, 4, 5}},
               1);
}

rfs_mesh::Mesh sphere() {
  const double g = (1 + std::sqrt(5.0)) / 2;
  rfs_mesh::Mesh mesh;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (auto& p : mesh.positions) p.normalize();
  constexpr int kRounds =
      7;  // 20 x 4^7 faces: edges of 0.009, so a facet's middle is 1.4e-5 inside the sphere
  for (int round = 0; round < kRounds; ++round) {
    std::map<std::pair<Index, Index>, Index> middle;
    const auto between = [&](Index a, Index b) {
      const auto [at, fresh] = middle.try_emplace(std::minmax(a, b), Index(mesh.positions.size()));
      if (fresh) mesh.positions.push_back((mesh.positions[a] + mesh.positions[b]).normalized());
      return at->second;
    };
    std::vector<rfs_mesh::Face> finer;
    for (const auto& [a, b, c] : mesh.faces) {
      const Index ab = between(a, b), bc = between(b, c), ca = between(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.faces = std::move(finer);
  }
  return mesh;
}

rfs_mesh::Mesh torus(double major, double minor) {
  constexpr int kAround = 512, kTube = 256;
  return grid(kAround, kTube, [&](int i, int j) {
    const double s = 2 * kPi * (i % kAround) / kAround, t = 2 * kPi * (j % kTube) / kTube;
    const double r = major + minor * std::cos(t);
    return Eigen::Vector3d(r * std::cos(s), r * std::sin(s), minor * std::sin(t));
  });
}

rfs_mesh::Mesh sheet(double width, int cells) {
  return grid(cells, cells, [&](int i, int j) {
    const double x = width * i / cells, y = width * j / cells;
    return Eigen::Vector3d(x, y, 0.1 * std::sin(2 * kPi * x / width) * std::cos(2 * kPi * y / width));
  });
}

}  // namespace rfsmooth::bench
