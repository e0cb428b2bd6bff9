#include "rfsmooth/rfs_mesh/orient.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "rfsmooth/rfs_mesh/collect.h"
#include "rfsmooth/rfs_mesh/parallel.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Eigen::Vector3d;

/// An edge and whether the normals at its ends are on one side.
struct Link {
  float doubt;  ///< 1 - |a|, 0 = sure
  bool turned;
  Index a, b;
};

bool operator<(const Link& x, const Link& y) {
  if (x.doubt != y.doubt) return x.doubt < y.doubt;
  return x.a != y.a ? x.a < y.a : x.b < y.b;
}

double agreement(const Vector3d& p, const Vector3d& n, const Vector3d& q, const Vector3d& m) {
  const Vector3d e = q - p;
  const double square = e.squaredNorm();
  if (!(square > 0)) return n.dot(m);
  return n.dot(m) - 2 * m.dot(e) * n.dot(e) / square;
}

/// Union-find whose members know their side relative to their root.
class Sides {
 public:
  explicit Sides(std::size_t n) : parent_(n), turned_(n, 0), size_(n, 1) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }
  struct Root {
    Index index;
    bool turned;
  };
  Root find(Index i) {
    bool turned = false;
    while (parent_[i] != i) {
      const Index up = parent_[i];
      turned_[i] ^= turned_[up];  // path halving: now relative to the grandparent
      parent_[i] = parent_[up];
      turned ^= turned_[i] != 0;
      i = parent_[i];
    }
    return {i, turned};
  }
  void join(Index a, Index b, bool turned) {
    Root x = find(a), y = find(b);
    if (x.index == y.index) return;
    const bool between = turned ^ x.turned ^ y.turned;
    if (size_[x.index] < size_[y.index] || (size_[x.index] == size_[y.index] && y.index < x.index))
      std::swap(x, y);
    parent_[y.index] = x.index;
    turned_[y.index] = between ? 1 : 0;
    size_[x.index] += size_[y.index];
  }

 private:
  std::vector<Index> parent_;
  std::vector<char> turned_;
  std::vector<Index> size_;
};

std::vector<Link> links_of(const Mesh& mesh, const std::vector<Edge>& tree, const std::vector<Edge>& bridges,
                           const Positions& normals, const Context& context) {
  const Positions& at = mesh.positions;
  const auto link = [&](Index a, Index b) {
    const double s = agreement(at[a], normals[a], at[b], normals[b]);
    return Link{float(std::max(0.0, 1 - std::abs(s))), s < 0, a, b};
  };
  std::vector<Link> links = collect<Link>(context, at.size(), [&](std::size_t i, auto&& emit) {
    for (const Index j : mesh.one_ring[i])
      if (j > i) emit(link(Index(i), j));
  });
  std::vector<Edge> not_near = bridges;
  std::sort(not_near.begin(), not_near.end());
  const std::vector<Link> more = collect<Link>(context, tree.size(), [&](std::size_t e, auto&& emit) {
    const auto ring = mesh.one_ring[tree[e][0]];
    if (std::binary_search(ring.begin(), ring.end(), tree[e][1])) return;
    if (std::binary_search(not_near.begin(), not_near.end(), tree[e])) return;
    emit(link(tree[e][0], tree[e][1]));
  });
  links.insert(links.end(), more.begin(), more.end());
  parallel_sort(context, links, [](const Link& x, const Link& y) { return x < y; });
  return links;
}

/// What the points of a part say together.
struct Part {
  Vector3d centre = Vector3d::Zero(), sum = Vector3d::Zero();
  double area = 0, volume = 0, extent = 0, towards = 0;
};

bool turn_to_positive(const Vector3d& v) {
  for (const int axis : {2, 1, 0})
    if (v[axis] != 0) return v[axis] < 0;
  return false;
}

}  // namespace

std::size_t orient(const Mesh& mesh, const std::vector<Edge>& tree, const std::vector<Edge>& bridges,
                   const std::optional<Vector3d>& viewpoint, Positions& normals, const Context& context) {
  const std::size_t n = mesh.positions.size();
  if (normals.size() != n) throw std::invalid_argument("orient: normals must hold one vector per vertex");
  const Positions& at = mesh.positions;
  // The side a normal came with must not matter where nothing else decides.
  for_each_index(context, n, [&](std::size_t i) {
    if (turn_to_positive(normals[i])) normals[i] = -normals[i];
  });
  Sides sides(n);
  for (const Link& link : links_of(mesh, tree, bridges, normals, context))
    sides.join(link.a, link.b, link.turned);

  std::vector<double> area(n);
  for_each_index(context, n, [&](std::size_t i) {
    const auto ring = mesh.one_ring[i];
    double sum = 0;
    for (const Index j : ring) sum += (at[j] - at[i]).squaredNorm();
    area[i] = ring.size() > 0 ? sum / double(ring.size()) : 0;
  });
  std::vector<Index> root(n);
  std::vector<Part> parts(n);
  for (Index i = 0; i < n; ++i) {
    const auto found = sides.find(i);
    root[i] = found.index;
    if (found.turned) normals[i] = -normals[i];
    parts[root[i]].centre += area[i] * at[i];
    parts[root[i]].area += area[i];
  }
  for (Part& part : parts)
    if (part.area > 0) part.centre /= part.area;
  for (Index i = 0; i < n; ++i) {
    Part& part = parts[root[i]];
    part.volume += area[i] * (at[i] - part.centre).dot(normals[i]);
    part.extent += area[i] * (at[i] - part.centre).norm();
    part.sum += normals[i];
    if (viewpoint) {
      const Vector3d ray = *viewpoint - at[i];
      if (const double d = ray.norm(); d > 0) part.towards += ray.dot(normals[i]) / d;
    }
  }
  constexpr double kFlat = 0.01;
  std::vector<char> turn(n, 0);
  std::size_t count = 0;
  for (Index i = 0; i < n; ++i) {
    if (root[i] != i) continue;
    ++count;
    const Part& part = parts[i];
    if (viewpoint && part.towards != 0)
      turn[i] = part.towards < 0 ? 1 : 0;
    else if (std::abs(part.volume) > kFlat * part.extent)
      turn[i] = part.volume < 0 ? 1 : 0;
    else
      turn[i] = turn_to_positive(part.sum) ? 1 : 0;
  }
  for_each_index(context, n, [&](std::size_t i) {
    if (turn[root[i]] != 0) normals[i] = -normals[i];
  });
  return count;
}

}  // namespace rfsmooth::rfs_mesh
