#include "rfs_mesh/search/kd_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "base/halving.h"
#include "base/parallel.h"

namespace rfsmooth::rfs_mesh {

namespace {

struct Item {
  double at[3];
  Index id;
};

/// The longest axis of the box around `count` points, and where the box lies on it.
struct Span {
  int axis = 0;
  double low = 0, extent = 0;

  template <class At>
  Span(std::size_t count, At&& at) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    double lows[3] = {kInfinity, kInfinity, kInfinity}, highs[3] = {-kInfinity, -kInfinity, -kInfinity};
    for (std::size_t i = 0; i < count; ++i) {
      const double* const p = at(i);
      for (int k = 0; k < 3; ++k) {
        lows[k] = std::min(lows[k], p[k]);
        highs[k] = std::max(highs[k], p[k]);
      }
    }
    for (int k = 0; k < 3; ++k)
      if (k == 0 || highs[k] - lows[k] > extent) {
        axis = k;
        low = lows[k];
        extent = highs[k] - lows[k];
      }
  }
};

void check_size(const Eigen::Vector3d& p) {
  constexpr double kLargest = 1e150;  // squares stay finite
  if (!(p.array().abs() < kLargest).all()) throw std::invalid_argument("KdTree: a coordinate is not finite");
}

/// The box and the least id of a node, from those of its children.
void join_children(const KdTree::Cursor& c, std::vector<KdTree::Node>& nodes) {
  const KdTree::Node &left = nodes[c.left().node], &right = nodes[c.right().node];
  nodes[c.node] = {left.low.cwiseMin(right.low), left.high.cwiseMax(right.high),
                   std::min(left.least_id, right.least_id)};
}

class Builder {
 public:
  Builder(const Positions& points, std::vector<KdTree::Node>& nodes, std::vector<KdTree::Leaf>& leaves)
      : points_(points), order_(points.size()), spare_(points.size()), nodes_(nodes), leaves_(leaves) {
    std::iota(order_.begin(), order_.end(), Index{0});
  }

  /// The whole tree: the upper nodes level by level, then the subtrees below them, each by one thread.
  void build(KdTree::Cursor root, const Context& context) {
    std::vector<KdTree::Cursor> level = {root}, upper, small;
    while (!level.empty()) {
      std::vector<KdTree::Cursor> next;
      for (const KdTree::Cursor& c : level)
        (c.last - c.first <= KdTree::kSerialLeaves ? small : next).push_back(c);
      for_each_index(
          context, next.size(), [&](std::size_t i) { split(next[i]); }, 1);
      level.clear();
      for (const KdTree::Cursor& c : next) {
        upper.push_back(c);
        level.push_back(c.left());
        level.push_back(c.right());
      }
    }
    for_blocks(context, small.size(), 1, [&](std::size_t begin, std::size_t) {
      const KdTree::Cursor& c = small[begin];
      Halving halving;
      std::vector<Item> items(end_of(c.last) - begin_of(c.first)), spare(items.size());
      for (std::size_t i = 0; i < items.size(); ++i) {
        const Index id = order_[begin_of(c.first) + i];
        items[i] = {{points_[id][0], points_[id][1], points_[id][2]}, id};
      }
      build_serial(c, items.data(), spare.data(), halving);
    });
    for (std::size_t i = upper.size(); i-- > 0;) join_children(upper[i], nodes_);
  }

 private:
  std::size_t begin_of(std::uint32_t leaf) const { return std::size_t(leaf) * KdTree::kLeaf; }
  std::size_t end_of(std::uint32_t leaf) const { return std::min(points_.size(), begin_of(leaf)); }
  std::size_t count_of(const KdTree::Cursor& c) const { return end_of(c.last) - begin_of(c.first); }

  /// Puts the lower half of an upper node's points before its middle.
  void split(const KdTree::Cursor& c) {
    Index *const ids = order_.data() + begin_of(c.first), *const to = spare_.data() + begin_of(c.first);
    const std::size_t count = count_of(c);
    const Span span(count, [&](std::size_t i) { return points_[ids[i]].data(); });
    Halving()(ids, count, begin_of(c.middle()) - begin_of(c.first), span.low, span.extent, to,
              [&](Index id) { return points_[id][span.axis]; });
    std::copy(to, to + count, ids);
  }

