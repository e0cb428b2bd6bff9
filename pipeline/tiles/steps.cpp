#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <sys/resource.h>

#include "base/fail.h"
#include "base/parallel.h"
#include "base/quantile.h"
#include "pipeline/io/io.h"
#include "pipeline/measure_points.h"
#include "pipeline/tiles/halo.h"
#include "pipeline/tiles/job.h"
#include "pipeline/tiles/records.h"
#include "pipeline/tiles/row_file.h"
#include "pipeline/tiles/statistics_json.h"
#include "pipeline/tiles/tile_normals.h"
#include "rfs_mesh/connect/umbrella.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::pipeline::tiles {

namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using nlohmann::ordered_json;

constexpr int kRingsOfSwaps = 2;  // a swap changes two faces, and needs their four neighbours to itself

[[noreturn]] void refuse_step(const Job& job, const std::string& message) {
  fail(ErrorCode::usage, "{}: {}", job.folder.string(), message);
}

void check_tile(const Job& job, std::size_t tile) {
  if (tile >= job.tiles.size())
    refuse_step(job, fmt::format("there is no tile {}; they are 0 to {}", tile, job.tiles.size() - 1));
}

/// The flows that clouds are smoothed by in tiles.
std::vector<std::string_view> flows_in_tiles() {
  std::vector<std::string_view> names;
  for (const AnyFlow& flow : flows())
    if (std::holds_alternative<AutomaticOptions>(flow) || support_rings({flow}))
      names.push_back(name_of(flow));
  return names;
}

Vector3d place(const Record& r) {
  return {r.x, r.y, r.z};
}

/// Of this process, all threads.
double processor_seconds() {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

void append(const std::vector<Record>& points, std::vector<double>& xyz) {
  for (const Record& r : points) xyz.insert(xyz.end(), {r.x, r.y, r.z});
}

Settled settled_of(const Job& job) {
  if (!std::filesystem::exists(job.settled())) refuse_step(job, "is not settled yet");
  return read_settled(job.settled());
}

/// Whether a tile is smoothed, and has its normals if it is to have some.
bool is_run(const Job& job, std::size_t tile, bool normals, const Context& context) {
  const auto there = complete_records(job.done(tile), context);
  return there && *there == job.tiles[tile].points && (!normals || complete_normals(job, tile, context));
}

/// The records of all tiles, by rows.
template <class T>
class OfAllTiles {
 public:
  OfAllTiles(const Job& job, std::filesystem::path (Job::*of_tile)(std::size_t) const, const Context& context)
      : context_(context) {
    for (std::size_t t = 0; t < job.tiles.size(); ++t) readers_.emplace_back((job.*of_tile)(t), context_);
  }
  /// Calls `visit(row - first, record, tile)` for rows [first, first + count), in no order. Forward only.
  template <class Visit>
  void visit(std::uint64_t first, std::uint64_t count, Visit&& visit) {
    context_.check_stop();
    for (std::size_t t = 0; t < readers_.size(); ++t)
      for (const T* r = readers_[t].peek(); r != nullptr && r->row < first + count; r = readers_[t].peek()) {
        readers_[t].next();
        if (r->row >= first) visit(std::size_t(r->row - first), *r, t);  // else of an input before this one
      }
  }

 private:
  const Context& context_;
  std::vector<ReaderOf<T>> readers_;
};

/// Patches the rows of the inputs with the results of all tiles.
class Patcher {
 public:
  Patcher(const Job& job, const Context& context) : places_(job, &Job::done, context) {}
  /// With normals, which must be there.
  void add_normals(const Job& job, const Context& context) {
    reversed_ = find_sides(job, context);
    normals_.emplace(job, &Job::normals, context);
  }
  /// `first`: the row of the cloud that `rows` begins with.
  void patch(const RowFile& file, std::uint64_t first, std::uint64_t count, io::Bytes& rows) {
    places_.visit(first, count, [&](std::size_t row, const Record& r, std::size_t) {
      file.put(rows, row, {r.x, r.y, r.z});
      ++patched_;
    });
    if (!normals_) return;
    normals_->visit(first, count, [&](std::size_t row, const NormalRecord& r, std::size_t tile) {
      const double sign = reversed_[tile][std::size_t(r.piece)] != 0 ? -1 : 1;
      file.put_normal(rows, row, {sign * r.x, sign * r.y, sign * r.z});
    });
  }
  std::uint64_t patched() const { return patched_; }

 private:
  OfAllTiles<Record> places_;
  std::optional<OfAllTiles<NormalRecord>> normals_;
  std::vector<std::vector<char>> reversed_;  ///< by tile and piece
  std::uint64_t patched_ = 0;
};

/// A box of coordinates.
struct Ends {
  std::array<double, 3> low, high;
  Ends() {
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
  }
  void add(const std::array<double, 3>& xyz) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], xyz[axis]);
      high[axis] = std::max(high[axis], xyz[axis]);
    }
  }
};

