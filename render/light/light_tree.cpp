#include "render/light/light_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/error.h"
#include "core/four.h"
#include "core/math.h"
#include "core/parallel.h"
#include "render/light/light_tree_lanes.h"

namespace oktett {

// ---- Bounds of emitters.

/// Added to each joined cone, for the rounding of its axis.
static constexpr double kSlack = 1e-6;

double lit_part(double spread) {
  const double cosine = portable::cos(spread), mean = (1 + cosine) / 2;
  const double width = cosine > 0 ? portable::sin(spread) : 1;
  return mean >= width ? mean : (mean + width) * (mean + width) / (4 * width);
}

LightBounds join(const LightBounds& a, const LightBounds& b) {
  LightBounds sum = a;
  sum.box.grow(b.box);
  sum.reach = std::max(a.reach, b.reach);
  sum.both_sides = a.both_sides || b.both_sides;
  sum.power = a.power + b.power;
  const Vec3d p = normalize(Vec3d(a.axis));
  Vec3d q = normalize(Vec3d(b.axis));
  if (a.both_sides && b.both_sides && dot(p, q) < 0) q = -q;
  if (p == q) {
    sum.spread = std::max(a.spread, b.spread);
    return sum;
  }
  const Vec3d side = q - p * dot(p, q);
  const double sine = length(side), between = portable::atan2(sine, dot(p, q));
  if (between + b.spread <= a.spread) return sum;
  if (between + a.spread <= b.spread) {
    sum.axis = Vec3f(q), sum.spread = b.spread;
    return sum;
  }
  const double spread = (a.spread + between + b.spread) / 2;
  // Opposite axes leave open where to turn.
  if (spread + kSlack >= std::numbers::pi || (sine < kSlack && dot(p, q) < 0)) {
    sum.spread = static_cast<float>(std::numbers::pi);
    return sum;
  }
  const double turn = spread - a.spread;
  sum.axis = Vec3f(normalize(p * portable::cos(turn) + side * (portable::sin(turn) / std::max(sine, 1e-30))));
  sum.spread = static_cast<float>(spread + kSlack);
  return sum;
}

/// The point in four lanes.
static LightPointLanes<Four> point_lanes(const LightPoint& point) {
  const auto all = [](bool x) { return x ? Four(0.0f) < Four(1.0f) : Four(0.0f) < Four(0.0f); };
  const Vec3f &p = point.position, &n = point.normal;
  return {{p.x, p.y, p.z}, {n.x, n.y, n.z}, all(point.front_only), all(n != Vec3f{})};
}

static Four importances(const LightQuad& quad, const LightPointLanes<Four>& point) {
  const LightQuadLanes<Four> lanes([&](const auto& column) { return Four::load(column(quad)); });
  return light_importances(lanes, point);
}

std::optional<LightTree::Choice> LightTree::choose(const LightPoint& point, SquareSample& s) const {
  if (quads_.empty()) return std::nullopt;
  if (slots_.size() == 1) return Choice{0, 1};
  const LightPointLanes<Four> lanes = point_lanes(point);
  LightWalks<1> walk;
  walk.begin(0, s.x, s.y);
  do {
    const LightQuad& quad = quads_[LightQuad::number(walk.child[0])];
    walk.look_at(0, quad, LightWeights<Four>(quad, importances(quad, lanes)));
    choose_children<1, ScalarIsa>(walk, 0);
    walk.child[0] = quad.child[static_cast<int>(walk.chosen[0])];
  } while (!(walk.child[0] & LightQuad::kLeaf));
  s = {walk.u[0][0], walk.u[1][0]};
  return Choice{LightQuad::number(walk.child[0]), walk.probability[0]};
}

double LightTree::probability(const LightPoint& point, std::uint32_t index) const {
  if (slots_.size() == 1) return 1;
  // From the root, so that the product is the same bits as that of choose().
  std::uint32_t way[kDeepest], steps = 0;
  for (std::uint32_t slot = slots_[index]; slot != kRoot; slot = parents_[slot / 4]) way[steps++] = slot;
  const LightPointLanes<Four> lanes = point_lanes(point);
  double probability = 1;
  while (steps-- > 0) {
    const LightQuad& quad = quads_[way[steps] / 4];
    const LightWeights<Four> weights(quad, importances(quad, lanes));
    probability *= weights.lane[way[steps] % 4] / weights.sum();
  }
  return probability;
}

double LightTree::importance(const LightPoint& point) const {
  if (quads_.empty()) return 0;
  float lane[LightQuad::kLanes];
  importances(quads_[0], point_lanes(point)).store(lane);
  return (double{lane[0]} + double{lane[1]}) + (double{lane[2]} + double{lane[3]});
}

static constexpr int kBuckets = 12;

/// Deeper than this, ranges are halved by number, which limits the depth of the tree.
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

/// The first `count` items of a range are on the left along `axis`; kNoAxis if that is not so.
struct Division {
  std::uint32_t count;
  int axis;
};
constexpr int kNoAxis = 3;

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

/// Moves the items left of the split to the front: at least one and not all.
static Division divide(std::span<Item> items, std::uint32_t depth) {
  const auto half = static_cast<std::uint32_t>(items.size() / 2);
  if (depth >= kDepthOfSplits) return {half, kNoAxis};
  const Box centers = box_of_centers(items);
  if (items.size() == 2) {
    const Vec3f e = centers.extent();
    const int axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
    if (items[0].bounds.box.center()[axis] > items[1].bounds.box.center()[axis])
      std::swap(items[0], items[1]);
    return {1, axis};
  }
  const Split split = best_split(items, centers);
  if (split.axis < 0) return {half, kNoAxis};
  const float lo = centers.lo[split.axis], scale = bucket_scale(centers, split.axis);
  std::uint32_t count = 0;
  for (Item& item : items) {
    if (bucket_of(item.bounds.box.center()[split.axis], lo, scale) > split.bucket) continue;
    if (&item != &items[count]) std::swap(item, items[count]);
    ++count;
  }
  return {count, split.axis};
}

/// A node of the binary tree, which stands depth first in memory: the left child of a node follows it.
struct BinaryLightNode {
  LightBounds bounds;
  std::uint32_t next;  ///< leaf: index of the emitter; else: the right child
  bool leaf;
  int axis = kNoAxis;  ///< along which the left child lies before the right one
};

/// Builds the subtree of `items` at the front of `nodes`; `first` is the number of that place. The subtree
/// has one node less than twice as many as there are items.
static void build_binary(std::span<Item> items, BinaryLightNode* nodes, std::uint32_t first,
                         std::uint32_t depth) {
  if (items.size() == 1) {
    *nodes = {items[0].bounds, items[0].index, true};
    return;
  }
  const Division division = divide(items, depth);
  const std::uint32_t n = division.count, right = 2 * n;
  const auto build_left = [&] { build_binary(items.first(n), nodes + 1, first + 1, depth + 1); };
  const auto build_right = [&] { build_binary(items.subspan(n), nodes + right, first + right, depth + 1); };
  if (items.size() > kLongRange)
    run_both(build_left, build_right);
  else
    build_left(), build_right();
  *nodes = {join(nodes[1].bounds, nodes[right].bounds), first + right, false, division.axis};
}

/// How much is gained by looking at the children of a node instead of the node.
static float coarseness(const LightBounds& b) {
  const Vec3f e = b.box.extent();
  return b.power * dot(e, e);
}

/// Makes quads of the binary tree.
class LightTree::Builder {
 public:
  /// `wide` is the extent of the centres of all emitters: its two widest axes have a random number each.
  Builder(LightTree& tree, const std::vector<BinaryLightNode>& nodes, const Vec3f& wide)
      : tree_(tree), nodes_(nodes) {
    const int least = wide.y <= wide.x && wide.y <= wide.z ? 1 : wide.z <= wide.x ? 2 : 0;
    axis_dimension_[(least + 1) % 3] = 0, axis_dimension_[(least + 2) % 3] = 1;
  }

