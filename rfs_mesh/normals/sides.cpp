#include "rfs_mesh/normals/sides.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "base/parallel.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// As in sides.h.
double clarity(const SideLink& link) {
  return double(link.agreement) * link.agreement / link.count;
}

constexpr double kSurest = 0.8;  // clarity: with these the growth begins
constexpr int kRoundsInBlocks =
    2;  // more, and regions at the block's rim grow astray: they miss half of their links
constexpr std::size_t kBlock = 4096;  // points that one thread links by itself: a bound of its work

/// Regions that grow. What links points at first links the regions that they have become.
class Growth {
 public:
  Growth(std::size_t n, std::vector<SideLink> links, const std::vector<double>& votes, const Context& context)
      : context_(context), sides_(n), links_(std::move(links)), votes_(votes), best_(n, kNone) {
    bundle();
  }

  /// As long as there are links of at least that clarity. Afterwards links() are those between the regions.
  void grow(double least) {
    while (join(least)) bundle();
  }

  /// The same in so many rounds by the surest links.
  void grow_a_little(int rounds) {
    for (int round = 0; round < rounds; ++round) {
      join(kSurest);
      bundle();
    }
  }

  /// With the lowest points of regions for ends.
  const std::vector<SideLink>& links() const { return links_; }

  Regions regions() {
    Regions regions;
    const std::size_t n = best_.size();
    regions.of_point.resize(n);
    regions.turned.resize(n);
    for (Index i = 0; i < n; ++i) {
      const Sides::Root root = sides_.find(i);
      regions.of_point[i] = root.index;
      regions.turned[i] = root.turned ? 1 : 0;
    }
    return regions;
  }

 private:
  /// Renames the ends to their regions, drops what is inside one, adds up what joins the same two.
  void bundle() {
    std::size_t kept = 0;
    for (SideLink link : links_) {
      const Sides::Root a = sides_.find(link.a), b = sides_.find(link.b);
      if (a.index == b.index) continue;
      link.a = std::min(a.index, b.index);
      link.b = std::max(a.index, b.index);
      if (a.turned != b.turned) link.agreement = -link.agreement;
      links_[kept++] = link;
    }
    links_.resize(kept);
    sort();
    kept = 0;
    for (std::size_t k = 0; k < links_.size();) {
      SideLink sum = links_[k++];
      for (; k < links_.size() && links_[k].a == sum.a && links_[k].b == sum.b; ++k) {
        sum.agreement += links_[k].agreement;
        sum.count += links_[k].count;
      }
      links_[kept++] = sum;
    }
    links_.resize(kept);
  }

  /// By all their fields. The rows of one region are short: counting brings them together, faster than four
  /// threads sort.
  void sort() {
    std::vector<std::size_t> end(best_.size() + 1, 0);
    for (const SideLink& link : links_) ++end[link.a + 1];
    for (std::size_t a = 1; a < end.size(); ++a) end[a] += end[a - 1];
    std::vector<SideLink> sorted(links_.size());
    for (const SideLink& link : links_) sorted[end[link.a]++] = link;
    for_each_index(
        context_, best_.size(),
        [&](std::size_t a) {
          const auto at = [&](std::size_t k) { return sorted.begin() + std::ptrdiff_t(k); };
          std::sort(at(a == 0 ? 0 : end[a - 1]), at(end[a]), [](const SideLink& x, const SideLink& y) {
            return std::tie(x.b, x.agreement, x.count) < std::tie(y.b, y.agreement, y.count);
          });
        },
        kBlock);
    links_.swap(sorted);
  }

  /// Whether the votes of two regions count more against joining them than their links do for it.
  bool refused(Index a, Index b, float agreement) const {
    if (votes_.empty()) return false;
    const double one = votes_[a], other = agreement < 0 ? -votes_[b] : votes_[b];
    return one * other < 0 && std::min(std::abs(one), std::abs(other)) > std::abs(double(agreement));
  }

