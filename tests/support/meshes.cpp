#include "tests/support/meshes.h"

#include <cmath>
#include <map>
#include <random>
#include <set>

#include <Eigen/Geometry>

namespace rfsmooth::support {

using Eigen::Vector3d;
using rfsmooth::Face;
using rfsmooth::Mesh;

namespace {

constexpr double kPi = 3.14159265358979323846;

Mesh finished(Mesh mesh) {
  rebuild_adjacency(mesh, {});
  return mesh;
}

/// Adds the two triangles of the cell a b / c d (a-b one ring, c-d the next), counter-clockwise.
void add_cell(Mesh& mesh, Index a, Index b, Index c, Index d) {
  mesh.faces.push_back({a, b, d});
  mesh.faces.push_back({a, d, c});
}

/// The surface of a solid made of unit cells, named by their lowest corners.
Mesh surface_of(const std::set<std::array<int, 3>>& cells) {
  Mesh mesh;
  std::map<std::array<int, 3>, Index> number;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [it, fresh] = number.try_emplace(at, Index(mesh.positions.size()));
    if (fresh) mesh.positions.emplace_back(at[0], at[1], at[2]);
    return it->second;
  };
  for (const std::array<int, 3>& cell : cells)
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        std::array<int, 3> beyond = cell, a = cell;
        beyond[axis] += side == 1 ? 1 : -1;
        if (cells.count(beyond) > 0) continue;
        a[axis] += side;
        std::array<int, 3> b = a, c = a, d = a;
        // Along u then v turns outward on the upper side, v then u on the lower.
        const std::size_t u = (axis + (side == 1 ? 1 : 2)) % 3, v = (axis + (side == 1 ? 2 : 1)) % 3;
        ++b[u];
        ++c[v];
        ++d[u], ++d[v];
        add_cell(mesh, vertex(a), vertex(b), vertex(c), vertex(d));
      }
  return finished(std::move(mesh));
}

}  // namespace

Mesh icosphere(int levels) {
  const double t = (1 + std::sqrt(5.0)) / 2;
  Mesh mesh;
  mesh.positions = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                    {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  mesh.faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (Vector3d& p : mesh.positions) p.normalize();
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<Index, Index>, Index> middle;
    const auto midpoint = [&](Index a, Index b) {
      const auto [it, fresh] = middle.try_emplace(std::minmax(a, b), Index(mesh.positions.size()));
      if (fresh) mesh.positions.push_back((mesh.positions[a] + mesh.positions[b]).normalized());
      return it->second;
    };
    std::vector<Face> finer;
    for (const Face& f : mesh.faces) {
      const Index a = midpoint(f[0], f[1]), b = midpoint(f[1], f[2]), c = midpoint(f[2], f[0]);
      finer.insert(finer.end(), {Face{f[0], a, c}, Face{f[1], b, a}, Face{f[2], c, b}, Face{a, b, c}});
    }
    mesh.faces = std::move(finer);
  }
  return finished(std::move(mesh));
}

Mesh torus(int around, int along, double minor) {
  Mesh mesh;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < along; ++j) {
      const double u = 2 * kPi * i / around, v = 2 * kPi * j / along, r = 1 + minor * std::cos(v);
      mesh.positions.emplace_back(r * std::cos(u), r * std::sin(u), minor * std::sin(v));
    }
  const auto at = [&](int i, int j) { return Index((i % around) * along + j % along); };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < along; ++j) add_cell(mesh, at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1));
  return finished(std::move(mesh));
}

Mesh octahedron() {
  Mesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  return finished(std::move(mesh));
}

Mesh cube(int cells) {
  std::set<std::array<int, 3>> solid;
  for (int x = 0; x < cells; ++x)
    for (int y = 0; y < cells; ++y)
      for (int z = 0; z < cells; ++z) solid.insert({x, y, z});
  Mesh mesh = surface_of(solid);
  for (Vector3d& p : mesh.positions) p = 2.0 / cells * p - Vector3d::Ones();
  return mesh;
}

