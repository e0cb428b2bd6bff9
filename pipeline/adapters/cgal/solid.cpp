#include "pipeline/adapters/cgal/solid.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <unordered_map>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>

#include "pipeline/surface/topology.h"
#include "rfs_mesh/edge_faces.h"
#include "rfs_mesh/measure.h"

namespace rfsmooth::cgal {

namespace {

using rfsmooth::Face;
using Cell = Delaunay::Cell_handle;

/// Two numbers per pair of neighbours and two terminals, in boost's words.
class Cut {
 public:
  explicit Cut(std::size_t nodes) : graph_(nodes + 2), outside_(nodes), inside_(nodes + 1) {}
  void join(std::size_t a, std::size_t b, double cost) { edge(a, b, cost, cost); }
  void pull_outside(std::size_t a, double cost) { edge(outside_, a, cost, 0); }
  void pull_inside(std::size_t a, double cost) { edge(a, inside_, cost, 0); }

  /// 1 for every node that is inside.
  std::vector<char> solve() {
    boost::boykov_kolmogorov_max_flow(graph_, outside_, inside_);
    const auto side = boost::get(boost::vertex_color, graph_);
    std::vector<char> inside(outside_);
    for (std::size_t k = 0; k < inside.size(); ++k) inside[k] = side[k] != side[outside_];
    return inside;
  }

 private:
  using Traits = boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
  using Graph = boost::adjacency_list<
      boost::vecS, boost::vecS, boost::directedS,
      boost::property<boost::vertex_index_t, std::size_t,
                      boost::property<boost::vertex_color_t, boost::default_color_type,
                                      boost::property<boost::vertex_distance_t, double,
                                                      boost::property<boost::vertex_predecessor_t,
                                                                      Traits::edge_descriptor>>>>,
      boost::property<boost::edge_capacity_t, double,
                      boost::property<boost::edge_residual_capacity_t, double,
                                      boost::property<boost::edge_reverse_t, Traits::edge_descriptor>>>>;

  void edge(std::size_t a, std::size_t b, double there, double back) {
    const auto to = boost::add_edge(a, b, graph_).first, from = boost::add_edge(b, a, graph_).first;
    boost::put(boost::edge_capacity, graph_, to, there);
    boost::put(boost::edge_capacity, graph_, from, back);
    boost::put(boost::edge_reverse, graph_, to, from);
    boost::put(boost::edge_reverse, graph_, from, to);
  }
  Graph graph_;
  std::size_t outside_, inside_;
};

// Chosen on the closed development shapes with 2 % noise, 10,000 and 50,000 points: with 6 and less it is
// cheaper to cut an ear of armadillo off than to fill its merged root, with 15 and more walls grow flaps.
constexpr double kOfNormals = 10;
constexpr double kOfOthers = 0.433;  // x longest edge squared: the area of an even triangle
constexpr double kOfFront = 0.02;

class Builder {
 public:
  Builder(const Delaunay& tetrahedra, const Positions& points, const Positions& normals)
      : all_(tetrahedra), points_(points), normals_(normals) {
    for (auto c = all_.all_cells_begin(); c != all_.all_cells_end(); ++c) {
      number_.emplace(&*c, cells_.size());
      cells_.push_back(c);
    }
    on_front_.assign(4 * cells_.size(), 0);
  }

  Solid solve(const std::vector<FrontFace>& front, double longest, const Context& context) {
    Cut cut(cells_.size());
    double whole = 0;
    for (const FrontFace& face : front) {
      vote(face, cut);
      whole += area(face.corners);
    }
    let_normals_vote(kOfNormals * whole / double(points_.size()), cut);
    for (std::size_t k = 0; k < cells_.size(); ++k) {
      if (all_.is_infinite(cells_[k])) cut.pull_outside(k, std::numeric_limits<float>::max());
      for (int i = 0; i < 4; ++i) join(k, i, cut);
    }
    context.check_stop();
    inside_ = cut.solve();
    context.check_stop();
    return boundary(whole, longest);
  }

 private:
  std::size_t number(Cell c) const { return number_.at(&*c); }
  Index corner(Cell c, int i) const { return Index(c->vertex(i)->id()); }
  /// The corners of the facet opposite of vertex i of cell c, seen counterclockwise from outside of c.
  Face corners(Cell c, int i) const {
    Face f{corner(c, (i + 1) & 3), corner(c, (i + 2) & 3), corner(c, (i + 3) & 3)};
    if (i % 2 == 1) std::swap(f[1], f[2]);
    return f;
  }
  double area(const Face& f) const { return 0.5 * rfs_mesh::face_cross(points_, f).norm(); }