  /// Every region takes its clearest link of at least that clarity. Whether any did.
  bool join(double least) {
    std::fill(best_.begin(), best_.end(), kNone);
    for (Index k = 0; k < links_.size(); ++k) {
      const SideLink& link = links_[k];
      const double c = clarity(link);
      if (c < least || refused(link.a, link.b, link.agreement)) continue;
      for (const Index r : {link.a, link.b})
        if (best_[r] == kNone || c > clarity(links_[best_[r]])) best_[r] = k;
    }
    bool any = false;
    for (const Index k : best_) {
      if (k == kNone) continue;
      const Sides::Root a = sides_.find(links_[k].a), b = sides_.find(links_[k].b);
      if (a.index == b.index) continue;
      const float agreement = a.turned != b.turned ? -links_[k].agreement : links_[k].agreement;
      if (refused(a.index, b.index, agreement)) continue;  // it has grown since
      sides_.join(a.index, b.index, agreement < 0);
      if (!votes_.empty())
        votes_[std::min(a.index, b.index)] += (agreement < 0 ? -1 : 1) * votes_[std::max(a.index, b.index)];
      any = true;
    }
    return any;
  }

  const Context& context_;
  Sides sides_;
  std::vector<SideLink> links_;
  std::vector<double> votes_;  ///< of regions, at their lowest point
  std::vector<Index> best_;
};

}  // namespace

bool points_down(const Eigen::Vector3d& v) {
  for (const int axis : {2, 1, 0})
    if (v[axis] != 0) return v[axis] < 0;
  return false;
}

bool on_wrong_side(double vote, double volume, double extent, const Eigen::Vector3d& normals) {
  constexpr double kFlatPart = 0.01;  // volume / (area x extent) below which a part has no outside
  if (vote != 0) return vote < 0;
  if (std::abs(volume) > kFlatPart * extent) return volume < 0;
  return points_down(normals);
}

Regions grow_regions(std::size_t n, std::vector<SideLink> links, const std::vector<double>& votes,
                     const Context& context) {
  Growth growth(n, std::move(links), votes, context);
  for (const double least : {kSurest, 0.6, 0.4, 0.2, 0.1, 0.0}) growth.grow(least);
  return growth.regions();
}

namespace {

/// Grows the regions that blocks have found together. They are the points of this second growth, numbered in
/// the order of their lowest points. \param left by block, what links its regions; emptied
void join_blocks(Regions& all, std::vector<std::vector<SideLink>>& left, const Context& context) {
  const std::size_t n = all.of_point.size();
  std::vector<Index> number(n, kNone), lowest;
  for (std::size_t i = 0; i < n; ++i)
    if (all.of_point[i] == i) {
      number[i] = Index(lowest.size());
      lowest.push_back(Index(i));
    }
  std::vector<SideLink> between;
  for (std::vector<SideLink>& of_block : left) {
    for (const SideLink& link : of_block) {
      const Index a = all.of_point[link.a], b = all.of_point[link.b];
      const bool turned = all.turned[link.a] != all.turned[link.b];
      if (a != b)
        between.push_back({number[a], number[b], turned ? -link.agreement : link.agreement, link.count});
    }
    std::vector<SideLink>().swap(of_block);
  }
  const Regions joined = grow_regions(lowest.size(), std::move(between), {}, context);
  for_each_index(context, n, [&](std::size_t i) {
    const Index r = number[all.of_point[i]];
    all.turned[i] = char(all.turned[i] ^ joined.turned[r]);
    all.of_point[i] = lowest[joined.of_point[r]];
  });
}

}  // namespace

Regions grow_regions_in_blocks(std::size_t n, const LinksOf& links, const Context& context) {
  Regions all;
  all.of_point.resize(n);
  all.turned.resize(n);
  std::vector<std::vector<SideLink>> left((n + kBlock - 1) / kBlock);  // of each block
  for_blocks(context, n, kBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<SideLink> inner, &outer = left[begin / kBlock];
    links(begin, end, inner);
    const auto inside = [&](Index i) { return i >= begin && i < end; };
    const auto leaving = std::stable_partition(
        inner.begin(), inner.end(), [&](const SideLink& link) { return inside(link.a) && inside(link.b); });
    outer.assign(leaving, inner.end());
    inner.erase(leaving, inner.end());
    const auto first = Index(begin);
    for (SideLink& link : inner) link = {link.a - first, link.b - first, link.agreement, link.count};
    Growth growth(end - begin, std::move(inner), {}, context);
    growth.grow_a_little(kRoundsInBlocks);
    const Regions own = growth.regions();
    for (std::size_t i = begin; i < end; ++i) {
      all.of_point[i] = first + own.of_point[i - begin];
      all.turned[i] = own.turned[i - begin];
    }
    for (const SideLink& link : growth.links())
      outer.push_back({first + link.a, first + link.b, link.agreement, link.count});
  });
  join_blocks(all, left, context);
  return all;
}

}  // namespace rfsmooth::rfs_mesh
