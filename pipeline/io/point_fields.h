/// What several fields of a point say together: its colour (PLY: red green blue; PCD: rgb, rgba, packed) and
/// its normal (PLY: nx ny nz; PCD: normal_x normal_y normal_z).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline::io {

/// The fields of a normal.
using NormalNames = std::array<const char*, 3>;
inline constexpr NormalNames kPlyNormal = {"nx", "ny", "nz"};                    ///< as PLY calls them
inline constexpr NormalNames kPcdNormal = {"normal_x", "normal_y", "normal_z"};  ///< as PCL does

/// Red, green, blue.
using Rgb = std::array<std::uint8_t, 3>;

/// Whether the points have the fields of a normal, or some of them.
bool has_normals(const Cloud& cloud);

/// The values of a plain field that packs a colour into four bytes, as PCL does in a float or a whole number:
/// 0xAARRGGBB. O(n).
std::vector<std::uint32_t> packed_colors(const Cloud& cloud, std::size_t field, const Context& context = {});

/// One colour per point; empty if the cloud has none. Colours in floats are from 0 to 1, or to 255 or 65535
/// where one of them is above. O(n).
std::vector<Rgb> colors_of(const Cloud& cloud, const Context& context = {});

/// n x 3; empty if the cloud has no normals. O(n).
std::vector<double> normals_of(const Cloud& cloud, const Context& context = {});

}  // namespace rfsmooth::pipeline::io
