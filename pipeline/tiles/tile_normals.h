/// Normals of tiles, all on one side.
///
/// A tile's normals are those of its smoothed points with what lies around them, and each part of the surface
/// has a side by itself: a piece. Points around a tile have normals in their own tile, too. The sum of the
/// cosines between the two says how the pieces of both agree, and pieces grow together by these sums
/// (rfs_mesh/normals/sides.h). What grew together from several faces the viewpoint, else outward, by the sign
/// of sum (p - c) . n over its points, c their centroid. A piece that met no other keeps its side, so that
/// one tile has the normals of the whole cloud.
///
/// Not as in the whole cloud: what hides a point from the viewpoint must lie in its tile or around it, and
/// cavities that tiles cut are taken for outsides.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include <rfsmooth/normals.h>

#include "pipeline/tiles/files/records.h"
#include "pipeline/tiles/job.h"

namespace rfsmooth::pipeline::tiles {

/// A point around a tile: its row, and the tile it is in.
struct Around {
  std::uint64_t row = 0;
  std::size_t tile = 0;
};

/// A tile's points and those around it.
struct Gathered {
  std::vector<Record> own;
  std::vector<Around> around;  ///< for normals only: of the others, by tile, rows ascending
  std::vector<double> xyz;     ///< n x 3, the tile's own first
};

/// Writes the normals of a tile's points, whose `xyz` are smoothed, and those of the points around it that
/// are within `reach` (world units). Returns what is to be known of the pieces, for `find_sides`. \throw
/// Failure.
nlohmann::ordered_json write_normals(const Job& job, std::size_t tile, const Gathered& points,
                                     const NormalsOptions& options, double reach, const Context& context);

/// Whether a tile's normals are there and complete.
bool complete_normals(const Job& job, std::size_t tile, const Context& context);

/// For each tile, by piece: 1 where its normals are to be reversed. Memory: the pieces. \throw Failure.
std::vector<std::vector<char>> find_sides(const Job& job, const Context& context);

}  // namespace rfsmooth::pipeline::tiles
