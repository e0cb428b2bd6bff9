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

#include <rfsmooth/mesh.h>
#include <rfsmooth/options.h>

namespace rfsmooth {

/// Parameters of all flows. Every field is optional: each flow uses those its registry entry names and has
/// its own defaults for the empty ones; giving one that the flow does not use is an error.
struct FlowOptions {
  std::string flow = "auto";      ///< a name from `flows()`
  std::optional<int> iterations;  ///< steps
  std::optional<double>
      strength;                  ///< auto: 0 = nothing, 1 = as the noise asks for, 2 = as for twice the noise
  std::optional<Length> noise;   ///< auto: standard deviation along the normal; empty = measured
  std::optional<bool> equalize;  ///< auto: evens the points out along the surface afterwards
  std::optional<double> lambda;  ///< step length of explicit flows, dimensionless
  std::optional<double> mu;      ///< Taubin: length of the inflating step, > lambda
  std::optional<double> dt;      ///< time step of implicit flows, dimensionless, any size
  std::optional<double> alpha;   ///< HC: weight of the original point against the current one, in [0, 1]
  std::optional<double> beta;    ///< HC: a vertex's own difference against its neighbours', in [0, 1]
  std::optional<std::string> anchor;   ///< Laplacian: the point that is averaged with the neighbours' mean
  std::optional<std::string> weights;  ///< neighbours' weights of the umbrella
  std::optional<std::string> update;   ///< all vertices at once, or each seeing its predecessors' new places
  std::optional<std::string> op;       ///< implicit flows: the Laplacian
  std::optional<int> order;            ///< implicit flows: its power
  std::optional<double> mixture;       ///< implicit flows: share of the first power beside the order-th
  std::optional<bool> keep_weights;    ///< implicit flows: weights of the first mesh for all steps
  std::optional<bool> normalised;      ///< curvature flow: divided by the sum of the cotangents
  std::optional<double> tangential;    ///< modified curvature flow: weight of the tangential umbrella
  std::optional<int> power;            ///< directional: m of the energy integral H^(2m) dA that falls
  std::optional<std::string> direction;  ///< directional: "auto" or "x,y,z"
  std::optional<std::string> scheme;     ///< directional: keeps the volume of a step, or as printed
  std::optional<double> eps;             ///< local directional: |K| below it counts as flat, 1/h^2
  std::optional<std::string> chart;      ///< discrete fairing: how neighbours get their parameters
  std::optional<double> tolerance;       ///< implicit flows: residual to stop at, relative
  std::optional<std::string> norm;       ///< implicit flows: of the residual

  // Modifiers, usable with every flow (`modifiers()` lists them).
  std::optional<bool> push_back;          ///< HC's second half after every step
  std::optional<double> push_alpha;       ///< its alpha
  std::optional<double> push_beta;        ///< its beta
  std::optional<std::string> threshold;   ///< vertices slower than a threshold stay
  std::optional<double> threshold_value;  ///< the constant threshold, x mean edge length
  std::optional<int> threshold_every;     ///< steps between recomputing it from the rings
  std::optional<std::string> preserve;    ///< invariant restored after every step
  std::optional<std::string> boundary;    ///< what happens at edges with one face

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    const auto words = [](std::string_view name, std::string_view help,
                          std::vector<std::string_view> choices) {
      OptionInfo info{name, help, ""};
      info.choices = std::move(choices);
      return info;
    };
    visit(OptionInfo{"flow", "how the mesh is smoothed (see `rfsmooth flows`)", ""}, self.flow);
    visit(OptionInfo{"iterations", "number of steps", "steps", 0, 1000000}, self.iterations);
    visit(OptionInfo{"strength", "auto: times the strength that the noise asks for", "", 0, 10},
          self.strength);
    visit(OptionInfo{"noise", "auto: its standard deviation along the normal", "world units or x spacing", 0,
                     1e300},
          self.noise);
    visit(
        OptionInfo{"equalize", "auto: even the points out along the surface, by half a spacing at most", ""},
        self.equalize);
    visit(OptionInfo{"lambda", "step length of explicit flows", "", 0, 1}, self.lambda);
    visit(OptionInfo{"mu", "Taubin: length of the inflating step", "", 0, 2}, self.mu);
    visit(OptionInfo{"dt", "time step of implicit flows", "", 0, 1e9}, self.dt);
    visit(OptionInfo{"alpha", "weight of the original (or centre) point", "", 0, 1}, self.alpha);
    visit(OptionInfo{"beta", "HC: own difference against the neighbours' mean", "", 0, 1}, self.beta);
    visit(words("anchor", "point averaged with the neighbours' mean, with weight alpha",
                {"none", "centre", "original"}),
          self.anchor);
    visit(words("weights", "neighbours' weights", {"equal", "inverse-distance"}), self.weights);
    visit(words("update", "all vertices at once, or one after the other in index order",
                {"simultaneous", "sequential"}),
          self.update);
    visit(words("operator", "implicit flows: the Laplacian",
                {"umbrella", "inverse-distance", "scale-dependent", "curvature", "tufted"}),
          self.op);
    visit(OptionInfo{"order", "implicit flows: power of the operator", "", 1, 4}, self.order);
    visit(OptionInfo{"mixture", "implicit flows: share of the first power; negative enhances", "", -1, 1},
          self.mixture);
    visit(OptionInfo{"keep-weights", "implicit flows: weights of the first mesh for all steps", ""},
          self.keep_weights);
    visit(OptionInfo{"normalised", "curvature flow: divided by the sum of the cotangents", ""},
          self.normalised);
    visit(OptionInfo{"tangential", "modified curvature flow: weight of the tangential part", "", 0, 4},
          self.tangential);
    visit(OptionInfo{"power", "directional: m of the energy integral H^(2m) dA", "", 0, 8}, self.power);
    visit(OptionInfo{"direction", "directional: auto, or x,y,z", ""}, self.direction);
    visit(words("scheme", "directional: a step that keeps the volume, or the one the paper prints",
                {"conserving", "printed"}),
          self.scheme);
    visit(
        OptionInfo{"eps", "local directional: Gauss curvature that counts as flat", "1/(mean edge)^2", 0, 1},
        self.eps);
    visit(
        words("chart", "discrete fairing: parameters of the neighbours", {"tangent", "exponential", "mixed"}),
        self.chart);
    visit(OptionInfo{"tolerance", "implicit flows: relative residual to stop at", "", 1e-14, 1},
          self.tolerance);
    visit(words("norm", "implicit flows: norm of the residual", {"l2", "linf"}), self.norm);
    visit(OptionInfo{"push-back", "any flow: HC's push-back after every step", ""}, self.push_back);
    visit(OptionInfo{"push-alpha", "push-back: weight of the original point", "", 0, 1}, self.push_alpha);
    visit(OptionInfo{"push-beta", "push-back: own difference against the neighbours' mean", "", 0, 1},
          self.push_beta);
    visit(words("threshold", "any flow: vertices slower than this stay, others move by the excess",
                {"none", "constant", "one-ring", "two-ring"}),
          self.threshold);
    visit(OptionInfo{"threshold-value", "the constant threshold", "x mean edge per unit step", 0, 1e6},
          self.threshold_value);
    visit(OptionInfo{"threshold-every", "steps between recomputing ring thresholds", "steps", 1, 1000000},
          self.threshold_every);
    visit(words("preserve", "any flow: what is restored after every step",
                {"none", "volume", "area", "height-field"}),
          self.preserve);
    visit(words("boundary", "any flow: rule for edges with one face", {"free", "fixed", "curve", "virtual"}),
          self.boundary);
  }
};

