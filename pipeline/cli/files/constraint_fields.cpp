#include "pipeline/cli/files/constraint_fields.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/cli/options/text_values.h"

namespace rfsmooth::cli {

using Eigen::Vector3d;
using pipeline::io::Cloud;
using Kind = HardConstraint::Kind;

namespace {

std::vector<double> values_of(const Cloud& cloud, const std::string& name, const Context& context) {
  const auto field = pipeline::io::find_plain_field(cloud, name);
  if (!field) {
    std::vector<std::string> names;
    for (const auto& present : cloud.points().fields)
      if (present.is_plain()) names.push_back(present.name);
    fail(ErrorCode::usage, "the points have no field '{}' with one value each; there are: {}", name,
         fmt::join(names, ", "));
  }
  return pipeline::io::field_values(cloud, *field, context);
}

/// One direction per row: the same for all, or the file's normals.
class Directions {
 public:
  Directions(const std::string& text, const Cloud& cloud, const Context& context) {
    if (text == "normals") {
      for (std::size_t k = 0; k < 3; ++k)
        normal_[k] = values_of(cloud, std::array{"nx", "ny", "nz"}[k], context);
      return;
    }
    all_ = read_point(text).value_or(Vector3d::Zero());
    if (all_ == Vector3d::Zero())
      fail(ErrorCode::usage, "--slide-direction: expected x,y,z, not all zero, or normals; found '{}'", text);
  }

  Vector3d operator()(std::size_t row) const {
    if (normal_[0].empty()) return all_;
    Vector3d normal(normal_[0][row], normal_[1][row], normal_[2][row]);
    if (!normal.allFinite() || normal == Vector3d::Zero())
      fail(ErrorCode::usage, "point {} is to slide but has no normal", row);
    return normal;
  }

 private:
  Vector3d all_ = Vector3d::Zero();
  std::array<std::vector<double>, 3> normal_;
};

}  // namespace

std::vector<double> strengths(const Cloud& cloud, const std::string& field, const Context& context) {
  std::vector<double> values = values_of(cloud, field, context);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!(values[i] >= 0 && values[i] <= 1))
      fail(ErrorCode::usage, "--strength-field {}: expected values from 0 to 1, found {} at point {}", field,
           values[i], i);
  return values;
}

Constraints constraints_of(const ConstraintFields& fields, const Cloud& cloud,
                           const std::vector<Index>& of_row, std::size_t n, const Context& context) {
  Constraints out;
  if (fields.strength) {
    const std::vector<double> by_row = strengths(cloud, *fields.strength, context);
    out.strength.assign(n, 1);
    for (std::size_t row = 0; row < of_row.size(); ++row)
      if (of_row[row] != kNone) out.strength[of_row[row]] = by_row[row];
  }
  std::vector<char> taken(n, 0);
  const auto constrain = [&](const std::optional<std::string>& field, Kind kind) {
    if (!field) return;
    const std::vector<double> by_row = values_of(cloud, *field, context);
    std::optional<Directions> direction;
    if (kind != Kind::fixed) direction.emplace(fields.direction.value_or("normals"), cloud, context);
    for (std::size_t row = 0; row < of_row.size(); ++row) {
      const Index v = of_row[row];
      if (v == kNone || std::isnan(by_row[row]) || by_row[row] == 0 || taken[v] != 0) continue;
      taken[v] = 1;
      out.hard.push_back({v, kind, direction ? (*direction)(row) : Vector3d(Vector3d::Zero())});
    }
  };
  constrain(fields.fixed, Kind::fixed);
  constrain(fields.axis, Kind::axis);
  constrain(fields.plane, Kind::plane);
  return out;
}

}  // namespace rfsmooth::cli
