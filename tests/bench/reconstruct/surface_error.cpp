#include "tests/bench/reconstruct/surface_error.h"

#include "base/parallel.h"
#include "clouds/shapes/sampling.h"
#include "tests/bench/quality/data/closest.h"

namespace rfsmooth::bench {
namespace {

double one_way(const Mesh& from, const Mesh& to, std::size_t samples, const Context& context) {
  const Positions points = clouds::sample(from, samples, 7, clouds::Sampling::uniform);
  const ClosestTree tree(to);
  std::vector<double> squared(points.size());
  in_arena(context, [&] {
    for_each_index(context, points.size(),
                   [&](std::size_t i) { squared[i] = tree.nearest(points[i]).squared; });
  });
  double sum = 0;
  for (const double s : squared) sum += s;
  return sum / double(samples);
}

}  // namespace

SurfaceError surface_error(const Mesh& mesh, const Mesh& truth, std::size_t samples, const Context& context) {
  return {one_way(mesh, truth, samples, context), one_way(truth, mesh, samples, context)};
}

}  // namespace rfsmooth::bench
