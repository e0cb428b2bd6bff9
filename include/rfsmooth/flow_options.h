/// The options of every flow, one plain struct each, and of the modifiers that go around any of them.
///
/// A flow is one of these structs, its line in `AnyFlow` below, and the file flow_<name>.cpp that defines its
/// `start`. Where only so many rings of neighbours have a say in a vertex's step, the struct says how many by
/// `rings`, and clouds can be smoothed by it in tiles. An option that means something only beside another one
/// says so; without it, it must be left at its default (`validate`). Defaults are the fields' initialisers;
/// ranges stand in `describe`, which every help text, report and check is made from. Options of one name mean
/// the same in every flow. docs/FLOWS.md shows each flow at work. Dimensionless unless a unit is given. Plain
/// values: thread safe as those are.
#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/options.h>

namespace rfsmooth {

struct Context;
struct Mesh;
class Flow;
struct Constraints;

/// Neighbours' weights in the umbrella: 1, or 1 / distance.
enum class UmbrellaWeights { equal, inverse_distance };
/// All vertices at once, or one after the other in index order, each seeing its predecessors' new places.
enum class Update { simultaneous, sequential };
/// The point that is averaged with the neighbours' mean: none, the vertex before the step, or at the start.
enum class Anchor { none, centre, original };
/// The Laplacian that a flow steps by. Options take any but the last, which is for explicit steps.
enum class OperatorKind {
  umbrella,
  inverse_distance,
  scale_dependent,
  curvature,
  tufted,
  curvature_normalised,
};
/// Of a residual: root mean square, or the largest.
enum class Norm { l2, linf };
/// How neighbours get their parameters: projected to the tangent plane, by lengths and scaled angles around
/// the vertex, the mean of the latter and the uniform chart, or the uniform chart: even angles, all lengths
/// their mean.
enum class Chart { tangent, exponential, mixed, uniform };
/// A step whose size is bounded where a mesh is bad, with the mixed area in H n; or the papers' equation as
/// it is printed: no bounds, and in H n the area of the whole one-ring, which makes it a third.
enum class Scheme { safe, printed };
/// Where the threshold comes from that vertices must be faster than: a constant, or the mean curvature of
/// the first ring of neighbours, or of the first and the second.
enum class ThresholdKind { none, constant, one_ring, two_ring };
/// The invariant that is restored after every step: the volume of a closed mesh, the area of an open one, or
/// the volume between a height field and the plane z = 0.
enum class Preserve { none, volume, area, height_field };
/// What happens at edges with one face: nothing special; their vertices stay; they follow the flow along the
/// curve that they make; or each loop is closed by a virtual vertex, for the flow only.
enum class Boundary { free, fixed, curve, virtual_vertices };

/// What lists say of a flow.
struct FlowInfo {
  std::string_view name;
  std::string_view summary;  ///< one line
  std::string_view source;   ///< paper and section
};

/// What the tables say of options that several flows have.
struct Shared {
  static inline const OptionInfo kIterations{"iterations", "number of steps", "steps", 0, 1000000};
  static inline const OptionInfo kLambda{"lambda", "step length of explicit flows", "", 0, 1};
  static inline const OptionInfo kDt{"dt", "time step of implicit flows", "", 0, 1e9};
  static inline const OptionInfo kAlpha{"alpha", "weight of the original (or centre) point", "", 0, 1};
  static inline const OptionInfo kBeta{"beta", "HC: own difference against the neighbours' mean", "", 0, 1};
  static inline const OptionInfo kWeights =
      words("weights", "neighbours' weights", {"equal", "inverse-distance"});
  static inline const OptionInfo kUpdate =
      words("update", "all vertices at once, or one after the other in index order",
            {"simultaneous", "sequential"});
  static inline const OptionInfo kTolerance{"tolerance", "implicit flows: relative residual to stop at", "",
                                            1e-14, 1};
  static inline const OptionInfo kNorm =
      words("norm", "implicit flows: norm of the residual", {"l2", "linf"});
  static inline const std::vector<std::string_view> kCharts = {"tangent", "exponential", "mixed", "uniform"};
  static inline const OptionInfo kScheme =
      words("scheme", "curvature flows: steps bounded on bad faces, or the equation as the paper prints it",
            {"safe", "printed"});
  static inline const OptionInfo kPower{"power", "directional flows: m of the energy integral H^(2m) dA", "",
                                        0, 8};
};

/// The automatic smoother.
struct AutomaticOptions {
  static constexpr FlowInfo kInfo{"auto",
                                  "strength chosen at every point from the measured noise; the default",
                                  "Desbrun 2.6, Kobbelt, Stein 1981"};
  int iterations = 1;           ///< steps, each with its own measurement
  double strength = 1;          ///< 0 = nothing, 1 = as the noise asks for, 2 = as for twice the noise
  std::optional<Length> noise;  ///< standard deviation along the normal; empty = measured
  bool equalize = true;  ///< evens points out along the surface; not on lines, nor where all share noise
  bool learned = true;   ///< a trained network has the last word on heights (docs/FLOWS.md)

