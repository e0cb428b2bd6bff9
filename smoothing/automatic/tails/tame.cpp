#include "smoothing/automatic/tails/tame.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "base/parallel.h"
#include "rfs_mesh/levels.h"
#include "smoothing/automatic/guide/stranded.h"

namespace rfsmooth::smoothing {

namespace {

constexpr double kCalm = 0.1;    // of the figure: so much calmer places have no part in the tails
constexpr float kMostOfOne = 2;  // sigma: what one neighbour's distance counts as in a mean over them

/// How far each point lies off a patch that is wide enough not to follow it, beyond what its neighbours do,
/// too: they all lie off it beside an edge.
std::vector<float> off_neighbours(const HeightField& field, const MixedScales& pass,
                                  const rfs_mesh::NoiseField& noise, const Context& context) {
  std::vector<float> off(field.size()), at_most(field.size());
  for_each_index(context, off.size(), [&](std::size_t i) {
    off[i] = field.local()[i].height - pass.wide[i];
    const float most = kMostOfOne * float(noise.local[i]);
    at_most[i] = std::clamp(off[i], -most, most);
  });
  at_most = field.local_mean(at_most, context);
  for_each_index(context, off.size(), [&](std::size_t i) { off[i] -= at_most[i]; });
  return off;
}

/// How many times more of the neighbours of points that lie far off do so, too, than of all points. 1 for
/// tails, which are each point's own; beside shape, and where the noise is louder than was measured, far
/// points stand together.
double far_together(const HeightField& field, const std::vector<float>& off, const Context& context) {
  const auto known = [&](std::size_t i) { return !std::isnan(off[i]); };
  const auto far = [&](std::size_t i) {  // not if unknown
    return double(std::abs(off[i])) > rfs_mesh::kScatterWindow;
  };
  // Of those that are known: points, far ones, their neighbours, and far ones of these.
  const Eigen::Vector4d sums =
      sum_over(context, field.size(), Eigen::Vector4d(0, 0, 0, 0), [&](std::size_t i) {
        Eigen::Vector4d one(known(i) ? 1 : 0, 0, 0, 0);
        if (!far(i)) return one;
        one[1] = 1;
        for (const Index j : field.neighbors()[i])
          if (known(j)) one += Eigen::Vector4d(0, 0, 1, far(j) ? 1 : 0);
        return one;
      });
  return sums[2] > 0 ? sums[3] * sums[0] / (sums[1] * sums[2]) : 0;
}

/// Where the neighbours are farther off than the noise explains, too, divides by how many times: that is
/// noise which was measured too small there, or shape, and no tail. Where more of them are far than tails
/// have, nothing is known.
void relate_to_neighbours(const HeightField& field, std::vector<float>& relative, std::vector<float>& least,
                          const Context& context) {
  constexpr float kMeanOfNormal = 0.766F;  // the mean of min(|x|, kMostOfOne), x normal
  // The same where as many of the neighbours are far as tails may have.
  constexpr float kMostTypical = kMeanOfNormal + float(kMostInTails) * (kMostOfOne - kMeanOfNormal);
  std::vector<float> typical(field.size());
  for_each_index(context, typical.size(), [&](std::size_t i) {
    typical[i] = std::isnan(relative[i]) ? kMeanOfNormal : std::min(kMostOfOne, std::abs(relative[i]));
  });
  typical = field.local_mean(typical, context);
  for_each_index(context, typical.size(), [&](std::size_t i) {
    if (typical[i] > kMostTypical) {
      relative[i] = least[i] = std::numeric_limits<float>::quiet_NaN();
      return;
    }
    const float times = std::max(1.0F, typical[i] / kMeanOfNormal);
    relative[i] /= times;
    least[i] /= times;
  });
}

/// Points of the tails that are each other's neighbours on the guide stay together beside the surface in the
/// first smoothing. Here they are put onto the surface that the points around them show.
void land_hovering(const HeightField& field, const MixedScales& pass, const Mesh& mesh, const Tails& tails,
                   const rfs_mesh::NoiseField& noise, Positions& data, const Context& context) {
  Positions smooth(field.size());
  for_each_index(context, smooth.size(), [&](std::size_t i) {
    smooth[i] = field.guide()[i] + double(pass.height[i]) * field.normal(i);
  });
  Positions landed = smooth;
  land_stranded_only(mesh.positions, mesh.one_ring, noise.strays_beyond(tails.times, context), landed,
                     context);
  for_each_index(context, smooth.size(), [&](std::size_t i) {
    if (landed[i] == smooth[i] || noise.local[i] < kCalm * noise.sigma) return;
    const Eigen::Vector3d off = mesh.positions[i] - landed[i];
    data[i] = landed[i] + tails.weight(off.norm() / noise.local[i]) * off;
  });
}

}  // namespace

Tails tame(const HeightField& field, const MixedScales& pass, const Mesh& mesh,
           const rfs_mesh::NoiseField& noise, std::optional<Statistics::Tails>& whole, Positions& data,
           const Context& context) {
  // Terraces stand out as tails do, and so does what lines of points pass over.
  if (is_of_steps(noise) || noise.on_lines) return {};
  if (whole && !(whole->share > 0)) return Tails(*whole);
  constexpr float kMostItsOwn = 0.8F;
  constexpr double kByChance = 1.6;  // far points together: tails have 0.7 to 1.1 in ten thousand points
  constexpr double kGroups = 5;      // the same, off wide patches, too: of shape, or noise that points share
  const std::vector<float> off = off_neighbours(field, pass, noise, context);
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> relative(off.size(), kUnknown), least(off.size(), kUnknown);
  for_each_index(context, off.size(), [&](std::size_t i) {
    if (noise.local[i] < kCalm * noise.sigma) return;
    const auto sigma = float(noise.local[i]);
    const float e = field.local()[i].height - pass.height[i],
                without = e / (1 - std::clamp(pass.own[i], 0.0F, kMostItsOwn));
    relative[i] = off[i] / sigma;
    // Where the mixture had to be narrow, a wide patch says little.
    least[i] = std::min(std::abs(relative[i]), std::abs(without) / sigma);
  });
  const double together = whole ? whole->together : far_together(field, least, context);
  const bool groups = !whole && std::max(together, far_together(field, relative, context)) > kGroups;
  if (!groups && together > kByChance) relate_to_neighbours(field, relative, least, context);
  if (!whole) {
    whole = groups ? Statistics::Tails() : find_tails(relative, least);
    whole->together = together;
  }
  const Tails tails(*whole);
  if (!(tails.share > 0)) return tails;
  data = mesh.positions;
  for_each_index(context, off.size(), [&](std::size_t i) {
    if (!std::isnan(relative[i]))
      data[i] -= (1 - tails.weight(double(relative[i]))) * double(off[i]) * field.normal(i);
  });
  land_hovering(field, pass, mesh, tails, noise, data, context);
  return tails;
}

rfs_mesh::NoiseField tamed(rfs_mesh::NoiseField noise, const Tails& tails) {
  if (is_shared(noise)) return noise;  // what points share is not of their tails
  noise.sigma *= tails.noise();
  for (double& local : noise.local) local *= tails.noise();
  return noise;
}

}  // namespace rfsmooth::smoothing
