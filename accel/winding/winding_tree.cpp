#include "accel/winding/winding_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

#include "core/box.h"
#include "core/parallel.h"

namespace oktett {

// ---- Moments of clusters.

WindingMoments WindingMoments::about(const Vec3d& other) const {
  WindingMoments m = *this;
  const Vec3d d = center - other;
  m.center = other;
  m.reach = reach + length(d) * (1 + 0x1p-50);
  m.first = first + d * area;
  m.second = second + 2 * dot(d, first) + dot(d, d) * area;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      m.quadrupole[i][j] += dipole[i] * d[j];
      for (int k = 0; k < 3; ++k)
        m.octupole[i][j][k] += quadrupole[i][j] * d[k] + quadrupole[i][k] * d[j] + dipole[i] * d[j] * d[k];
    }
  return m;
}

void WindingMoments::add(const WindingMoments& other) {
  reach = std::max(reach, other.reach);
  area += other.area, second += other.second;
  first += other.first, dipole += other.dipole;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      quadrupole[i][j] += other.quadrupole[i][j];
      for (int k = 0; k < 3; ++k) octupole[i][j][k] += other.octupole[i][j][k];
    }
}

WindingMoments WindingMoments::moved(const Affine& m, double scale) const {
  // Area vectors turn with the cofactors, |det| times the transposed inverse.
  const Affine inverse = m.inverse();
  const double det = std::abs(m.determinant());
  double cofactor[3][3], stretch = 0, turned = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      cofactor[i][j] = det * inverse.m[j][i];
      stretch += m.m[i][j] * m.m[i][j], turned += cofactor[i][j] * cofactor[i][j];
    }
  // The Frobenius norm bounds how much a map lengthens vectors.
  stretch = (scale > 0 ? scale : std::sqrt(stretch)) * (1 + 0x1p-30);
  turned = (scale > 0 ? scale * scale : std::sqrt(turned)) * (1 + 0x1p-30);
  WindingMoments r;
  r.center = m.point(center);
  r.reach = reach * stretch, r.area = area * turned, r.second = second * turned * stretch * stretch;
  r.first = m.vector(first) * turned;
  for (int i = 0; i < 3; ++i)
    for (int a = 0; a < 3; ++a) {
      const double c = cofactor[i][a];
      r.dipole[i] += c * dipole[a];
      for (int j = 0; j < 3; ++j)
        for (int b = 0; b < 3; ++b) {
          const double cb = c * m.m[j][b];
          r.quadrupole[i][j] += cb * quadrupole[a][b];
          for (int k = 0; k < 3; ++k)
            for (int d = 0; d < 3; ++d) r.octupole[i][j][k] += cb * m.m[k][d] * octupole[a][b][d];
        }
    }
  return r;
}

namespace {

Vec3f rounded(const Vec3d& v) { return Vec3f(v); }

/// Those of one triangle about `center`.
WindingMoments moments_of(const WindingTriangle& t, const Vec3d& center) {
  WindingMoments m;
  m.center = center;
  Vec3d y[3];
  for (int k = 0; k < 3; ++k) {
    y[k] = Vec3d(t.corner[k]) - center;
    m.reach = std::max(m.reach, length(y[k]) * (1 + 0x1p-50));
  }
  m.dipole = cross(y[1] - y[0], y[2] - y[0]) * 0.5;
  // What rounds where a triangle is thin counts, too.
  m.area = length(m.dipole) + length(y[1] - y[0]) * length(y[2] - y[0]) * 0x1p-50;
  const Vec3d mean = (y[0] + y[1] + y[2]) * (1.0 / 3);
  m.first = mean * m.area;
  double inner[3][3];
  for (int j = 0; j < 3; ++j)
    for (int k = 0; k < 3; ++k)
      inner[j][k] = (y[0][j] * y[0][k] + y[1][j] * y[1][k] + y[2][j] * y[2][k] + 9 * mean[j] * mean[k]) / 12;
  m.second = m.area * (inner[0][0] + inner[1][1] + inner[2][2]);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      m.quadrupole[i][j] = m.dipole[i] * mean[j];
      for (int k = 0; k < 3; ++k) m.octupole[i][j][k] = m.dipole[i] * inner[j][k];
    }
  return m;
}

// ---- The tree.

/// Where an element stands in the order of the leaves, and its place in space.
struct WindingRef {
  Vec3f center;
  std::uint32_t element;
};

/// Makes a tree of elements, up to Elements::kLeafSize in a leaf.
template <class Elements>
class WindingBuilder {
 public:
  static constexpr std::size_t kLeafSize = Elements::kLeafSize;

