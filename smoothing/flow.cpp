#include <algorithm>
#include <type_traits>

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
#include "smoothing/trace.h"

namespace rfsmooth {

using namespace smoothing;

namespace {

template <class... Options>
std::vector<AnyFlow> one_of_each(const std::variant<Options...>*) {
  return {Options{}...};
}

/// What `get` makes of the options of the flow; `other` where it cannot be called with them.
template <class AnyOptions, class T, class Get>
T of_options(AnyOptions& flow, T other, const Get& get) {
  return std::visit(
      [&](auto& options) -> T {
        if constexpr (std::is_invocable_v<Get, decltype(options)>)
          return get(options);
        else
          return other;
      },
      flow);
}

/// The length of an explicit flow's step or the time of an implicit one's; 1 for flows that have neither.
double step_length(const AnyFlow& flow) {
  const double time = of_options(flow, 1.0, [](auto& o) -> decltype(o.dt) { return o.dt; });
  return of_options(flow, time, [](auto& o) -> decltype(o.lambda) { return o.lambda; });
}

/// The flow around which the invariant is kept, if one is asked for.
std::unique_ptr<Flow> preserving(std::unique_ptr<Flow> flow, const Mesh& mesh, Preserve invariant,
                                 const Constraints& constraints, const Context& context) {
  if (invariant == Preserve::none) return flow;
  return make_preserving(std::move(flow), mesh, invariant, AllowedMoves(constraints, mesh.positions.size()),
                         context);
}

/// The flow with its modifiers but the invariant, innermost first: constraints, push-back, threshold.
std::unique_ptr<Flow> compose(const FlowMaker& make, const Mesh& mesh, const FlowOptions& options,
                              const Constraints& constraints, const Context& context) {
  const Modifiers& m = options.modifiers;
  AllowedMoves allowed(constraints, mesh.positions.size());
  std::unique_ptr<Flow> flow = make(mesh, constraints);
  const bool constrained = !constraints.hard.empty() || !constraints.strength.empty();
  if (constrained && !flow->applies_constraints()) flow = make_constrained(std::move(flow), allowed);
  if (m.push_back) flow = make_pushback(std::move(flow), mesh, m.push_alpha, m.push_beta, allowed);
  if (m.threshold != ThresholdKind::none) {
    ThresholdRule rule;
    rule.rings = m.threshold == ThresholdKind::two_ring ? 2 : m.threshold == ThresholdKind::one_ring ? 1 : 0;
    rule.constant = m.threshold_value;
    rule.every = m.threshold_every;
    rule.lambda = step_length(options.flow);
    if (!(rule.lambda > 0)) rule.lambda = 1;
    rule.scheme =
        of_options(options.flow, rule.scheme, [](auto& o) -> decltype(o.scheme) { return o.scheme; });
    flow = make_threshold(std::move(flow), mesh, rule, context);
  }
  return flow;
}

}  // namespace

SolverSummary& SolverSummary::operator+=(const SolverSummary& other) {
  iterations += other.iterations;
  residual = std::max(residual, other.residual);
  converged = converged && other.converged;
  return *this;
}

const std::vector<AnyFlow>& flows() {
  static const std::vector<AnyFlow> all = one_of_each(static_cast<AnyFlow*>(nullptr));
  return all;
}

Result<AnyFlow> find_flow(std::string_view name) {
  std::vector<std::string_view> names;
  for (const AnyFlow& flow : flows()) {
    if (name_of(flow) == name) return flow;
    names.push_back(name_of(flow));
  }
  return Error{ErrorCode::usage,
               fmt::format("there is no flow '{}'; there are {}", name, fmt::join(names, ", "))};
}

Result<FlowOptions> as_printed(FlowOptions options) {
  if (std::holds_alternative<AutomaticOptions>(options.flow))
    return Error{ErrorCode::usage, "the flow 'auto' is in no paper; name one that is"};
  Scheme* const scheme = of_options(options.flow, static_cast<Scheme*>(nullptr),
                                    [](auto& o) -> decltype(&o.scheme) { return &o.scheme; });
  if (scheme != nullptr) *scheme = Scheme::printed;
  return options;
}

Result<Done> validate(const FlowOptions& options) {
  if (auto ranges = validate<FlowOptions>(options); !ranges.ok()) return ranges;
  for (const Partner& p : partners(options))
    if (!p.on && p.set)
      return Error{ErrorCode::usage, fmt::format("`{}` has no effect without {}", p.option, p.partner)};
  return Done{};
}

std::optional<int> support_rings(const FlowOptions& options) {
  Modifiers others = options.modifiers;
  others.push_back = false;
  const auto rings = of_options(options.flow, std::optional<int>(),
                                [](auto& o) -> decltype(o.rings()) { return o.rings(); });
  if (!rings || others.any()) return std::nullopt;
  return iterations(options.flow) * (*rings + int(options.modifiers.push_back));
}

Result<std::unique_ptr<Flow>> make_flow(const FlowMaker& make, const Mesh& mesh, const FlowOptions& options,
                                        const Context& context, const Constraints& constraints) {
  return guarded([&] {
    value_or_throw(validate(options));
    // Along a curve the boundary moves too, so the invariant is restored after that, by all vertices.
    const Preserve invariant = options.modifiers.preserve;
    const bool outside = options.modifiers.boundary == Boundary::curve;
    auto flow =
        with_boundary_rule(options, mesh, constraints, context, [&](const Mesh& on, const Constraints& c) {
          auto inner = compose(make, on, options, c, context);
          return outside ? std::move(inner) : preserving(std::move(inner), on, invariant, c, context);
        });
    return outside ? preserving(std::move(flow), mesh, invariant, constraints, context) : std::move(flow);
  });
}

Result<std::unique_ptr<Flow>> make_flow(const Mesh& mesh, const FlowOptions& options, const Context& context,
                                        const Constraints& constraints) {
  const FlowMaker start = [&](const Mesh& on, const Constraints& c) {
    return std::visit([&](const auto& flow) { return flow.start(on, c, context); }, options.flow);
  };
  return make_flow(start, mesh, options, context, constraints);
}

namespace {

FlowReport run(Mesh& mesh, const FlowOptions& options, const Context& context,
               const Constraints& constraints) {
  FlowReport report;
  const auto flow = value_or_throw(make_flow(mesh, options, context, constraints));
  const int steps = iterations(options.flow);
  Tracer tracer(options.trace ? &report.trace : nullptr, mesh, context);
  for (; report.steps < steps; ++report.steps) {
    context.report("smooth", double(report.steps) / steps);
    flow->step(mesh, context);
    tracer.add(mesh, context);
  }
  context.report("smooth", 1);
  report.solver = flow->solver();
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
    value_or_throw(validate(options));
    original = mesh.positions;
    FlowReport report;
    in_arena(context, [&] {
      const Update update = of_options(options.flow, Update::simultaneous,
                                       [](auto& o) -> decltype(o.update) { return o.update; });
      report = update == Update::simultaneous && iterations(options.flow) > 0 && is_scattered(mesh, context)
                   ? run_reordered(mesh, options, context, constraints)
                   : run(mesh, options, context, constraints);
      report.largest_move = largest_move(original, mesh.positions, context);
    });
    return report;
  });
  // Bringing them back needs no memory; there are none if the options were wrong.
  if (!result.ok() && !original.empty()) mesh.positions.swap(original);
  return result;
}

}  // namespace rfsmooth
