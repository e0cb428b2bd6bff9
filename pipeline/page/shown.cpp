#include "pipeline/page/shown.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/io/table/cloud.h"
#include "rfs_mesh/points.h"

namespace rfsmooth::pipeline {

namespace {

/// The finite rows along a Morton curve, those of one position in their own order.
std::vector<std::size_t> along_curve(const std::vector<double>& xyz, const Context& context) {
  const auto cloud = value_or_throw(rfs_mesh::make_working_cloud(xyz.data(), xyz.size() / 3, context));
  std::vector<std::size_t> next(cloud.points.size() + 1, 0);
  for (std::size_t p = 0; p < cloud.points.size(); ++p) next[p + 1] = next[p] + cloud.multiplicity[p];
  std::vector<std::size_t> rows(next.back());
  for (std::size_t row = 0; row < cloud.of_input.size(); ++row)
    if (cloud.of_input[row] != kNone) rows[next[cloud.of_input[row]]++] = row;
  return rows;
}

/// `most` places of `rows`, fewer than there are, as flags: evenly, and those that moved farthest.
std::vector<char> chosen_places(const std::vector<std::size_t>& rows, const std::vector<double>& moved,
                                const std::vector<RowKind>& kinds, std::size_t most) {
  std::vector<char> chosen(rows.size(), 0);
  const std::size_t even = most - most / 4;
  for (std::size_t k = 0; k < even; ++k)
    chosen[std::size_t(double(k) * double(rows.size()) / double(even))] = 1;
  const auto importance = [&](std::size_t place) {
    const std::size_t row = rows[place];
    return kinds[row] == RowKind::surface ? moved[row] : std::numeric_limits<double>::infinity();
  };
  std::vector<std::size_t> others;
  for (std::size_t place = 0; place < rows.size(); ++place)
    if (chosen[place] == 0) others.push_back(place);
  const auto end = others.begin() + std::ptrdiff_t(most - even);
  std::nth_element(others.begin(), end, others.end(), [&](std::size_t a, std::size_t b) {
    const double x = importance(a), y = importance(b);
    return x != y ? x > y : a < b;
  });
  for (auto place = others.begin(); place != end; ++place) chosen[*place] = 1;
  return chosen;
}

}  // namespace

std::vector<RowKind> kinds_of_rows(const std::vector<double>& before, const std::vector<double>& after,
                                   const std::vector<char>& outlier) {
  std::vector<RowKind> kinds(before.size() / 3, RowKind::absent);
  for (std::size_t row = 0; row < kinds.size(); ++row) {
    if (!io::finite_row(&before[3 * row])) continue;
    kinds[row] = !io::finite_row(&after[3 * row])        ? RowKind::removed
                 : !outlier.empty() && outlier[row] != 0 ? RowKind::outlier
                                                         : RowKind::surface;
  }
  return kinds;
}

std::vector<double> displacements(const std::vector<double>& before, const std::vector<double>& after) {
  std::vector<double> moved(before.size() / 3, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t row = 0; row < moved.size(); ++row)
    if (io::finite_row(&before[3 * row]) && io::finite_row(&after[3 * row]))
      moved[row] = std::hypot(after[3 * row] - before[3 * row], after[3 * row + 1] - before[3 * row + 1],
                              after[3 * row + 2] - before[3 * row + 2]);
  return moved;
}

std::vector<std::size_t> shown_rows(const std::vector<double>& before, const std::vector<double>& moved,
                                    const std::vector<RowKind>& kinds, std::size_t most,
                                    const Context& context) {
  std::vector<std::size_t> rows = along_curve(before, context);
  if (rows.size() > most) {
    const std::vector<char> chosen = chosen_places(rows, moved, kinds, most);
    std::size_t count = 0;
    for (std::size_t place = 0; place < rows.size(); ++place)
      if (chosen[place] != 0) rows[count++] = rows[place];
    rows.resize(count);
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [&](std::size_t a, std::size_t b) { return kinds[a] < kinds[b]; });
  return rows;
}

}  // namespace rfsmooth::pipeline