/// The box of the coordinates as they will be written, for the header of a LAS file.
void find_box(const Job& job, RowFile& file, std::uint64_t before, const Context& context) {
  Patcher patcher(job, context);
  Ends ends;
  file.for_each_piece(context, [&](std::uint64_t first, std::size_t count, io::Bytes& rows) {
    patcher.patch(file, before + first, count, rows);
    for (std::size_t i = 0; i < count; ++i) ends.add(file.get(rows, i));
  });
  if (file.rows() > 0) file.set_box(ends.low, ends.high);
}

/// Refines the scale of a LAS file to `step`, unless nothing of it moved.
io::RefinedScale refine_moved(const Job& job, RowFile& file, std::uint64_t before, double step,
                              const Context& context) {
  OfAllTiles<Record> places(job, &Job::done, context);
  Ends ends;
  bool moved = false;
  file.for_each_piece(context, [&](std::uint64_t first, std::size_t count, const io::Bytes& rows) {
    for (std::size_t i = 0; i < count; ++i) ends.add(file.get(rows, i));
    places.visit(before + first, count, [&](std::size_t row, const Record& r, std::size_t) {
      const std::array<double, 3> now = {r.x, r.y, r.z};
      moved = moved || now != file.get(rows, row);
      ends.add(now);
    });
  });
  return moved ? file.refine_scale(step, ends.low, ends.high) : io::RefinedScale();
}

/// How far away a point may be that has a say in where another goes: through quadrics, the rough mesh's
/// neighbourhoods and the patches (kHaloRadii), then along the mesh. Fills `widest`, `radii` and `halo`.
/// \param sample of the points
void find_halo(const DenoiseOptions& options, const Positions& sample, const Context& context,
               Settled& settled) {
  settled.widest = std::size_t(options.connect.neighbours);
  const Statistics& found = settled.report.statistics;
  if (found.scale) settled.widest = std::max(settled.widest, found.scale->neighbours);
  if (found.noise && found.noise->across) settled.widest = std::max(settled.widest, *found.noise->across);
  for (const auto& pass : found.passes)
    for (const auto& scale : pass.scales) settled.widest = std::max(settled.widest, scale.members);
  const double radius = typical_radius(sample, settled.widest, context);
  settled.halo = kHaloRadii * radius;
  if (const auto rings = support_rings(options.flow)) {
    const int swaps = options.swap ? std::max(0, iterations(options.flow.flow) - 1) : 0;
    const double longest_edge = typical_radius(sample, rfs_mesh::kMostRibs, context);
    settled.halo += (*rings + kRingsOfSwaps * swaps) * longest_edge;
  }
  settled.radii = radius > 0 ? settled.halo / radius : kHaloRadii;
}

