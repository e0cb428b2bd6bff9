/// A cloud larger than memory, smoothed in tiles: a folder that holds all there is to know, and steps that
/// each do their part of the work in it.
///
///     plan     cuts the cloud into tiles of about as many points, each row in one of them
///     measure  takes a tile's part of the sample
///     settle   finds what the cloud as a whole is like (rfsmooth/statistics.h): the noise of the sample,
///              the rest of a part of it that is smoothed
///     run      smooths a tile with what lies around it, and keeps what is its own
///     join     copies the inputs with the new coordinates in them
///
/// Tiles may be measured and run in any order, by any number of processes, on any machines that see the
/// folder, and again: whatever is there complete is not made again, and a file is there complete or not at
/// all. The same inputs give the same bytes. Memory: plan some 30 MB, join a few and 32 KB a tile, the others
/// what `denoise` takes for the points of a tile and its surroundings, or of the sample.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <rfsmooth/denoise.h>
#include <rfsmooth/normals.h>

#include "pipeline/io/formats/las/las_scale.h"

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

/// What the plan says.
struct Job {
  std::filesystem::path folder;
  std::vector<JobInput> inputs;
  Statistics::Box box;         ///< of the finite points
  std::uint64_t points = 0;    ///< finite rows
  std::uint64_t sample = 0;    ///< points that are smoothed for the statistics
  std::uint64_t measured = 0;  ///< points whose noise and spacing are measured
  std::vector<Tile> tiles;
  nlohmann::ordered_json options;  ///< of denoise, as the command keeps them

  using Path = std::filesystem::path;
  Path settled() const { return folder / "statistics.json"; }         ///< the statistics and the halo
  Path cut(std::size_t t) const { return of_tile("cut", t); }         ///< the points of tile t
  Path sampled(std::size_t t) const { return of_tile("sample", t); }  ///< its part of the sample
  Path done(std::size_t t) const { return of_tile("done", t); }       ///< its points, smoothed
  Path normals(std::size_t t) const { return of_tile("done", t, ".normals"); }  ///< theirs, if asked for
  Path around(std::size_t t) const { return of_tile("done", t, ".around"); }    ///< of points around it
  Path cost(std::size_t t) const { return of_tile("done", t, ".json"); }        ///< what all that took
  Path of_tile(const char* kind, std::size_t t, const char* ending = "") const {
    return folder / kind / (std::to_string(t) + ending);
  }
};

/// The halo is this many radii of the widest patch. What a point becomes passes through such patches six
/// times: from their members to them and from them to the point, for the heights and twice more for the means
/// of the evidence. The weights (1 - d^2)^2 have a standard deviation of 0.35 radii, six in a row 0.87, and
/// this is 3.5 of those.
constexpr double kHaloRadii = 3;

/// How many times more points are measured than smoothed: so many that it takes no more memory.
constexpr std::uint64_t kMeasuredOverSmoothed = 4;

/// How to plan.
struct PlanOptions {
  std::uint64_t tile_points = 5'000'000;    ///< most points of a tile, without what lies around it
  std::uint64_t sample_points = 1'000'000;  ///< of all tiles together, that are smoothed to be known
};

/// Refuses options by which points at any distance may have a say in where a point goes. \throw Failure
/// (usage) naming what can be done.
void check_for_tiles(const DenoiseOptions& options);

/// Plans a job, unless the folder holds one of the same inputs and options. \throw Failure.
Job plan_job(const std::vector<std::string>& inputs, const std::filesystem::path& folder,
             const PlanOptions& how, const nlohmann::ordered_json& options, const Context& context);

/// Reads the plan. \throw Failure (input_unreadable).
Job open_job(const std::filesystem::path& folder);

/// \throw Failure.
void measure_tile(const Job& job, std::size_t tile, const Context& context);

/// Needs every tile measured. \throw Failure (usage) naming the first that is not.
void settle_job(const Job& job, const DenoiseOptions& options, const Context& context);

/// Needs the job settled. \param normals how to find them, if at all. \param most of the tile's points and
/// those around it: where these are more, what lies around is made narrower. \throw Failure.
void run_tile(const Job& job, std::size_t tile, const DenoiseOptions& options,
              const std::optional<NormalsOptions>& normals, const Context& context,
              std::uint64_t most = std::numeric_limits<std::uint64_t>::max());

/// Where the scanner stood, if all inputs tell the same place.
std::optional<Eigen::Vector3d> common_viewpoint(const std::vector<std::string>& inputs,
                                                const Context& context);

/// \throw Failure (usage) if the output's extension is of another format.
void check_format(io::Format input, const std::string& output);

/// What there is to say of an output.
struct Joined {
  bool las = false;
  io::RefinedScale scale;            ///< of LAS; all zeros where it was not looked at
  double noise = 0, noise_left = 0;  ///< for which it was
};

/// Needs every tile run. `outputs`: one for each input, of its format. Files in their place are replaced if
/// `force`. LAS: scales that are coarse for what is left of the noise are refined, unless `keep_scale` or
/// nothing moved. `normals`: whether the tiles were run with them. Returns one for each input. \throw Failure
/// (usage) naming the first tile that is not.
std::vector<Joined> join_job(const Job& job, const std::vector<std::string>& outputs, bool force,
                             bool keep_scale, bool normals, const Context& context);

/// What settle found.
struct Settled {
  DenoiseReport report;    ///< of the sample: its statistics, spacing and noise; nothing else is kept
  double halo = 0;         ///< typical width of what a tile is smoothed with, world units
  double radii = 0;        ///< the same in radii of the widest patch
  std::size_t widest = 0;  ///< points of that
};

/// \throw Failure (input_unreadable).
Settled read_settled(const std::filesystem::path& path);

/// What running a tile took: an object, which is empty if there is no such file.
nlohmann::ordered_json read_cost(const Job& job, std::size_t tile);

/// What there is to say of a job whose tiles were run, as of a whole cloud, but for its mesh. Moves are those
/// before the coordinates were written. \throw Failure.
DenoiseReport report_of(const Job& job, const DenoiseOptions& options);

/// The points that a tile of a settled job is smoothed with, its own among them. \throw Failure.
std::uint64_t points_with_halo(const Job& job, std::size_t tile, const Context& context);

/// Halves a tile; the new one is the last, and the plan on the disk does not know of it. False if all of its
/// points are at one place. Before the first tile is run. \throw Failure.
bool split_tile(Job& job, std::size_t tile, const Context& context);

/// How far a job is.
struct JobStatus {
  std::size_t tiles = 0, measured = 0, run = 0;
  bool settled = false;
  double halo = 0;        ///< typical width of the surroundings, world units; 0 until settled
  double halo_share = 0;  ///< points around the tiles that were run, over those in them
  double seconds = 0;     ///< of processor time that these took
  std::uint64_t points = 0;
  std::vector<std::size_t> missing;  ///< tiles not run
};
/// Reads every result in full: one that is not as it was written counts as missing.
JobStatus job_status(const Job& job, const Context& context);

}  // namespace rfsmooth::pipeline::tiles
