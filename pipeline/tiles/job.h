/// A cloud larger than memory, smoothed in tiles: a folder that holds all there is to know, and steps that
/// each do their part of the work in it. Each has its file in steps/:
///
///     plan     cuts the cloud into tiles of about as many points, each row in one of them
///     measure  takes a tile's part of the sample
///     settle   finds what the cloud as a whole is like (rfsmooth/statistics.h): the noise of the sample,
///              the rest of a part of it that is smoothed
///     run      smooths a tile with what lies around it, and keeps what is its own
///     join     copies the inputs with the new coordinates in them
///     status   tells how far that is
///
/// Tiles may be measured and run in any order, by any number of processes, on any machines that see the
/// folder, and again: whatever is there complete is not made again, and a file is there complete or not at
/// all. The same inputs give the same bytes. Memory: plan some 30 MB, join a few and 32 KB a tile, the others
/// what `denoise` takes for the points of a tile and its surroundings, or of the sample.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <rfsmooth/statistics.h>

namespace rfsmooth::pipeline::tiles {

/// An input and its part of the rows.
struct JobInput {
  std::string path;
  std::uint64_t rows = 0;
  std::uint64_t bytes = 0;
  std::int64_t changed = 0;  ///< when it was last, as the file system says it
};

/// A tile: the box of its points, and how many there are.
struct Tile {
  Statistics::Box box;
  std::uint64_t points = 0;
};

/// A place that many rows share (repeats.h): the first is in a tile, the others are not.
struct RepeatedPlace {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  std::uint64_t first = 0, others = 0;  ///< a row of the cloud, and how many more rows there are
};

/// What the plan says.
struct Job {
  std::filesystem::path folder;
  std::vector<JobInput> inputs;
  Statistics::Box box;         ///< of the finite points
  std::uint64_t points = 0;    ///< finite rows
  std::uint64_t sample = 0;    ///< points that are smoothed for the statistics
  std::uint64_t measured = 0;  ///< points whose noise and spacing are measured
  std::vector<Tile> tiles;
  std::vector<RepeatedPlace> repeated;
  nlohmann::ordered_json options;  ///< of denoise, as the command keeps them

  /// Rows of all inputs.
  std::uint64_t rows() const {
    std::uint64_t rows = 0;
    for (const JobInput& input : inputs) rows += input.rows;
    return rows;
  }
  /// Finite rows that are in tiles.
  std::uint64_t in_tiles() const {
    std::uint64_t rows = points;
    for (const RepeatedPlace& place : repeated) rows -= place.others;
    return rows;
  }
  /// Rows at the place of a row that is in a tile.
  std::uint64_t rows_with(std::uint64_t row) const {
    for (const RepeatedPlace& place : repeated)
      if (place.first == row) return 1 + place.others;
    return 1;
  }

  using Path = std::filesystem::path;
  Path settled() const { return folder / "statistics.json"; }         ///< the statistics and the halo
  Path cut(std::size_t t) const { return of_tile("cut", t); }         ///< the points of tile t
  Path repeats() const { return folder / "cut" / "repeats"; }         ///< the rows in no tile
  Path sampled(std::size_t t) const { return of_tile("sample", t); }  ///< its part of the sample
  Path done(std::size_t t) const { return of_tile("done", t); }       ///< its points, smoothed
  Path normals(std::size_t t) const { return of_tile("done", t, ".normals"); }  ///< theirs, if asked for
  Path around(std::size_t t) const { return of_tile("done", t, ".around"); }    ///< of points around it
  Path cost(std::size_t t) const { return of_tile("done", t, ".json"); }        ///< what all that took
  Path of_tile(const char* kind, std::size_t t, const char* ending = "") const {
    return folder / kind / (std::to_string(t) + ending);
  }
};

/// How to plan.
struct PlanOptions {
  std::uint64_t tile_points = 5'000'000;    ///< most places of a tile, about; rows at one place count once
  std::uint64_t sample_points = 1'000'000;  ///< of all tiles together, that are smoothed to be known
};

/// Reads the plan. \throw Failure (input_unreadable).
Job open_job(const std::filesystem::path& folder);

/// What running a tile took: an object, which is empty if there is no such file.
nlohmann::ordered_json read_cost(const Job& job, std::size_t tile);

/// Refuses a step that is not possible. \throw Failure (usage) with the folder and the message.
[[noreturn]] void refuse_step(const Job& job, const std::string& message);

/// \throw Failure (usage) if there is no such tile.
void check_tile(const Job& job, std::size_t tile);

}  // namespace rfsmooth::pipeline::tiles
