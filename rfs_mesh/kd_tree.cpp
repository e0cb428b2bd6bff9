#include "rfsmooth/rfs_mesh/kd_tree.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "rfsmooth/rfs_mesh/parallel.h"

namespace rfsmooth::rfs_mesh {

namespace {

struct Item {
  double at[3];
  Index id;
};

constexpr std::uint32_t kSerialLeaves =
    512;  // subtrees below this size are built by one thread, in its cache

constexpr double kLargest = 1e150;  // squares stay finite

class Builder {
 public:
  Builder(std::vector<Item>& items, std::vector<KdTree::Node>& nodes, std::vector<KdTree::Leaf>& leaves)
      : items_(items), nodes_(nodes), leaves_(leaves) {}

  /// The whole tree: the upper nodes level by level, then the subtrees below them, each by one thread.
  void build(KdTree::Cursor root, const Context& context) {
    std::vector<KdTree::Cursor> level = {root}, upper, small;
    while (!level.empty()) {
      std::vector<KdTree::Cursor> next;
      for (const KdTree::Cursor& c : level) (c.last - c.first <= kSerialLeaves ? small : next).push_back(c);
      for_each_index(
          context, next.size(), [&](std::size_t i) { split(next[i]); }, 1);
      level.clear();
      for (const KdTree::Cursor& c : next) {
        upper.push_back(c);
        level.push_back(c.left());
        level.push_back(c.right());
      }
    }
    for_each_index(
        context, small.size(), [&](std::size_t i) { build_serial(small[i]); }, 1);
    for (std::size_t i = upper.size(); i-- > 0;) nodes_[upper[i].node].least_id = least_of_children(upper[i]);
  }

 private:
  std::size_t begin_of(std::uint32_t leaf) const { return std::size_t(leaf) * KdTree::kLeaf; }
  std::size_t end_of(std::uint32_t leaf) const { return std::min(items_.size(), begin_of(leaf)); }
  Index least_of_children(const KdTree::Cursor& c) const {
    return std::min(nodes_[c.left().node].least_id, nodes_[c.right().node].least_id);
  }

  void set_box(const KdTree::Cursor& c) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Eigen::Vector3d low = Eigen::Vector3d::Constant(kInfinity), high = -low;
    for (std::size_t i = begin_of(c.first); i < end_of(c.last); ++i)
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], items_[i].at[axis]);
        high[axis] = std::max(high[axis], items_[i].at[axis]);
      }
    nodes_[c.node].low = low;
    nodes_[c.node].high = high;
  }

  /// Puts the lower half of the node's points before its middle; ties by id, so that the halves are unique.
  void split(const KdTree::Cursor& c) {
    set_box(c);
    int axis = 0;
    (nodes_[c.node].high - nodes_[c.node].low).maxCoeff(&axis);
    const auto at = [&](std::size_t i) { return items_.begin() + std::ptrdiff_t(i); };
    std::nth_element(at(begin_of(c.first)), at(begin_of(c.middle())), at(end_of(c.last)),
                     [axis](const Item& a, const Item& b) {
                       return a.at[axis] != b.at[axis] ? a.at[axis] < b.at[axis] : a.id < b.id;
                     });
  }

  void build_serial(const KdTree::Cursor& c) {
    if (c.is_leaf()) return fill(c);
    split(c);
    build_serial(c.left());
    build_serial(c.right());
    nodes_[c.node].least_id = least_of_children(c);
  }

  void fill(const KdTree::Cursor& c) {
    set_box(c);
    KdTree::Leaf& leaf = leaves_[c.first];
    const std::size_t begin = begin_of(c.first), count = end_of(c.last) - begin;
    std::sort(items_.begin() + std::ptrdiff_t(begin), items_.begin() + std::ptrdiff_t(begin + count),
              [](const Item& a, const Item& b) { return a.id < b.id; });
    nodes_[c.node].least_id = items_[begin].id;
    constexpr double kFar = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < KdTree::kLeaf; ++i) {
      const bool there = i < count;
      leaf.x[i] = there ? items_[begin + i].at[0] : kFar;
      leaf.y[i] = there ? items_[begin + i].at[1] : kFar;
      leaf.z[i] = there ? items_[begin + i].at[2] : kFar;
      leaf.id[i] = there ? items_[begin + i].id : kNone;
    }
  }

  std::vector<Item>& items_;
  std::vector<KdTree::Node>& nodes_;
  std::vector<KdTree::Leaf>& leaves_;
};

}  // namespace

KdTree::KdTree(const Positions& points, const Context& context) {
  if (points.empty()) return;
  std::vector<Item> items(points.size());
  for_each_index(context, points.size(), [&](std::size_t i) {
    const Eigen::Vector3d& p = points[i];
    if (!(p.array().abs() < kLargest).all())
      throw std::invalid_argument("KdTree: a coordinate is not finite");
    items[i] = {{p[0], p[1], p[2]}, Index(i)};
  });
  leaves_.resize((points.size() + kLeaf - 1) / kLeaf);
  nodes_.resize(2 * leaves_.size() - 1);
  Builder(items, nodes_, leaves_).build(root(), context);
}

/// The box around those of the children.
void KdTree::enclose_children(const Cursor& c) {
  const Node &left = nodes_[c.left().node], &right = nodes_[c.right().node];
  nodes_[c.node].low = left.low.cwiseMin(right.low);
  nodes_[c.node].high = left.high.cwiseMax(right.high);
}

/// The nodes of a subtree, from its leaves up.
void KdTree::enclose(const Positions& points, const Cursor& c) {
  if (!c.is_leaf()) {
    enclose(points, c.left());
    enclose(points, c.right());
    return enclose_children(c);
  }
  Leaf& leaf = leaves_[c.first];
  Node& box = nodes_[c.node];
  box.low = box.high = points[leaf.id[0]];
  for (std::size_t i = 0; i < kLeaf && leaf.id[i] != kNone; ++i) {
    const Eigen::Vector3d& p = points[leaf.id[i]];
    if (!(p.array().abs() < kLargest).all())
      throw std::invalid_argument("KdTree: a coordinate is not finite");
    leaf.x[i] = p[0];
    leaf.y[i] = p[1];
    leaf.z[i] = p[2];
    box.low = box.low.cwiseMin(p);
    box.high = box.high.cwiseMax(p);
  }
}

void KdTree::follow(const Positions& points, const Context& context) {
  if (empty()) return;
  const std::vector<Cursor> small = subtrees(kSerialLeaves);
  for_each_index(
      context, small.size(), [&](std::size_t i) { enclose(points, small[i]); }, 1);
  // The nodes above them: in preorder a node comes before what is below it.
  std::vector<Cursor> above, stack = {root()};
  while (!stack.empty()) {
    const Cursor c = stack.back();
    stack.pop_back();
    if (c.last - c.first <= kSerialLeaves) continue;
    above.push_back(c);
    stack.push_back(c.left());
    stack.push_back(c.right());
  }
  for (std::size_t i = above.size(); i-- > 0;) enclose_children(above[i]);
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
