#include "smoothing/trace.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/parallel.h"
#include "rfs_mesh/edge_faces.h"
#include "rfs_mesh/measure.h"
#include "smoothing/operators/operator.h"
#include "smoothing/operators/surface.h"

namespace rfsmooth::smoothing {

namespace {

/// Root mean square turn of the normal across the edges with two faces, degrees.
double roughness(const Mesh& mesh) {
  double sum = 0;
  std::size_t edges = 0;
  using rfs_mesh::EdgeFace;
  rfs_mesh::for_each_edge(rfs_mesh::edge_faces(mesh.faces), [&](const EdgeFace* first, const EdgeFace* last) {
    if (last - first != 2) return;
    const auto opposite = [&](const EdgeFace& at) { return mesh.positions[at.opposite(mesh.faces)]; };
    const double turn = M_PI - rfs_mesh::dihedral_angle(mesh.positions[first->a], mesh.positions[first->b],
                                                        opposite(first[0]), opposite(first[1]));
    sum += turn * turn;
    ++edges;
  });
  return edges > 0 ? 180 / M_PI * std::sqrt(sum / double(edges)) : 0;
}

/// The enclosed volume, if the mesh encloses one: every edge has two faces, and it has two sides. One thread.
std::optional<double> volume(const Mesh& mesh, const Context& context) {
  if (mesh.faces.empty()) return std::nullopt;
  Unclosed missing;
  Mesh outward;
  outward.faces = oriented_as_far_as_possible(mesh, &missing);
  if (missing.rim + missing.crowded > 0 || missing.one_sided) return std::nullopt;
  outward.positions = mesh.positions;
  return rfs_mesh::signed_volume(outward, context);
}

}  // namespace

double largest_move(const Positions& before, const Positions& after, const Context& context) {
  return reduce_blocks(
      context, before.size(), 0.0,
      [&](std::size_t begin, std::size_t end) {
        double largest = 0;
        for (std::size_t i = begin; i < end; ++i) largest = std::max(largest, (after[i] - before[i]).norm());
        return largest;
      },
      [](double a, double b) { return std::max(a, b); });
}

Tracer::Tracer(std::vector<TraceRow>* rows, const Mesh& mesh, const Context& context)
    : rows_(rows), before_(rows == nullptr ? Positions{} : mesh.positions) {
  add(mesh, context);
}

void Tracer::add(const Mesh& mesh, const Context& context) {
  if (rows_ == nullptr) return;
  TraceRow row;
  row.step = int(rows_->size());
  row.volume = volume(mesh, context);
  row.area = rfs_mesh::surface_area(mesh, context);
  row.energy = thin_plate_energy(mesh.one_ring, umbrella(mesh.one_ring, context), mesh.positions, context);
  row.roughness = roughness(mesh);
  row.largest_move = largest_move(before_, mesh.positions, context);
  before_ = mesh.positions;
  rows_->push_back(row);
}

}  // namespace rfsmooth::smoothing
