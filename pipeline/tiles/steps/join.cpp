#include "pipeline/tiles/steps/join.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/io/stream/atomic_file.h"
#include "pipeline/tiles/allowed.h"
#include "pipeline/tiles/files/records.h"
#include "pipeline/tiles/files/row_file.h"
#include "pipeline/tiles/steps/run.h"
#include "pipeline/tiles/steps/settle.h"
#include "pipeline/tiles/tile_normals.h"

namespace rfsmooth::pipeline::tiles {

namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// The records of all tiles, by rows, from row `from` on; repeats have those of the first row at their place.
template <class T>
class OfAllTiles {
 public:
  OfAllTiles(const Job& job, std::filesystem::path (Job::*of_tile)(std::size_t) const, std::uint64_t from,
             const Context& context)
      : context_(context) {
    for (std::size_t t = 0; t < job.tiles.size(); ++t) {
      readers_.emplace_back((job.*of_tile)(t), context_);
      if (from > 0) readers_.back().skip_to(from);
    }
    if (job.repeated.empty()) return;
    for (const RepeatedPlace& place : job.repeated) find_first(job, of_tile, place);
    repeats_.emplace(job.repeats(), context_);
    repeats_->skip_to(from);
  }
  /// Calls `visit(row - first, record, tile)` for rows [first, first + count), in no order. Forward only.
  template <class Visit>
  void visit(std::uint64_t first, std::uint64_t count, Visit&& visit) {
    context_.check_stop();
    for (std::size_t t = 0; t < readers_.size(); ++t)
      for (const T* r = readers_[t].peek(); r != nullptr && r->row < first + count; r = readers_[t].peek()) {
        readers_[t].next();
        visit(std::size_t(r->row - first), *r, t);
      }
    if (repeats_) visit_repeats(first, count, visit);
  }

 private:
  /// What became of the first row at a place, and the tile that this is in.
  struct AtPlace {
    Vector3d at;
    T record;
    std::size_t tile;
  };

  void find_first(const Job& job, std::filesystem::path (Job::*of_tile)(std::size_t) const,
                  const RepeatedPlace& place) {
    for (std::size_t t = 0; t < job.tiles.size(); ++t) {
      ReaderOf<T> reader((job.*of_tile)(t), context_);
      reader.skip_to(place.first);
      const T* const r = reader.peek();
      if (r != nullptr && r->row == place.first) return first_.push_back({place.at, *r, t});
    }
    fail(ErrorCode::internal, "row {} is in no tile", place.first);
  }

  template <class Visit>
  void visit_repeats(std::uint64_t first, std::uint64_t count, Visit& visit) {
    for (const Record* r = repeats_->peek(); r != nullptr && r->row < first + count; r = repeats_->peek()) {
      repeats_->next();
      const Vector3d at = place(*r);
      const auto same =
          std::find_if(first_.begin(), first_.end(), [&](const AtPlace& other) { return other.at == at; });
      if (same == first_.end()) fail(ErrorCode::internal, "row {} repeats no other", r->row);
      T record = same->record;
      record.row = r->row;
      visit(std::size_t(r->row - first), record, same->tile);
    }
  }

  const Context& context_;
  std::vector<ReaderOf<T>> readers_;
  std::vector<AtPlace> first_;
  std::optional<RecordReader> repeats_;
};

/// Patches the rows of the inputs, from row `from` on, with the results of all tiles.
class Patcher {
 public:
  Patcher(const Job& job, std::uint64_t from, const Context& context)
      : places_(job, &Job::done, from, context) {}
  /// With normals, which must be there.
  void add_normals(const Job& job, const Context& context) {
    reversed_ = find_sides(job, context);
    normals_.emplace(job, &Job::normals, 0, context);
  }
  /// `first`: the row of the cloud that `rows` begins with. \return how many points the file's coordinates
  /// cannot say.
  std::size_t patch(const RowFile& file, std::uint64_t first, std::uint64_t count, io::Bytes& rows) {
    std::size_t beyond = 0;
    places_.visit(first, count, [&](std::size_t row, const Record& r, std::size_t) {
      file.put(rows, row, place(r));
      beyond += std::size_t(!io::can_hold(file.coordinates(), place(r)));
      ++patched_;
    });
    if (!normals_) return beyond;
    normals_->visit(first, count, [&](std::size_t row, const NormalRecord& r, std::size_t tile) {
      const double sign = reversed_[tile][std::size_t(r.piece)] != 0 ? -1 : 1;
      file.put_normal(rows, row, sign * Vector3d(r.x, r.y, r.z));
    });
    return beyond;
  }
  std::uint64_t patched() const { return patched_; }