/// Calls `visit(record, tile)` for the points of all other tiles that are in what `meets` and `holds`.
template <class Meets, class Holds, class Visit>
void for_each_around(const Job& job, std::size_t tile, const Context& context, Meets&& meets, Holds&& holds,
                     Visit&& visit) {
  for (std::size_t t = 0; t < job.tiles.size(); ++t) {
    if (t == tile || job.tiles[t].points == 0) continue;
    if (!meets(AlignedBox3d(job.tiles[t].box.low, job.tiles[t].box.high))) continue;
    RecordReader reader(job.cut(t), context);
    for (; const Record* r = reader.peek(); reader.next())
      if (holds(place(*r))) visit(*r, t);
  }
}

/// Calls `visit(record, tile)` for the points of a tile's halo.
template <class Visit>
void for_each_in(const Job& job, std::size_t tile, const Halo& halo, const Context& context, Visit&& visit) {
  for_each_around(
      job, tile, context, [&](const AlignedBox3d& other) { return halo.meets(other); },
      [&](const Vector3d& p) { return halo.holds(p); }, visit);
}

/// Leaves so many of a tile's points that all tiles have `wanted` together: those nearest to the one in the
/// middle of the tile, a piece of the surface that is as whole as it can be.
void keep_middle(const Job& job, std::size_t tile, std::uint64_t wanted, std::vector<Record>& points) {
  const double share = double(wanted) / double(job.points);
  const auto kept = std::size_t(std::ceil(share * double(job.tiles[tile].points)));
  if (kept >= points.size() || points.empty()) return;
  const Vector3d middle = 0.5 * (job.tiles[tile].box.low + job.tiles[tile].box.high);
  const auto nearer = [](const Vector3d& to) {
    return [to](const Record& a, const Record& b) {
      const double x = (place(a) - to).squaredNorm(), y = (place(b) - to).squaredNorm();
      return x != y ? x < y : a.row < b.row;
    };
  };
  const Vector3d centre = place(*std::min_element(points.begin(), points.end(), nearer(middle)));
  std::nth_element(points.begin(), points.begin() + std::ptrdiff_t(kept), points.end(), nearer(centre));
  points.resize(kept);
  std::sort(points.begin(), points.end(), [](const Record& a, const Record& b) { return a.row < b.row; });
}

/// Points of all tiles, n x 3: those that are measured, where they are more, and those that are smoothed.
struct Sample {
  std::vector<double> measured, smoothed;
};

Sample sample_of(const Job& job, const Context& context) {
  Sample sample;
  const bool more = job.sample < job.measured;
  const std::size_t rounded_up = job.tiles.size();  // in every tile
  if (more) sample.measured.reserve(3 * (std::size_t(job.measured) + rounded_up));
  sample.smoothed.reserve(3 * (std::size_t(job.sample) + rounded_up));
  for (std::size_t t = 0; t < job.tiles.size(); ++t) {
    std::vector<Record> points = read_records(job.sampled(t), context);
    if (more) append(points, sample.measured);
    keep_middle(job, t, job.sample, points);
    append(points, sample.smoothed);
  }
  return sample;
}

/// How a tile's points moved, and how many have no surface near them. `now`, `outlier`: theirs come first.
ordered_json moves_of(const std::vector<Record>& own, const std::vector<double>& now,
                      const std::vector<char>& outlier) {
  std::size_t moved = 0;
  double squares = 0, largest = 0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    const Vector3d move = Vector3d(now[3 * i], now[3 * i + 1], now[3 * i + 2]) - place(own[i]);
    moved += std::size_t(move.squaredNorm() > 0);
    squares += move.squaredNorm();
    largest = std::max(largest, move.norm());
  }
  const auto strays =
      outlier.empty() ? 0
                      : std::count(outlier.begin(), outlier.begin() + std::ptrdiff_t(own.size()), char(1));
  return {{"moved", moved}, {"squares", squares}, {"largest", largest}, {"outliers", strays}};
}

/// The surroundings of a tile, and how many points they are with the tile's own.
struct Surroundings {
  Halo halo;
  std::uint64_t points = 0;
};

