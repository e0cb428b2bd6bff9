/// Keeps the side of the normals that a cloud came with, when new normals are written after smoothing.
///
///     v_i = sum of a_j over i and its 24 nearest,    a_j = normal_j . before_j / |before_j|
///
/// If the new normals are on one side throughout (rfsmooth/normals.h) and the old ones had sides at all, a_j
/// has one sign on each part of the surface, also on the two faces of a thin sheet. v_i gives that sign even
/// if noise has reversed some normals.
#pragma once

#include <cstddef>

#include <rfsmooth/context.h>

namespace rfsmooth::pipeline {

/// Reverses those of the n `normals` (n x 3, row-major, unit) with v_i < 0. `before`: n x 3, of any length;
/// rows that are zero or not finite do not count. `xyz`: n x 3; normals of rows that are not finite stay.
/// Does nothing and returns false if the old normals have no common sides: sum |v_i| is less than half of the
/// sum of the |a_j| in it (random sides give about a sixth). Same result for any number of threads. O(n log
/// n). \throw Failure if cancelled.
bool keep_sides(const double* xyz, std::size_t n, const double* before, double* normals,
                const Context& context);

}  // namespace rfsmooth::pipeline