  std::unique_ptr<Flow> start(const Mesh&, const Constraints&, const Context&) const;
  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(Shared::kIterations, self.iterations);
    visit(OptionInfo{"strength", "auto: times the strength that the noise asks for", "", 0, 10},
          self.strength);
    visit(OptionInfo{"noise", "auto: its standard deviation along the normal", "world units or x spacing", 0,
                     1e300},
          self.noise);
    visit(
        OptionInfo{"equalize", "auto: even the points out along the surface, by half a spacing at most", ""},
        self.equalize);
    visit(OptionInfo{"learned", "auto: a small trained network takes the last step along the normal", ""},
          self.learned);
  }
};

/// Laplacian smoothing and its anchored variants.
struct LaplacianOptions {
  static constexpr FlowInfo kInfo{"laplacian", "each vertex to the mean of its neighbours; fast, shrinks",
                                  "Vollmer 3; Ohtake (1)-(4)"};
  int iterations = 3;            ///< the paper's figures; more shrink more than they smooth
  double lambda = 1;             ///< multiplies the step of every anchor
  double alpha = 0.5;            ///< weight of the anchor; only where there is one
  Anchor anchor = Anchor::none;  ///< with `original` and alpha > 0 it converges
  UmbrellaWeights weights = UmbrellaWeights::equal;  ///< of the neighbours in the umbrella
  Update update = Update::simultaneous;  ///< whether vertices see the new places of those before them

  std::unique_ptr<Flow> start(const Mesh&, const Constraints&, const Context&) const;
  std::optional<int> rings() const {
    return update == Update::simultaneous ? std::optional(1) : std::nullopt;
  }
  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(Shared::kIterations, self.iterations);
    visit(Shared::kLambda, self.lambda);
    visit(Shared::kAlpha, self.alpha);
    visit(words("anchor", "point averaged with the neighbours' mean, with weight alpha",
                {"none", "centre", "original"}),
          self.anchor);
    visit(Shared::kWeights, self.weights);
    visit(Shared::kUpdate, self.update);
  }
};

/// The HC algorithm.
struct HcOptions {
  static constexpr FlowInfo kInfo{
      "hc", "Laplacian steps pushed back by the mean difference; keeps size and shape", "Vollmer 4"};
  int iterations = 10;  ///< steps
  double alpha = 0;     ///< of the original against the current point; with 0 ten steps are 10 (1 - beta) L^2
  double beta = 0.6;    ///< a vertex's own difference; the paper's bound for convergence is 0.5
  Update update = Update::simultaneous;  ///< whether vertices see the new places of those before them

  std::unique_ptr<Flow> start(const Mesh&, const Constraints&, const Context&) const;
  std::optional<int> rings() const {
    return update == Update::simultaneous ? std::optional(2) : std::nullopt;
  }
  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(Shared::kIterations, self.iterations);
    visit(Shared::kAlpha, self.alpha);
    visit(Shared::kBeta, self.beta);
    visit(Shared::kUpdate, self.update);
  }
};

/// HC's limit.
struct HcLimitOptions {
  static constexpr FlowInfo kInfo{"hc-limit", "what HC converges to, in one solve",
                                  "Vollmer 4, theorem 5.2; our derivation"};
  int iterations = 1;       ///< steps
  double alpha = 0.04;      ///< HC's, above 0; (1 - beta) / alpha = 10 weighs the fairness
  double beta = 0.6;        ///< HC's, above 0.5
  double tolerance = 1e-5;  ///< residual to stop at, relative to the right side
  Norm norm = Norm::l2;     ///< of the residual

