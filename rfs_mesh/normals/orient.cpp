#include "rfs_mesh/normals/orient.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/collect.h"
#include "base/parallel.h"
#include "base/quantile.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/measure.h"
#include "rfs_mesh/normals/sides.h"
#include "rfs_mesh/normals/visible.h"
#include "rfs_mesh/normals/winding.h"
#include "rfs_mesh/sample.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Eigen::Vector3d;

// Chosen on the closed development shapes (tests/bench/normals).
constexpr int kSteps = 4;        // more follow the noise
constexpr double kBetter = 0.8;  // of it: what votes must bring to be believed

double agreement(const Vector3d& p, const Vector3d& n, const Vector3d& q, const Vector3d& m) {
  const Vector3d e = q - p;
  const double square = e.squaredNorm();
  if (!(square > 0)) return n.dot(m);
  return n.dot(m) - 2 * m.dot(e) * n.dot(e) / square;
}

class Orienter {
 public:
  Orienter(const Mesh& mesh, const std::vector<Edge>& tree, const std::vector<Edge>& bridges,
           const Positions& calm, Positions& normals, const Context& context)
      : mesh_(mesh),
        at_(mesh.positions),
        calm_(calm),
        tree_(tree),
        bridges_(bridges),
        normals_(normals),
        context_(context) {
    // The side a normal came with must not matter where nothing else decides.
    for_each_index(context_, normals_.size(), [&](std::size_t i) {
      if (points_down(normals_[i])) normals_[i] = -normals_[i];
    });
    std::sort(bridges_.begin(), bridges_.end());
    around_ = vertex_faces(mesh_, context_);
    areas_ = areas(calm_);
  }

  std::size_t towards(const Vector3d& viewpoint) {
    const double spacing = mean_edge_length(mesh_, context_);
    std::vector<double> votes = seen_squarely(at_, normals_, viewpoint, spacing, context_);
    for (double& vote : votes) vote = std::clamp(2 * vote, -1.0, 1.0);
    part_ = apply(grow_regions(at_.size(), links(calm_), votes, context_), normals_, votes);
    return parts_;
  }

  std::size_t outward() {
    Positions alone = normals_;
    const Regions parts = grow_regions(at_.size(), links(calm_), {}, context_);
    part_ = apply(parts, alone, {});
    const std::size_t count = parts_;
    if (closes(parts, alone)) {
      normals_.swap(alone);
      return count;
    }
    // From here on the points themselves: calmer ones may have merged the very sheets to be told apart.
    const Samples samples(at_, areas(at_));
    if (!(samples.area > 0)) {
      normals_.swap(alone);
      return count;
    }
    const Winding winding(samples.at, samples.softening(), context_);
    const std::vector<double> votes = gauss_votes(winding, samples);
    Positions voted = normals_;
    apply(grow_regions(at_.size(), links(at_), votes, context_), voted, votes);
    const std::vector<double> open = openness(winding, samples, parts, alone),
                              still_open = openness(winding, samples, parts, voted);
    for_each_index(context_, at_.size(), [&](std::size_t i) {
      const Index part = parts.of_point[i];
      normals_[i] = open[part] > kClosed && still_open[part] < kBetter * open[part] ? voted[i] : alone[i];
    });
    return count;
  }

  /// n: which part each point is of, by a point of it.
  std::vector<Index>& part() { return part_; }

 private:
  /// Points spread evenly over the rows, each standing for several.
  struct Samples {
    Samples(const Positions& points, const std::vector<double>& areas_of_points)
        : row(sample_rows(points.size())) {
      for (const Index i : row) {
        at.push_back(points[i]);
        areas.push_back(areas_of_points[i] * double(points.size()) / double(row.size()));
        area += areas.back();
      }
    }
    double softening() const { return softening_of(area, at.size()); }
    std::vector<Index> row;
    Positions at;
    std::vector<double> areas;
    double area = 0;
  };

  /// Whether the winding number is near 1/2 in every part, or there is no surface to ask.
  bool closes(const Regions& parts, const Positions& normals) const {
    const Samples samples(calm_, areas_);
    if (!(samples.area > 0)) return true;  // points in a line, or too few for a face
    const Winding winding(samples.at, samples.softening(), context_);
    const std::vector<double> open = openness(winding, samples, parts, normals);
    return std::none_of(samples.row.begin(), samples.row.end(),
                        [&](Index i) { return open[parts.of_point[i]] > kClosed; });
  }