  void build_serial(const KdTree::Cursor& c, Item* items, Item* spare, Halving& halving) {
    if (c.is_leaf()) return fill(c, items);
    const std::size_t count = count_of(c), half = begin_of(c.middle()) - begin_of(c.first);
    const Span span(count, [&](std::size_t i) { return items[i].at; });
    halving(items, count, half, span.low, span.extent, spare,
            [axis = span.axis](const Item& item) { return item.at[axis]; });
    build_serial(c.left(), spare, items, halving);
    build_serial(c.right(), spare + half, items + half, halving);
    join_children(c, nodes_);
  }

  /// The points ascend by id.
  void fill(const KdTree::Cursor& c, const Item* items) {
    KdTree::Leaf& leaf = leaves_[c.first];
    KdTree::Node& node = nodes_[c.node];
    const std::size_t count = count_of(c);
    const auto point = [&](std::size_t i) { return Eigen::Map<const Eigen::Vector3d>(items[i].at); };
    node.low = node.high = point(0);
    node.least_id = items[0].id;
    for (std::size_t i = 0; i < count; ++i) {
      leaf.put(i, point(i), items[i].id);
      node.extend(point(i));
    }
    leaf.end_at(count);
  }

  const Positions& points_;
  std::vector<Index> order_, spare_;
  std::vector<KdTree::Node>& nodes_;
  std::vector<KdTree::Leaf>& leaves_;
};

}  // namespace

KdTree::KdTree(const Positions& points, const Context& context) {
  if (points.empty()) return;
  for_each_index(context, points.size(), [&](std::size_t i) { check_size(points[i]); });
  leaves_.resize((points.size() + kLeaf - 1) / kLeaf);
  nodes_.resize(2 * leaves_.size() - 1);
  Builder(points, nodes_, leaves_).build(root(), context);
}

KdTree::KdTree(const std::vector<Index>& order) : leaves_((order.size() + kLeaf - 1) / kLeaf) {
  if (order.empty()) return;
  nodes_.resize(2 * leaves_.size() - 1);
  for (Leaf& leaf : leaves_) leaf.end_at(0);
  for (std::size_t i = 0; i < order.size(); ++i) leaves_[i / kLeaf].id[i % kLeaf] = order[i];
}

std::vector<Index> KdTree::order() const {
  std::vector<Index> order;
  order.reserve(kLeaf * leaves_.size());
  for (const Leaf& leaf : leaves_)
    for (const Index id : leaf.id)
      if (id != kNone) order.push_back(id);
  return order;
}

/// The box of every node; `enclose_leaf(leaf, node)` changes a leaf and makes its own.
template <class Enclose>
void KdTree::enclose_all(const Context& context, const Enclose& enclose_leaf) {
  for_each_node_upward(context, [&](const Cursor& c) {
    if (c.is_leaf())
      enclose_leaf(leaves_[c.first], nodes_[c.node]);
    else
      join_children(c, nodes_);
  });
}

void KdTree::follow(const Positions& points, const Context& context) {
  enclose_all(context, [&](Leaf& leaf, Node& box) {
    box.low = box.high = points[leaf.id[0]];
    box.least_id = leaf.id[0];
    for (std::size_t i = 0; i < kLeaf && leaf.id[i] != kNone; ++i) {
      const Eigen::Vector3d& p = points[leaf.id[i]];
      check_size(p);
      leaf.put(i, p, leaf.id[i]);
      box.extend(p);
    }
  });
}

void KdTree::leave_out(const std::vector<char>& gone, const Context& context) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  enclose_all(context, [&](Leaf& leaf, Node& box) {
    box.low.setConstant(kInfinity);  // of a leaf without points: infinitely far from everything
    box.high.setConstant(-kInfinity);
    std::size_t to = 0;
    for (std::size_t i = 0; i < kLeaf && leaf.id[i] != kNone; ++i) {
      if (gone[leaf.id[i]] != 0) continue;
      box.extend(leaf.point(i));
      leaf.put(to++, leaf.point(i), leaf.id[i]);
    }
    leaf.end_at(to);
  });
}

std::vector<KdTree::Cursor> KdTree::subtrees(std::uint32_t leaves) const {
  std::vector<Cursor> found;
  if (empty()) return found;
  std::vector<Cursor> stack = {root()};
  while (!stack.empty()) {
    const Cursor c = stack.back();
    stack.pop_back();
    if (c.last - c.first <= leaves) {
      found.push_back(c);
    } else {
      stack.push_back(c.right());
      stack.push_back(c.left());
    }
  }
  return found;
}

}  // namespace rfsmooth::rfs_mesh
