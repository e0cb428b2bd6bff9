#include "pipeline/tiles/steps/run.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <sys/resource.h>

#include "base/fail.h"
#include "base/parallel.h"
#include "pipeline/io/io.h"
#include "pipeline/tiles/allowed.h"
#include "pipeline/tiles/files/records.h"
#include "pipeline/tiles/halo.h"
#include "pipeline/tiles/steps/settle.h"
#include "pipeline/tiles/tile_normals.h"

namespace rfsmooth::pipeline::tiles {

namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using nlohmann::ordered_json;

/// Of this process, all threads.
double processor_seconds() {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
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
  Positions points, others;
  for (const Record& r : own) points.push_back(place(r));
  for_each_around(
      job, tile, context,
      [&](const AlignedBox3d& other) { return box.squaredExteriorDistance(other) <= most; },
      [&](const Vector3d& p) { return box.squaredExteriorDistance(p) <= most; },
      [&](const Record& r, std::size_t) { others.push_back(place(r)); });
  points = distinct_places(points);
  const std::size_t own_places = points.size();
  others = distinct_places(others);
  points.insert(points.end(), others.begin(), others.end());
  std::optional<Halo> halo;
  in_arena(context, [&] { halo.emplace(points, own_places, settled.widest, settled.radii, context); });
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

Gathered gather(const Job& job, std::size_t tile, const Settled& settled, bool normals, std::uint64_t most,
                const Context& context) {
  Gathered points;
  points.own = read_records(job.cut(tile), context);
  append_places(points.own, points.xyz);
  Surroundings surroundings = surroundings_of(job, tile, points.own, settled, context);
  narrow(job, tile, most, context, surroundings);
  for_each_in(job, tile, surroundings.halo, context, [&](const Record& r, std::size_t t) {
    points.xyz.insert(points.xyz.end(), {r.x, r.y, r.z});
    if (normals) points.around.push_back({r.row, t});
  });
  return points;
}

/// How a tile's points moved, and how many have no surface near them, with their repeats. `now`, `outlier`:
/// theirs come first.
ordered_json moves_of(const Job& job, const std::vector<Record>& own, const std::vector<double>& now,
                      const std::vector<char>& outlier) {
  std::uint64_t moved = 0, strays = 0;
  double squares = 0, largest = 0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    const Vector3d move = Vector3d(&now[3 * i]) - place(own[i]);
    const std::uint64_t rows = job.rows_with(own[i].row);
    moved += move.squaredNorm() > 0 ? rows : 0;
    strays += !outlier.empty() && outlier[i] != 0 ? rows : 0;
    squares += double(rows) * move.squaredNorm();
    largest = std::max(largest, move.norm());
  }
  return {{"moved", moved}, {"squares", squares}, {"largest", largest}, {"outliers", strays}};
}

}  // namespace

bool is_run(const Job& job, std::size_t tile, bool normals, const Context& context) {
  const auto there = complete_records(job.done(tile), context);
  return there && *there == job.tiles[tile].points && (!normals || complete_normals(job, tile, context));
}

void run_tile(const Job& job, std::size_t tile, const DenoiseOptions& options,
              const std::optional<NormalsOptions>& normals, const Context& context, std::uint64_t most) {
  check_tile(job, tile);
  check_for_tiles(options);
  const Settled settled = settled_of(job);
  if (is_run(job, tile, normals.has_value(), context)) return;
  const double began = processor_seconds();
  Gathered points = gather(job, tile, settled, normals.has_value(), most, context);
  auto& [own, around, xyz] = points;
  std::vector<char> outlier;
  if (!own.empty()) {
    DenoiseOptions how = options;
    how.statistics = settled.report.statistics;
    outlier = value_or_throw(denoise(xyz.data(), xyz.size() / 3, how, context)).outlier;
  }
  ordered_json cost = {{"around", xyz.size() / 3 - own.size()}, {"seconds", 0}};
  cost.update(moves_of(job, own, xyz, outlier));
  if (normals)  // from within the widest patch, where those of both tiles are good
    cost.update(write_normals(job, tile, points, *normals, settled.halo / kHaloRadii, context));
  RecordWriter writer(job.done(tile), context);
  for (std::size_t i = 0; i < own.size(); ++i)
    writer.add({own[i].row, xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]});
  cost["seconds"] = processor_seconds() - began;
  value_or_throw(io::write_bytes(cost.dump() + '\n', job.cost(tile), true, context));
  writer.commit();  // last: a tile counts as run once its points are there
}

std::uint64_t points_with_halo(const Job& job, std::size_t tile, const Context& context) {
  const std::vector<Record> own = read_records(job.cut(tile), context);
  return surroundings_of(job, tile, own, settled_of(job), context).points;
}

}  // namespace rfsmooth::pipeline::tiles
