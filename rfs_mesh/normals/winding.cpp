#include "rfs_mesh/normals/winding.h"

#include <cmath>
#include <stdexcept>

#include "base/parallel.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Eigen::Vector3d;
constexpr double kFourPi = 4 * M_PI;
constexpr double kOpening = 0.25;  // squared ratio of radius to distance below which a box is a point
constexpr std::size_t kGrain = 256;

}  // namespace

double softening_of(double area, std::size_t count) {
  return 0.8 * std::sqrt(area / double(count));
}

Winding::Winding(const Positions& points, double softening, const Context& context)
    : points_(points), softening_square_(softening * softening), tree_(points, context) {
  if (!(softening_square_ > 0)) throw std::invalid_argument("Winding: the softening must be positive");
  balls_.resize(tree_.node_count());
  tree_.for_each_node_upward(context, [&](const KdTree::Cursor& c) { enclose(c); });
}

void Winding::enclose(const KdTree::Cursor& at) {
  Ball& ball = balls_[at.node];
  if (at.is_leaf()) {
    for (const Index id : tree_.leaf(at.first).id) {
      if (id == kNone) continue;
      ball.centre += points_[id];
      ball.count += 1;
    }
  } else {
    for (const KdTree::Cursor child : {at.left(), at.right()}) {
      ball.centre += balls_[child.node].count * balls_[child.node].centre;
      ball.count += balls_[child.node].count;
    }
  }
  ball.centre /= ball.count;
  const KdTree::Node& box = tree_.node(at.node);
  ball.radius_square = (box.high - ball.centre).cwiseMax(ball.centre - box.low).squaredNorm();
}

template <class Moment>
std::vector<Moment> Winding::sum_up(const std::vector<Moment>& of, Moment zero,
                                    const Context& context) const {
  std::vector<Moment> sums(tree_.node_count(), zero);
  tree_.for_each_node_upward(context, [&](const KdTree::Cursor& c) {
    if (c.is_leaf()) {
      for (const Index id : tree_.leaf(c.first).id)
        if (id != kNone) sums[c.node] += of[id];
    } else {
      sums[c.node] += sums[c.left().node];
      sums[c.node] += sums[c.right().node];
    }
  });
  return sums;
}

template <class Sum, class Moment, class Term>
std::vector<Sum> Winding::evaluate(const std::vector<Moment>& of, Moment no_moment, Sum nothing,
                                   const Context& context, Term&& term) const {
  const std::vector<Moment> moments = sum_up(of, no_moment, context);
  std::vector<Sum> results(points_.size());
  for_blocks(context, results.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<KdTree::Cursor> pending;
    for (std::size_t i = begin; i < end; ++i) {
      const Vector3d& q = points_[i];
      Sum sum = nothing;
      const auto add = [&](const Vector3d& r, const Moment& moment) {
        const double soft = r.squaredNorm() + softening_square_;
        sum += term(r, 1 / (soft * std::sqrt(soft)), moment);
      };
      for (pending.assign(1, tree_.root()); !pending.empty();) {
        const KdTree::Cursor at = pending.back();
        pending.pop_back();
        const Ball& ball = balls_[at.node];
        const Vector3d r = ball.centre - q;
        if (ball.radius_square < kOpening * r.squaredNorm()) {
          add(r, moments[at.node]);
        } else if (at.is_leaf()) {
          for (const Index id : tree_.leaf(at.first).id)
            if (id != kNone) add(points_[id] - q, of[id]);
        } else {
          pending.push_back(at.right());
          pending.push_back(at.left());
        }
      }
      results[i] = sum / kFourPi;
    }
  });
  return results;
}

std::vector<double> Winding::numbers(const Positions& area_vectors, const Context& context) const {
  return evaluate(area_vectors, Vector3d(Vector3d::Zero()), 0.0, context,
                  [](const Vector3d& r, double weight, const Vector3d& m) { return weight * r.dot(m); });
}

Positions Winding::field(const std::vector<double>& charges, const Context& context) const {
  return evaluate(charges, 0.0, Vector3d(Vector3d::Zero()), context,
                  [](const Vector3d& r, double weight, double c) { return Vector3d(-(weight * c) * r); });
}

Positions Winding::gauss(int steps, const Context& context) const {
  const std::size_t n = points_.size();
  const auto square = [&](const std::vector<double>& v) {
    return sum_over(context, n, 0.0, [&](std::size_t i) { return v[i] * v[i]; });
  };
  // With A m = numbers(m) and A^T c = field(c): conjugate gradients for A A^T c = 1/2, with m = A^T c beside
  // them (Craig's method). `direction` is one of c, `along` and `change` are its A^T and its A A^T.
  Positions area_vectors(n, Vector3d(Vector3d::Zero()));
  std::vector<double> residual(n, 0.5), direction = residual;
  double before = square(residual);
  for (int step = 0; step < steps && before > 0; ++step) {
    const Positions along = field(direction, context);
    const std::vector<double> change = numbers(along, context);
    const double curvature =
        sum_over(context, n, 0.0, [&](std::size_t i) { return direction[i] * change[i]; });
    if (!(curvature > 0)) break;
    const double length = before / curvature;
    for_each_index(context, n, [&](std::size_t i) {
      area_vectors[i] += length * along[i];
      residual[i] -= length * change[i];
    });
    const double after = square(residual);
    for_each_index(context, n,
                   [&](std::size_t i) { direction[i] = residual[i] + after / before * direction[i]; });
    before = after;
  }
  return area_vectors;
}

}  // namespace rfsmooth::rfs_mesh
