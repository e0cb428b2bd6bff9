#include "pipeline/tiles/steps/plan.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <memory>
#include <utility>

#include <Eigen/Geometry>

#include "base/fail.h"
#include "base/quantile.h"
#include "pipeline/io/io.h"
#include "pipeline/tiles/files/job_json.h"
#include "pipeline/tiles/files/records.h"
#include "pipeline/tiles/files/row_file.h"
#include "pipeline/tiles/repeats.h"

namespace rfsmooth::pipeline::tiles {

namespace fs = std::filesystem;

namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using nlohmann::ordered_json;

constexpr std::uint64_t kPlanned = 250'000;  // points that the cuts are found among, to twice as many
constexpr std::size_t kOpen = 500;           // files that are written at once
constexpr const char* kFolders[] = {"cut", "sample", "done"};  // of a job
constexpr std::uint64_t kMeasuredOverSmoothed = 4;  // points: so many that measuring takes no more memory

/// A number that a place has, whatever its row: the finaliser of splitmix64 (Steele et al. 2014) of its bits.
std::uint64_t number_of(const Vector3d& p) {
  std::uint64_t hash = 0;
  for (int axis = 0; axis < 3; ++axis) {
    std::uint64_t bits;
    const double value = p[axis];
    std::memcpy(&bits, &value, sizeof bits);
    hash = (hash ^ bits) + 0x9e3779b97f4a7c15;
    hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9;
    hash = (hash ^ (hash >> 27)) * 0x94d049bb133111eb;
    hash ^= hash >> 31;
  }
  return hash;
}

/// Visits every finite row of every input, in order, as the part [from, to] of the stage "plan".
template <class Visit>
void for_each_point(const Job& job, double from, double to, const Context& context, Visit&& visit) {
  const auto all = double(job.rows());
  std::uint64_t row = 0;
  for (const JobInput& input : job.inputs) {
    const RowFile file(input.path, context);
    file.for_each_piece(context, [&](std::uint64_t, std::size_t count, const io::Bytes& rows) {
      context.report("plan", from + (to - from) * double(row) / all);
      for (std::size_t i = 0; i < count; ++i, ++row)
        if (const Vector3d p = file.get(rows, i); p.allFinite()) visit(row, p);
    });
  }
}

/// Places of a sample, each once. Memory: that of twice as many as there are.
class DistinctPlaces {
 public:
  /// \param expected places at most, as long as none come again
  explicit DistinctPlaces(std::size_t expected) : merge_at_(expected) { places_.reserve(expected); }
  void add(const Vector3d& p) {
    if (places_.size() == merge_at_) {
      merge();
      merge_at_ = std::max(merge_at_, 2 * places_.size());
    }
    places_.push_back(p);
  }
  std::vector<Vector3d> take() {
    merge();
    return std::move(places_);
  }

 private:
  void merge() {
    std::sort(places_.begin(), places_.end(), [](const Vector3d& a, const Vector3d& b) {
      return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    });
    places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
  }

  std::vector<Vector3d> places_;
  std::size_t merge_at_;
};

/// A tree of cuts: inner nodes have an axis and a place, leaves the number of a tile.
class Cuts {
 public:
  /// Halves the sample at the median of its widest axis until no part has more than `most`.
  Cuts(std::vector<Vector3d> sample, std::size_t most) : sample_(std::move(sample)), most_(most) {
    cut(0, sample_.size());
    std::vector<Vector3d>().swap(sample_);
  }
  std::size_t tiles() const { return tiles_; }
  std::size_t tile_of(const Vector3d& p) const {
    std::size_t at = 0;
    while (nodes_[at].axis >= 0) at = p[nodes_[at].axis] < nodes_[at].place ? at + 1 : nodes_[at].other;
    return nodes_[at].other;
  }

 private:
  struct Node {
    int axis = -1;          // -1: a leaf
    double place = 0;       // what is below goes to the next node, the rest to `other`
    std::size_t other = 0;  // of a leaf: the tile
  };

