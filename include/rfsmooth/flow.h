/// The front door of the flow library: every flow by name, one way to run it.
///
/// A flow moves the vertices of a mesh and never changes its connectivity. Step by step (`make_flow`) it can
/// alternate with edge swaps or reconnection, which live in other rooms; `smooth` runs it for its number of
/// steps. Functions are thread safe on distinct meshes; one Flow is for one thread at a time.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <rfsmooth/flow_options.h>
#include <rfsmooth/mesh.h>

namespace rfsmooth {

/// What a mesh measures before the first step (row 0) and after each. World units.
struct TraceRow {
  int step = 0;
  std::optional<double> volume;  ///< of closed meshes that have an inside
  double area = 0;               ///< of the faces
  double energy = 0;             ///< sum over the edges' ends of |umbrella vector|^2, the thin-plate energy
  double roughness = 0;          ///< root mean square turn of the normal across edges of two faces, degrees
  double largest_move = 0;       ///< of this step
};

/// How the solves of an implicit flow ended, all steps together; the defaults are those of explicit flows,
/// which solve nothing.
struct SolverSummary {
  int iterations = 0;     ///< products with the matrix
  double residual = 0;    ///< the largest at the end of a solve, relative to the right side
  bool converged = true;  ///< whether each is within the tolerance, or as small as rounding leaves it
  /// Adds those of a further flow or step.
  SolverSummary& operator+=(const SolverSummary& other);
};

/// What a run did.
struct FlowReport {
  int steps = 0;
  SolverSummary solver;
  double largest_move = 0;      ///< world units
  std::vector<TraceRow> trace;  ///< steps + 1 rows if asked for (FlowOptions::trace)
};

/// What a cloud itself shows of its noise. Lengths in world units.
struct NoiseSummary {
  double typical = 0;     ///< standard deviation along the normal, of the typical place
  double loudest = 0;     ///< the same of the loudest tenth of the points, its least
  double shared = 1;      ///< over how many neighbouring points it is about the same; 1: each has its own
  double step = 0;        ///< typical distance between depths that come in steps, world units; 0: they do not
  bool on_grid = false;   ///< whether the points are on a grid of that step, as voxels' centres are
  bool on_lines = false;  ///< whether the points lie along lines, as on the rings of a spinning laser
};

/// Why everything stays where it is.
enum class NotSmoothed {
  no_iterations,     ///< the options ask for none
  no_strength,       ///< the strength in the options is 0
  too_few_points,    ///< for the automatic flow, which looks at 32 neighbours
  too_little_noise,  ///< to be told from shape
};

/// A vertex that may not move freely.
struct HardConstraint {
  enum class Kind { fixed, axis, plane };
  Index vertex = 0;
  Kind kind = Kind::fixed;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< along the axis, or the plane's normal; not zero
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
  /// finite positions it leaves finite positions, whatever the mesh. \throw Failure (cancelled) if
  /// `context.stop` is set; the positions may be of a part of the step then.
  virtual void step(Mesh& mesh, const Context& context) = 0;

  /// Called when the connectivity has changed (edge swaps) while the vertices stayed the same.
  virtual void connectivity_changed(const Mesh&, const Context&) {}

  /// Of all steps so far.
  virtual SolverSummary solver() const { return {}; }

  /// Whether the flow keeps to the constraints it was made with by itself; if not, `make_flow` wraps it.
  virtual bool applies_constraints() const { return false; }
};

/// Makes a flow on a mesh under constraints.
using FlowMaker = std::function<std::unique_ptr<Flow>(const Mesh&, const Constraints&)>;

/// Every flow with its own defaults, in the order of the table of flows. The reference stays valid.
const std::vector<AnyFlow>& flows();

/// The flow called `name`, with its defaults. Errors: usage, with the names there are.
Result<AnyFlow> find_flow(std::string_view name);

/// The same options with exactly the equations that the papers print: every scheme is Scheme::printed. Flows
/// that have no scheme are printed already. Errors: usage, for auto, which is in no paper.
Result<FlowOptions> as_printed(FlowOptions options);

/// Checks the ranges, and that no option without effect (push_alpha without push_back) has another value than
/// its default. The error (usage) names the option, and its range or the partner that it needs.
Result<Done> validate(const FlowOptions& options);

/// How many rings of neighbours around a vertex have a say in where it goes, all steps together: the others
/// could be left out of the mesh. None if any vertex may have one: in flows that solve a system, that take a
/// mean over the mesh or the vertices in an order, and under modifiers other than the push-back; also of the
/// automatic flow, whose patches are wider than rings.
std::optional<int> support_rings(const FlowOptions& options);

/// Starts a flow on `mesh`, whose current positions are the original points. Validates the options.
/// Errors: usage, cancelled. \throw std::invalid_argument for constraints that do not fit the mesh.
Result<std::unique_ptr<Flow>> make_flow(const Mesh& mesh, const FlowOptions& options, const Context& context,
                                        const Constraints& constraints = {});

/// The same with a flow of your own: `make` makes it, and the modifiers of `options` go around it. Of the
/// flow in `options` the threshold takes the step length and the scheme, and under Boundary::curve the
/// boundary follows that flow, ahead of the rest if it is implicit.
Result<std::unique_ptr<Flow>> make_flow(const FlowMaker& make, const Mesh& mesh, const FlowOptions& options,
                                        const Context& context, const Constraints& constraints = {});

/// Runs a flow for its number of steps. On an error or cancel the mesh is untouched. The same bytes for any
/// number of threads. Errors: usage, out_of_memory, cancelled. \throw std::invalid_argument for constraints
/// that do not fit the mesh. Precondition: `check(mesh)` is empty. About O(n + m) a step for n vertices and m
/// faces, of implicit flows an iteration of the solver; auto: O(n log n) a step.
Result<FlowReport> smooth(Mesh& mesh, const FlowOptions& options, const Context& context,
                          const Constraints& constraints = {});

}  // namespace rfsmooth
