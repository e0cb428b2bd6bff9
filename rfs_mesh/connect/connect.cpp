#include "rfs_mesh/connect/connect.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <stdexcept>

#include "base/collect.h"
#include "base/parallel.h"
#include "base/quantile.h"
#include "base/stopwatch.h"
#include "rfs_mesh/connect/emst/emst.h"
#include "rfs_mesh/connect/flattest_pair.h"
#include "rfs_mesh/connect/part_sheets.h"
#include "rfs_mesh/connect/sdg.h"
#include "rfs_mesh/connect/umbrella.h"
#include "rfs_mesh/fit/local_surface.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/search/neighbors.h"
#include "rfs_mesh/small_holes.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// Times the stages and reports them.
class Stages {
 public:
  Stages(std::vector<StageTime>& seconds, const Context& context) : seconds_(seconds), context_(context) {}

  template <class Body>
  auto run(const char* stage, double fraction, Body&& body) {
    context_.report(stage, fraction);
    const Stopwatch watch(seconds_, stage);
    return body();
  }

 private:
  std::vector<StageTime>& seconds_;
  const Context& context_;
};

/// What the tests are made on: positions, the surface through each, their own neighbours and tree.
struct Ground {
  Positions at;
  std::vector<LocalSurface> surfaces;
  NeighborTable near;
  std::vector<Edge> tree;     // in any order
  std::vector<char> between;  // two sheets: n flags, or none
};

/// A quadric through m points leaves about a third of the noise in the shadow at the m that noise_scale
/// picks.
constexpr double kNoiseLeft = 1.0 / 3;

/// The noise of a cloud, and what the surface of each point is fitted by.
struct Measured {
  NoiseLevel level;
  std::vector<double> field;  ///< n: the noise there, world units: the measured one, less where narrow
                              ///< neighbourhoods show less than the figure, at least 0.05 spacings
  std::vector<Index> wider;   ///< as wider_where_dense() says
};

/// The ground at the shadows of the points. Quadrics no wider than the neighbourhoods looked at are fitted a
/// second time, on the shadows; wider ones have the better normals already. \param tree of the points
Ground shadow_ground(const Positions& points, KdTree tree, std::vector<LocalSurface> surfaces,
                     const NoiseScale& scale, const Measured& measured, const ConnectOptions& options,
                     const Context& context) {
  const int k = options.neighbours;
  Ground ground;
  ground.surfaces = std::move(surfaces);
  ground.at = shadows(ground.surfaces, context);
  const SpatialIndex index(ground.at, std::move(tree), context);
  ground.near = index.nearest(k, context);
  ground.tree = emst_unsorted(index, ground.near, context);
  if (scale.neighbours <= std::size_t(k)) {
    std::vector<double> left = measured.field;
    for (double& sigma : left) sigma *= kNoiseLeft;
    ground.surfaces =
        shared_local_surfaces(index, ground.near, scale, left, measured.wider, scale.neighbours, context);
  }
  ground.between =
      part_sheets(points, index, ground.near, measured.level.sigma, options.sheets, ground.surfaces, context);
  ground.at = shadows(ground.surfaces, context);
  return ground;
}

/// SDG edges of the vertices that no face reaches: those without a ring.
std::vector<Edge> loose_edges(const Adjacency& ring, const std::vector<Edge>& sdg, const Context& context) {
  return collect<Edge>(context, sdg.size(), [&](std::size_t e, auto&& emit) {
    if (ring.degree(sdg[e][0]) == 0 || ring.degree(sdg[e][1]) == 0) emit(sdg[e]);
  });
}

/// The cloud and who is near whom in it.
struct Cloud {
  SpatialIndex index;
  NeighborTable near;
};

Cloud search(const Positions& points, const ConnectOptions& options, const Context& context, Stages& stages) {
  SpatialIndex index = stages.run("index", 0, [&] { return SpatialIndex(points, context); });
  NeighborTable near =
      stages.run("neighbours", 0.05, [&] { return index.nearest(options.neighbours, context); });
  return {std::move(index), std::move(near)};
}

/// The noise at the sites, none less than can be told from detail. Not empty.
std::vector<double> at_sites(const NoiseModel& noise) {
  std::vector<double> sigma = noise.at_sites;
  if (sigma.empty()) sigma.push_back(noise.sigma);
  for (double& s : sigma) s = std::max(s, kNoNoise * noise.spacing);
  return sigma;
}

/// Of the louder parts of the cloud, too: the root of the mean square.
double loudness(const NoiseModel& noise) {
  double sum = 0;
  const std::vector<double> sigma = at_sites(noise);
  for (const double s : sigma) sum += s * s;
  return std::sqrt(sum / double(sigma.size()));
}