std::uint64_t count_in(const Job& job, std::size_t tile, const Halo& halo, const Context& context) {
  std::uint64_t points = job.tiles[tile].points;
  for_each_in(job, tile, halo, context, [&](const Record&, std::size_t) { ++points; });
  return points;
}

/// Those of a tile of these points.
Surroundings surroundings_of(const Job& job, std::size_t tile, const std::vector<Record>& own,
                             const Settled& settled, const Context& context) {
  const AlignedBox3d box(job.tiles[tile].box.low, job.tiles[tile].box.high);
  const double most = std::pow(settled.halo / settled.radii, 2);
  Positions points;
  for (const Record& r : own) points.push_back(place(r));
  for_each_around(
      job, tile, context,
      [&](const AlignedBox3d& other) { return box.squaredExteriorDistance(other) <= most; },
      [&](const Vector3d& p) { return box.squaredExteriorDistance(p) <= most; },
      [&](const Record& r, std::size_t) { points.push_back(place(r)); });
  std::optional<Halo> halo;
  in_arena(context, [&] { halo.emplace(points, own.size(), settled.widest, settled.radii, context); });
  const std::uint64_t count = count_in(job, tile, *halo, context);
  return {std::move(*halo), count};
}

/// Makes them narrower until they are at most so many points.
void narrow(const Job& job, std::size_t tile, std::uint64_t most, const Context& context,
            Surroundings& around) {
  constexpr double kNarrower = 0.85;
  most = std::max(most, job.tiles[tile].points);
  for (int round = 0; around.points > most && round < 100; ++round) {
    around.halo.scale(kNarrower);
    around.points = count_in(job, tile, around.halo, context);
  }
}

void check_inputs(const Job& job) {
  for (const JobInput& input : job.inputs) {
    std::error_code error;
    if (std::filesystem::file_size(input.path, error) != input.bytes || error ||
        std::filesystem::last_write_time(input.path, error).time_since_epoch().count() != input.changed)
      refuse_step(job, fmt::format("{} changed since it was planned; plan again", input.path));
  }
}

}  // namespace

void check_for_tiles(const DenoiseOptions& options) {
  const FlowOptions& flow = options.flow;
  const auto* automatic = std::get_if<AutomaticOptions>(&flow.flow);
  if (automatic != nullptr && automatic->iterations != 1)
    fail(ErrorCode::usage, "in tiles the automatic flow takes one iteration");
  if (automatic != nullptr && flow.modifiers.any())
    fail(ErrorCode::usage, "in tiles the automatic flow goes without modifiers");
  if (automatic == nullptr && !support_rings(flow))
    fail(ErrorCode::usage,
         "any point of the cloud may have a say in where the flow '{}' moves another with these options, so "
         "they do not go in tiles; {} do, all vertices at once and without modifiers but `push-back`",
         name_of(flow.flow), fmt::join(flows_in_tiles(), ", "));
}

void check_format(io::Format input, const std::string& output) {
  if (const auto format = io::format_of_extension(output).value_or(input); format != input)
    fail(ErrorCode::usage, "{}: in tiles a cloud keeps its format, {}", output, io::name_of(input));
}

Settled read_settled(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) fail(ErrorCode::input_unreadable, "{}: cannot be read", path.string());
  try {
    const ordered_json json = ordered_json::parse(file);
    Settled settled = {{}, json.at("halo"), json.at("halo_radii"), json.at("widest")};
    DenoiseReport& report = settled.report;
    report.statistics = statistics_of(json.at("statistics"));
    report.noise = json.at("noise");
    report.noise_left = json.at("noise_left");
    report.measured = summary_of(json.at("noise_measured"));
    report.not_smoothed = not_smoothed_of(json.at("not_smoothed"));
    report.guide_strength = json.at("guide_strength");
    report.tail_times = json.at("tail_times");
    report.spacing = json.at("spacing");
    return settled;
  } catch (const nlohmann::json::exception& error) {
    fail(ErrorCode::input_unreadable, "{}: {}", path.string(), error.what());
  }
}

