#include "pipeline/cli/commands/compare/compare_figures.h"

#include <optional>
#include <string>

#include "pipeline/cli/deviation.h"

namespace rfsmooth::cli {

namespace {

using nlohmann::ordered_json;

struct ToJson {
  ordered_json& out;
  void operator()(const MeasureInfo& info, const std::optional<double>& value) {
    if (value) out[std::string(info.name)] = *value;
  }
};

}  // namespace

ordered_json figures_of(const CompareReport& report, const Deviation& deviation) {
  ordered_json own, unit;
  Measures::describe(report.own_units, ToJson{own});
  const Measures scaled = rfsmooth::on_unit_sphere(report.own_units, report.radius);
  Measures::describe(scaled, ToJson{unit});
  return {{"points", report.points},
          {"finite", report.finite},
          {"truth_points", report.truth_points},
          {"truth_faces", report.truth_faces},
          {"truth_closed", report.truth_closed},
          {"radius", report.radius},
          {"deviation",
           {{"rms", deviation.rms},
            {"median", deviation.median},
            {"percentile_95", deviation.most},
            {"largest", deviation.largest}}},
          {"own_units", own},
          {"unit_sphere", unit}};
}

}  // namespace rfsmooth::cli