/// The scale of the quadrics: that of what the calm quarter of places shows, times how much louder the cloud
/// is than that. It is less than what was measured where that took a second sheet for noise. But noise that
/// neighbours share does not show in narrow neighbourhoods, nor any noise in lines of points, and where
/// depth comes in steps a narrow quadric follows one of the layers that the noise makes: there the measure
/// decides.
NoiseScale scale_for(const SpatialIndex& index, const NoiseModel& noise, const Context& context) {
  if (!(noise.sigma > 0)) return {};
  std::vector<double> sigma = at_sites(noise);
  const double loud = loudness(noise), calm = quantile(sigma, 0.25);
  const bool understated = is_shared(noise) || noise.step > 0 || noise.on_lines;
  NoiseScale scale = noise_scale(index, context, loud, std::max(1.0, loud / calm), understated);
  scale.sigma = std::min(scale.sigma, loud);
  return scale;
}

/// n: the points that a quadric needs around each, where some are denser than on the mean; else none. Sigma
/// over the spacing is larger there, and the slab that a ball must hold has as many times the points as its
/// square. \param loud of the cloud; \param scale of the quadrics for that
std::vector<Index> wider_where_dense(const NoiseField& noise, double loud, const NoiseScale& scale) {
  std::vector<Index> wider(noise.local_spacing.size());
  for (std::size_t i = 0; i < wider.size(); ++i) {
    const double times = noise.local[i] / loud * noise.spacing / noise.local_spacing[i],
                 m = std::max(1.0, times * times) * double(scale.neighbours);
    wider[i] = Index(std::min(m, double(std::max(kWidestFit, scale.neighbours))));
  }
  return wider;
}

/// What `whole` says of the noise; what it does not say is measured and entered.
Measured measure(const SpatialIndex& index, const NeighborTable& near, const Context& context,
                 Statistics& whole) {
  measure_cloud(index, near, whole, context);
  NoiseField field = spread_noise(*whole.noise, index.points(), context);
  const double loud = loudness(field), least = kNoNoise * field.spacing;
  const double share = loud > 0 ? whole.scale->sigma / loud : 0;
  std::vector<Index> wider = wider_where_dense(field, loud, *whole.scale);
  for (double& sigma : field.local) sigma = std::max(share * sigma, least);
  return {{*whole.spacing, field.sigma}, std::move(field.local), std::move(wider)};
}

/// The first stages, up to the surfaces: what is measured on the points themselves. Fills emst, noise and
/// on_shadow of `c`; returns what the tests are made on.
Ground survey(Cloud cloud, const ConnectOptions& options, const Wanted& wanted, const Context& context,
              Statistics& whole, Connection& c, Stages& stages) {
  SpatialIndex& index = cloud.index;
  const NeighborTable& near = cloud.near;
  const Positions& points = index.points();
  const std::size_t n = points.size();
  const Measured measured = stages.run("noise", 0.15, [&] { return measure(index, near, context, whole); });
  c.noise = measured.level;
  const NoiseScale scale = *whole.scale;
  c.on_shadow = n > 0 && scale.sigma > options.shadow_from * c.noise.spacing;
  std::vector<Edge> tree;
  stages.run("emst", 0.2, [&] {
    if (wanted.emst) c.emst = emst(index, near, context);
    if (!c.on_shadow) tree = wanted.emst ? c.emst : emst_unsorted(index, near, context);
  });
  auto surfaces = stages.run("local surfaces", 0.4, [&] {
    const auto least = std::min(std::size_t(options.neighbours), scale.neighbours);
    return c.on_shadow
               ? shared_local_surfaces(index, near, scale, measured.field, measured.wider, least, context)
               : local_surfaces(points, near, context);
  });
  if (!c.on_shadow) return {points, std::move(surfaces), std::move(cloud.near), std::move(tree), {}};
  cloud.near = NeighborTable();  // neighbours among the noisy points: not needed any more
  return stages.run("shadow", 0.5, [&] {
    return shadow_ground(points, index.release_tree(), std::move(surfaces), scale, measured, options,
                         context);
  });
}

void keep_tree(Ground& ground, Connection& c, const Context& context) {
  c.tree = std::move(ground.tree);
  parallel_sort(context, c.tree, std::less<Edge>());
}

