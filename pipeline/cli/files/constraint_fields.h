/// Constraints on vertices from fields of the file: how far each follows the flow, which stay, which slide
/// along an axis or in a plane.
///
/// Desbrun et al. 1999, 2.7. A vertex is constrained where the field is neither zero nor NaN. Of several
/// constraints on one vertex fixed wins, then axis.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <rfsmooth/flow.h>
#include <rfsmooth/options.h>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::cli {

struct ConstraintFields {
  std::optional<std::string> strength, fixed, axis, plane;
  std::optional<std::string> direction;  ///< empty: normals

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"strength-field", "field in [0, 1] of the input: 0 stays, 1 is smoothed fully", ""},
          self.strength);
    visit(OptionInfo{"fixed-field", "points where this field is not 0 stay", ""}, self.fixed);
    visit(OptionInfo{"axis-field", "points where this field is not 0 move along --slide-direction only", ""},
          self.axis);
    visit(OptionInfo{"plane-field",
                     "points where this field is not 0 move in the plane across --slide-direction only", ""},
          self.plane);
    visit(OptionInfo{"slide-direction",
                     "of --axis-field and --plane-field: x,y,z, or normals = each point's own (nx, ny, nz)",
                     ""},
          self.direction);
  }
};

/// The strengths in one field, by row. \throw Failure (usage) naming the first row outside [0, 1], or, if
/// there is no such field, the fields there are.
std::vector<double> strengths(const pipeline::io::Cloud& cloud, const std::string& field,
                              const Context& context);

/// The constraints on n vertices; `of_row`: the vertex of each row, or kNone. \throw Failure (usage).
Constraints constraints_of(const ConstraintFields& fields, const pipeline::io::Cloud& cloud,
                           const std::vector<Index>& of_row, std::size_t n, const Context& context);

}  // namespace rfsmooth::cli
