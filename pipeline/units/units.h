/// Clouds of any size: lengths are kept as floats in many places, which hold 1e-38 to 1e38 and whose squares
/// hold less. A cloud far outside of that is smoothed in other units, a power of two times its own, so that
/// no digit is lost on the way there and back. Thread safe: no state is kept.
#pragma once

#include <cstddef>

#include <rfsmooth/context.h>
#include <rfsmooth/denoise.h>

namespace rfsmooth::pipeline {

/// What to multiply the n x 3 coordinates by: 1 where the box of all of them is 1e-12 to 1e12 along its
/// longest side, strays included, or the half of the points nearest to their middle is that wide, or all are
/// at one place; else a power of two that brings that half to about 1. So strays do not make a cloud unusual.
/// But beside a stray at a usual distance, a cloud smaller than 1e-12 stays as small as it is: telling it
/// apart would take every cloud two medians along each axis. The same for any order of the rows. O(n).
double working_unit(const double* xyz, std::size_t n, const Context& context);

/// Multiplies every length of the options by `unit`, a power of two.
void change_units(DenoiseOptions& options, double unit);
/// The same of statistics.
void change_units(Statistics& statistics, double unit);
/// The same of a report: areas by its square, volumes by its cube.
void change_units(DenoiseReport& report, double unit);

}  // namespace rfsmooth::pipeline