Mesh bracket() {
  std::set<std::array<int, 3>> solid;
  for (int x = 0; x < 6; ++x)
    for (int y = 0; y < 4; ++y)
      for (int z = 0; z < 6; ++z)
        if ((x < 2 || z < 2) && !(x >= 3 && x < 5 && y >= 1 && y < 3)) solid.insert({x, y, z});
  return surface_of(solid);
}

Mesh bowl(int half) {
  Mesh mesh = grid(2 * half + 1, 2 * half + 1);
  for (Vector3d& p : mesh.positions) {
    p -= Vector3d(half, half, 0);
    p.z() = (p.x() * p.x() + p.y() * p.y()) / 8;
  }
  return mesh;
}

Mesh moebius(int around) {
  Mesh mesh;
  for (int i = 0; i < around; ++i)
    for (const double w : {-0.3, 0.3}) {
      const double u = 2 * kPi * i / around, r = 1 + w * std::cos(u / 2);
      mesh.positions.emplace_back(r * std::cos(u), r * std::sin(u), w * std::sin(u / 2));
    }
  const auto at = [&](int i, int side) {
    return i < around ? Index(2 * i + side)
                      : Index(1 - side);  // around the strip once, the sides are swapped
  };
  for (int i = 0; i < around; ++i) add_cell(mesh, at(i, 0), at(i + 1, 0), at(i, 1), at(i + 1, 1));
  return finished(std::move(mesh));
}

Mesh finned_sphere(int levels) {
  Mesh mesh = icosphere(levels);
  const Face first = mesh.faces.front();
  mesh.faces.push_back({first[0], first[1], Index(mesh.positions.size())});
  mesh.positions.push_back(1.3 * (mesh.positions[first[0]] + mesh.positions[first[1]]) / 2);
  return finished(std::move(mesh));
}

Mesh grid(int columns, int rows, bool equilateral) {
  Mesh mesh;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c)
      mesh.positions.emplace_back(equilateral ? c - 0.5 * r : c, equilateral ? r * std::sqrt(0.75) : r, 0);
  const auto at = [&](int c, int r) { return Index(r * columns + c); };
  for (int r = 0; r + 1 < rows; ++r)
    for (int c = 0; c + 1 < columns; ++c)
      add_cell(mesh, at(c, r), at(c + 1, r), at(c, r + 1), at(c + 1, r + 1));
  return finished(std::move(mesh));
}

Mesh cylinder(int around, int rings, double step) {
  Mesh mesh;
  for (int r = 0; r < rings; ++r)
    for (int i = 0; i < around; ++i) {
      const double u = 2 * kPi * (i + 0.5 * r) / around;
      mesh.positions.emplace_back(std::cos(u), std::sin(u), r * step);
    }
  const auto at = [&](int i, int r) { return Index(r * around + (i + around) % around); };
  for (int r = 0; r + 1 < rings; ++r)
    for (int i = 0; i < around; ++i) {
      mesh.faces.push_back({at(i, r), at(i + 1, r), at(i, r + 1)});
      mesh.faces.push_back({at(i + 1, r), at(i + 1, r + 1), at(i, r + 1)});
    }
  return finished(std::move(mesh));
}

Mesh two_density_sphere(int around) {
  Mesh mesh;
  mesh.positions.emplace_back(0, 0, 1);
  std::vector<double> latitudes;  // from the top; the lower half has twice as many circles
  const int half = around / 4;
  for (int k = 1; k < half; ++k) latitudes.push_back(0.5 * kPi * k / half);
  for (int k = 0; k < 2 * half; ++k) latitudes.push_back(0.5 * kPi * (1 + 0.5 * k / half));
  for (const double v : latitudes)
    for (int i = 0; i < around; ++i) {
      const double u = 2 * kPi * i / around;
      mesh.positions.emplace_back(std::sin(v) * std::cos(u), std::sin(v) * std::sin(u), std::cos(v));
    }
  mesh.positions.emplace_back(0, 0, -1);
  const int circles = int(latitudes.size());
  const auto at = [&](int i, int k) { return Index(1 + k * around + i % around); };
  for (int i = 0; i < around; ++i) {
    mesh.faces.push_back({0, at(i, 0), at(i + 1, 0)});
    for (int k = 0; k + 1 < circles; ++k)
      add_cell(mesh, at(i, k + 1), at(i + 1, k + 1), at(i, k), at(i + 1, k));
    mesh.faces.push_back({Index(mesh.positions.size() - 1), at(i + 1, circles - 1), at(i, circles - 1)});
  }
  return finished(std::move(mesh));
}

