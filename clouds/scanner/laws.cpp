#include "clouds/scanner/laws.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "clouds/shapes/random.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::clouds {

using Eigen::Vector3d;

namespace {

/// The noise of every law but those that are made of something else: a third of a spacing is what scans have
/// whose points are stored as densely as they are measured.
constexpr double kUsual = 0.35;

std::vector<Law> make_laws() {
  std::vector<Law> list;
  const auto add = [&](std::string_view name, std::string_view says, double sigma) -> Law& {
    list.emplace_back();
    list.back().name = name;
    list.back().says = says;
    list.back().sigma = sigma;
    return list.back();
  };
  add("white", "alike in all directions, independent", kUsual);
  add("tails5", "5 % of the points have four times as much", kUsual).loud_share = 0.05;
  add("tails20", "20 % of the points have four times as much", kUsual).loud_share = 0.2;
  add("correlated7", "correlated over 7 neighbours", kUsual).correlated = 7;
  add("correlated30", "correlated over 30 neighbours", kUsual).correlated = 30;
  add("half", "half of the cloud is exact", kUsual).half = 0;
  add("contrast", "half of the cloud has a fifth of the noise of the other", 0.5).half = 0.2;
  add("steps1", "depth in steps of one spacing", 0).step = 1;
  add("steps4", "depth in steps of four spacings", 0).step = 4;
  Law& scans = add("scans", "ten scans that miss each other by 0.3 spacings", 0.2);
  scans.scans = 10;
  scans.between = 0.3;
  Law& rings = add("rings", "a spinning scanner: rings 20 times farther apart than points", kUsual);
  rings.along_ray = true;
  rings.spread = Spread::rings;
  Law& range = add("range", "along the ray, growing with range squared", kUsual);
  range.along_ray = true;
  range.range_power = 2;
  Law& clumps = add("clumps", "photogrammetry: clumps of points that are off together", 0.15);
  clumps.clumps = 0.3;
  clumps.spread = Spread::clumps;
  Law& mixed =
      add("mixed", "growing with range, correlated over 7, 5 % loud, three scans, small steps", 0.25);
  mixed.range_power = 2;
  mixed.correlated = 7;
  mixed.loud_share = 0.05;
  mixed.scans = 3;
  mixed.between = 0.2;
  mixed.step = 0.5;
  return list;
}

/// Independent draws, then the sum of each point's nearest k, over sqrt(k): variance 1 again, and two points
/// that share s of their k correlate by s / k.
Positions standard_noise(const Positions& points, int k, Random& random) {
  Positions white(points.size());
  for (Vector3d& w : white) w = random.normal3();
  if (k <= 1) return white;
  const rfs_mesh::SpatialIndex index(points, {});
  const auto near = index.nearest(k - 1, {});
  Positions noise = white;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const Index j : near[i]) noise[i] += white[j];
    noise[i] /= std::sqrt(double(k));
  }
  return noise;
}

/// One side of a plane through the middle that no face or symmetry of a usual shape lies along.
std::vector<char> calm_half(const Positions& points, const Vector3d& centre) {
  const Vector3d across(0.48, 0.6, 0.64);
  std::vector<char> calm(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) calm[i] = (points[i] - centre).dot(across) > 0;
  return calm;
}

/// Turns by an angle and shifts, each of a standard deviation of between / sqrt(2) at the rim of the cloud.
void move_scans(const Law& law, const Frame& frame, double spacing, Random& random, NoisyCloud& cloud) {
  const double each = law.between * spacing / std::sqrt(2.0);
  std::vector<Eigen::Isometry3d> motions;
  for (int s = 0; s < law.scans; ++s) {
    const Vector3d shift = each * random.normal3();
    const double angle = each / frame.radius * random.normal();
    motions.push_back(Eigen::Translation3d(frame.centre + shift) *
                      Eigen::AngleAxisd(angle, random.direction()) * Eigen::Translation3d(-frame.centre));
  }
  for (Vector3d& p : cloud.measured) {
    cloud.scan.push_back(Index(random.uniform() * law.scans));
    p = motions[cloud.scan.back()] * p;
  }
}

/// Each point along its ray to the nearest whole step of depth.
void count_steps(const Vector3d& eye, double step, Positions& points) {
  for (Vector3d& p : points) {
    const double depth = eye[2] - p[2], whole = step * std::round(depth / step);
    p = eye + whole / depth * (p - eye);
    p[2] = eye[2] - whole;
  }
}

}  // namespace

const std::vector<Law>& laws() {
  static const std::vector<Law> list = make_laws();
  return list;
}

const Law* find_law(std::string_view name) {
  for (const Law& law : laws())
    if (law.name == name) return &law;
  return nullptr;
}

Law scaled(Law law, double times) {
  for (double* length : {&law.sigma, &law.clumps, &law.between, &law.step}) *length *= times;
  return law;
}

Frame frame_of(const Positions& points) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : points) box.extend(p);
  Frame frame;
  frame.centre = box.center();
  for (const Vector3d& p : points) frame.radius = std::max(frame.radius, (p - frame.centre).norm());
  frame.eye = frame.centre + kEyeDistance * frame.radius * Vector3d::UnitZ();
  return frame;
}

NoisyCloud add_noise(const Law& law, const Spots& spots, double spacing, std::uint64_t seed) {
  const Frame frame = frame_of(spots.points);
  Random random(seed);
  NoisyCloud cloud;
  cloud.eye = frame.eye;
  cloud.measured = spots.points;
  const std::vector<char> calm = law.half < 1 ? calm_half(spots.points, frame.centre) : std::vector<char>();
  if (law.half == 0) cloud.exact = calm;
  const Positions noise = standard_noise(spots.points, law.correlated, random);
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const double loud = law.loud_share > 0 && random.uniform() < law.loud_share ? law.loud_times : 1;
    const Vector3d ray = spots.points[i] - frame.eye;
    const double range = std::pow(ray.norm() / (kEyeDistance * frame.radius), law.range_power);
    const double of_half = !calm.empty() && calm[i] != 0 ? law.half : 1;
    if (of_half == 0) continue;
    const double sigma = law.sigma * spacing * of_half * loud * range;
    cloud.measured[i] += sigma * (law.along_ray ? Vector3d(noise[i][0] * ray.normalized()) : noise[i]);
  }
  if (law.clumps > 0 && !spots.clump.empty()) {
    Positions shift(1 + *std::max_element(spots.clump.begin(), spots.clump.end()));
    for (Vector3d& s : shift) s = law.clumps * spacing * random.normal3();
    for (std::size_t i = 0; i < noise.size(); ++i) cloud.measured[i] += shift[spots.clump[i]];
  }
  if (law.scans > 1) move_scans(law, frame, spacing, random, cloud);
  if (law.step > 0) count_steps(frame.eye, law.step * spacing, cloud.measured);
  return cloud;
}

}  // namespace rfsmooth::clouds