  std::unique_ptr<Flow> start(const Mesh&, const Constraints&, const Context&) const;
  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(Shared::kIterations, self.iterations);
    visit(Shared::kAlpha, self.alpha);
    visit(Shared::kBeta, self.beta);
    visit(Shared::kTolerance, self.tolerance);
    visit(Shared::kNorm, self.norm);
  }
};

/// Taubin's pair of steps.
struct TaubinOptions {
  static constexpr FlowInfo kInfo{"taubin",
                                  "alternates shrinking and inflating steps; keeps volume, may leave waves",
                                  "Ohtake (6); Desbrun 2.1"};
  int iterations = 10;     ///< steps
  double lambda = 0.6307;  ///< of the shrinking step; Desbrun's figure 4, pass band 0.1
  double mu = 0.6732;      ///< of the inflating step, above lambda
  UmbrellaWeights weights = UmbrellaWeights::equal;  ///< of the neighbours in the umbrella

  std::unique_ptr<Flow> start(const Mesh&, const Constraints&, const Context&) const;
  std::optional<int> rings() const { return 2; }
  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(Shared::kIterations, self.iterations);
    visit(Shared::kLambda, self.lambda);
    visit(OptionInfo{"mu", "Taubin: length of the inflating step", "", 0, 2}, self.mu);
    visit(Shared::kWeights, self.weights);
  }
};

/// Bilaplacian flow.
struct BilaplacianOptions {
  static constexpr FlowInfo kInfo{"bilaplacian", "descends the thin-plate energy; shrinks little",
                                  "Ohtake 2"};
  int iterations = 10;  ///< steps
  double lambda = 0.4;  ///< stable up to 0.5

  std::unique_ptr<Flow> start(const Mesh&, const Constraints&, const Context&) const;
  std::optional<int> rings() const { return 2; }
  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(Shared::kIterations, self.iterations);
    visit(Shared::kLambda, self.lambda);
  }
};

/// Explicit mean curvature flow.
struct CurvatureOptions {
  static constexpr FlowInfo kInfo{
      "curvature", "along the normal by the mean curvature; leaves flat parts and the sampling alone",
      "Desbrun (14), 5.5; Ohtake (7), (8)"};
  int iterations = 10;           ///< steps
  double lambda = 0.25;          ///< on a regular mesh half of what is stable
  bool normalised = false;       ///< divided by the sum of the cotangents; stable up to lambda = 1
  Scheme scheme = Scheme::safe;  ///< bounded steps, or as the paper prints it

  std::unique_ptr<Flow> start(const Mesh&, const Constraints&, const Context&) const;
  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(Shared::kIterations, self.iterations);
    visit(Shared::kLambda, self.lambda);
    visit(OptionInfo{"normalised", "curvature flow: divided by the sum of the cotangents", ""},
          self.normalised);
    visit(Shared::kScheme, self.scheme);
  }
};

/// Implicit fairing.
struct ImplicitOptions {
  static constexpr FlowInfo kInfo{"implicit", "one stable linear solve per step, of first to fourth order",
                                  "Desbrun 2.3-2.7, 4, 5"};
  int iterations = 1;                        ///< steps
  double dt = 10;                            ///< any size is stable
  OperatorKind op = OperatorKind::umbrella;  ///< the Laplacian
  int order = 2;                             ///< power of the operator; 2 is the paper's recommendation (2.6)
  double mixture = 0;            ///< share of the first power beside the order-th; negative enhances
  bool keep_weights = false;     ///< weights of the first mesh for all steps
  Scheme scheme = Scheme::safe;  ///< printed: the curvature operator's area, and L x of fixed vertices is 0
                                 ///< inside L (L x) too, where safe counts how the surface bends there
  double tolerance = 1e-5;       ///< residual to stop at, relative to the right side
  Norm norm = Norm::l2;          ///< of the residual