Mesh non_manifold_fan() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 1}};
  for (int page = 0; page < 3; ++page) {
    const double u = 2 * kPi * page / 3;
    const auto at = Index(mesh.positions.size());
    mesh.positions.emplace_back(std::cos(u), std::sin(u), 0.2);
    mesh.positions.emplace_back(std::cos(u), std::sin(u), 0.9);
    mesh.faces.push_back({0, at, 1});
    mesh.faces.push_back({at, Index(at + 1), 1});
  }
  const auto tie = Index(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {{3, 0, 0}, {4, 0, 0.1}, {4, 1, 0}, {2, 0, 0}, {2, -1, 0.2}});
  mesh.faces.push_back({tie, Index(tie + 1), Index(tie + 2)});
  mesh.faces.push_back({tie, Index(tie + 3), Index(tie + 4)});
  return finished(std::move(mesh));
}

Mesh degenerate_triangles() {
  Mesh mesh = grid(5, 5);
  mesh.positions[6] = mesh.positions[7];        // coincident neighbours: two faces without area
  mesh.positions[12] = {2.999999999, 2, 1e-9};  // needles
  const auto n = Index(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {{10, 0, 0}, {11, 0, 0}, {12, 0, 0}, {20, 20, 20}, {9, 9, 9}});
  mesh.faces.push_back({n, Index(n + 1), Index(n + 2)});  // collinear
  mesh.loose_edges = {{0, Index(n + 4)}};                 // and n + 3 has nothing at all
  return finished(std::move(mesh));
}

std::vector<Mesh> all_small() {
  return {icosphere(2),
          torus(24, 12, 0.4),
          grid(9, 8),
          grid(9, 8, true),
          cylinder(16, 8, 0.3),
          two_density_sphere(16),
          non_manifold_fan(),
          degenerate_triangles(),
          octahedron(),
          cube(1),
          cube(3),
          bracket(),
          bowl(4),
          moebius(16),
          finned_sphere(1)};
}

void add_noise(Mesh& mesh, double sigma, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> gauss(0, sigma);
  for (Vector3d& p : mesh.positions)
    for (int axis = 0; axis < 3; ++axis) p[axis] += gauss(engine);
}

Mesh permuted(const Mesh& mesh, const std::vector<Index>& place) {
  Mesh out;
  out.positions.resize(mesh.positions.size());
  for (Index i = 0; i < place.size(); ++i) out.positions[place[i]] = mesh.positions[i];
  for (const Face& f : mesh.faces) out.faces.push_back({place[f[0]], place[f[1]], place[f[2]]});
  rebuild_adjacency(out, {});
  return out;
}

double area(const Mesh& mesh) {
  const Positions& at = mesh.positions;
  double sum = 0;
  for (const auto& f : mesh.faces) sum += (at[f[1]] - at[f[0]]).cross(at[f[2]] - at[f[0]]).norm() / 2;
  return sum;
}

double enclosed_volume(const Mesh& mesh) {
  double volume = 0;
  for (const Face& f : mesh.faces)
    volume += mesh.positions[f[0]].dot(mesh.positions[f[1]].cross(mesh.positions[f[2]])) / 6;
  return volume;
}

double mean_edge(const Mesh& mesh) {
  double total = 0;
  for (Index i = 0; i < mesh.positions.size(); ++i)
    for (const Index j : mesh.one_ring[i]) total += (mesh.positions[i] - mesh.positions[j]).norm();
  return total / double(mesh.one_ring.items.size());
}

double rms_distance(const Positions& x, const Positions& y) {
  double total = 0;
  for (std::size_t i = 0; i < x.size(); ++i) total += (x[i] - y[i]).squaredNorm();
  return std::sqrt(total / double(x.size()));
}

double rms_off_unit_sphere(const Positions& x) {
  double total = 0;
  for (const Vector3d& p : x) total += (p.norm() - 1) * (p.norm() - 1);
  return std::sqrt(total / double(x.size()));
}

}  // namespace rfsmooth::support
