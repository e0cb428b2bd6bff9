/// Discrete fairing, interpolating: a finer mesh of least thin-plate energy through the given vertices.
///
/// Every level splits each face into four; then the new vertices (all but the given ones) minimise the energy
/// of divided_difference.h, coarse to fine. Points on boundary curves and on edges named sharp come from the
/// four-point scheme (-1, 9, 9, -1) / 16 along the curve alone and then stay, so that meshes that share a
/// boundary still do. The two sides of a sharp line share only its points: every fit and every term of the
/// energy is one-sided there. Kobbelt 1997, sections 4 and 5.
///
/// Differs from the paper: conjugate gradients instead of Gauss-Seidel sweeps (no visiting order, so the same
/// bits for any number of threads); charts of a level come from the mesh it starts with. Thread safe: no
/// state is kept.
#pragma once

#include <vector>

#include <rfsmooth/flow_options.h>
#include <rfsmooth/mesh.h>

namespace rfsmooth::smoothing {

/// How to refine.
struct RefineOptions {
  int levels = 1;              ///< each multiplies the faces by four
  Chart chart = Chart::mixed;  ///< how neighbours get their parameters
  double pimple = 0;           ///< how far given vertices may move at the end, x mean edge: flattens pimples
  double tolerance = 1e-4;     ///< of each level's solve, relative

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"levels", "each multiplies the faces by four", "", 0, 10}, self.levels);
    visit(words("chart", "how neighbours get their parameters", Shared::kCharts), self.chart);
    visit(OptionInfo{"pimple", "how far given vertices may move at the end", "x mean edge", 0, 10},
          self.pimple);
    visit(OptionInfo{"tolerance", "relative residual of each level", "", 1e-14, 1}, self.tolerance);
  }
};

/// The refined mesh. Vertices 0 .. n-1 are the given ones, bit for bit (unless pimple > 0); loose edges stay.
/// Errors: usage, out_of_memory, cancelled. \throw std::invalid_argument if a sharp edge is not an edge of a
/// face.
Result<Mesh> refine(const Mesh& mesh, const RefineOptions& options, const Context& context,
                    const std::vector<Edge>& sharp = {});

/// How many vertices the refined mesh has. O(1).
std::size_t refined_vertices(const Mesh& mesh, int levels);

/// Splits every face into four, with new vertices at the middle of the edges. `curve` edges (boundary and
/// sharp, each {a, b}, any order) are split too.
Mesh split(const Mesh& mesh, std::vector<Edge>& curve, const Context& context);

}  // namespace rfsmooth::smoothing
