#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <variant>

#include <rfsmooth/denoise.h>

#include "base/fail.h"
#include "base/parallel.h"
#include "base/quantile.h"
#include "base/stopwatch.h"
#include "pipeline/denoise_lean.h"
#include "pipeline/outliers.h"
#include "pipeline/prepare.h"
#include "pipeline/units/units.h"
#include "rfs_mesh/connect/connect.h"
#include "rfs_mesh/connect/edge_swap.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/points.h"
#include "smoothing/automatic/flow_auto.h"
#include "smoothing/trace.h"

namespace rfsmooth {

using namespace pipeline;

namespace {

/// The coordinates of all rows, n x 3: a caller's. Where they can be made again, nobody holds them meanwhile.
class Rows {
 public:
  Rows(double* xyz, std::size_t n) : xyz_(xyz), n_(n) {}
  Rows(std::vector<double>& xyz, const std::function<std::vector<double>()>& again)
      : xyz_(xyz.data()), n_(xyz.size() / 3), held_(&xyz), again_(again) {}

  double* xyz() const { return xyz_; }
  std::size_t size() const { return n_; }

  void give_up() {
    if (held_ == nullptr) return;
    std::vector<double>().swap(*held_);
    xyz_ = nullptr;
  }
  void take_back() {
    if (held_ == nullptr) return;
    *held_ = again_();
    xyz_ = held_->data();
  }