 private:
  OfAllTiles<Record> places_;
  std::optional<OfAllTiles<NormalRecord>> normals_;
  std::vector<std::vector<char>> reversed_;  ///< by tile and piece
  std::uint64_t patched_ = 0;
};

/// An input, open, and its first row's number in the cloud.
struct OpenInput {
  RowFile file;
  std::uint64_t before = 0;
};

/// Refines the scale of a LAS file to `step`, unless nothing of it moved: then all of it is zeros.
io::RefinedScale refine_moved(const Job& job, OpenInput& input, double step, const Context& context) {
  OfAllTiles<Record> places(job, &Job::done, input.before, context);
  AlignedBox3d box;
  bool moved = false;
  const RowFile& file = input.file;
  file.for_each_piece(context, [&](std::uint64_t first, std::size_t count, const io::Bytes& rows) {
    for (std::size_t i = 0; i < count; ++i) box.extend(file.get(rows, i));
    places.visit(input.before + first, count, [&](std::size_t row, const Record& r, std::size_t) {
      moved = moved || place(r) != file.get(rows, row);
      box.extend(place(r));
    });
  });
  return moved ? input.file.refine_scale(step, box) : io::RefinedScale();
}

/// Puts the box of the coordinates as they will be written into the header of a LAS file, unless it is the
/// box of the present ones: then the header says of it what it did.
void find_box(const Job& job, OpenInput& input, const Context& context) {
  Patcher patcher(job, input.before, context);
  AlignedBox3d before, after;
  const RowFile& file = input.file;
  file.for_each_piece(context, [&](std::uint64_t first, std::size_t count, io::Bytes& rows) {
    for (std::size_t i = 0; i < count; ++i) before.extend(file.get(rows, i));
    patcher.patch(file, input.before + first, count, rows);
    for (std::size_t i = 0; i < count; ++i) after.extend(file.get(rows, i));
  });
  if (before.min() != after.min() || before.max() != after.max()) input.file.set_box(after);
}

/// Makes the header of a LAS file ready for the new coordinates: first the scale, in steps of which the box
/// is written.
io::RefinedScale prepare_las(const Job& job, OpenInput& input, bool keep_scale, const DenoiseReport& settled,
                             const Context& context) {
  io::RefinedScale scale;
  if (settled.noise > 0)
    scale =
        refine_moved(job, input, io::finest_asked(keep_scale, settled.noise, settled.noise_left), context);
  find_box(job, input, context);
  return scale;
}

/// The input, patched, as `output`. Warns as set_positions.
void write_joined(const Job& job, const OpenInput& input, const std::string& output, bool force,
                  Patcher& patcher, const Context& context) {
  io::AtomicFile to(output, force, context);
  std::size_t beyond = 0;
  input.file.copy(
      to,
      [&](std::uint64_t first, std::size_t count, io::Bytes& rows) {
        context.report("join", double(input.before + first) / double(job.rows()));
        beyond += patcher.patch(input.file, input.before + first, count, rows);
      },
      context);
  io::warn_of_rounding(input.file.coordinates(), beyond, context);
  to.commit(true);
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

std::vector<Joined> join_job(const Job& job, const std::vector<std::string>& outputs, const JoinOptions& how,
                             const Context& context) {
  check_inputs(job);
  for (std::size_t t = 0; t < job.tiles.size(); ++t)
    if (!is_run(job, t, how.normals, context))
      refuse_step(job, fmt::format("tile {} is not smoothed yet", t));
  const DenoiseReport settled = settled_of(job).report;
  std::vector<Joined> joined;
  Patcher patcher(job, 0, context);
  if (how.normals) patcher.add_normals(job, context);
  std::uint64_t before = 0;
  for (std::size_t i = 0; i < job.inputs.size(); ++i) {
    OpenInput input = {RowFile(job.inputs[i].path, context), before};
    check_format(input.file.format(), outputs[i]);
    if (how.normals) input.file.need_normals();
    Joined& done = joined.emplace_back();
    done.las = input.file.format() == io::Format::las;
    if (done.las) done.scale = prepare_las(job, input, how.keep_scale, settled, context);
    if (!how.folder.empty()) io::make_folder(how.folder);
    write_joined(job, input, outputs[i], how.force, patcher, context);
    before += input.file.rows();
  }
  if (patcher.patched() != job.points)
    fail(ErrorCode::internal, "{} of {} points were written", patcher.patched(), job.points);
  return joined;
}

}  // namespace rfsmooth::pipeline::tiles