  /// The two tetrahedra at a face of the front say which is inside.
  void vote(const FrontFace& face, Cut& cut) {
    Cell in = face.facet.first, out = in->neighbor(face.facet.second);
    const int i = face.facet.second, j = out->index(in);
    on_front_[4 * number(in) + std::size_t(i)] = on_front_[4 * number(out) + std::size_t(j)] = 1;
    // `corners` looks from outside of the cell: an odd permutation of it looks from inside.
    const Face seen = corners(in, i);
    std::size_t k = 0;
    while (seen[k] != face.corners[0]) ++k;
    if (seen[(k + 1) % 3] != face.corners[1]) std::swap(in, out);
    const double weight = area(face.corners);
    cut.pull_inside(number(in), weight);
    cut.pull_outside(number(out), weight);
  }

  /// The tetrahedra behind and before each point say which is inside.
  void let_normals_vote(double weight, Cut& cut) const {
    std::vector<Cell> cells;
    for (auto v = all_.finite_vertices_begin(); v != all_.finite_vertices_end(); ++v) {
      cells.clear();
      all_.incident_cells(v, std::back_inserter(cells));
      const auto p = Index(v->id());
      for (const Cell c : cells) {
        if (all_.is_infinite(c)) continue;
        const int i = c->index(v);
        Eigen::Matrix3d edges;
        for (int k = 0; k < 3; ++k) edges.col(k) = points_[corner(c, (i + 1 + k) & 3)] - points_[p];
        const Eigen::Vector3d along = edges.partialPivLu().solve(normals_[p]);
        if (along.minCoeff() >= 0) cut.pull_outside(number(c), weight);
        if (along.maxCoeff() <= 0) cut.pull_inside(number(c), weight);
      }
    }
  }

  void join(std::size_t k, int i, Cut& cut) const {
    const Cell c = cells_[k], n = c->neighbor(i);
    const std::size_t m = number(n);
    if (m < k || (all_.is_infinite(c) && all_.is_infinite(n))) return;
    const Face f = corners(c, i);
    cut.join(k, m,
             on_front_[4 * k + std::size_t(i)] != 0 ? kOfFront * area(f) : kOfOthers * longest_square(f));
  }

  double longest_square(const Face& f) const {
    double longest = 0;
    for (std::size_t e = 0; e < 3; ++e)
      longest = std::max(longest, (points_[f[e]] - points_[f[(e + 1) % 3]]).squaredNorm());
    return longest;
  }

  /// Calls visit(face, whether it is the front's) for the boundary of the inside.
  template <class Visit>
  void for_each_face(Visit&& visit) const {
    for (std::size_t k = 0; k < cells_.size(); ++k)
      for (int i = 0; inside_[k] && i < 4; ++i)
        if (!inside_[number(cells_[k]->neighbor(i))])
          visit(corners(cells_[k], i), on_front_[4 * k + std::size_t(i)] != 0);
  }

  Solid boundary(double whole, double longest) const {
    Solid solid;
    double all = 0;
    std::vector<Face> far;
    for_each_face([&](const Face& f, bool of_front) {
      solid.faces.push_back(f);
      const Eigen::Vector3d cross = rfs_mesh::face_cross(points_, f);
      all += area(f);
      if (of_front) solid.kept += area(f) / whole;
      if (cross.dot(normals_[f[0]] + normals_[f[1]] + normals_[f[2]]) < 0) solid.disagreeing += area(f);
      if (longest_square(f) > longest * longest) far.push_back(f);
    });
    if (all > 0) solid.disagreeing /= all;
    DisjointSets<Index> gaps = pipeline::pieces_of(points_.size(), far);
    std::unordered_map<Index, double> areas;
    for (const Face& f : far) solid.widest_gap = std::max(solid.widest_gap, areas[gaps.of(f[0])] += area(f));
    return solid;
  }

  const Delaunay& all_;
  const Positions& points_;
  const Positions& normals_;
  std::vector<Cell> cells_;
  std::unordered_map<const void*, std::size_t> number_;
  std::vector<char> on_front_;  ///< 4 per cell
  std::vector<char> inside_;
};

}  // namespace

Solid solid_of(const Delaunay& tetrahedra, const Positions& points, const Positions& normals,
               const std::vector<FrontFace>& front, double longest, const Context& context) {
  return Builder(tetrahedra, points, normals).solve(front, longest, context);
}

}  // namespace rfsmooth::cgal