  /// Adds the quad whose children are the descendants of `node`, and all quads below. `last` is the random
  /// number that was used last on the way to it.
  void add_quad(std::uint32_t node, std::uint32_t parent, std::uint32_t last) {
    const Row row = open(node, last);
    const auto number = static_cast<std::uint32_t>(tree_.quads_.size());
    tree_.quads_.emplace_back();
    tree_.parents_.push_back(parent);
    for (std::uint32_t lane = 0; lane < row.count; ++lane) {
      const BinaryLightNode& child = nodes_[row.node[lane]];
      write(child, tree_.quads_[number], lane);
      if (child.leaf)
        tree_.slots_[child.next] = 4 * number + lane;
      else
        add_quad(row.node[lane], 4 * number + lane, row.last[lane]);
    }
    for (std::uint32_t k = 0; k + 1 < row.count; ++k)
      tree_.quads_[number].child[k] |= row.boundary[k] << 28 | row.dimension[k] << 30;
  }

 private:
  static constexpr std::uint32_t kLanes = LightQuad::kLanes;

  /// Children of a quad, and the decisions that lead to them.
  struct Row {
    std::uint32_t node[kLanes], last[kLanes], count = 1;
    std::uint32_t boundary[kLanes - 1], dimension[kLanes - 1];
  };

