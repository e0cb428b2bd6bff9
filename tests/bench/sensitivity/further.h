/// Clouds and commands that the laws on shapes do not stand for, cheap ones: a line of the kind "further" and
/// one figure each.
///
/// Rings, steps of depth, merged scans, noise that neighbours share, hardly any noise; crops of what lasers
/// and cameras see of a room, voxels of it, a stack of sheets; the normals of clean clouds and of those whose
/// scanner is known; a surface.
#pragma once

#include <cstddef>

#include "tests/bench/quality/law_runs.h"

namespace rfsmooth::bench {

/// Mean squared distance to the surface: squared spacings, of further laws, each on one shape of the plan;
/// squared metres, of sensors' clouds; squares of the noise, of a stack, to the sheet that a point is of.
/// \param plan its shapes, at least one, cache and options of denoise. \param points of each cloud of a
/// shape. \throw std::runtime_error if rfsmooth fails.
void print_further(const LawPlan& plan, std::size_t points);

/// Mean angle to the true normals, a wrong side included, degrees: of what sensors saw, and of two shapes
/// without noise.
void print_further_normals(const LawPlan& plan);

/// Mean squared distance between a surface made from noisy points and the true one, both ways, squared
/// spacings, of two shapes. Nothing without CGAL. \throw std::runtime_error if there is no surface.
void print_surfaces(const LawPlan& plan, std::size_t points);

}  // namespace rfsmooth::bench
