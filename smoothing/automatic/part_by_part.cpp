#include "smoothing/automatic/part_by_part.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/collect.h"
#include "rfs_mesh/noise/parts.h"
#include "rfs_mesh/sample.h"
#include "smoothing/automatic/flow_auto.h"

namespace rfsmooth::smoothing {

namespace {

/// The rows of a mesh that are in a part, with their neighbours there; no faces.
Mesh mesh_of(const Mesh& all, const std::vector<Index>& rows, const Context& context) {
  std::vector<Index> place(all.positions.size(), kNone);
  for (std::size_t k = 0; k < rows.size(); ++k) place[rows[k]] = Index(k);
  const auto edges = rfsmooth::collect<Edge>(context, rows.size(), [&](std::size_t k, auto&& emit) {
    for (const Index j : all.one_ring[rows[k]])
      if (place[j] != kNone && k < place[j]) emit(Edge{Index(k), place[j]});
  });
  Mesh part;
  part.positions = rfs_mesh::at_rows(all.positions, rows, context);
  part.one_ring = make_adjacency(rows.size(), edges, context);
  return part;
}

/// The options for a part: noise that is stated in world units is that of the cloud, and differs from part to
/// part as what was measured does.
AutomaticOptions options_of(const AutomaticOptions& of_all, const NoiseModel& all, const NoiseModel& part) {
  AutomaticOptions options = of_all;
  if (options.noise && !options.noise->times_spacing && all.sigma > 0)
    options.noise->value *= part.sigma / all.sigma;
  return options;
}

/// What is found of a cloud of parts: the noise and the guide of the largest that is smoothed, means over all
/// points, and the most that any part has.
class FindingsOfParts {
 public:
  void add(const AutomaticFindings& part, std::size_t points) {
    const auto weight = double(points);
    points_ += weight;
    left_ += weight * part.left * part.left;
    equalized_ += weight * part.equalized * part.equalized;
    most_ = std::max(most_, part.equalized_most);
    times_ = std::max(times_, part.tail_times);
    stranded_ += part.stranded;
    const auto rank = std::make_pair(!part.not_smoothed, points);
    if (rank < rank_) return;
    rank_ = rank;
    of_all_ = part;
  }

  AutomaticFindings take(const NoiseSummary& measured) {
    of_all_.measured = measured;
    if (!(points_ > 0)) return of_all_;
    of_all_.left = std::sqrt(left_ / points_);
    of_all_.equalized = std::sqrt(equalized_ / points_);
    of_all_.equalized_most = most_;
    of_all_.tail_times = times_;
    of_all_.stranded = stranded_;
    return of_all_;
  }

 private:
  AutomaticFindings of_all_;
  std::pair<bool, std::size_t> rank_ = {false, 0};
  double points_ = 0, left_ = 0, equalized_ = 0, most_ = 0, times_ = 1;
  std::size_t stranded_ = 0;
};

}  // namespace

AutomaticFindings smooth_part_by_part(Mesh& mesh, const rfs_mesh::NoiseField& noise,
                                      const AutomaticOptions& options, Statistics& whole,
                                      const Context& context) {
  std::vector<double> bounds;
  for (std::size_t k = 1; k < whole.parts.size(); ++k) bounds.push_back(whole.parts[k].from);
  // Not the rows that were measured: that was done before outliers were known, or on all tiles of a cloud.
  const auto rows = rfs_mesh::rows_of_parts(rfs_mesh::SpatialIndex(mesh.positions, context), bounds, context);
  FindingsOfParts found;
  Positions smooth = mesh.positions;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    Statistics& own = whole.parts[k].own;
    Mesh part = mesh_of(mesh, rows[k], context);
    if (const auto of_part = smooth_automatically(part, options_of(options, noise, *own.noise), context,
                                                  Connectivity::used_up, &own, nullptr, &noise))
      found.add(*of_part, rows[k].size());
    for (std::size_t i = 0; i < rows[k].size(); ++i) smooth[rows[k][i]] = part.positions[i];
  }
  mesh.positions.swap(smooth);
  return found.take(summary_of(noise));
}

}  // namespace rfsmooth::smoothing