  Row open(std::uint32_t node, std::uint32_t last) const {
    Row row;
    row.node[0] = node, row.last[0] = last;
    while (row.count < kLanes) {
      // The coarsest child makes room for its own children.
      std::uint32_t opened = kLanes;
      for (std::uint32_t i = 0; i < row.count; ++i) {
        if (nodes_[row.node[i]].leaf) continue;
        if (opened == kLanes ||
            coarseness(nodes_[row.node[i]].bounds) > coarseness(nodes_[row.node[opened]].bounds))
          opened = i;
      }
      if (opened == kLanes) break;
      for (std::uint32_t k = 0; k + 1 < row.count; ++k)
        if (row.boundary[k] > opened) ++row.boundary[k];
      for (std::uint32_t i = row.count; i > opened + 1; --i)
        row.node[i] = row.node[i - 1], row.last[i] = row.last[i - 1];
      const BinaryLightNode& wide = nodes_[row.node[opened]];
      const std::uint32_t dimension = dimension_of(wide.axis, row.last[opened]);
      row.boundary[row.count - 1] = opened + 1, row.dimension[row.count - 1] = dimension;
      row.node[opened + 1] = wide.next, ++row.node[opened];
      row.last[opened] = row.last[opened + 1] = dimension;
      ++row.count;
    }
    return row;
  }

  std::uint32_t dimension_of(int axis, std::uint32_t last) const {
    return axis != kNoAxis && axis_dimension_[axis] != kEither ? axis_dimension_[axis] : 1 - last;
  }

  /// Writes a child, apart from its own quad, which is the next one.
  void write(const BinaryLightNode& child, LightQuad& quad, std::uint32_t lane) const {
    const LightBounds& bounds = child.bounds;
    const Vec3f center = bounds.box.center(), axis = normalize(bounds.axis);
    const Vec3d half = max(Vec3d(bounds.box.hi) - Vec3d(center), Vec3d(center) - Vec3d(bounds.box.lo));
    for (int i = 0; i < 3; ++i) quad.center[i][lane] = center[i], quad.axis[i][lane] = axis[i];
    quad.radius[lane] = round_up(length(half) * (1 + 1e-12));
    const float cos_spread = quad.cos_spread[lane] = static_cast<float>(portable::cos(bounds.spread));
    quad.sin_spread[lane] = cos_spread > 0 ? std::sqrt(std::max(1 - cos_spread * cos_spread, 0.0f)) : 1;
    const double limit = std::min(double{bounds.spread} + bounds.reach, std::numbers::pi);
    quad.cos_limit[lane] = static_cast<float>(portable::cos(limit));
    quad.power[lane] = bounds.both_sides ? -bounds.power : bounds.power;
    const auto next = child.leaf ? child.next : static_cast<std::uint32_t>(tree_.quads_.size());
    quad.child[lane] = 2 * next + (child.leaf ? LightQuad::kLeaf : 0);
  }

  static constexpr std::uint32_t kEither = 2;

  LightTree& tree_;
  const std::vector<BinaryLightNode>& nodes_;
  std::uint32_t axis_dimension_[3] = {kEither, kEither, kEither};  ///< per axis
};

LightTree::LightTree(std::span<const LightBounds> emitters) {
  if (emitters.empty()) return;
  if (emitters.size() > LightQuad::kMostNumbers)
    throw Error(
        fmt::format("{} lights; at most {} can be sampled", emitters.size(), LightQuad::kMostNumbers));
  std::vector<Item> items(emitters.size());
  for (std::uint32_t i = 0; i < items.size(); ++i) items[i] = make_item(emitters[i], i);
  const Vec3f wide = box_of_centers(items).extent();
  std::vector<BinaryLightNode> nodes(2 * items.size() - 1);
  build_binary(items, nodes.data(), 0, 0);
  quads_.reserve(items.size() / 2 + 1);
  slots_.resize(items.size());
  Builder(*this, nodes, wide).add_quad(0, kRoot, 1);
  quads_.shrink_to_fit();
}

}  // namespace oktett
