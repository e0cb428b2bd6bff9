#include "smoothing/automatic/hidden_sheets.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "base/parallel.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/sheets/two_sheets.h"

namespace rfsmooth::smoothing {

namespace {

constexpr float kItself = 0.008F;         // a point's share in its own v: 0.0064 to 0.0088 on average
constexpr float kLouderPlace = 1.3F;      // v / c from which a place counts
constexpr float kLoudest = 4;             // v beyond which the sheets are not hidden
constexpr double kMostSheetShare = 0.75;  // more is another kind of noise; rotor's walls are at most 0.62
constexpr float kMostOwn = 0.25F;         // beyond, hardly smoothed, little of c is left: they say nothing
constexpr double kPrior = 0.15;           // standard deviation of ln c: how wrongly the noise may be measured
constexpr int kSheetRounds = 4;           // each of as many local means: all 16 are over some 500 points
constexpr float kEmptyLane = 1e9F;        // in lanes without a point: its values count as too large

/// So many points are weighed side by side.
using Lanes = Eigen::Array<float, 16, 1>;

struct Sum {
  double evidence = 0;     // of those counted in `points`, nats
  std::size_t louder = 0;  // points that may be of two sheets
  std::size_t points = 0;  // those of them that are no layers
  double area = 0;         // of these points: the sum of their squares
  Sum& operator+=(const Sum& other) {
    evidence += other.evidence;
    louder += other.louder;
    area += other.area;
    points += other.points;
    return *this;
  }
};

/// By point: the square of the surface that one has, in squares of the unit.
std::vector<float> squares_of_points(const HeightField& field, const Residuals& left,
                                     const Context& context) {
  std::vector<float> squares(field.size());
  for_each_index(context, field.size(), [&](std::size_t i) {
    const auto row = field.neighbors()[i];
    const double farthest = (field.guide()[row[row.size() - 1]] - field.guide()[i]).squaredNorm();
    squares[i] = float(rfs_mesh::square_of_point(farthest, row.size()) / (left.unit * left.unit));
  });
  return squares;
}

/// Half the distance of sheets that would be layers, squared, in squares of the unit: as squared_nearest() of
/// two_sheets.h says. \param squares of points
Lanes squared_of_layers(const Lanes& squares, const Residuals& left) {
  const auto apart = float(left.apart / left.unit);
  return (float(rfs_mesh::kToNearest) * squares).max(apart * apart) / 4;
}

/// Whether these places have more points than the others on the same area: twice as many where there are
/// two sheets, and a part of them has. Scans that do not meet have as many everywhere. \param squares of
/// points
bool is_denser(const Sum& sum, const std::vector<float>& squares, const Context& context) {
  const double all =
      sum_over(context, squares.size(), 0.0, [&](std::size_t i) { return double(squares[i]); });
  const double points = double(sum.points), others = double(squares.size()) - points;
  return sum.area * others < (1 - rfs_mesh::kLeastPart / 2) * (all - sum.area) * points;
}

/// What the evidence is of, by point.
struct ByPoint {
  const Residuals& left;
  const std::vector<float>& own;
  const std::vector<float>& v;        ///< local means of the squared residuals
  const std::vector<float>& squares;  ///< squares_of_points
};

/// Of points begin to end, if noise has the variance c.
Sum evidence_in(const ByPoint& of, float c, std::size_t begin, std::size_t end) {
  Sum part;
  for (std::size_t i = begin; i < end; i += Lanes::SizeAtCompileTime) {
    const auto there = Eigen::Index(std::min(end - i, std::size_t(Lanes::SizeAtCompileTime)));
    const auto lanes = [&](const std::vector<float>& values) {
      Lanes all = Lanes::Constant(kEmptyLane);
      all.head(there) = Eigen::Map<const Eigen::ArrayXf>(values.data() + i, there);
      return all;
    };
    const Lanes mean = lanes(of.v), share = lanes(of.own), square = lanes(of.squares),
                least = squared_of_layers(square, of.left);
    const Lanes squared = rfs_mesh::squared_apart(mean, c);
    const auto loud = share <= kMostOwn && mean >= kLouderPlace * c && mean <= kLoudest;
    part.louder += std::size_t(loud.count());
    const auto counts = loud && squared >= least;
    const auto counted = std::size_t(counts.count());
    if (counted == 0) continue;
    const Lanes variance = c * (1 - 2 * share),
                evidence = rfs_mesh::evidence_of_two(lanes(of.left.scores), squared, variance);
    part.evidence += double(counts.select(evidence, 0).sum());
    part.points += counted;
    part.area += double(counts.select(square, 0).sum());
  }
  return part;
}

/// Over all c. \param whole as of split_hidden_sheets
HiddenSheets best_evidence(const ByPoint& of, double whole, const Context& context) {
  const std::size_t n = of.v.size();
  HiddenSheets best;
  Sum at_best;
  for (double c = 1.1; c > 0.55; c *= 0.9) {
    const Sum sum = reduce_blocks(
        context, n, Sum(),
        [&](std::size_t begin, std::size_t end) { return evidence_in(of, float(c), begin, end); },
        [](Sum a, const Sum& b) { return a += b; });
    const double unlikely = std::log(c) / kPrior, evidence = whole * sum.evidence - unlikely * unlikely / 2;
    if (double(sum.points) < kLeastSheetShare * double(n) || evidence <= best.evidence) continue;
    best.evidence = evidence;
    best.variance = c;
    at_best = sum;
  }
  const bool everywhere = double(at_best.louder) > kMostSheetShare * double(n);
  const bool believed = everywhere ? of.left.with_tails : is_denser(at_best, of.squares, context);
  if (!believed) best.evidence = 0;
  return best;
}

}  // namespace

bool HiddenSheets::there() const {
  return evidence >= rfs_mesh::kNatsOfTwo;
}

HiddenSheets split_hidden_sheets(const HeightField& field, const Residuals& left, std::vector<float>& height,
                                 const std::vector<float>& own, double whole,
                                 std::optional<Statistics::Sheets>& known, const Context& context) {
  HiddenSheets found;
  if (known) found = {*known};
  if (known && !found.there()) return found;
  const std::size_t n = field.size();
  const std::vector<float> squares = squares_of_points(field, left, context);
  std::vector<float> v(n);
  const ByPoint of{left, own, v, squares};
  const std::vector<float>& residual = left.scores;
  // Smoothing left 1 - 2 own of the noise's variance, which is about 1: what it took is added.
  const auto variance_at = [&](std::size_t i) { return residual[i] * residual[i] + 2 * own[i]; };
  for_each_index(context, n, [&](std::size_t i) { v[i] = variance_at(i); });
  // Each round averages v over more points. A mean over few follows each of them, and that makes any noise
  // look like two sheets: where it does not even so, wider means will not, and the rounds end.
  for (int round = 0; round < kSheetRounds; ++round) {
    for (int again = 0; again < kSheetRounds; ++again) v = field.local_mean(v, context);
    if (known) continue;
    found = best_evidence(of, whole, context);
    if (!found.there()) break;
  }
  if (found.there()) {  // of the other points
    for_each_index(context, n,
                   [&](std::size_t i) { v[i] = (v[i] - kItself * variance_at(i)) / (1 - kItself); });
    if (!known) found = best_evidence(of, whole, context);
  }
  known = found;
  if (!found.there()) return found;
  const double c = found.variance;
  for_each_index(context, n, [&](std::size_t i) {
    const double mean = double(v[i]);
    const double squared = rfs_mesh::squared_apart(mean, c);
    if (mean < double(kLouderPlace) * c ||
        squared < double(squared_of_layers(Lanes::Constant(squares[i]), left)[0]))
      return;
    const double d = std::sqrt(squared);
    height[i] += float(left.unit * d * rfs_mesh::sharpened_label(double(residual[i]), d, c));
  });
  return found;
}

}  // namespace rfsmooth::smoothing
