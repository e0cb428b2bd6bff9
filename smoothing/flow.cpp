#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include <rfsmooth/flow.h>

#include "base/parallel.h"
#include "smoothing/modifiers/boundary.h"
#include "smoothing/modifiers/constraint.h"
#include "smoothing/modifiers/preserve.h"
#include "smoothing/modifiers/pushback.h"
#include "smoothing/modifiers/threshold.h"
#include "smoothing/partners.h"
#include "smoothing/remesh/reorder.h"

namespace rfsmooth::smoothing {
#define RFSMOOTH_FLOW(name) FlowEntry flow_##name();
#include "smoothing/flows/flows.inc"
#undef RFSMOOTH_FLOW
}  // namespace rfsmooth::smoothing

namespace rfsmooth {

using namespace smoothing;

const std::vector<FlowEntry>& flows() {
  static const std::vector<FlowEntry> all = {
#define RFSMOOTH_FLOW(name) flow_##name(),
#include "smoothing/flows/flows.inc"
#undef RFSMOOTH_FLOW
  };
  return all;
}

namespace {

/// Levenshtein distance, for "did you mean".
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t up = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = up;
    }
  }
  return row.back();
}

/// The addresses of the optional fields in the table's order, to walk two structs side by side.
struct Fields {
  std::vector<const void*> at;
  template <class T>
  void operator()(const OptionInfo&, const std::optional<T>& value) {
    at.push_back(&value);
  }
  template <class T>
  void operator()(const OptionInfo&, const T&) {}
};

struct FillEmpty {
  const FlowEntry& entry;
  std::vector<const void*> defaults;
  bool checking = true;
  std::size_t next = 0;
  template <class T>
  void operator()(const OptionInfo& info, std::optional<T>& value) {
    const auto& standard = *static_cast<const std::optional<T>*>(defaults[next++]);
    const auto& used = entry.parameters;
    const auto& any = modifiers();
    if (checking && value && std::find(used.begin(), used.end(), info.name) == used.end() &&
        std::find(any.begin(), any.end(), info.name) == any.end())
      throw Failure({ErrorCode::usage, fmt::format("--{} has no meaning for the flow '{}', which uses: {}",
                                                   info.name, entry.name, fmt::join(used, ", "))});
    if (!value) value = standard;
  }
  template <class T>
  void operator()(const OptionInfo&, T&) {}
};

FlowOptions modifier_defaults() {
  FlowOptions o;
  o.push_back = false;
  o.push_alpha = 0;
  o.push_beta = 0.6;  // HC's own defaults
  o.threshold = "none";
  o.threshold_value = 0.1;
  o.threshold_every = 5;
  o.preserve = "none";
  o.boundary = "free";
  return o;
}

/// The flow around which the invariant is kept, if one is asked for.
std::unique_ptr<Flow> preserving(std::unique_ptr<Flow> flow, const Mesh& mesh, const FlowOptions& o,
                                 const Constraints& constraints, const Context& context) {
  if (*o.preserve == "none") return flow;
  const Invariant invariant = *o.preserve == "volume" ? Invariant::volume
                              : *o.preserve == "area" ? Invariant::area
                                                      : Invariant::height_field;
  return make_preserving(std::move(flow), mesh, invariant, AllowedMoves(constraints, mesh.positions.size()),
                         context);
}

/// The flow with its modifiers but the invariant, innermost first: constraints, push-back, threshold.
std::unique_ptr<Flow> compose(const FlowEntry& entry, const Mesh& mesh, const FlowOptions& o,
                              const Constraints& constraints, const Context& context) {
  AllowedMoves allowed(constraints, mesh.positions.size());
  std::unique_ptr<Flow> flow = entry.make(mesh, o, constraints, context);
  const bool constrained = !constraints.hard.empty() || !constraints.strength.empty();
  if (constrained && !flow->applies_constraints()) flow = make_constrained(std::move(flow), allowed);
  if (*o.push_back) flow = make_pushback(std::move(flow), mesh, *o.push_alpha, *o.push_beta, allowed);
  if (*o.threshold != "none") {
    ThresholdRule rule;
    rule.rings = *o.threshold == "two-ring" ? 2 : *o.threshold == "one-ring" ? 1 : 0;
    rule.constant = o.threshold_value.value_or(0);
    rule.every = o.threshold_every.value_or(1);
    rule.lambda = o.lambda ? *o.lambda : o.dt ? *o.dt : 1;
    if (!(rule.lambda > 0)) rule.lambda = 1;
    flow = make_threshold(std::move(flow), mesh, rule, context);
  }
  return flow;
}

}  // namespace