  explicit WindingBuilder(const Elements& elements) : elements_(elements) {
    refs_.resize(elements.size());
    in_parts(refs_.size(), 1u << 14, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        refs_[i] = {elements_.place(i), static_cast<std::uint32_t>(i)};
    });
  }

  void build(WindingTree& tree) {
    if (refs_.empty()) return;
    order(0, refs_.size());
    count_nodes(refs_.size());
    tree.nodes.resize(std::max<std::size_t>(nodes_of(refs_.size()), 1));
    tree.groups.resize(elements_.group_count());
    tree.whole = add_node(tree, 0, 0, refs_.size());
  }

 private:
  /// Ranges up to which a task works alone.
  static constexpr std::size_t kAlone = 1u << 13;

  /// Where a range is cut in two: leaves are full but for the last.
  static std::size_t middle(std::size_t begin, std::size_t end) {
    const std::size_t leaves = (end - begin + kLeafSize - 1) / kLeafSize;
    return begin + (leaves + 1) / 2 * kLeafSize;
  }

  /// Brings a range into the order of the leaves: along the longest axis, halves first.
  void order(std::size_t begin, std::size_t end) {
    if (end - begin <= kLeafSize) return;
    Box box;
    for (std::size_t i = begin; i < end; ++i) box.grow(refs_[i].center);
    const Vec3f extent = box.extent();
    const int axis = dominant_axis(extent);
    const std::size_t mid = middle(begin, end);
    const auto at = [&](std::size_t i) { return refs_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(mid), at(end), [axis](const WindingRef& a, const WindingRef& b) {
      const float x = a.center[axis], y = b.center[axis];
      return x != y ? x < y : a.element < b.element;
    });
    if (end - begin <= kAlone) return order(begin, mid), order(mid, end);
    run_both([&] { order(begin, mid); }, [&] { order(mid, end); });
  }

  /// Cuts a range in up to eight. Returns how many.
  static int cut_range(std::size_t begin, std::size_t end, std::size_t (&bounds)[WindingNode::kWidth + 1]) {
    bounds[0] = begin, bounds[1] = end;
    int count = 1;
    for (int round = 0; round < 3; ++round) {
      std::size_t cut[WindingNode::kWidth + 1];
      int cuts = 0;
      for (int i = 0; i < count; ++i) {
        cut[cuts++] = bounds[i];
        if (bounds[i + 1] - bounds[i] > kLeafSize) cut[cuts++] = middle(bounds[i], bounds[i + 1]);
      }
      cut[cuts] = end;
      std::copy(cut, cut + cuts + 1, bounds);
      count = cuts;
    }
    return count;
  }

  /// The number of nodes of a range follows from its size; there are only a few sizes.
  void count_nodes(std::size_t size) {
    if (size <= kLeafSize || node_count_.contains(size)) return;
    std::size_t bounds[WindingNode::kWidth + 1], nodes = 1;
    const int count = cut_range(0, size, bounds);
    for (int i = 0; i < count; ++i) {
      count_nodes(bounds[i + 1] - bounds[i]);
      nodes += nodes_of(bounds[i + 1] - bounds[i]);
    }
    node_count_[size] = nodes;
  }
  std::size_t nodes_of(std::size_t size) const { return size <= kLeafSize ? 0 : node_count_.at(size); }

  /// Makes node `index` of a range, and those below behind it. Returns its moments.
  WindingMoments add_node(WindingTree& tree, std::size_t index, std::size_t begin, std::size_t end) {
    std::size_t bounds[WindingNode::kWidth + 1], first[WindingNode::kWidth];
    const int count = cut_range(begin, end, bounds);
    std::size_t next = index + 1;
    for (int i = 0; i < count; ++i) first[i] = next, next += nodes_of(bounds[i + 1] - bounds[i]);
    WindingMoments child[WindingNode::kWidth];
    WindingNode& node = tree.nodes[index];
    const auto add_child = [&](int i) {
      const std::size_t size = bounds[i + 1] - bounds[i];
      node.child[i] = static_cast<std::uint32_t>(first[i]);
      child[i] = size > kLeafSize
                     ? add_node(tree, first[i], bounds[i], bounds[i + 1])
                     : elements_.leaf(tree, bounds[i] / kLeafSize, leaf_refs(bounds[i], size), node.child[i]);
    };
    if (end - begin > kAlone)
      tbb::parallel_for(0, count, add_child);
    else
      for (int i = 0; i < count; ++i) add_child(i);
    for (int i = count; i < WindingNode::kWidth; ++i) node.child[i] = WindingNode::kLeaf;
    for (int i = 0; i < WindingNode::kWidth; ++i) set_child(node, i, i < count ? child[i] : missing());
    return sum_of({child, static_cast<std::size_t>(count)}, {&refs_[begin], end - begin});
  }

  /// The elements of a leaf, in order.
  std::span<const WindingRef> leaf_refs(std::size_t begin, std::size_t size) {
    const std::span<WindingRef> refs(&refs_[begin], size);
    std::ranges::sort(refs, {}, &WindingRef::element);
    return refs;
  }

  WindingMoments sum_of(std::span<const WindingMoments> children, std::span<const WindingRef> refs) const {
    Vec3d weighted;
    double area = 0;
    for (const WindingMoments& m : children) weighted += m.center * m.area + m.first, area += m.area;
    WindingMoments sum;
    sum.center = Vec3d(rounded(area > 0 ? weighted / area : children[0].center));
    for (const WindingMoments& m : children) sum.add(m.about(sum.center));
    sum.reach = std::min(sum.reach, elements_.reach(refs, sum.center));
    return sum;
  }

  static WindingMoments missing() {
    WindingMoments m;
    m.center = {1e30, 1e30, 1e30};
    return m;
  }

  static float up(double x) {
    const auto f = static_cast<float>(x);
    return static_cast<double>(f) < x ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
  }

  static void set_child(WindingNode& node, int i, const WindingMoments& m) {
    constexpr double kTurn = 1 / (4 * std::numbers::pi);
    for (int k = 0; k < 3; ++k) node.center[k][i] = static_cast<float>(m.center[k]);
    node.reach[i] = up(m.reach);
    node.area[i] = up(m.area * (1 + 0x1p-40) * kTurn);
    // |y|^3 is at most reach |y|^2. A least number keeps tiny surfaces from vanishing in float.
    const double spread = m.reach * m.second * (1 + 0x1p-40) * kTurn;
    node.spread[i] = m.area > 0 ? std::max(up(spread), 0x1p-120f) : 0.0f;
    const auto set = [i](float(&column)[WindingNode::kWidth], double value) {
      column[i] = static_cast<float>(value);
    };
    for (int k = 0; k < 3; ++k) set(node.dipole[k], m.dipole[k] * kTurn);
    // With s = 1 / |r| and the unit vector v along r, the sum is
    // s^2 (dipole . v - 3 s quadrupole : v v + 15/2 s^2 octupole : v v v).
    const auto& q = m.quadrupole;
    const double third = (q[0][0] + q[1][1] + q[2][2]) / 3, three = 3 * kTurn;
    set(node.quadrupole[0], three * (q[0][0] - third)), set(node.quadrupole[1], three * (q[1][1] - third));
    set(node.quadrupole[2], three * (q[0][1] + q[1][0])),
        set(node.quadrupole[3], three * (q[0][2] + q[2][0]));
    set(node.quadrupole[4], three * (q[1][2] + q[2][1]));
    const auto& o = m.octupole;
    const auto even = [&](int a, int b, int c) { return (o[a][b][c] + o[b][a][c] + o[c][a][b]) / 3; };
    double trace[3];
    for (int k = 0; k < 3; ++k) trace[k] = (even(0, 0, k) + even(1, 1, k) + even(2, 2, k)) / 5;
    const double c = 7.5 * kTurn;
    set(node.octupole[0], c * (even(0, 0, 0) - 3 * trace[0]));
    set(node.octupole[1], 3 * c * (even(0, 1, 1) - trace[0]));
    set(node.octupole[2], 3 * c * (even(0, 0, 1) - trace[1]));
    set(node.octupole[3], c * (even(1, 1, 1) - 3 * trace[1]));
    set(node.octupole[4], c * (even(0, 0, 2) - trace[2]));
    set(node.octupole[5], c * (even(1, 1, 2) - trace[2]));
    set(node.octupole[6], 6 * c * even(0, 1, 2));
  }

  const Elements& elements_;
  std::vector<WindingRef> refs_;
  std::unordered_map<std::size_t, std::size_t> node_count_;  ///< by the size of a range
};

