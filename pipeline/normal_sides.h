/// Which of its two sides a surface was seen from before it was smoothed: what is known of it stays known.
///
///     v_i = sum of a_j over i and its 24 nearest,    a_j = normal_j . before_j
///
/// With `normals` on one side throughout (rfsmooth/normals.h), a_j has one sign on each part of the surface
/// if the normals before had sides at all, on the two faces of a thin sheet too, and v_i says which, in spite
/// of some that noise threw over.
#pragma once

#include <cstddef>

#include <rfsmooth/context.h>

namespace rfsmooth::pipeline {

/// Turns the n normals (n x 3, row-major, unit) to the sides of `before` (n x 3, any length; rows that are
/// zero or not finite say nothing): all with v_i < 0. Returns whether it did: not if the normals before have
/// no common sides, that is if sum |v_i| is less than half of sum |a_j| counted as often (random sides give
/// about a sixth). Rows of `xyz` (n x 3) that are not finite stay as they are. Same result for any number of
/// threads. O(n log n). \throw Failure if cancelled.
bool keep_sides(const double* xyz, std::size_t n, const double* before, double* normals,
                const Context& context);

}  // namespace rfsmooth::pipeline
