/// \file Building a LightTree top-down by the surface area orientation heuristic.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/math.h"
#include "core/parallel.h"
#include "render/light/light_tree.h"

namespace oktett {

static constexpr int kBuckets = 12;

/// Deeper than this, ranges are halved by number, so that the trails fit into 64 bits.
static constexpr std::uint32_t kDepthOfSplits = 32;

/// Ranges longer than this are built in parallel.
static constexpr std::uint32_t kLongRange = 4096;

namespace {

struct Item {
  LightBounds bounds;
  /// The mean of the normals if they are uniform in their cone, times the power.
  Vec3f axis_sum;
  std::uint32_t index;
};

/// What the cost of a set of emitters is computed from.
struct Bucket {
  Box box;
  Vec3f axis_sum;
  float power = 0;

  void grow(const Bucket& b) { box.grow(b.box), axis_sum += b.axis_sum, power += b.power; }
  bool empty() const { return box.empty(); }
  float cost() const;
};

struct Split {
  int axis = -1;   ///< -1: none
  int bucket = 0;  ///< the last one on the left
};

}  // namespace

/// acos(x) for x in [0, 1] within 1e-4 (Abramowitz and Stegun 4.4.45).
static float rough_acos(float x) {
  return std::sqrt(1 - x) * (1.5707288f + x * (-0.2121144f + x * (0.0742610f + x * -0.0187293f)));
}

/// The measure of directions that emitters reach whose normals fill a cone (Conty and Kulla, equation 1), for
/// emitters that give light up to pi / 2 from their normals.
static float orientation_measure(float cosine) {
  constexpr float kPi = std::numbers::pi_v<float>;
  const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
  if (cosine >= 0) return kPi * (2 - cosine) + kPi * kPi / 2 * sine;
  return 2 * kPi * (1 - cosine) + kPi * rough_acos(-cosine) * sine;
}

float Bucket::cost() const {
  // The mean of unit vectors that are uniform in a cone has the length (1 + cosine of its half angle) / 2.
  const float cosine = std::clamp(2 * length(axis_sum) / power - 1, -1.0f, 1.0f);
  const Vec3f e = box.extent();
  // The square of the diagonal stands for the surface area, which is 0 for emitters in a row.
  return power * orientation_measure(cosine) * dot(e, e);
}

static Item make_item(const LightBounds& bounds, std::uint32_t index) {
  const double cosine = bounds.spread == 0 ? 1 : portable::cos(bounds.spread);
  Vec3f axis = bounds.axis * (bounds.power * static_cast<float>((1 + cosine) / 2));
  // Both directions mean the same, so that is chosen which points up.
  if (bounds.both_sides && axis.y < 0) axis = -axis;
  return {bounds, axis, index};
}

static int bucket_of(float center, float lo, float scale) {
  return std::clamp(static_cast<int>((center - lo) * scale), 0, kBuckets - 1);
}

static Box box_of_centers(std::span<const Item> items) {
  Box box;
  for (const Item& item : items) box.grow(item.bounds.box.center());
  return box;
}

/// Buckets per length, along an axis on which the centres differ.
static float bucket_scale(const Box& centers, int axis) {
  return kBuckets / (centers.hi[axis] - centers.lo[axis]);
}

static Split best_split(std::span<const Item> items, const Box& centers) {
  Split best;
  float best_cost = std::numeric_limits<float>::infinity();
  const float widest = max_component(centers.extent());
  for (int axis = 0; axis < 3; ++axis) {
    const float extent = centers.extent()[axis], scale = bucket_scale(centers, axis);
    if (!(extent > 0) || !std::isfinite(scale)) continue;
    Bucket buckets[kBuckets], right[kBuckets];
    for (const Item& item : items) {
      const int i = bucket_of(item.bounds.box.center()[axis], centers.lo[axis], scale);
      buckets[i].grow({item.bounds.box, item.axis_sum, item.bounds.power});
    }
    right[kBuckets - 1] = buckets[kBuckets - 1];
    for (int i = kBuckets - 1; i-- > 1;) right[i] = right[i + 1], right[i].grow(buckets[i]);
    Bucket left;
    for (int i = 0; i + 1 < kBuckets; ++i) {
      if (buckets[i].empty()) continue;
      left.grow(buckets[i]);
      if (right[i + 1].empty()) break;
      // Thin slices cost more.
      const float cost = (left.cost() + right[i + 1].cost()) * (widest / extent);
      if (best.axis < 0 || cost < best_cost) best = {axis, i}, best_cost = cost;
    }
  }
  return best;
}

/// Moves the items left of the split to the front; returns their number, at least 1 and not all.
static std::uint32_t divide(std::span<Item> items, std::uint32_t depth) {
  const auto half = static_cast<std::uint32_t>(items.size() / 2);
  if (depth >= kDepthOfSplits || items.size() == 2) return half;
  const Box centers = box_of_centers(items);
  const Split split = best_split(items, centers);
  if (split.axis < 0) return half;
  const float lo = centers.lo[split.axis], scale = bucket_scale(centers, split.axis);
  std::size_t count = 0;
  for (Item& item : items) {
    if (bucket_of(item.bounds.box.center()[split.axis], lo, scale) > split.bucket) continue;
    if (&item != &items[count]) std::swap(item, items[count]);
    ++count;
  }
  return static_cast<std::uint32_t>(count);
}

class LightTree::Builder {
 public:
  explicit Builder(LightTree& tree) : tree_(tree) {}

  /// Builds the subtree of `items` whose root is `node`, with one node less than twice as many nodes as
  /// items.
  LightBounds build(std::span<Item> items, std::uint32_t node, std::uint32_t depth, std::uint64_t trail) {
    if (items.size() == 1) {
      tree_.nodes_[node] = make_node(items[0].bounds);
      tree_.nodes_[node].leaf = 1;
      tree_.nodes_[node].next = items[0].index;
      tree_.trails_[items[0].index] = trail;
      return items[0].bounds;
    }
    const std::uint32_t count = divide(items, depth), right_node = node + 2 * count;
    LightBounds left, right;
    const auto build_left = [&] { left = build(items.first(count), node + 1, depth + 1, trail); };
    const auto build_right = [&] {
      right = build(items.subspan(count), right_node, depth + 1, trail | std::uint64_t{1} << depth);
    };
    if (items.size() > kLongRange)
      run_both(build_left, build_right);
    else
      build_left(), build_right();
    const LightBounds sum = join(left, right);
    tree_.nodes_[node] = make_node(sum);
    tree_.nodes_[node].next = right_node;
    return sum;
  }

 private:
  LightTree& tree_;
};

LightTree::LightTree(std::span<const LightBounds> emitters) {
  if (emitters.empty()) return;
  std::vector<Item> items(emitters.size());
  for (std::uint32_t i = 0; i < items.size(); ++i) items[i] = make_item(emitters[i], i);
  nodes_.resize(2 * items.size() - 1);
  trails_.resize(items.size());
  Builder(*this).build(items, 0, 0, 0);
}

}  // namespace oktett