const std::vector<std::string_view>& modifiers() {
  static const std::vector<std::string_view> all = {"push-back", "push-alpha",      "push-beta",
                                                    "threshold", "threshold-value", "threshold-every",
                                                    "preserve",  "boundary"};
  return all;
}

Result<const FlowEntry*> find_flow(std::string_view name) {
  const FlowEntry* nearest = &flows().front();
  for (const FlowEntry& entry : flows()) {
    if (entry.name == name) return &entry;
    if (edit_distance(entry.name, name) < edit_distance(nearest->name, name)) nearest = &entry;
  }
  return Error{ErrorCode::usage,
               fmt::format("there is no flow '{}'; did you mean '{}'? `rfsmooth flows` lists them all", name,
                           nearest->name)};
}

Result<FlowOptions> complete(const FlowOptions& options) {
  return guarded([&] {
    const FlowEntry& entry = *value_or_throw(find_flow(options.flow));
    value_or_throw(validate(options));
    FlowOptions full = options;
    const FlowOptions standard = modifier_defaults();
    Fields own, common;
    FlowOptions::describe(entry.defaults, own);
    FlowOptions::describe(full, FillEmpty{entry, own.at, true});
    FlowOptions::describe(standard, common);
    FlowOptions::describe(full, FillEmpty{entry, common.at, false});
    settle_partners(options, full);
    return full;
  });
}

Result<std::unique_ptr<Flow>> make_flow(const Mesh& mesh, const FlowOptions& options, const Context& context,
                                        const Constraints& constraints) {
  return guarded([&] {
    const FlowOptions o = value_or_throw(complete(options));
    const FlowEntry& entry = *find_flow(o.flow).value();
    // Along a curve the boundary moves too, so the invariant is restored after that, by all vertices.
    const bool outside = *o.boundary == "curve";
    auto flow = with_boundary_rule(o, mesh, constraints, context, [&](const Mesh& on, const Constraints& c) {
      auto inner = compose(entry, on, o, c, context);
      return outside ? std::move(inner) : preserving(std::move(inner), on, o, c, context);
    });
    return outside ? preserving(std::move(flow), mesh, o, constraints, context) : std::move(flow);
  });
}

namespace {

FlowReport run(Mesh& mesh, const FlowOptions& options, const Context& context,
               const Constraints& constraints) {
  FlowReport report;
  const auto flow = value_or_throw(make_flow(mesh, options, context, constraints));
  const int steps = *options.iterations;
  for (; report.steps < steps; ++report.steps) {
    context.report(options.flow, double(report.steps) / steps);
    flow->step(mesh, context);
  }
  report.solver_iterations = flow->solver_iterations();
  return report;
}

/// The same on the mesh in an order that suits the cache; mesh.positions come back in the caller's.
FlowReport run_reordered(Mesh& mesh, const FlowOptions& options, const Context& context,
                         const Constraints& constraints) {
  Reordered near = reorder(mesh, context);
  FlowReport report;
  try {
    report = run(near.mesh, options, context, reorder(constraints, near.place));
  } catch (const Failure& failure) {
    if (failure.error.code != ErrorCode::usage) throw;
    return run(mesh, options, context, constraints);  // fails too, with the caller's vertices in the message
  }
  for_each_index(context, near.place.size(),
                 [&](std::size_t i) { mesh.positions[i] = near.mesh.positions[near.place[i]]; });
  return report;
}

}  // namespace

Result<FlowReport> smooth(Mesh& mesh, const FlowOptions& options, const Context& context,
                          const Constraints& constraints) {
  Positions original;
  auto result = guarded([&] {
    const FlowOptions o = value_or_throw(complete(options));
    original = mesh.positions;
    FlowReport report;
    in_arena(context, [&] {
      const bool any_order = !o.update || *o.update == "simultaneous";
      report = any_order && *o.iterations > 0 && is_scattered(mesh, context)
                   ? run_reordered(mesh, o, context, constraints)
                   : run(mesh, o, context, constraints);
      report.largest_move = reduce_blocks(
          context, original.size(), 0.0,
          [&](std::size_t begin, std::size_t end) {
            double largest = 0;
            for (std::size_t i = begin; i < end; ++i)
              largest = std::max(largest, (mesh.positions[i] - original[i]).norm());
            return largest;
          },
          [](double a, double b) { return std::max(a, b); });
    });
    return report;
  });
  // Bringing them back needs no memory; there are none if the options were wrong.
  if (!result.ok() && !original.empty()) mesh.positions.swap(original);
  return result;
}

}  // namespace rfsmooth
