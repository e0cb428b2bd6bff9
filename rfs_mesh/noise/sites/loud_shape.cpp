#include "rfs_mesh/noise/sites/loud_shape.h"

#include <algorithm>

#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise_levels.h"
#include "rfs_mesh/noise/sites/views/site_view.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// Whether what a site shows is noise for sure.
bool is_sure(const NoiseSites& sites, std::size_t s) {
  return sites.speaks[s] != 0 && sites.turned[s] == 0 && sites.tells_noise(s);
}

/// The noise that is typical of the sites which show it for sure; 0: they are too few.
double sure_noise(const NoiseSites& sites) {
  const std::vector<double> area = areas(sites.fits);
  std::vector<Weighed> sure;
  double saying = 0, surely = 0;
  for (std::size_t s = 0; s < area.size(); ++s) {
    if (sites.speaks[s] != 0) saying += area[s];
    if (!is_sure(sites, s)) continue;
    sure.push_back({sites.sigma[s], area[s]});
    surely += area[s];
  }
  return surely > kLeastPart * saying ? quantile(sure, 0.5) : 0;
}

}  // namespace

void silence_loud_shape(NoiseSites& sites, const Context& context) {
  const double sure = sure_noise(sites);
  if (!(sure > 0)) return;
  std::vector<char> loud(sites.at.size());
  for (std::size_t s = 0; s < loud.size(); ++s)
    loud[s] = char(sites.speaks[s] != 0 && sites.sigma[s] > kMuchLouder * sure);
  if (std::find(loud.begin(), loud.end(), 1) == loud.end()) return;
  std::vector<std::size_t> silent;
  const SiteGroups groups = site_groups({sites.at, context}, kSmallestGroup, context);
  for (std::size_t s = 0; s < loud.size(); ++s) {
    if (loud[s] == 0) continue;
    double around = 0, surely = 0, turned = 0;
    for (const Neighbor& q : groups[s]) {
      if (loud[q.index] == 0) continue;
      ++around;
      surely += double(is_sure(sites, q.index));
      turned += double(sites.turned[q.index] != 0);
    }
    if (surely >= kLittle * around || turned < kLeastPart * around) continue;
    sites.volume[s] = sites.sigma[s];
    sites.sigma[s] = sure;
    silent.push_back(s);
  }
  for (const std::size_t s : silent) sites.speaks[s] = 0;
}

}  // namespace rfsmooth::rfs_mesh