 private:
  double* xyz_;
  std::size_t n_;
  std::vector<double>* held_ = nullptr;
  std::function<std::vector<double>()> again_;
};

/// Takes over what the automatic smoother measured of the cloud and did in its first step: later ones
/// measure only what that left, and of it too little, for neighbours share it.
void enter(const smoothing::AutomaticFindings& first, DenoiseReport& report) {
  report.noise = first.noise;
  report.measured = first.measured;
  report.not_smoothed = first.not_smoothed;
  report.stranded = first.stranded;
  report.guide_strength = first.guide_strength;
  report.tail_times = first.tail_times;
  report.equalized_rms = first.equalized;
  report.equalized_largest = first.equalized_most;
}

/// Smooths the mesh, alternating steps and swaps. What is left of it are its positions.
void alternate(Mesh& mesh, const Constraints& constraints, const DenoiseOptions& options,
               DenoiseReport& report, const Context& context) {
  Statistics& whole = report.statistics;
  const int steps = iterations(options.flow.flow);
  const bool swap = options.swap && steps > 1;
  const auto* automatic = std::get_if<AutomaticOptions>(&options.flow.flow);
  std::optional<smoothing::AutomaticFindings> found, first;
  std::unique_ptr<Flow> flow;  // none where the automatic smoother has nothing around it
  if (automatic == nullptr)
    flow = value_or_throw(make_flow(mesh, options.flow, context, constraints));
  else if (options.flow.modifiers.any() || !constraints.strength.empty())
    flow = value_or_throw(
        make_flow([&](auto&&...) { return smoothing::make_automatic(*automatic, found, whole); }, mesh,
                  options.flow, context, constraints));
  smoothing::Tracer tracer(options.flow.trace ? &report.trace : nullptr, mesh, context);
  for (int step = 0; step < steps; ++step) {
    const bool last = step + 1 == steps;
    context.report("smooth", double(step) / steps);
    {
      const Stopwatch watch(report.seconds, "smooth");
      if (flow)
        flow->step(mesh, context);
      else
        found = smooth_automatically(
            mesh, *automatic, context,
            last && !options.flow.trace ? smoothing::Connectivity::used_up : smoothing::Connectivity::kept,
            step == 0 ? &whole : nullptr);
    }
    if (step == 0) first = found;
    tracer.add(mesh, context);
    if (!swap || last) continue;
    const Stopwatch watch(report.seconds, "swap");
    const std::size_t swaps = rfs_mesh::swap_edges(mesh, options.swaps, context);
    report.swaps += swaps;
    if (swaps > 0 && flow) flow->connectivity_changed(mesh, context);
  }
  context.report("smooth", 1);
  if (flow) report.solver = flow->solver();
  if (first)
    enter(*first, report);
  else if (steps == 0)
    report.not_smoothed = NotSmoothed::no_iterations;
  else if (automatic != nullptr)
    report.not_smoothed = NotSmoothed::too_few_points;
  if (report.not_smoothed)
    report.noise_left = report.noise;
  else if (first && !flow)
    report.noise_left = first->left;
}

/// The median edge length around each vertex: as far as a flow may move it. A noisy point is at least as far
/// from its neighbours as from the surface, so this does not stop a flow from taking noise away; it stops a
/// vertex beside a hole or a stray, whose ring is lopsided, from being dragged out of its neighbourhood.
std::vector<double> reaches(const Mesh& mesh, const Context& context) {
  std::vector<double> reach(mesh.positions.size(), 0);
  for_blocks(context, reach.size(), 4096, [&](std::size_t begin, std::size_t end) {
    std::vector<double> lengths;
    for (std::size_t i = begin; i < end; ++i) {
      lengths.clear();
      for (const Index j : mesh.one_ring[i])
        lengths.push_back((mesh.positions[i] - mesh.positions[j]).norm());
      reach[i] = rfsmooth::median(lengths);
    }
  });
  return reach;
}

/// \throw Failure if a flow left the realm of numbers.
void check_finite(const Positions& points, const DenoiseOptions& options, const Context& context) {
  for_each_index(context, points.size(), [&](std::size_t i) {
    if (!points[i].allFinite())
      fail(ErrorCode::usage,
           "the flow '{}' diverges with these options; smaller steps or fewer iterations are needed",
           name_of(options.flow.flow));
  });
}

/// Moves each row to where its working point is now, at most as far as its reach (empty: any); the only place
/// of run() that writes to the coordinates it was given, and it cannot fail or be cancelled.
void commit(double* xyz, const rfs_mesh::WorkingCloud& cloud, const Positions& now,
            const std::vector<double>& reach, DenoiseReport& report) {
  double square_sum = 0;
  const auto move = [&](std::size_t i, const double* from) {
    const Index p = cloud.of_input[i];
    if (p == kNone) return;
    double* const row = xyz + 3 * i;
    Eigen::Vector3d moved = now[p] - (Eigen::Vector3d(from[0], from[1], from[2]) - cloud.origin);
    if (!reach.empty())
      if (const double length = moved.norm(); length > reach[p]) moved *= reach[p] / length;
    bool changed = false;
    for (int axis = 0; axis < 3; ++axis) {
      const double before = row[axis], after = before + moved[axis];
      if (after == before) continue;  // keeps -0 and whatever bits the caller had
      row[axis] = after;
      changed = true;
    }
    report.moved += changed;
    const double square = moved.squaredNorm();
    square_sum += square;
    report.largest_move = std::max(report.largest_move, std::sqrt(square));
  };
  // Twins first: the rows that they move like are still where they were.
  for (std::size_t i = 0; i < cloud.like.size(); ++i)
    if (cloud.like[i] != kNone) move(i, xyz + 3 * std::size_t(cloud.like[i]));
  for (std::size_t i = 0; i < cloud.of_input.size(); ++i)
    if (cloud.like.empty() || cloud.like[i] == kNone) move(i, xyz + 3 * i);
  if (report.finite > 0) report.rms_move = std::sqrt(square_sum / double(report.finite));
}

/// The strengths of the working points, the least of their rows': twins are one working point.
std::vector<double> working_strengths(const std::vector<double>& strength,
                                      const rfs_mesh::WorkingCloud& cloud, std::size_t points) {
  std::vector<double> working(strength.empty() ? 0 : points, 1);
  for (std::size_t i = 0; i < strength.size(); ++i)
    if (const Index p = cloud.of_input[i]; p != kNone) working[p] = std::min(working[p], strength[i]);
  return working;
}

/// The strengths of the rows: where some share a position, the least of theirs, so that they move together.
std::vector<double> least_strengths(std::vector<double> strength, const rfs_mesh::WorkingCloud& cloud) {
  const std::vector<double> least = working_strengths(strength, cloud, cloud.points.size());
  for (std::size_t i = 0; i < strength.size(); ++i)
    if (const Index p = cloud.of_input[i]; p != kNone) strength[i] = least[p];
  return strength;
}

/// Outliers that the tails of the noise explain are none: such points stood alone among calm ones, and are
/// put onto the smoothed surface. `now`: the smoothed points; those landed are added. \param strength as
/// least_strengths
void land_tails(const double* xyz, const std::vector<double>& strength, const DenoiseOptions& options,
                const Context& context, rfs_mesh::WorkingCloud& cloud, Positions& now,
                DenoiseReport& report) {
  const auto* automatic = std::get_if<AutomaticOptions>(&options.flow.flow);
  if (automatic == nullptr || report.outliers == 0 || !(report.tail_times > 1)) return;
  const rfs_mesh::SpatialIndex surface(now, context);
  const double most =
      rfs_mesh::kNoiseReach * std::max(1.0, automatic->strength) * report.tail_times * report.noise;
  Positions added;  // only after all have landed: the surface must not change under them
  for (std::size_t i = 0; i < report.outlier.size(); ++i) {
    if (report.outlier[i] == 0) continue;
    const Eigen::Vector3d was = Eigen::Vector3d(&xyz[3 * i]) - cloud.origin;
    Eigen::Vector3d landed = was;
    if (!land(surface, most, landed)) continue;
    if (!strength.empty()) landed = was + strength[i] * (landed - was);
    cloud.of_input[i] = Index(now.size() + added.size());
    if (!cloud.like.empty()) cloud.like[i] = kNone;
    added.push_back(landed);
    report.outlier[i] = 0;
    --report.outliers;
  }
  now.insert(now.end(), added.begin(), added.end());
  if (report.outliers == 0) report.outlier.clear();
}

/// \throw Failure for stated noise that is larger than the whole cloud, which has no surface then; most
/// likely it is in other units. `spacing`: 0 if it is not known yet, and then only world units are looked at.
void refuse_noise_beyond(const Statistics::Box& box, double spacing, const DenoiseOptions& options) {
  const auto* automatic = std::get_if<AutomaticOptions>(&options.flow.flow);
  if (automatic == nullptr || !automatic->noise) return;
  const double noise = automatic->noise->resolve(spacing), size = (box.high - box.low).norm();
  if (noise > size && size > 0)
    fail(ErrorCode::usage,
         "`noise` is more than the whole cloud, {:.4g} times what it is from corner to corner; it takes the "
         "units of the coordinates, or times the spacing as in 0.5x",
         noise / size);
}

/// The points to work on.
rfs_mesh::WorkingCloud working_cloud(const double* xyz, std::size_t n, const DenoiseOptions& options,
                                     const Context& context, DenoiseReport& report) {
  const Stopwatch watch(report.seconds, "prepare");
  context.report("prepare", 0);
  const auto& box = report.statistics.box;
  auto cloud = value_or_throw(rfs_mesh::make_working_cloud(xyz, n, context, box ? &*box : nullptr));
  report.finite = cloud.finite();
  report.distinct = cloud.points.size();
  if (options.flow.modifiers.preserve == Preserve::height_field) {  // measured from the caller's own z = 0
    for (Eigen::Vector3d& p : cloud.points) p.z() += cloud.origin.z();
    cloud.origin.z() = 0;
  }
  std::vector<Index>().swap(cloud.multiplicity);  // nobody asks
  return cloud;
}

/// Whether the mesh's faces are read while it is smoothed: the automatic smoother asks for neighbours only.
bool reads_faces(const DenoiseOptions& options) {
  const FlowOptions& flow = options.flow;
  return !std::holds_alternative<AutomaticOptions>(flow.flow) || iterations(flow.flow) > 1 || flow.trace ||
         flow.modifiers.any();
}

/// The rough mesh of the points, less those that are outliers and set aside.
Connection connected(rfs_mesh::WorkingCloud& cloud, const DenoiseOptions& options, const Context& context,
                     DenoiseReport& report) {
  Statistics& whole = report.statistics;
  rfs_mesh::Wanted wanted;
  wanted.emst = wanted.tree = false;
  // As in the paper the edges of points that no face reaches go. Without neighbours such points stay under
  // flows; the automatic smoother puts them onto the surface (stranded.h). Kept, such an edge would carry a
  // stray over its whole length, and HC's push-back would throw its neighbour after it.
  wanted.loose_edges = false;
  wanted.surfaces = false;
  wanted.fill_holes = reads_faces(options);
  Prepared prepared =
      prepare(cloud, options.connect.neighbours, options.outliers, whole, report.seconds, context);
  report.outlier = std::move(prepared.outlier);
  report.outliers = std::size_t(std::count(report.outlier.begin(), report.outlier.end(), 1));
  if (!whole.points) whole.points = cloud.points.size();
  return value_or_throw(rfs_mesh::connect(std::move(*prepared.index), std::move(prepared.near),
                                          options.connect, wanted, context, &whole));
}

/// What the connection says of the cloud. Of the rest only the mesh is needed while smoothing.
Mesh told_of(Connection connection, DenoiseReport& report) {
  add_times(connection.seconds, report.seconds);
  report.spacing = connection.noise.spacing;
  report.noise = connection.noise.sigma;
  report.sdg_edges = connection.sdg.size();
  report.bridges = connection.bridges.size();
  report.faceless = connection.faceless;
  report.faces = connection.mesh.faces.size();
  report.edges = connection.mesh.edge_count();
  return std::move(connection.mesh);
}

DenoiseReport run(Rows rows, const DenoiseOptions& options, const Context& context,
                  const std::vector<double>& strengths) {
  DenoiseReport report;
  report.points = rows.size();
  report.effective = options;
  if (options.statistics) report.statistics = *options.statistics;
  rfs_mesh::WorkingCloud cloud = working_cloud(rows.xyz(), rows.size(), options, context, report);
  rows.give_up();
  const std::vector<double> strength = least_strengths(strengths, cloud);
  refuse_noise_beyond(cloud.box, 0, options);
  Mesh mesh = told_of(connected(cloud, options, context, report), report);
  refuse_noise_beyond(cloud.box, report.spacing, options);
  Positions().swap(cloud.points);  // the mesh has them, and the caller

  std::vector<double> reach;  // the automatic smoother keeps to its own
  if (!std::holds_alternative<AutomaticOptions>(options.flow.flow)) reach = reaches(mesh, context);
  alternate(mesh, {{}, working_strengths(strength, cloud, mesh.positions.size())}, options, report, context);
  check_finite(mesh.positions, options, context);
  rows.take_back();
  land_tails(rows.xyz(), strength, options, context, cloud, mesh.positions, report);
  context.check_stop();
  commit(rows.xyz(), cloud, mesh.positions, reach, report);
  return report;
}

/// \throw Failure for clouds of which the patches over all points would be more than 2^32: 14 lie over each.
void refuse_too_many(std::size_t n) {
  constexpr std::size_t kMostPoints = 300'000'000;
  if (n > kMostPoints)
    fail(ErrorCode::usage, "{} points; at most {} are smoothed at once, larger clouds in tiles", n,
         kMostPoints);
}

/// The same for clouds of any size; those that are far too large or too small in other units.
DenoiseReport run_in_working_units(const Rows& rows, const DenoiseOptions& options, const Context& context,
                                   const std::vector<double>& strength) {
  double* const xyz = rows.xyz();
  const std::size_t n = rows.size();
  const double unit = working_unit(xyz, n, context);
  if (unit == 1) return run(rows, options, context, strength);
  std::vector<double> before(xyz, xyz + 3 * n);
  for (double& x : before) x *= unit;
  std::vector<double> after = before;
  DenoiseOptions scaled = options;
  change_units(scaled, unit);
  DenoiseReport report = run({after.data(), n}, scaled, context, strength);
  for (std::size_t i = 0; i < after.size(); ++i)
    if (std::isfinite(after[i]) && after[i] != before[i]) xyz[i] = after[i] / unit;
  change_units(report, 1 / unit);
  return report;
}

/// \throw Failure for what needs a surface without the holes that a rough mesh has between its umbrellas.
void refuse_for_clouds(const Modifiers& modifiers) {
  if (modifiers.boundary != Boundary::free)
    fail(ErrorCode::usage,
         "`boundary` is for meshes: in the rough mesh of a cloud most edges with one face are holes between "
         "umbrellas, not the rim of the surface; use smooth-mesh, or `strength-field` to hold the points of "
         "a rim");
  if (modifiers.preserve == Preserve::volume)
    fail(ErrorCode::usage,
         "`preserve` volume is for closed meshes: the rough mesh of a cloud has holes between its umbrellas "
         "and encloses nothing; use smooth-mesh, or a flow that keeps size (auto, hc)");
}

Result<DenoiseReport> denoise_rows(const Rows& rows, const DenoiseOptions& options, const Context& context,
                                   const std::vector<double>& strength) {
  const std::size_t n = rows.size();
  if (!strength.empty() && strength.size() != n)
    throw std::invalid_argument("the strengths are not one per row");
  for (const double s : strength)
    if (!(s >= 0 && s <= 1)) throw std::invalid_argument("a strength is outside [0, 1]");
  return guarded([&] {
    refuse_too_many(n);
    value_or_throw(validate(options));
    value_or_throw(validate(options.flow));
    refuse_for_clouds(options.flow.modifiers);
    if (options.statistics)
      if (const auto wrong = check(*options.statistics); !wrong.empty())
        fail(ErrorCode::usage, "`statistics`: {}", wrong.front());
    DenoiseReport report;
    in_arena(context, [&] { report = run_in_working_units(rows, options, context, strength); });
    return report;
  });
}

}  // namespace

Result<DenoiseReport> denoise(double* xyz, std::size_t n, const DenoiseOptions& options,
                              const Context& context, const std::vector<double>& strength) {
  return denoise_rows({xyz, n}, options, context, strength);
}

Result<DenoiseReport> pipeline::denoise_lean(std::vector<double>& xyz,
                                             const std::function<std::vector<double>()>& again,
                                             const DenoiseOptions& options, const Context& context,
                                             const std::vector<double>& strength) {
  return denoise_rows({xyz, again}, options, context, strength);
}

std::size_t denoise_memory(std::size_t n) {
  // Peaks of 526 to 612 bytes a point beyond the input on a bumpy sphere of 200,000 and a million points with
  // noise of 0.2 to 3 spacings, one and two threads; the rest is room for clouds that take more patches.
  constexpr std::size_t kBytesPerPoint = 950, kFixed = std::size_t{20} << 20;
  return kFixed + n * kBytesPerPoint;
}

}  // namespace rfsmooth