  std::unique_ptr<Flow> start(const Mesh&, const Constraints&, const Context&) const;
  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(Shared::kIterations, self.iterations);
    visit(Shared::kDt, self.dt);
    visit(words("operator", "implicit flows: the Laplacian",
                {"umbrella", "inverse-distance", "scale-dependent", "curvature", "tufted"}),
          self.op);
    visit(OptionInfo{"order", "implicit flows: power of the operator", "", 1, 4}, self.order);
    visit(OptionInfo{"mixture", "implicit flows: share of the first power; negative enhances", "", -1, 1},
          self.mixture);
    visit(OptionInfo{"keep-weights", "implicit flows: weights of the first mesh for all steps", ""},
          self.keep_weights);
    visit(Shared::kScheme, self.scheme);
    visit(Shared::kTolerance, self.tolerance);
    visit(Shared::kNorm, self.norm);
  }
};

/// Mean curvature flow that evens the sampling.
struct ModifiedCurvatureOptions {
  static constexpr FlowInfo kInfo{"modified-curvature",
                                  "curvature flow that evens the sampling by the umbrella's tangential part",
                                  "Ohtake (11)"};
  int iterations = 10;           ///< steps
  double lambda = 0.25;          ///< step length, dimensionless
  double tangential = 1;         ///< weight of the tangential part
  Scheme scheme = Scheme::safe;  ///< bounded steps, or as the paper prints it

  std::unique_ptr<Flow> start(const Mesh&, const Constraints&, const Context&) const;
  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(Shared::kIterations, self.iterations);
    visit(Shared::kLambda, self.lambda);
    visit(OptionInfo{"tangential", "modified curvature flow: weight of the tangential part", "", 0, 4},
          self.tangential);
    visit(Shared::kScheme, self.scheme);
  }
};

/// Curvature speed in the median direction.
struct MedianDirectionOptions {
  static constexpr FlowInfo kInfo{
      "median-direction", "curvature flow moving towards the neighbours' mean; smooths and evens edges",
      "Ohtake (12), (13)"};
  int iterations = 4;         ///< more round edges more than they smooth
  double lambda = 0.25;       ///< step length, dimensionless
  double least_cosine = 0.1;  ///< the paper's epsilon: where the two directions are nearer to a right angle
                              ///< a vertex stays
  Scheme scheme = Scheme::safe;  ///< bounded steps, or as the paper prints it

  std::unique_ptr<Flow> start(const Mesh&, const Constraints&, const Context&) const;
  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(Shared::kIterations, self.iterations);
    visit(Shared::kLambda, self.lambda);
    visit(OptionInfo{"least-cosine",
                     "median direction: vertices stay where its cosine to the normal is less (epsilon)", "",
                     0, 1},
          self.least_cosine);
    visit(Shared::kScheme, self.scheme);
  }
};

/// Directional diffusion.
struct DirectionalOptions {
  static constexpr FlowInfo kInfo{
      "directional",
      "curvature flow along one direction, for closed meshes: smooths the side that faces it, roughens the "
      "other, keeps the volume; takes little noise from clouds",
      "Zhao-Xu (3), (33)"};
  int iterations = 4;    ///< steps
  double lambda = 0.05;  ///< in units of the squared mean edge length
  int power = 0;         ///< m of the energy, the integral of H^(2m), that falls; only without a direction
  std::optional<Eigen::Vector3d> direction;  ///< not zero; empty = the one in which the energy falls
  Scheme scheme = Scheme::safe;              ///< safe also keeps the volume to first order

  std::unique_ptr<Flow> start(const Mesh&, const Constraints&, const Context&) const;
  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(Shared::kIterations, self.iterations);
    visit(Shared::kLambda, self.lambda);
    visit(Shared::kPower, self.power);
    visit(OptionInfo{"direction", "directional: auto, or x,y,z", ""}, self.direction);
    visit(Shared::kScheme, self.scheme);
  }
};

/// Local directional diffusion.
struct LocalDirectionalOptions {
  static constexpr FlowInfo kInfo{"local-directional",
                                  "diffusion weighted by Gauss curvature on each one-ring, for meshes whose "
                                  "corners and saddles must stay; takes little noise from clouds",
                                  "Zhao-Xu (34)-(36)"};
  int iterations = 8;            ///< steps
  double lambda = 0.005;         ///< the paper's figure 3
  double eps = 0.05;             ///< Gauss curvature that counts as flat, 1 / (mean edge length)^2
  int power = 0;                 ///< m of the energy, the integral of H^(2m) over each one-ring
  Scheme scheme = Scheme::safe;  ///< bounded steps, or as the paper prints it

