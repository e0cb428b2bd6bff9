#include "tests/bench/sensitivity/angles.h"

#include <algorithm>
#include <cmath>

#include "rfs_mesh/measure.h"
#include "tests/bench/sensitivity/rows.h"

namespace rfsmooth::bench {

Angles angles_of_normals(const Positions& points, const NormalsOptions& options, const Positions& truth) {
  Context context;
  context.threads = 1;
  Positions found(points.size());
  const Stopwatch watch;
  estimate_normals(points.data()->data(), points.size(), options, context, found.data()->data()).value();
  Angles angles;
  angles.seconds = watch.seconds();
  for (std::size_t i = 0; i < points.size(); ++i)
    angles.mean +=
        180 / M_PI * std::acos(std::clamp(truth[i].dot(found[i]), -1.0, 1.0)) / double(points.size());
  return angles;
}

Positions true_normals(const Truth& truth, const Positions& points) {
  const Mesh& mesh = truth.sample().mesh;
  Positions normals;
  for (const Eigen::Vector3d& p : points) {
    const auto& face = mesh.faces[truth.surface().nearest(p).primitive];
    normals.emplace_back(rfs_mesh::face_cross(mesh.positions, face).normalized());
  }
  return normals;
}

}  // namespace rfsmooth::bench