/// Triangles, in the tree's unit.
struct TriangleElements {
  static constexpr std::size_t kLeafSize = WindingGroup::kSize;

  std::span<const WindingTriangle> triangles;
  float scale;

  std::size_t size() const { return triangles.size(); }
  WindingTriangle scaled(std::size_t i) const {
    WindingTriangle t = triangles[i];
    for (Vec3f& c : t.corner) c = c * scale;
    return t;
  }
  Vec3f place(std::size_t i) const {
    const WindingTriangle t = scaled(i);
    return (t.corner[0] + t.corner[1] + t.corner[2]) * (1.0f / 3);
  }
  double reach(std::span<const WindingRef> refs, const Vec3d& center) const {
    double square = 0;
    for (const WindingRef& ref : refs) {
      const WindingTriangle t = scaled(ref.element);
      for (const Vec3f& c : t.corner) {
        const Vec3d y = Vec3d(c) - center;
        square = std::max(square, dot(y, y));
      }
    }
    return std::sqrt(square) * (1 + 0x1p-50);
  }
  std::size_t group_count() const { return (size() + kLeafSize - 1) / kLeafSize; }
  WindingMoments leaf(WindingTree& tree, std::size_t index, std::span<const WindingRef> refs,
                      std::uint32_t& number) const {
    number = static_cast<std::uint32_t>(index) | WindingNode::kLeaf;
    WindingGroup& group = tree.groups[index];
    Vec3d weighted;
    double area = 0;
    for (int i = 0; i < WindingGroup::kSize; ++i) {
      const bool is_there = static_cast<std::size_t>(i) < refs.size();
      const WindingTriangle t = scaled(refs[is_there ? static_cast<std::size_t>(i) : 0].element);
      for (int k = 0; k < 3; ++k)
        for (int axis = 0; axis < 3; ++axis) group.corner[k][axis][i] = t.corner[is_there ? k : 0][axis];
      if (!is_there) continue;
      const WindingMoments m = moments_of(t, Vec3d(t.corner[0]));
      weighted += m.center * m.area + m.first, area += m.area;
    }
    WindingMoments sum;
    sum.center = Vec3d(rounded(area > 0 ? weighted / area : Vec3d(place(refs[0].element))));
    for (const WindingRef& ref : refs) sum.add(moments_of(scaled(ref.element), sum.center));
    return sum;
  }
};

