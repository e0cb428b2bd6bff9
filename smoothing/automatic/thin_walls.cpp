#include "smoothing/automatic/thin_walls.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>

#include "base/linear/symmetric_eigen.h"
#include "base/parallel.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/search/thinning.h"
#include "rfs_mesh/search/wide_neighbors.h"
#include "rfs_mesh/sheets/two_sheets.h"
#include "smoothing/automatic/hidden_sheets.h"

namespace rfsmooth::smoothing {

namespace {

using Eigen::Vector3d;

constexpr std::size_t kWidestLook = 4;   // times the members of the patches that saw it; from 1 on, doubling
constexpr double kLeastCovered = 10;     // sum of weights, in points
constexpr std::size_t kFirstLook = 512;  // members that nine unknowns are well known from

/// What a patch says of a member.
struct Move {
  Index point;
  float weight;
  Eigen::Vector3f by;
};

/// What all patches say of a point.
struct Mean {
  Vector3d move = Vector3d::Zero();
  double weight = 0;
};

/// The walls that patches of one size see, each fitted as two sheets.
class Walls {
 public:
  Walls(const HeightField& field, const Positions& data, const Positions& smooth,
        const rfs_mesh::NoiseField& noise, std::size_t members)
      : field_(field), data_(data), smooth_(smooth), noise_(noise), members_(members) {}

  /// Adds to the means of their members what those of the patches around these seeds say that see a wall.
  void look(const std::vector<Index>& seeds, std::vector<Mean>& means, const Context& context) const {
    std::vector<std::vector<Move>> moves(seeds.size());
    for_blocks(context, seeds.size(), 16, [&](std::size_t begin, std::size_t end) {
      rfs_mesh::WideNeighbors near(field_.index(), members_);
      std::vector<rfs_mesh::SheetPoint> points;
      for (std::size_t s = begin; s < end; ++s) fit(seeds[s], near, points, moves[s]);
    });
    for (const std::vector<Move>& patch : moves)
      for (const Move& move : patch) {
        means[move.point].move += double(move.weight) * move.by.cast<double>();
        means[move.point].weight += double(move.weight);
      }
  }

 private:
  /// What the normals of every `stride`-th member have in common, whatever their side.
  Vector3d axis(const rfs_mesh::WideNeighbors& near, double square, std::size_t stride) const {
    Vector3d axis = Vector3d::Zero();
    for (int again = 0; again < 3; ++again) {
      Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
      for (std::size_t k = 0; k < members_; k += stride) {
        const Vector3d normal = field_.normal(near.index()[k]);
        if (again > 0 && std::abs(normal.dot(axis)) < rfs_mesh::kSameSheet) continue;
        sum += std::pow(1 - double(near.squared()[k]) / square, 2) * normal * normal.transpose();
      }
      axis = symmetric_eigen(sum).vectors.col(2);
    }
    return axis;
  }

  /// A patch as the fit sees it.
  struct Seen {
    Vector3d normal;
    double sigma, weights = 0;
  };

  /// Enters every `stride`-th member in `points`. \param square of the patch's radius
  Seen see(Index seed, const rfs_mesh::WideNeighbors& near, double square, std::size_t stride,
           std::vector<rfs_mesh::SheetPoint>& points) const {
    const Vector3d& centre = field_.guide()[seed];
    Seen seen = {axis(near, square, stride), std::min(noise_.sigma, noise_.local[seed])};
    const Vector3d &normal = seen.normal, u = normal.unitOrthogonal(), v = normal.cross(u);
    const double in_radii = 1 / std::sqrt(square);
    points.clear();
    for (std::size_t k = 0; k < members_; k += stride) {
      const Index i = near.index()[k];
      const Vector3d r(near.x()[k], near.y()[k], near.z()[k]);
      const double inside = 1 - double(near.squared()[k]) / square;
      const float cosine = std::abs(float(normal.dot(field_.normal(i))));
      points.push_back({u.dot(r) * in_radii, v.dot(r) * in_radii, normal.dot(data_[i] - centre) / seen.sigma,
                        normal.dot(smooth_[i] - centre) / seen.sigma,
                        inside * inside * double(same_sheet(cosine))});
      seen.weights += points.back().weight;
    }
    return seen;
  }

  /// Where the patch around a seed sees a wall, enters how far each member is from its own sheet of it.
  void fit(Index seed, rfs_mesh::WideNeighbors& near, std::vector<rfs_mesh::SheetPoint>& points,
           std::vector<Move>& moves) const {
    near.find(field_.guide()[seed]);
    const double square = rfs_mesh::kBeyond * double(near.farthest());
    if (!(square > 0)) return;
    // A patch of thousands that is no wall shows it to a few hundred of its members, spread evenly.
    if (const std::size_t stride = members_ / kFirstLook; stride > 1) {
      see(seed, near, square, stride, points);
      if (!rfs_mesh::SheetPair(points).possible()) return;
    }
    const auto [normal, sigma, weights] = see(seed, near, square, 1, points);
    const rfs_mesh::SheetPair sheets(points);
    if (!sheets.convincing()) return;
    for (std::size_t k = 0; k < members_; ++k) {
      const rfs_mesh::SheetPoint& p = points[k];
      const Index i = near.index()[k];
      const double height = sheets.nearer(p), inside = 1 - double(near.squared()[k]) / square;
      if (std::abs(p.height - height) > rfs_mesh::kNoiseReach ||
          std::abs(normal.dot(field_.normal(i))) < rfs_mesh::kSameSheet)
        continue;  // no points of rims
      // The more points, the better is what they say.
      moves.push_back(
          {i, float(inside * inside * weights), (sigma * (height - p.estimate) * normal).cast<float>()});
    }
  }

  const HeightField& field_;
  const Positions &data_, &smooth_;
  const rfs_mesh::NoiseField& noise_;
  std::size_t members_;
};

}  // namespace

void part_thin_walls(HeightField& field, const Positions& data, const std::vector<Index>& seeds,
                     std::size_t members, const rfs_mesh::NoiseField& noise, Positions& smooth,
                     std::optional<bool>& parted, const Context& context) {
  if (data.size() != field.size() || smooth.size() != field.size() || noise.local.size() != field.size())
    throw std::invalid_argument("part_thin_walls: the field and what belongs to its points differ in number");
  const double most = double(seeds.size()) * double(kWidestLook * members);  // points they can reach
  const bool enough = parted ? *parted : most >= kLeastSheetShare * double(field.size());
  if (!parted) parted = false;
  if (seeds.empty() || !enough) return;
  field.ready_for_searches(context);
  const bool known = *parted;
  std::vector<Mean> means(field.size());
  for (std::size_t wider = 1; wider <= kWidestLook; wider *= 2) {
    std::vector<Index> sparse = seeds;  // wider patches need fewer to lie over every point as often
    while (sparse.size() > 1 && sparse.size() * wider >= seeds.size())
      sparse = rfs_mesh::thin(field.guide(), sparse, context);
    const Walls walls(field, data, smooth, noise, std::min(wider * members, field.size()));
    walls.look(sparse, means, context);
  }
  const auto covered = [](const Mean& mean) { return mean.weight >= kLeastCovered; };
  const auto points = std::size_t(std::count_if(means.begin(), means.end(), covered));
  if (!known && double(points) < kLeastSheetShare * double(means.size())) return;
  parted = true;
  for_each_index(context, means.size(), [&](std::size_t i) {
    if (covered(means[i])) smooth[i] += means[i].move / means[i].weight;
  });
}

}  // namespace rfsmooth::smoothing