  std::vector<SideLink> links(const Positions& at) const {
    const auto link = [&](Index a, Index b) {
      return SideLink{a, b, float(agreement(at[a], normals_[a], at[b], normals_[b])), 1};
    };
    std::vector<SideLink> all = collect<SideLink>(context_, at_.size(), [&](std::size_t i, auto&& emit) {
      for (const Index j : mesh_.one_ring[i])
        if (j > i) emit(link(Index(i), j));
    });
    const std::vector<SideLink> more =
        collect<SideLink>(context_, tree_.size(), [&](std::size_t e, auto&& emit) {
          const auto ring = mesh_.one_ring[tree_[e][0]];
          if (std::binary_search(ring.begin(), ring.end(), tree_[e][1])) return;
          if (std::binary_search(bridges_.begin(), bridges_.end(), tree_[e])) return;
          emit(link(tree_[e][0], tree_[e][1]));
        });
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  /// n: a third of the faces around each point, with the points at `at`.
  std::vector<double> areas(const Positions& at) const {
    std::vector<double> areas(at.size());
    for_each_index(context_, at.size(), [&](std::size_t i) {
      double sum = 0;
      for (const Index f : around_[i]) sum += face_cross(at, mesh_.faces[f]).norm() / 6;
      areas[i] = sum;
    });
    return areas;
  }

  /// Turns `normals` by regions and gives each region its side. Returns the region of each point.
  std::vector<Index> apply(Regions regions, Positions& normals, const std::vector<double>& votes) {
    follow_bridges(regions, votes);
    const std::size_t n = at_.size();
    for_each_index(context_, n, [&](std::size_t i) {
      if (regions.turned[i] != 0) normals[i] = -normals[i];
    });
    struct Sum {
      Vector3d centre = Vector3d::Zero(), normal = Vector3d::Zero();
      double area = 0, volume = 0, extent = 0, vote = 0;
    };
    std::vector<Sum> sums(n);
    for (std::size_t i = 0; i < n; ++i) {
      Sum& sum = sums[regions.of_point[i]];
      sum.centre += areas_[i] * calm_[i];
      sum.area += areas_[i];
      if (!votes.empty()) sum.vote += regions.turned[i] != 0 ? -votes[i] : votes[i];
    }
    for (Sum& sum : sums)
      if (sum.area > 0) sum.centre /= sum.area;
    for (std::size_t i = 0; i < n; ++i) {
      Sum& sum = sums[regions.of_point[i]];
      sum.volume += areas_[i] * (calm_[i] - sum.centre).dot(normals[i]);
      sum.extent += areas_[i] * (calm_[i] - sum.centre).norm();
      sum.normal += normals[i];
    }
    std::vector<char> turn(n, 0);
    parts_ = 0;
    for (std::size_t r = 0; r < n; ++r) {
      if (regions.of_point[r] != r) continue;
      ++parts_;
      const Sum& sum = sums[r];
      turn[r] = on_wrong_side(sum.vote, sum.volume, sum.extent, sum.normal) ? 1 : 0;
    }
    for_each_index(context_, n, [&](std::size_t i) {
      if (turn[regions.of_point[i]] != 0) normals[i] = -normals[i];
    });
    return std::move(regions.of_point);
  }

  /// Regions too small to have a side of their own take that of what they hang on.
  void follow_bridges(Regions& regions, const std::vector<double>& votes) const {
    const std::size_t n = at_.size();
    std::vector<std::size_t> size(n, 0);
    std::vector<char> judged(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      ++size[regions.of_point[i]];
      if (!votes.empty() && votes[i] != 0) judged[regions.of_point[i]] = 1;
    }
    std::vector<SideLink> bridges;
    for (const Edge& e : bridges_) {
      const bool turned = regions.turned[e[0]] != regions.turned[e[1]];
      const double a = agreement(at_[e[0]], normals_[e[0]], at_[e[1]], normals_[e[1]]);
      bridges.push_back({regions.of_point[e[0]], regions.of_point[e[1]], float(turned ? -a : a), 1});
    }
    std::stable_sort(bridges.begin(), bridges.end(), [](const SideLink& x, const SideLink& y) {
      return std::abs(x.agreement) > std::abs(y.agreement);
    });
    Sides sides(n);
    bool any = false;
    for (const SideLink& link : bridges) {
      const Sides::Root a = sides.find(link.a), b = sides.find(link.b);
      const auto hangs = [&](Index r) { return size[r] < kNeighbourhood && judged[r] == 0; };
      if (a.index == b.index || !(hangs(a.index) || hangs(b.index))) continue;
      sides.join(a.index, b.index, (link.agreement < 0) != (a.turned != b.turned));
      const Index root = std::min(a.index, b.index);
      size[root] = size[a.index] + size[b.index];
      judged[root] = judged[a.index] != 0 || judged[b.index] != 0 ? 1 : 0;
      any = true;
    }
    if (!any) return;
    for (std::size_t i = 0; i < n; ++i) {
      const Sides::Root root = sides.find(regions.of_point[i]);
      regions.of_point[i] = root.index;
      if (root.turned) regions.turned[i] = char(1 - regions.turned[i]);
    }
  }

  /// By part: the root mean square of w - 1/2, or of w less its mean where that is near 1/2: areas are known
  /// as well as the mesh has no holes and no overlaps.
  std::vector<double> openness(const Winding& winding, const Samples& samples, const Regions& parts,
                               const Positions& normals) const {
    Positions area_vectors;
    for (std::size_t s = 0; s < samples.row.size(); ++s)
      area_vectors.push_back(samples.areas[s] * normals[samples.row[s]]);
    const std::vector<double> w = winding.numbers(area_vectors, context_);
    std::vector<double> sum(at_.size(), 0), squares(at_.size(), 0), count(at_.size(), 0);
    for (std::size_t s = 0; s < w.size(); ++s) {
      const Index part = parts.of_point[samples.row[s]];
      const double bounded = std::clamp(w[s], -0.5, 1.5);
      sum[part] += bounded;
      squares[part] += bounded * bounded;
      count[part] += 1;
    }
    for (std::size_t p = 0; p < sum.size(); ++p) {
      if (!(count[p] > 0)) continue;
      const double mean = sum[p] / count[p];
      const double level = std::clamp(mean, 0.5 - kClosed, 0.5 + kClosed);
      sum[p] = std::sqrt(std::max(0.0, squares[p] / count[p] - 2 * level * mean + level * level));
    }
    return sum;
  }

  /// n: how surely each sample's normal is on the right side, -1 to 1; 0 for the other points.
  std::vector<double> gauss_votes(const Winding& winding, const Samples& samples) const {
    const Positions area_vectors = winding.gauss(kSteps, context_);
    std::vector<double> vote(samples.row.size()), sizes;
    for (std::size_t s = 0; s < vote.size(); ++s) vote[s] = normals_[samples.row[s]].dot(area_vectors[s]);
    for (const double v : vote) sizes.push_back(std::abs(v));
    const double usual = median(sizes);
    std::vector<double> votes(at_.size(), 0);
    for (std::size_t s = 0; s < vote.size(); ++s)
      if (usual > 0) votes[samples.row[s]] = std::clamp(vote[s] / usual, -1.0, 1.0);
    return votes;
  }

  const Mesh& mesh_;
  const Positions& at_;
  const Positions& calm_;
  const std::vector<Edge>& tree_;
  std::vector<Edge> bridges_;
  Positions& normals_;
  const Context& context_;
  Adjacency around_;  ///< the faces of each vertex
  std::vector<double> areas_;
  std::vector<Index> part_;
  std::size_t parts_ = 0;
};

}  // namespace

std::size_t orient(const Mesh& mesh, const std::vector<Edge>& tree, const std::vector<Edge>& bridges,
                   const std::optional<Vector3d>& viewpoint, Positions& normals, const Context& context,
                   const Positions* calm, std::vector<Index>* part) {
  const std::size_t n = mesh.positions.size();
  if (normals.size() != n || (calm != nullptr && calm->size() != n))
    throw std::invalid_argument("orient: normals and calm positions must hold one vector per vertex");
  if (part != nullptr) part->clear();
  if (n == 0) return 0;
  Orienter orienter(mesh, tree, bridges, calm != nullptr ? *calm : mesh.positions, normals, context);
  const std::size_t parts = viewpoint ? orienter.towards(*viewpoint) : orienter.outward();
  if (part != nullptr) part->swap(orienter.part());
  return parts;
}

}  // namespace rfsmooth::rfs_mesh