/// `known`: the caller's search, or none. `whole`: what is there is taken, the rest entered.
Connection connect_all(const Positions& points, std::optional<Cloud> known, const ConnectOptions& options,
                       const Wanted& wanted, const Context& context, Statistics& whole) {
  Connection c;
  Stages stages(c.seconds, context);
  const std::size_t n = points.size();
  if (!known) known.emplace(search(points, options, context, stages));
  if (wanted.up_to == ConnectUpTo::emst) {
    c.noise.spacing = mean_spacing(points, known->near, context);
    c.emst = stages.run("emst", 0.2, [&] { return emst(known->index, known->near, context); });
    return c;
  }
  Ground ground = survey(std::move(*known), options, wanted, context, whole, c, stages);
  known.reset();
  const double noise = c.on_shadow ? kNoiseLeft * c.noise.sigma : c.noise.sigma;
  if (wanted.up_to == ConnectUpTo::tree) {
    keep_tree(ground, c, context);
    return c;
  }
  const Terrain terrain{ground.at, ground.surfaces, ground.near, noise, ground.between};

  Sdg sdg = stages.run("sdg", 0.6, [&] { return make_sdg(terrain, ground.tree, options.sdg, context); });
  c.sdg = std::move(sdg.edges);
  c.bridges = std::move(sdg.bridges);
  if (wanted.tree || wanted.up_to == ConnectUpTo::sdg) keep_tree(ground, c, context);
  if (wanted.up_to == ConnectUpTo::sdg) {
    c.surfaces = std::move(ground.surfaces);
    return c;
  }
  std::vector<Edge>().swap(ground.tree);
  const ProposedFaces proposed = stages.run("umbrellas", 0.75, [&] {
    const std::vector<Umbrella> umbrellas = open_umbrellas(terrain, sdg.graph, options.umbrella, context);
    ground.near = NeighborTable();
    sdg = {};
    if (wanted.surfaces)
      c.surfaces = std::move(ground.surfaces);
    else
      std::vector<LocalSurface>().swap(ground.surfaces);
    return proposed_faces(umbrellas, context);
  });
  stages.run("rfs-mesh", 0.9, [&] {
    FlattestPairs kept = keep_flattest_pairs(ground.at, proposed, options.umbrella.same_fold, context);
    c.mesh.faces = std::move(kept.faces);
    c.mesh.one_ring = std::move(kept.one_ring);  // filling holes adds no edge
    if (wanted.fill_holes) fill_small_holes(ground.at, options.umbrella.quality, c.mesh.faces, context);
    Positions().swap(ground.at);
    c.mesh.positions = points;
    for (std::size_t i = 0; i < n; ++i) c.faceless += std::size_t(c.mesh.one_ring.degree(i) == 0);
    if (wanted.loose_edges && c.faceless > 0) {
      c.mesh.loose_edges = loose_edges(c.mesh.one_ring, c.sdg, context);
      rebuild_adjacency(c.mesh, context);
    }
  });
  return c;
}

/// connect_all() behind a front door. `statistics`: as `whole`, or null.
Result<Connection> connect_or_fail(const Positions& points, std::optional<Cloud> known,
                                   const ConnectOptions& options, const Wanted& wanted,
                                   const Context& context, Statistics* statistics) {
  return guarded([&] {
    value_or_throw(validate(options));
    Connection connection;
    Statistics own;
    in_arena(context, [&] {
      connection = connect_all(points, std::move(known), options, wanted, context,
                               statistics != nullptr ? *statistics : own);
    });
    return connection;
  });
}

}  // namespace

void measure_cloud(const SpatialIndex& index, const NeighborTable& near, Statistics& whole,
                   const Context& context) {
  const NoiseModel& noise = known_noise(index, whole, context);
  if (!whole.spacing) whole.spacing = mean_spacing(index.points(), near, context);
  if (!whole.scale) whole.scale = scale_for(index, noise, context);
}

Result<Connection> connect(const Positions& points, const ConnectOptions& options, const Wanted& wanted,
                           const Context& context) {
  return connect_or_fail(points, {}, options, wanted, context, nullptr);
}

Result<Connection> connect(SpatialIndex index, NeighborTable near, const ConnectOptions& options,
                           const Wanted& wanted, const Context& context, Statistics* statistics) {
  const Positions& points = index.points();
  const std::size_t width =
      std::min(std::size_t(options.neighbours), std::max<std::size_t>(points.size(), 1) - 1);
  if (near.items.size() != points.size() * width)
    throw std::invalid_argument("connect: near is not the table that the options ask for");
  return connect_or_fail(points, Cloud{std::move(index), std::move(near)}, options, wanted, context,
                         statistics);
}

}  // namespace rfsmooth::rfs_mesh

namespace rfsmooth {

Result<Connection> connect(const Positions& points, const ConnectOptions& options, const Context& context,
                           ConnectUpTo up_to) {
  rfs_mesh::Wanted wanted;
  wanted.up_to = up_to;
  return rfs_mesh::connect(points, options, wanted, context);
}

}  // namespace rfsmooth
