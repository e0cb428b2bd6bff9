/// Comparing tools over a cell, and the tables.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tests/bench/quality/runs.h"

namespace rfsmooth::bench {

/// All rows of a run: (noise name, size) -> cell. `noisy input` and our variants are tools like any other.
using Results = std::map<std::pair<std::string, std::size_t>, Cell>;

enum class Measure { chamfer, p2s, edge_p2s };
double value(const Row& row, Measure measure);

/// Mean over `shapes`; infinite if a shape has no row.
double mean(const std::map<std::string, Row>& rows, const std::vector<std::string>& shapes, Measure measure);

/// The peer setting of `cell` with the lowest mean over `shapes`, chosen with the truth.
struct Best {
  std::string setting;  ///< empty: no setting has all shapes
  double value = 0;
};
Best best_peer(const Cell& cell, const std::vector<std::string>& shapes, Measure measure,
               const std::string& family = "");

/// Our mean over the best peer's, and the worst shape of the cell.
struct Ratio {
  double of_means = 0;
  double worst = 0;  ///< largest ratio on one shape to the best peer *on that shape*, whatever its setting
  std::string worst_shape, worst_peer;
  double worst_fixed = 0;  ///< the same against the one setting that is best for the cell
  std::string worst_fixed_shape;
};
Ratio compare(const Cell& cell, const std::string& ours, const std::vector<std::string>& shapes,
              Measure measure);

/// One table per noise level to stdout, the sizes one under the other; `all` prints every setting.
void print_tables(const Plan& plan, const Results& results, const std::vector<std::string>& ours, bool all);

/// One row per cell, shape and tool, comma-separated.
void write_csv(const std::filesystem::path& file, const Results& results);

}  // namespace rfsmooth::bench
