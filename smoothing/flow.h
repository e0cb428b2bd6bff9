/// The front door of the flow library: every flow by name, one way to run it.
///
/// A flow moves the vertices of a mesh and never changes its connectivity. Step by step (`make_flow`) it can
/// alternate with edge swaps or reconnection, which live in other rooms; `smooth` runs it for its number of
/// steps.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rfsmooth/rfs_mesh/mesh.h"
#include "rfsmooth/rfs_mesh/options.h"

namespace rfsmooth::smoothing {

/// Parameters of all flows. Every field is optional: each flow uses those its registry entry names and has
/// its own defaults for the empty ones; giving one that the flow does not use is an error.
struct FlowOptions {
  std::string flow = "hc";            ///< a name from `flows()`
  std::optional<int> iterations;      ///< steps
  std::optional<double> lambda;       ///< step length of explicit flows, dimensionless
  std::optional<double> alpha;        ///< HC: weight of the original point against the current one, in [0, 1]
  std::optional<double> beta;         ///< HC: a vertex's own difference against its neighbours', in [0, 1]
  std::optional<std::string> anchor;  ///< Laplacian: the point that is averaged with the neighbours' mean
  std::optional<std::string> weights;  ///< neighbours' weights of the umbrella
  std::optional<std::string> update;   ///< all vertices at once, or each seeing its predecessors' new places

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"flow", "how the mesh is smoothed (see `rfsmooth flows`)", ""}, self.flow);
    visit(OptionInfo{"iterations", "number of steps", "steps", 0, 1000000}, self.iterations);
    visit(OptionInfo{"lambda", "step length of explicit flows", "", 0, 1}, self.lambda);
    visit(OptionInfo{"alpha", "weight of the original (or centre) point", "", 0, 1}, self.alpha);
    visit(OptionInfo{"beta", "HC: own difference against the neighbours' mean", "", 0, 1}, self.beta);
    visit(OptionInfo{"anchor",
                     "point averaged with the neighbours' mean, with weight alpha",
                     "",
                     -kNoLimit,
                     kNoLimit,
                     {"none", "centre", "original"}},
          self.anchor);
    visit(
        OptionInfo{"weights", "neighbours' weights", "", -kNoLimit, kNoLimit, {"equal", "inverse-distance"}},
        self.weights);
    visit(OptionInfo{"update",
                     "all vertices at once, or one after the other in index order",
                     "",
                     -kNoLimit,
                     kNoLimit,
                     {"simultaneous", "sequential"}},
          self.update);
  }

 private:
  static constexpr double kNoLimit = std::numeric_limits<double>::infinity();
};

/// What a run did.
struct FlowReport {
  int steps = 0;
  int solver_iterations = 0;  ///< implicit flows: conjugate gradient iterations, all steps together
  double largest_move = 0;    ///< world units
};

/// A running flow: remembers what it needs between steps (original positions, frozen weights).
class Flow {
 public:
  virtual ~Flow() = default;
  Flow() = default;
  Flow(const Flow&) = delete;
  Flow& operator=(const Flow&) = delete;

  /// One step: writes mesh.positions, leaves the connectivity. Deterministic; parallel over vertices. Given
  /// finite positions it leaves finite positions, whatever the mesh.
  virtual void step(rfs_mesh::Mesh& mesh, const Context& context) = 0;

  /// Told that the connectivity changed (edge swaps) while the vertices stayed the same.
  virtual void connectivity_changed(const rfs_mesh::Mesh&, const Context&) {}

  /// Conjugate gradient iterations of all steps so far; 0 for explicit flows.
  virtual int solver_iterations() const { return 0; }
};

/// One line of the registry.
struct FlowEntry {
  std::string_view name;
  std::string_view summary;                  ///< one line for `rfsmooth flows` and the README
  std::string_view source;                   ///< paper and section
  std::vector<std::string_view> parameters;  ///< the FlowOptions it uses, by option name
  FlowOptions defaults;                      ///< its values for empty options; `iterations` always has one
  std::unique_ptr<Flow> (*make)(const rfs_mesh::Mesh& mesh, const FlowOptions& options,
                                const Context& context);
};

/// All flows, in the order of the README's table.
const std::vector<FlowEntry>& flows();

/// The entry called `name`; an Error (usage) with the nearest name if there is none.
Result<const FlowEntry*> find_flow(std::string_view name);

/// The options with the flow's own defaults in the empty fields, validated: what `make_flow` will use. Read
/// the number of steps here: `*complete(options).value().iterations`. Errors: usage.
Result<FlowOptions> complete(const FlowOptions& options);

/// Starts a flow on `mesh`, whose current positions are the original points. Validates the options.
Result<std::unique_ptr<Flow>> make_flow(const rfs_mesh::Mesh& mesh, const FlowOptions& options,
                                        const Context& context);

/// Runs a flow for its number of steps. On an error or cancel the mesh is untouched.
Result<FlowReport> smooth(rfs_mesh::Mesh& mesh, const FlowOptions& options, const Context& context);

}  // namespace rfsmooth::smoothing