/// What a run did.
struct FlowReport {
  int steps = 0;
  int solver_iterations = 0;  ///< implicit flows: products with the matrix, all steps together
  double largest_move = 0;    ///< world units
};

/// What the automatic flow measured and chose.
struct AutomaticReport {
  double noise = 0;           ///< measured or stated, standard deviation along the normal, world units
  double guide_strength = 0;  ///< c of the guide's fairing, dimensionless
  double left = 0;            ///< estimate of the noise left, root mean square along the normal, world units
  double equalized = 0;       ///< root mean square move along the surface afterwards, world units
  double equalized_most = 0;  ///< the largest of them
  std::size_t stranded = 0;   ///< points that the fairing had left beside the surface
};

/// A vertex that may not move freely.
struct HardConstraint {
  enum class Kind { fixed, axis, plane };
  Index vertex = 0;
  Kind kind = Kind::fixed;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< along the axis, or the plane's normal; any length
};

/// Constraints relative to the places the vertices have at the start.
struct Constraints {
  std::vector<HardConstraint> hard;  ///< at most one per vertex
  std::vector<double> strength;      ///< n, in [0, 1]: 0 = stays, 1 = smoothed fully; empty = all 1
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
  virtual void step(Mesh& mesh, const Context& context) = 0;

  /// The same, on a mesh of which nobody will read more than the positions: the flow may use up its faces and
  /// rings.
  virtual void last_step(Mesh& mesh, const Context& context) { step(mesh, context); }

  /// Told that the connectivity changed (edge swaps) while the vertices stayed the same.
  virtual void connectivity_changed(const Mesh&, const Context&) {}

  /// Solver iterations (products with the matrix) of all steps so far; 0 for explicit flows.
  virtual int solver_iterations() const { return 0; }

  /// Whether the flow keeps points that it cannot place where they are; if not, the caller limits moves.
  virtual bool limits_moves() const { return false; }

  /// What the automatic flow chose; empty before its first step and for other flows.
  virtual std::optional<AutomaticReport> automatic() const { return {}; }

  /// Whether the flow heeds the constraints it was made with itself; if not, `make_flow` wraps it.
  virtual bool applies_constraints() const { return false; }
};

/// One line of the registry.
struct FlowEntry {
  std::string_view name;
  std::string_view summary;                  ///< one line for `rfsmooth flows` and the README
  std::string_view source;                   ///< paper and section
  std::vector<std::string_view> parameters;  ///< the FlowOptions it uses, by option name
  FlowOptions defaults;                      ///< its values for empty options; `iterations` always has one
  std::unique_ptr<Flow> (*make)(const Mesh& mesh, const FlowOptions& options, const Constraints& constraints,
                                const Context& context);
};

/// All flows, in the order of the README's table.
const std::vector<FlowEntry>& flows();

/// The options that work with every flow, by name, beside those of its entry.
const std::vector<std::string_view>& modifiers();

/// The entry called `name`; an Error (usage) with the nearest name if there is none.
Result<const FlowEntry*> find_flow(std::string_view name);

/// The options with the flow's own defaults in the empty fields, validated: what `make_flow` will use. Read
/// the number of steps here: `*complete(options).value().iterations`. Errors: usage.
Result<FlowOptions> complete(const FlowOptions& options);

/// Starts a flow on `mesh`, whose current positions are the original points. Validates the options.
/// Errors: usage. \throw std::invalid_argument for constraints that do not fit the mesh.
Result<std::unique_ptr<Flow>> make_flow(const Mesh& mesh, const FlowOptions& options, const Context& context,
                                        const Constraints& constraints = {});

/// Runs a flow for its number of steps. On an error or cancel the mesh is untouched.
Result<FlowReport> smooth(Mesh& mesh, const FlowOptions& options, const Context& context,
                          const Constraints& constraints = {});

}  // namespace rfsmooth