  void cut(std::size_t first, std::size_t last) {
    const std::size_t at = nodes_.size();
    nodes_.emplace_back();
    AlignedBox3d box;
    for (std::size_t i = first; i < last; ++i) box.extend(sample_[i]);
    Eigen::Index axis = 0;
    if (last - first <= most_ || !(box.sizes().maxCoeff(&axis) > 0)) {
      nodes_[at].other = tiles_++;
      return;
    }
    const auto begin = sample_.begin() + std::ptrdiff_t(first), end = sample_.begin() + std::ptrdiff_t(last),
               middle = begin + std::ptrdiff_t((last - first) / 2);
    std::nth_element(begin, middle, end,
                     [&](const Vector3d& a, const Vector3d& b) { return a[axis] < b[axis]; });
    double place = (*middle)[axis];
    if (place == box.min()[axis])  // half of them are at the end: cut behind these
      place = std::nextafter(place, box.max()[axis]);
    const auto upper = std::partition(begin, end, [&](const Vector3d& p) { return p[axis] < place; });
    const auto half = std::size_t(upper - sample_.begin());
    nodes_[at].axis = int(axis);
    nodes_[at].place = place;
    cut(first, half);
    nodes_[at].other = nodes_.size();
    cut(half, last);
  }

  std::vector<Vector3d> sample_;
  std::size_t most_, tiles_ = 0;
  std::vector<Node> nodes_;
};

JobInput describe_input(const std::string& path, const Context& context) {
  const RowFile file(path, context);
  return {fs::absolute(path).lexically_normal().string(), file.rows(), fs::file_size(path),
          std::int64_t(fs::last_write_time(path).time_since_epoch().count())};
}

/// The job whose plan is in the folder, if that is of the same inputs, options and `how`.
Job same_job_there(const Job& job, const PlanOptions& how) {
  const ordered_json plan = read_plan(job.folder);
  Job there = job_of(plan, job.folder);
  Job same = there;
  same.inputs = job.inputs;
  same.options = job.options;
  if (plan == json_of_job(same, how)) return there;
  fail(ErrorCode::cannot_write,
       "{}: holds a job of other inputs or options; remove it, or name another folder", job.folder.string());
}

/// Refuses a folder that is not the job's alone: whoever is done removes it with all that is in it.
void need_own_folder(const fs::path& folder) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    const bool own = std::find(std::begin(kFolders), std::end(kFolders), name) != std::end(kFolders);
    const bool left_by_a_crash = name.rfind(".job.json.part-", 0) == 0;
    if (!own && !left_by_a_crash)
      fail(ErrorCode::cannot_write, "{}: holds other files ({}); name a folder of its own for the job",
           folder.string(), name);
  }
}

void make_folders(const Job& job) {
  std::error_code error;
  for (const char* name : kFolders) {
    fs::create_directories(job.folder / name, error);
    if (error)
      fail(ErrorCode::cannot_write, "{}: cannot make the folder '{}': {}", job.folder.string(), name,
           error.message());
  }
}

/// Writes the points of a tile.
class TileWriter {
 public:
  TileWriter(const Job& job, std::size_t tile, const Context& context) : writer_(job.cut(tile), context) {}
  void add(const Record& r) {
    writer_.add(r);
    box_.extend(place(r));
    ++tile_.points;
  }
  Tile commit() {
    writer_.commit();
    if (tile_.points > 0) tile_.box = {box_.min(), box_.max()};
    return tile_;
  }

 private:
  RecordWriter writer_;
  AlignedBox3d box_;
  Tile tile_;
};