  std::unique_ptr<Flow> start(const Mesh&, const Constraints&, const Context&) const;
  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(Shared::kIterations, self.iterations);
    visit(Shared::kLambda, self.lambda);
    visit(
        OptionInfo{"eps", "local directional: Gauss curvature that counts as flat", "1/(mean edge)^2", 0, 1},
        self.eps);
    visit(Shared::kPower, self.power);
    visit(Shared::kScheme, self.scheme);
  }
};

/// Approximating discrete fairing.
struct DiscreteFairingOptions {
  static constexpr FlowInfo kInfo{"discrete-fairing",
                                  "thin-plate smoothing spline from divided differences in local charts",
                                  "Kobbelt 4"};
  int iterations = 1;          ///< steps
  double dt = 1;               ///< weight of the energy against the data
  Chart chart = Chart::mixed;  ///< how neighbours get their parameters
  double tolerance = 1e-5;     ///< residual to stop at, relative to the right side
  Norm norm = Norm::l2;        ///< of the residual

  std::unique_ptr<Flow> start(const Mesh&, const Constraints&, const Context&) const;
  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(Shared::kIterations, self.iterations);
    visit(Shared::kDt, self.dt);
    visit(words("chart", "discrete fairing: parameters of the neighbours", Shared::kCharts), self.chart);
    visit(Shared::kTolerance, self.tolerance);
    visit(Shared::kNorm, self.norm);
  }
};

/// The registry: one line per flow, in the order of the table of flows.
using AnyFlow = std::variant<AutomaticOptions,          //
                             LaplacianOptions,          //
                             HcOptions,                 //
                             HcLimitOptions,            //
                             TaubinOptions,             //
                             BilaplacianOptions,        //
                             CurvatureOptions,          //
                             ImplicitOptions,           //
                             ModifiedCurvatureOptions,  //
                             MedianDirectionOptions,    //
                             DirectionalOptions,        //
                             LocalDirectionalOptions,   //
                             DiscreteFairingOptions>;

/// What goes around any flow, after each of its steps.
struct Modifiers {
  bool push_back = false;                         ///< HC's second half
  double push_alpha = 0, push_beta = 0.6;         ///< its weights, HC's own defaults; only with push_back
  ThresholdKind threshold = ThresholdKind::none;  ///< of the speed, below which vertices stay
  double threshold_value = 0.1;  ///< of the constant one, x mean edge length of the first mesh per unit step
  int threshold_every = 5;       ///< steps between recomputing the ring thresholds
  Preserve preserve = Preserve::none;  ///< what is restored after every step
  Boundary boundary = Boundary::free;  ///< what happens at edges with one face

  /// Whether any of them does anything.
  bool any() const {
    return push_back || threshold != ThresholdKind::none || preserve != Preserve::none ||
           boundary != Boundary::free;
  }

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
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

/// How to smooth: a flow with its options, and modifiers around it.
struct FlowOptions {
  AnyFlow flow = AutomaticOptions();  ///< which flow, with its options
  Modifiers modifiers = {};           ///< what goes around it
  bool trace = false;  ///< measure the mesh after every step, for the report; costs about a step's time

  /// Visitors that can take the whole, because they know every flow and not only the one chosen, get it.
  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    if constexpr (std::is_invocable_v<Visit&, Self&>) {
      visit(self);
    } else {
      std::visit([&](auto& flow) { std::decay_t<decltype(flow)>::describe(flow, visit); }, self.flow);
      Modifiers::describe(self.modifiers, visit);
    }
  }
};

/// What lists say of the flow that is chosen.
inline const FlowInfo& info_of(const AnyFlow& flow) {
  return std::visit(
      [](const auto& options) -> const FlowInfo& { return std::decay_t<decltype(options)>::kInfo; }, flow);
}
/// Its name.
inline std::string_view name_of(const AnyFlow& flow) {
  return info_of(flow).name;
}

/// Its number of steps, to be set.
inline int& iterations(AnyFlow& flow) {
  return std::visit([](auto& options) -> int& { return options.iterations; }, flow);
}
/// Its number of steps.
inline int iterations(const AnyFlow& flow) {
  return std::visit([](const auto& options) { return options.iterations; }, flow);
}

}  // namespace rfsmooth
