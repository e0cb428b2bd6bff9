#include "tests/bench/quality/data/settings.h"

#include <stdexcept>

namespace rfsmooth::bench {

const std::vector<PeerSetting>& peer_settings() {
  static const std::vector<PeerSetting> settings = [] {
    std::vector<PeerSetting> list;
    for (const int k : {12, 24, 48, 96, 200}) {
      const std::string once = "CGAL jet k " + std::to_string(k);
      const int tier = k == 12 || k == 200 ? 1 : 0;
      const auto run = [k](const Positions& p, int threads) { return peers::cgal_jet(p, k, 1, threads); };
      list.push_back({"CGAL jet", once, tier, "", run});
      list.push_back({"CGAL jet", once + " x2", tier, once, run});
    }
    for (const int k : {24, 48}) {
      list.push_back(
          {"CGAL bilateral", "CGAL bilateral k " + std::to_string(k) + " x3", 1, "",
           [k](const Positions& p, int threads) { return peers::cgal_bilateral(p, k, 3, threads); }});
    }
    list.push_back({"CGAL WLOP", "CGAL WLOP radius 4 spacings", 2, "",
                    [](const Positions& p, int threads) { return peers::cgal_wlop(p, 4, threads); }});
    for (const int k : {24, 48, 96, 200}) {
      list.push_back({"PCL MLS", "PCL MLS k " + std::to_string(k), 0, "",
                      [k](const Positions& p, int threads) { return peers::pcl_mls(p, k, threads); }});
    }
    for (const int deviations : {1, 2})
      for (const int k : {24, 48, 96, 200}) {
        list.push_back({"PCL outliers + MLS",
                        "PCL outliers " + std::to_string(deviations) + " + MLS k " + std::to_string(k), 1, "",
                        [deviations, k](const Positions& p, int threads) {
                          return peers::pcl_outliers_mls(p, deviations, k, threads);
                        }});
      }
    return list;
  }();
  return settings;
}

const PeerSetting& peer_setting(const std::string& name) {
  for (const PeerSetting& setting : peer_settings())
    if (setting.name == name) return setting;
  throw std::invalid_argument("no peer is called \"" + name + "\"");
}

}  // namespace rfsmooth::bench
