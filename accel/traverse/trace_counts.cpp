#include "accel/traverse/trace_counts.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "accel/instance.h"
#include "kernels/exact_shapes.h"

namespace oktett {
namespace {

/// Rays counted by one task.
constexpr std::size_t kChunk = 1024;

/// One ray, on its way to a hit that is known beforehand: shapes other than triangles are not tested here,
/// but end the ray when the walk comes to the one that it hits.
class Walk {
 public:
  Walk(const Vec3d& o, const Vec3d& d, double tmin, double tmax, const Hit& hit, TraceCounts& counts)
      : o_(o), d_(d), tmin_(tmin), tmax_(tmax), hit_(hit), counts_(counts) {}

  void run(const Accel& accel) {
    for (const LeafEntry& leaf : accel.unbounded) entry(accel, leaf);
    if (accel.root.is_none()) return;
    std::vector<Pending> stack{{accel.root, tmin_}};
    while (!stack.empty()) {
      const Pending p = stack.back();
      stack.pop_back();
      if (p.near > tmax_) continue;
      if (p.ref.is_triangles())
        block(accel.blocks[p.ref.block()], p.ref.triangle_count());
      else if (p.ref.is_leaf())
        entry(accel, accel.leaves[p.ref.table_index()]);
      else
        node(accel.nodes[p.ref.node_index()], stack);
    }
  }

 private:
  struct Pending {
    NodeRef ref;
    double near;
  };

  void node(const BvhNode& node, std::vector<Pending>& stack) {
    ++counts_.nodes;
    const std::size_t base = stack.size();
    for (int i = 0; i < BvhNode::kWidth; ++i) {
      if (node.child[i].is_none()) continue;
      double near = tmin_, far = tmax_;
      for (int k = 0; k < 3; ++k) {
        const double lo = node.plane[2 * k][i] - o_[k], hi = node.plane[2 * k + 1][i] - o_[k];
        if (d_[k] == 0) {
          if (lo > 0 || hi < 0) far = -std::numeric_limits<double>::infinity();
          continue;
        }
        near = std::max(near, std::min(lo / d_[k], hi / d_[k]));
        far = std::min(far, std::max(lo / d_[k], hi / d_[k]));
      }
      if (near <= far) stack.push_back({node.child[i], near});
    }
    counts_.boxes += stack.size() - base;
    std::sort(stack.begin() + static_cast<std::ptrdiff_t>(base), stack.end(),
              [](const Pending& a, const Pending& b) { return a.near > b.near; });
  }

  /// Möller and Trumbore 1997, in double: good enough to count by.
  void block(const TriangleBlock& block, int count) {
    ++counts_.blocks;
    counts_.triangles += static_cast<std::uint64_t>(count);
    for (int i = 0; i < count; ++i) {
      const auto corner = [&](int k) { return Vec3d{block.v[k][0][i], block.v[k][1][i], block.v[k][2][i]}; };
      const Vec3d a = corner(0), e1 = corner(1) - a, e2 = corner(2) - a, s = o_ - a;
      const Vec3d p = cross(d_, e2), q = cross(s, e1);
      const double det = dot(e1, p), u = dot(s, p) / det, v = dot(d_, q) / det, t = dot(e2, q) / det;
      if (u >= 0 && v >= 0 && u + v <= 1 && t > tmin_ && t < tmax_) tmax_ = t;
    }
  }

  void entry(const Accel& accel, const LeafEntry& leaf) {
    if (leaf.kind == Kind::triangle) return block(accel.blocks[leaf.begin], leaf.count);
    if (holds_instances(leaf.kind))
      return each_instance(accel, leaf, [&](const auto& item, const Accel& child) {
        instance(item, child);
        return true;
      });
    counts_.other += leaf.count;
    if (leaf.kind == Kind::csg) {
      for (std::uint32_t k = leaf.begin; k < leaf.begin + leaf.count; ++k)
        tmax_ = std::min(tmax_, hit_.valid() ? double(hit_.t) : tmax_);
      return;
    }
    if (is_exact(leaf.kind)) {
      visit_exact(leaf.kind, *accel.exact, [&](auto, const auto& pool) {
        for (std::uint32_t k = leaf.begin; k < leaf.begin + leaf.count; ++k)
          if (pool.frames[pool.cells[k].element].item == hit_.item) tmax_ = std::min(tmax_, double(hit_.t));
      });
      return;
    }
    visit_pool(leaf.kind, accel.pools, [&](auto, const auto& pool) {
      for (std::uint32_t k = leaf.begin; k < leaf.begin + leaf.count; ++k)
        if (pool.item[k] == hit_.item) tmax_ = std::min(tmax_, double(hit_.t));
    });
  }

  template <class Instance>
  void instance(const Instance& instance, const Accel& child) {
    ++counts_.instances;
    Vec3d o, d;
    for (int k = 0; k < 3; ++k) {
      const auto* m = &instance.to_child[4 * k];
      o[k] = m[0] * o_.x + m[1] * o_.y + m[2] * o_.z + m[3];
      d[k] = m[0] * d_.x + m[1] * d_.y + m[2] * d_.z;
    }
    Walk inner(o, d, tmin_, tmax_, hit_, counts_);
    inner.run(child);
    tmax_ = inner.tmax_;
  }

  const Vec3d o_, d_;
  const double tmin_;
  double tmax_;
  const Hit& hit_;
  TraceCounts& counts_;
};

void add(TraceCounts& sum, const TraceCounts& c) {
  sum.rays += c.rays, sum.nodes += c.nodes, sum.boxes += c.boxes, sum.blocks += c.blocks;
  sum.triangles += c.triangles, sum.other += c.other, sum.instances += c.instances, sum.hits += c.hits;
}

}  // namespace

TraceCounts trace_counts(const Accel& accel, const RaySpan& rays) {
  HitBatch hits;
  hits.resize_uninitialized(rays.size);
  closest_hit(accel, rays, hits.span(), default_isa());
  std::vector<TraceCounts> parts((rays.size + kChunk - 1) / kChunk);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t c) {
    TraceCounts& counts = parts[c];
    for (std::size_t i = c * kChunk, end = std::min(i + kChunk, rays.size); i < end; ++i) {
      const Ray r = rays[i];
      const Hit hit = hits[i];
      ++counts.rays;
      counts.hits += hit.valid();
      // As in the queries, such rays meet nothing.
      if (!is_finite(r.origin) || !is_finite(r.direction) || r.direction == Vec3f{}) continue;
      if (!(r.tmin >= 0 && r.tmin < r.tmax)) continue;
      Walk(Vec3d(r.origin), Vec3d(r.direction), r.tmin, r.tmax, hit, counts).run(accel);
    }
  });
  TraceCounts sum;
  for (const TraceCounts& c : parts) add(sum, c);
  return sum;
}

}  // namespace oktett
