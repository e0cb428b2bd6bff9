#include "rfsmooth/rfs_mesh/rfs_mesh.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "rfsmooth/rfs_mesh/collect.h"
#include "rfsmooth/rfs_mesh/emst.h"
#include "rfsmooth/rfs_mesh/flattest_pair.h"
#include "rfsmooth/rfs_mesh/neighbors.h"
#include "rfsmooth/rfs_mesh/parallel.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// Times the stages and reports them.
class Stages {
 public:
  Stages(std::vector<Seconds>& seconds, const Context& context) : seconds_(seconds), context_(context) {}

  template <class Body>
  auto run(const char* stage, double fraction, Body&& body) {
    context_.report(stage, fraction);
    seconds_.push_back({stage, 0});
    const Stopwatch watch{seconds_, seconds_.size() - 1};
    return body();
  }

 private:
  struct Stopwatch {
    std::vector<Seconds>& seconds;
    std::size_t entry;  // made before: a destructor must not allocate
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    ~Stopwatch() {
      const std::chrono::duration<double> d = std::chrono::steady_clock::now() - start;
      seconds[entry].seconds = d.count();
    }
  };
  std::vector<Seconds>& seconds_;
  const Context& context_;
};

Positions shadows(const std::vector<LocalSurface>& surfaces, const Context& context) {
  Positions at(surfaces.size());
  for_each_index(context, at.size(), [&](std::size_t i) { at[i] = surfaces[i].shadow; });
  return at;
}

/// The positions to test on, where they are not the points, with their own neighbours and tree.
struct Ground {
  Positions at;
  NeighborTable near;
  std::vector<Edge> tree;
};

Ground ground_at(Positions at, int k, const Context& context) {
  Ground ground;
  ground.at = std::move(at);
  const SpatialIndex index(ground.at, context);
  ground.near = index.nearest(k, context);
  ground.tree = emst(index, ground.near, context);
  return ground;
}

/// SDG edges of the vertices that no face reaches.
std::vector<Edge> loose_edges(std::size_t n, const std::vector<Face>& faces, const std::vector<Edge>& sdg,
                              std::size_t& faceless, const Context& context) {
  std::vector<char> reached(n, 0);
  for (const Face& f : faces)
    for (const Index v : f) reached[v] = 1;
  faceless = std::size_t(std::count(reached.begin(), reached.end(), 0));
  return collect<Edge>(context, sdg.size(), [&](std::size_t e, auto&& emit) {
    if (!reached[sdg[e][0]] || !reached[sdg[e][1]]) emit(sdg[e]);
  });
}

Connection connect_all(const Positions& points, const ConnectOptions& options, const Context& context,
                       const Positions* guide) {
  Connection c;
  Stages stages(c.seconds, context);
  c.mesh.positions = points;
  const std::size_t n = points.size();
  const SpatialIndex index = stages.run("index", 0, [&] { return SpatialIndex(points, context); });
  NeighborTable near =
      stages.run("neighbours", 0.05, [&] { return index.nearest(options.neighbours, context); });
  const NoiseScale scale = stages.run("noise", 0.15, [&] { return noise_scale(index, context); });
  c.noise.spacing = mean_spacing(points, near, context);
  c.noise.sigma = scale.sigma;
  c.emst = stages.run("emst", 0.2, [&] { return emst(index, near, context); });

  Ground ground;
  double noise = scale.sigma;
  c.on_shadow = guide == nullptr && n > 0 && scale.sigma > options.shadow_from * c.noise.spacing;
  const bool moved = guide != nullptr || c.on_shadow;
  const auto k = std::size_t(options.neighbours);
  const bool wide = c.on_shadow && scale.neighbours > k;
  c.surfaces = stages.run("local surfaces", 0.4, [&] {
    return wide ? wide_local_surfaces(index, scale, k, context) : local_surfaces(points, near, context);
  });
  c.noise.field.resize(n);
  for_each_index(context, n, [&](std::size_t i) { c.noise.field[i] = c.surfaces[i].residual; });
  if (moved) {
    near = NeighborTable();  // neighbours among the noisy points: not needed any more
    stages.run(guide != nullptr ? "guide" : "shadow", 0.5, [&] {
      ground =
          ground_at(guide != nullptr ? *guide : shadows(c.surfaces, context), options.neighbours, context);
      // A wide quadric's normal is better than any from the shadows; a narrow one's is not.
      if (guide != nullptr || !wide) c.surfaces = local_surfaces(ground.at, ground.near, context);
      if (guide == nullptr && !wide) ground.at = shadows(c.surfaces, context);
    });
  }
  // A quadric through m points leaves about a third of the noise in the shadow at the m that noise_scale
  // picks.
  if (moved) noise = guide != nullptr ? 0 : noise / 3;
  const Terrain terrain{moved ? ground.at : points, c.surfaces, moved ? ground.near : near, noise};

  Sdg sdg = stages.run("sdg", 0.6,
                       [&] { return make_sdg(terrain, moved ? ground.tree : c.emst, options.sdg, context); });
  c.sdg = std::move(sdg.edges);
  c.bridges = std::move(sdg.bridges);
  const ProposedFaces proposed = stages.run("umbrellas", 0.75, [&] {
    const Adjacency graph = make_adjacency(n, c.sdg, context);
    return proposed_faces(open_umbrellas(terrain, graph, options.umbrella, context), context);
  });
  stages.run("rfs-mesh", 0.9, [&] {
    c.mesh.faces = keep_flattest_pairs(terrain.at, proposed, context);
    c.mesh.loose_edges = loose_edges(n, c.mesh.faces, c.sdg, c.faceless, context);
    rebuild_adjacency(c.mesh, context);
  });
  return c;
}

}  // namespace

Result<Connection> connect(const Positions& points, const ConnectOptions& options, const Context& context,
                           const Positions* guide) {
  if (guide != nullptr && guide->size() != points.size())
    throw std::invalid_argument("connect: guide must hold one position per point");
  return guarded([&] {
    value_or_throw(validate(options));
    Connection connection;
    in_arena(context, [&] { connection = connect_all(points, options, context, guide); });
    return connection;
  });
}

}  // namespace rfsmooth::rfs_mesh