ordered_json read_cost(const Job& job, std::size_t tile) {
  std::ifstream file(job.cost(tile));
  ordered_json cost = ordered_json::parse(file, nullptr, false);
  return cost.is_object() ? cost : ordered_json::object();
}

void measure_tile(const Job& job, std::size_t tile, const Context& context) {
  check_tile(job, tile);
  if (complete_records(job.sampled(tile), context)) return;
  std::vector<Record> points = read_records(job.cut(tile), context);
  keep_middle(job, tile, job.measured, points);
  RecordWriter writer(job.sampled(tile), context);
  for (const Record& r : points) writer.add(r);
  writer.commit();
}

void settle_job(const Job& job, const DenoiseOptions& options, const Context& context) {
  if (std::filesystem::exists(job.settled())) return;
  check_for_tiles(options);
  for (std::size_t t = 0; t < job.tiles.size(); ++t)
    if (!complete_records(job.sampled(t), context))
      refuse_step(job, fmt::format("tile {} is not measured yet", t));
  DenoiseOptions how = options;
  how.statistics.emplace();
  how.statistics->box = job.box;
  Sample sample = sample_of(job, context);
  if (!sample.measured.empty()) how.statistics = measure_points(std::move(sample.measured), how, context);
  const std::vector<double>& xyz = sample.smoothed;
  const std::size_t n = xyz.size() / 3;
  if (n < job.points) how.statistics->points = std::size_t(job.points);
  std::vector<double> smooth = xyz;
  Settled settled;
  settled.report = value_or_throw(denoise(smooth.data(), n, how, context));
  const DenoiseReport& report = settled.report;
  in_arena(context, [&] { find_halo(options, io::points_of(xyz), context, settled); });
  const ordered_json json = {{"halo", settled.halo},
                             {"halo_radii", settled.radii},
                             {"widest", settled.widest},
                             {"noise", report.noise},
                             {"noise_left", report.noise_left},
                             {"noise_measured", json_of(report.measured)},
                             {"not_smoothed", json_of(report.not_smoothed)},
                             {"guide_strength", report.guide_strength},
                             {"tail_times", report.tail_times},
                             {"spacing", report.spacing},
                             {"statistics", json_of(report.statistics)}};
  value_or_throw(io::write_bytes(json.dump(1) + '\n', job.settled(), true, context));
}

void run_tile(const Job& job, std::size_t tile, const DenoiseOptions& options,
              const std::optional<NormalsOptions>& normals, const Context& context, std::uint64_t most) {
  check_tile(job, tile);
  check_for_tiles(options);
  const Settled settled = settled_of(job);
  if (is_run(job, tile, normals.has_value(), context)) return;
  const double began = processor_seconds();
  std::vector<Record> own = read_records(job.cut(tile), context);
  std::vector<double> xyz;
  std::vector<Around> around;
  append(own, xyz);
  Surroundings surroundings = surroundings_of(job, tile, own, settled, context);
  narrow(job, tile, most, context, surroundings);
  for_each_in(job, tile, surroundings.halo, context, [&](const Record& r, std::size_t t) {
    xyz.insert(xyz.end(), {r.x, r.y, r.z});
    if (normals) around.push_back({r.row, t});
  });
  std::vector<char> outlier;
  if (!own.empty()) {
    DenoiseOptions how = options;
    how.statistics = settled.report.statistics;
    outlier = value_or_throw(denoise(xyz.data(), xyz.size() / 3, how, context)).outlier;
  }
  ordered_json cost = {{"around", xyz.size() / 3 - own.size()}, {"seconds", 0}};
  cost.update(moves_of(own, xyz, outlier));
  if (normals)  // from within the widest patch, where those of both tiles are good
    cost.update(write_normals(job, tile, own, around, xyz, *normals, settled.halo / kHaloRadii, context));
  RecordWriter writer(job.done(tile), context);
  for (std::size_t i = 0; i < own.size(); ++i)
    writer.add({own[i].row, xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]});
  cost["seconds"] = processor_seconds() - began;
  value_or_throw(io::write_bytes(cost.dump() + '\n', job.cost(tile), true, context));
  writer.commit();
}

