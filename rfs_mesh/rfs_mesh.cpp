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
    const Stopwatch watch{seconds_, stage};
    return body();
  }

 private:
  struct Stopwatch {
    std::vector<Seconds>& seconds;
    const char* stage;
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    ~Stopwatch() {
      const std::chrono::duration<double> d = std::chrono::steady_clock::now() - start;
      seconds.push_back({stage, d.count()});
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

double median_residual(const std::vector<LocalSurface>& surfaces) {
  if (surfaces.empty()) return 0;
  std::vector<double> r(surfaces.size());
  std::transform(surfaces.begin(), surfaces.end(), r.begin(),
                 [](const LocalSurface& s) { return s.residual; });
  std::nth_element(r.begin(), r.begin() + std::ptrdiff_t(r.size() / 2), r.end());
  return r[r.size() / 2];
}

/// How many neighbours a quadric needs to see a slab of noise from the side: those within 2.5 sigma, at the
/// median of a few places.
std::size_t wide_neighbourhood(const SpatialIndex& index, double sigma, int least) {
  constexpr double kBandwidth = 2.5;  // sigmas; ALGORITHMS: narrower balls lie inside the slab
  constexpr std::size_t kPlaces = 200, kMost = 400;
  const std::size_t n = index.points().size(), places = std::min(n, kPlaces);
  std::vector<std::size_t> counts(places);
  std::vector<Neighbor> found;
  for (std::size_t s = 0; s < places; ++s) {
    index.within(index.points()[s * n / places], kBandwidth * sigma, found);
    counts[s] = found.size();
  }
  std::nth_element(counts.begin(), counts.begin() + std::ptrdiff_t(places / 2), counts.end());
  return std::clamp(counts[places / 2], std::size_t(least), kMost);
}

/// The positions to test on, with their index, neighbours and surfaces.
struct Ground {
  Positions at;
  NeighborTable near;
  std::vector<LocalSurface> surfaces;
  std::vector<Edge> tree;
  double noise = 0;
};

/// Tests on other positions than the points: their own neighbours, surfaces and tree.
Ground ground_at(Positions at, int k, const Context& context) {
  Ground ground;
  ground.at = std::move(at);
  const SpatialIndex index(ground.at, context);
  ground.near = index.nearest(k, context);
  ground.surfaces = local_surfaces(ground.at, ground.near, context);
  ground.tree = emst(index, ground.near, context);
  ground.noise = median_residual(ground.surfaces);
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
  c.surfaces = stages.run("local surfaces", 0.2, [&] { return local_surfaces(points, near, context); });
  stages.run("noise", 0.35, [&] {
    c.noise.spacing = mean_spacing(points, near, context);
    c.noise.sigma = noise_sigma(points, index, context);
  });
  c.emst = stages.run("emst", 0.4, [&] { return emst(index, near, context); });

  Ground ground;
  c.on_shadow = guide == nullptr && n > 0 && c.noise.sigma > options.shadow_from * c.noise.spacing;
  if (guide != nullptr) {
    ground = stages.run("guide", 0.5, [&] { return ground_at(*guide, options.neighbours, context); });
  } else if (c.on_shadow) {
    stages.run("shadow", 0.5, [&] {
      const std::size_t wide = wide_neighbourhood(index, c.noise.sigma, options.neighbours);
      if (wide > std::size_t(options.neighbours))
        c.surfaces = wide_local_surfaces(points, index, wide, context);
      ground = ground_at(shadows(c.surfaces, context), options.neighbours, context);
    });
  }
  c.noise.field.resize(n);
  for_each_index(context, n, [&](std::size_t i) { c.noise.field[i] = c.surfaces[i].residual; });
  const bool moved = guide != nullptr || c.on_shadow;
  if (moved) c.surfaces = std::move(ground.surfaces);
  const Terrain terrain{moved ? ground.at : points, c.surfaces, moved ? ground.near : near,
                        moved ? ground.noise : c.noise.sigma};

  Sdg sdg = stages.run("sdg", 0.6,
                       [&] { return make_sdg(terrain, moved ? ground.tree : c.emst, options.sdg, context); });
  c.sdg = std::move(sdg.edges);
  c.bridges = std::move(sdg.bridges);
  const auto umbrellas = stages.run("umbrellas", 0.75, [&] {
    return open_umbrellas(terrain, make_adjacency(n, c.sdg, context), options.umbrella, context);
  });
  stages.run("rfs-mesh", 0.9, [&] {
    c.mesh.faces = keep_flattest_pairs(terrain.at, proposed_faces(umbrellas, context), context);
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
  if (const auto valid = validate(options); !valid.ok()) return valid.error();
  return guarded([&] {
    Connection connection;
    in_arena(context, [&] { connection = connect_all(points, options, context, guide); });
    return connection;
  });
}

}  // namespace rfsmooth::rfs_mesh