/// Writes every finite row into the file of its tile, or into that of the repeats. Memory: 32 KB a tile, of
/// at most kOpen.
void cut_rows(Job& job, const Cuts& cuts, RepeatsWriter& repeats, const Context& context) {
  job.tiles.assign(cuts.tiles(), {});
  for (std::size_t first = 0; first < cuts.tiles(); first += kOpen) {
    const std::size_t count = std::min(kOpen, cuts.tiles() - first);
    std::vector<std::unique_ptr<TileWriter>> writers;
    for (std::size_t t = first; t < first + count; ++t)
      writers.push_back(std::make_unique<TileWriter>(job, t, context));
    const auto done = [&](std::size_t tiles) { return 0.5 + 0.5 * double(tiles) / double(cuts.tiles()); };
    for_each_point(job, done(first), done(first + count), context, [&](std::uint64_t row, const Vector3d& p) {
      if (repeats.take(row, p)) return;
      const std::size_t t = cuts.tile_of(p);
      if (t >= first && t < first + count) writers[t - first]->add({row, p[0], p[1], p[2]});
    });
    for (std::size_t t = 0; t < count; ++t) job.tiles[first + t] = writers[t]->commit();
  }
}

/// What the first reading of the inputs finds.
struct Survey {
  AlignedBox3d box;
  std::uint64_t points = 0;      // finite rows
  std::vector<Vector3d> sample;  // distinct places, one of so many
  std::vector<Vector3d> shared;  // places that many rows are at
};

/// \param one_in of so many places, one is in the sample
Survey survey_inputs(const Job& job, std::uint64_t one_in, const Context& context) {
  constexpr std::uint64_t kShared = 1000;  // one of so many rows: what fewer share makes no tile larger
  const std::uint64_t rows = job.rows();
  Survey survey;
  DistinctPlaces sample(std::size_t(std::min(rows, 2 * kPlanned)));
  SharedPlaces places;
  for_each_point(job, 0, 0.5, context, [&](std::uint64_t, const Vector3d& p) {
    survey.box.extend(p);
    ++survey.points;
    places.add(p);
    if (number_of(p) % one_in == 0) sample.add(p);
  });
  survey.sample = sample.take();
  survey.shared = places.counted(std::max<std::uint64_t>(2, rows / kShared));
  return survey;
}

}  // namespace

Job plan_job(const std::vector<std::string>& inputs, const fs::path& folder, const PlanOptions& how,
             const ordered_json& options, const Context& context) {
  Job job;
  job.folder = folder;
  job.options = options;
  for (const std::string& path : inputs) job.inputs.push_back(describe_input(path, context));
  if (fs::exists(plan_file(folder))) return same_job_there(job, how);
  need_own_folder(folder);
  make_folders(job);
  const std::uint64_t one_in = std::max<std::uint64_t>(1, job.rows() / kPlanned);
  Survey survey = survey_inputs(job, one_in, context);
  if (survey.points == 0) fail(ErrorCode::no_usable_points, "none of the points is finite");
  job.points = survey.points;
  job.box = {survey.box.min(), survey.box.max()};
  RepeatsWriter repeats(survey.shared, job, context);
  const auto most = std::size_t(std::max<std::uint64_t>(1, how.tile_points / one_in));
  cut_rows(job, Cuts(std::move(survey.sample), most), repeats, context);
  repeats.commit(job);
  job.sample = std::min(job.in_tiles(), how.sample_points);
  job.measured = std::min(job.in_tiles(), kMeasuredOverSmoothed * how.sample_points);
  value_or_throw(io::write_bytes(json_of_job(job, how).dump(1) + '\n', plan_file(folder), true, context));
  return job;
}

bool split_tile(Job& job, std::size_t tile, const Context& context) {
  std::vector<Record> points = read_records(job.cut(tile), context);
  const Statistics::Box& box = job.tiles[tile].box;
  Eigen::Index axis = 0;
  if (points.size() < 2 || !((box.high - box.low).maxCoeff(&axis) > 0)) return false;
  std::vector<double> along;
  for (const Record& r : points) along.push_back(place(r)[axis]);
  double cut = rfsmooth::median(along);
  if (cut == box.low[axis]) cut = std::nextafter(cut, box.high[axis]);
  TileWriter low(job, tile, context), high(job, job.tiles.size(), context);
  for (const Record& r : points) (place(r)[axis] < cut ? low : high).add(r);
  job.tiles[tile] = low.commit();
  job.tiles.push_back(high.commit());
  return true;
}

}  // namespace rfsmooth::pipeline::tiles