std::vector<Joined> join_job(const Job& job, const std::vector<std::string>& outputs, bool force,
                             bool keep_scale, bool normals, const Context& context) {
  check_inputs(job);
  for (std::size_t t = 0; t < job.tiles.size(); ++t)
    if (!is_run(job, t, normals, context)) refuse_step(job, fmt::format("tile {} is not smoothed yet", t));
  const DenoiseReport settled = settled_of(job).report;
  const double step = io::finest_needed(settled.noise, settled.noise_left);
  std::vector<Joined> joined;
  Patcher patcher(job, context);
  if (normals) patcher.add_normals(job, context);
  std::uint64_t before = 0;
  for (std::size_t i = 0; i < job.inputs.size(); ++i) {
    RowFile file(job.inputs[i].path, context);
    check_format(file.format(), outputs[i]);
    if (normals) file.need_normals();
    const bool las = file.format() == io::Format::las;
    joined.push_back({las, {}, settled.noise, settled.noise_left});
    if (las && !keep_scale && settled.noise > 0)
      joined.back().scale = refine_moved(job, file, before, step, context);
    if (las) find_box(job, file, before, context);
    io::AtomicFile to(outputs[i], force, context);
    file.copy(
        to,
        [&](std::uint64_t first, std::size_t count, io::Bytes& rows) {
          context.report("join", double(before + first) / double(job.points + 1));
          patcher.patch(file, before + first, count, rows);
        },
        context);
    to.commit(true);
    before += file.rows();
  }
  if (patcher.patched() != job.points)
    fail(ErrorCode::internal, "{} of {} points were written", patcher.patched(), job.points);
  return joined;
}

DenoiseReport report_of(const Job& job, const DenoiseOptions& options) {
  DenoiseReport report = settled_of(job).report;
  report.effective = options;
  for (const JobInput& input : job.inputs) report.points += std::size_t(input.rows);
  report.finite = std::size_t(job.points);
  double squares = 0;
  for (std::size_t t = 0; t < job.tiles.size(); ++t) {
    const ordered_json cost = read_cost(job, t);
    report.moved += cost.value("moved", std::size_t{0});
    report.outliers += cost.value("outliers", std::size_t{0});
    report.largest_move = std::max(report.largest_move, cost.value("largest", 0.0));
    squares += cost.value("squares", 0.0);
  }
  if (report.finite > 0) report.rms_move = std::sqrt(squares / double(report.finite));
  return report;
}

std::uint64_t points_with_halo(const Job& job, std::size_t tile, const Context& context) {
  const std::vector<Record> own = read_records(job.cut(tile), context);
  return surroundings_of(job, tile, own, settled_of(job), context).points;
}

JobStatus job_status(const Job& job, const Context& context) {
  JobStatus status;
  status.tiles = job.tiles.size();
  status.points = job.points;
  double around = 0, within = 0;
  status.settled = std::filesystem::exists(job.settled());
  if (status.settled) status.halo = read_settled(job.settled()).halo;
  for (std::size_t t = 0; t < job.tiles.size(); ++t) {
    status.measured += std::size_t(complete_records(job.sampled(t), context).has_value());
    if (!is_run(job, t, false, context)) {
      status.missing.push_back(t);
      continue;
    }
    ++status.run;
    const ordered_json cost = read_cost(job, t);
    if (cost.empty()) continue;
    around += cost.value("around", 0.0);
    within += double(job.tiles[t].points);
    status.seconds += cost.value("seconds", 0.0);
  }
  if (within > 0) status.halo_share = around / within;
  return status;
}

}  // namespace rfsmooth::pipeline::tiles
