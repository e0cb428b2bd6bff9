/// Points as a page carries them: in blocks of neighbours, few bytes each.
///
/// A block has an origin, a step and a unit of its own. A point is, before, origin + step * (three uint16),
/// and moves by unit * (three int8): on either side it is where the file has it to half a step, or half a
/// unit, in x, y and z.
///
/// The bytes are planes, one after the other, each of one byte a point in the order of the points, which
/// deflate makes less of than of rows: for x, y, z the high and the low byte of the difference to the point
/// before in its block (the first: to 0), modulo 2^16 and zigzag-coded (0, -1, 1, -2, ... are 0, 1, 2, 3,
/// ...); the displacement's x, y, z; red, green, blue, if there are colours; two planes for the normals of a
/// side that has them (packed_normal).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/mesh.h>

#include "pipeline/io/point_fields.h"
#include "pipeline/page/shown.h"

namespace rfsmooth::pipeline {

/// The most points in a block.
inline constexpr std::size_t kBlockPoints = 4096;

/// What is shown, row by row around the page's own origin.
struct ShownPoints {
  Positions before, after;  ///< `after` of removed points: as before
  std::vector<RowKind> kinds;
  std::vector<io::Rgb> colors;                                 ///< or empty
  std::vector<Eigen::Vector3f> normals_before, normals_after;  ///< or empty
};

/// Neighbouring points with an origin and units of their own.
struct PageBlock {
  std::size_t count = 0;
  RowKind kind = RowKind::surface;  ///< of all its points
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double step = 0, unit = 0;  ///< world units
  double reach = 0;  ///< distance to the sixth nearest point shown: three quarters of the block are nearer to
                     ///< theirs, world units
};

/// Blocks of points, and their numbers as bytes.
struct PackedPoints {
  std::vector<PageBlock> blocks;
  std::string bytes;  ///< the planes
};

/// Packs the points, which are sorted by kind. O(n log n), the same for any number of threads.
PackedPoints pack_points(const ShownPoints& shown, const Context& context);

/// A normal without its side, in two bytes: turned to positive z and projected from the octahedron onto the
/// square (a, b) = (x + y, x - y) / (|x| + |y| + z), in 127ths. Of a normal that is none: that along z.
std::array<std::int8_t, 2> packed_normal(const Eigen::Vector3f& normal);

}  // namespace rfsmooth::pipeline