/// Parts, in the tree's unit.
struct PartElements {
  static constexpr std::size_t kLeafSize = 1;

  std::vector<WindingMoments> parts;

  std::size_t size() const { return parts.size(); }
  Vec3f place(std::size_t i) const { return Vec3f(parts[i].center); }
  double reach(std::span<const WindingRef>, const Vec3d&) const {
    return std::numeric_limits<double>::infinity();
  }
  std::size_t group_count() const { return 0; }
  WindingMoments leaf(WindingTree&, std::size_t, std::span<const WindingRef> refs,
                      std::uint32_t& number) const {
    const WindingMoments& m = parts[refs[0].element];
    number = refs[0].element | WindingNode::kLeaf;
    return m.about(Vec3d(rounded(m.center)));
  }
};

/// The power of two that brings what has these bounds to a size of about one.
double unit_of(const Vec3d& lo, const Vec3d& hi) {
  const double extent = max_component(hi - lo), most = max_component(max(abs(lo), abs(hi)));
  // Far from the origin coordinates have few digits left, and floats must hold them.
  const double size = std::max(extent, most * 0x1p-40);
  return size > 0 ? std::exp2(-std::ilogb(size)) : 1.0;
}

WindingMoments scaled_moments(const WindingMoments& m, double scale) {
  return m.moved(Affine::scaling({scale, scale, scale}), scale);
}

}  // namespace

WindingTree make_winding_tree(std::span<const WindingTriangle> triangles) {
  WindingTree tree;
  Box box;
  for (const WindingTriangle& t : triangles)
    for (const Vec3f& c : t.corner) box.grow(c);
  if (box.empty()) return tree;
  tree.scale = unit_of(Vec3d(box.lo), Vec3d(box.hi));
  // Floats reach to 2^127: a tree of less than that size is brought to one within their range.
  tree.scale = std::min(tree.scale, 0x1p126);
  const TriangleElements elements{triangles, static_cast<float>(tree.scale)};
  WindingBuilder(elements).build(tree);
  tree.whole = scaled_moments(tree.whole, 1 / tree.scale);
  return tree;
}

WindingTree make_winding_tree(std::span<const WindingMoments> parts) {
  WindingTree tree;
  if (parts.empty()) return tree;
  constexpr double inf = std::numeric_limits<double>::infinity();
  Vec3d lo{inf, inf, inf}, hi{-inf, -inf, -inf};
  for (const WindingMoments& m : parts) {
    const Vec3d reach{m.reach, m.reach, m.reach};
    lo = min(lo, m.center - reach), hi = max(hi, m.center + reach);
  }
  tree.scale = unit_of(lo, hi);
  PartElements elements;
  for (const WindingMoments& m : parts) elements.parts.push_back(scaled_moments(m, tree.scale));
  WindingBuilder(elements).build(tree);
  tree.whole = scaled_moments(tree.whole, 1 / tree.scale);
  return tree;
}

}  // namespace oktett
