#include "pipeline/units/units.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "base/parallel.h"
#include "base/quantile.h"
#include "pipeline/io/table/cloud.h"
#include "rfs_mesh/points.h"

namespace rfsmooth::pipeline {

namespace {

constexpr double kShort = 0x1p-40, kLong = 0x1p40;  // world units: lengths in between stay as they are

bool is_usual(double length) {
  return length >= kShort && length <= kLong;
}

/// The half of the points that are nearest to their middle are within this of it, along each axis.
double half_width(const double* xyz, std::size_t n) {
  double width = 0;
  std::vector<double> values;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    values.clear();
    for (std::size_t i = 0; i < n; ++i)
      if (io::finite_row(&xyz[3 * i])) values.push_back(xyz[3 * i + axis]);
    const double middle = median(values);
    for (double& v : values) v = std::abs(v - middle);
    width = std::max(width, median(values));
  }
  return width;
}

void scale(double unit, std::vector<double>& lengths) {
  for (double& length : lengths) length *= unit;
}

void scale(double unit, std::optional<double>& length) {
  if (length) *length *= unit;
}

void scale(double unit, NoiseModel& noise) {
  for (double* length : {&noise.sigma, &noise.spacing, &noise.apart, &noise.step, &noise.rounding})
    *length *= unit;
  for (Eigen::Vector3d& site : noise.sites) site *= unit;
  scale(unit, noise.at_sites);
  scale(unit, noise.spacing_at_sites);
}

void scale(double unit, std::vector<TraceRow>& trace) {
  for (TraceRow& row : trace) {
    if (row.volume) *row.volume *= unit * unit * unit;
    row.area *= unit * unit;
    row.energy *= unit * unit;
    row.largest_move *= unit;
  }
}

}  // namespace

double working_unit(const double* xyz, std::size_t n, const Context& context) {
  const auto box = rfs_mesh::finite_box(xyz, n, context);
  if (!box) return 1;
  const double side = rfs_mesh::largest_side(*box);
  if (is_usual(side) || !rfs_mesh::is_in_range(side)) return 1;
  const double width = half_width(xyz, n), size = width > 0 ? width : side;
  if (is_usual(size) || !(size > 0)) return 1;
  return std::ldexp(1, -std::ilogb(size));
}

void change_units(Statistics& statistics, double unit) {
  if (statistics.box) {
    statistics.box->low *= unit;
    statistics.box->high *= unit;
  }
  scale(unit, statistics.reach);
  scale(unit, statistics.spacing);
  if (statistics.scale) {
    statistics.scale->sigma *= unit;
    statistics.scale->radius *= unit;
  }
  if (statistics.noise) scale(unit, *statistics.noise);
  for (Statistics::Part& part : statistics.parts) {
    part.from *= unit;
    change_units(part.own, unit);
  }
}

void change_units(DenoiseOptions& options, double unit) {
  if (auto* automatic = std::get_if<AutomaticOptions>(&options.flow.flow))
    if (automatic->noise && !automatic->noise->times_spacing) automatic->noise->value *= unit;
  if (options.statistics) change_units(*options.statistics, unit);
}

void change_units(DenoiseReport& report, double unit) {
  for (double* length : {&report.spacing, &report.noise, &report.measured.typical, &report.measured.loudest,
                         &report.measured.step, &report.equalized_rms, &report.equalized_largest,
                         &report.largest_move, &report.rms_move})
    *length *= unit;
  if (report.noise_left) *report.noise_left *= unit;
  change_units(report.effective, unit);
  change_units(report.statistics, unit);
  scale(unit, report.trace);
}

}  // namespace rfsmooth::pipeline
