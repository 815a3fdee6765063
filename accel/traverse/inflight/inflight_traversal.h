#pragma once
/// \file Many single rays in flight through a tree: its nodes and blocks of triangles
/// (accel/traverse/inflight/triangle_steps.h), leaves of all other shapes, and instances. A ray that reaches
/// an instance goes inside and stays in flight.

#include <algorithm>
#include <limits>

#include "accel/traverse/inflight/inflight_ray.h"
#include "accel/traverse/inflight/triangle_steps.h"
#include "accel/traverse/ways.h"

namespace oktett {

// ---- Rays in flight that wait at the same leaf of shapes, tested together in lanes.

/// Rays of a group at a leaf of closed-form shapes or combinations.
inline constexpr int kGroupRays = kBeamGroup;

/// The least number of rays at a leaf that are tested faster together, with a ray in each lane, than one by
/// one, with a shape in each lane. Greater than kGroupRays if there is none.
inline int least_group(const LeafEntry& leaf) {
  // A ray that is alone at a combination or a polygon uses one lane.
  if (leaf.kind == Kind::polygon || leaf.kind == Kind::csg) return 3;
  // Alone, each ray takes one step for up to eight shapes. Together, sixteen take two steps for each shape.
  if (is_closed_form(leaf.kind)) return 2 * leaf.count + 1;
  return std::numeric_limits<int>::max();
}

/// Moves the rays that are at the same leaf as *begin next to it, and returns how many there are with *begin,
/// at most `most`; 0 if that is inside an instance. `kInstances`: the rays may be inside instances; else
/// their InflightRay::in is not set.
template <bool kInstances>
OKTETT_INLINE int rays_at_leaf(InflightRay** begin, InflightRay** end, int most) {
  const auto is_here = [&](const InflightRay& ray) {
    return (!kInstances || ray.in.instance == kNoInstance) && ray.current.bits() == (*begin)->current.bits();
  };
  if (!is_here(**begin)) return 0;
  int count = 1;
  for (InflightRay** at = begin + 1; at != end && count < most; ++at)
    if (is_here(**at)) std::swap(*at, begin[count++]);
  return count;
}

/// `count` rays of a batch side by side, up to their present ends. Lanes that are left over repeat the first.
template <int N, class A>
OKTETT_INLINE RayLanes<Simd<float, N, A>> gather_rays(const RaySpan& batch, InflightRay* const* rays,
                                                      int count) {
  using F = Simd<float, N, A>;
  alignas(64) float column[8][N];
  for (int i = 0; i < N; ++i) {
    const InflightRay& ray = *rays[i < count ? i : 0];
    for (int k = 0; k < 3; ++k)
      column[k][i] = batch.origin[k][ray.index], column[3 + k][i] = batch.direction[k][ray.index];
    column[6][i] = batch.tmin[ray.index], column[7][i] = ray.tmax;
  }
  const auto load = [&](int k) { return F::load(column[k]); };
  return {{load(0), load(1), load(2)}, {load(3), load(4), load(5)}, load(6), load(7)};
}

// ---- Rays in flight against leaves of spheres. What the test takes of a ray is kept in double, so that it
// need not be converted at each leaf.

/// Tests rays in flight against the spheres of a tree. Each ray has one of kInflightRays places, and comes
/// there from a chunk of W rays.
template <int W, class A>
class SphereLeaves {
 public:
  static constexpr int kSpheres = kShapeLanes<Sphere>;
  static_assert(kSpheres == TriangleBlock::kSize, "a leaf is tested at once");

  explicit SphereLeaves(const Accel& accel) : pool_(std::get<Sphere::Pool>(accel.pools)) {}

  /// Prepares the rays of a chunk for start().
  OKTETT_INLINE void prepare(const RayChunk<W, A>& c) {
    using F = Simd<float, W, A>;
    using D = Simd<double, W, A>;
    if (pool_.size() == 0) return;
    const Vec3<D> d{to_double(F::load(c.d[0])), to_double(F::load(c.d[1])), to_double(F::load(c.d[2]))};
    (D(1.0) / dot_lanes(d, d)).store(inverse_);
  }

  /// Puts ray `i` of the chunk at `place`.
  OKTETT_INLINE void start(std::ptrdiff_t place, const RayChunk<W, A>& c, int i) {
    if (pool_.size() == 0) return;
    Line& line = lines_[place];
    for (int k = 0; k < 3; ++k) line.o[k] = c.o[k][i], line.d[k] = c.d[k][i];
    line.tmin = c.tmin[i], line.inverse = inverse_[i];
  }

  /// Returns which spheres of `leaf` the ray at `place` hits, as bits; t[k] is the distance of sphere k. The
  /// ray is in no instance.
  OKTETT_INLINE unsigned meet(std::ptrdiff_t place, const InflightRay& ray, const LeafEntry& leaf,
                              float (&t)[kSpheres]) const {
    using F = Simd<float, kSpheres, A>;
    using D = Simd<double, kSpheres, A>;
    const Line& line = lines_[place];
    const auto tmax = static_cast<double>(ray.tmax);
    const auto wide = load_ray_lanes([](double x) { return D(x); }, line.o, line.d, line.tmin, tmax);
    D roots[Sphere::kRoots];
    const auto maybe = Sphere::roots_in_range(wide, D(line.inverse), D(Sphere::last_root(tmax)),
                                              Sphere::load<D>(pool_, leaf.begin), roots);
    if (none(maybe)) return 0;
    const Vec3<F> unused{F(0.0f), F(0.0f), F(0.0f)};
    HitLanes<F> hit;
    const auto met = first_in_range(RayLanes<F>{unused, unused, F(ray.tmin), F(ray.tmax)},
                                    mask_cast<float>(maybe), roots, hit);
    hit.t.store(t);
    return bits(met) & ((2u << (leaf.count - 1)) - 1);
  }

 private:
  struct alignas(64) Line {
    double o[3], d[3], tmin;
    double inverse;  ///< one over the square of the direction
  };

  const Sphere::Pool& pool_;
  alignas(64) double inverse_[W];  ///< of the chunk
  Line lines_[kInflightRays];
};

// ---- Many single rays in flight through a tree.

/// Leaves are visited when this many rays wait at leaves, or when no ray is at a node.
inline constexpr int kLeafThreshold = 8;

/// The steps of rays in flight through `accel`. `Derived` starts the rays, and has a member function
/// finish(ray, tail) that takes the result of a finished ray and may start another in its place.
template <class Derived, Query Q, class A, InflightTrees kTrees>
class InflightTraversal : protected TriangleSteps<Q, A, kTrees> {
 protected:
  using Base = TriangleSteps<Q, A, kTrees>;
  using Base::accel_, Base::rays_, Base::queues_, Base::inflight_, Base::states_;
  using Base::kInstances, Base::kEnter, Base::kChunk;
  using Base::pop, Base::found, Base::exact_state, Base::exact_in, Base::adopt, Base::keep_hit;
  using typename Base::Tails;

  explicit InflightTraversal(const Accel& accel) : Base(accel), spheres_(accel) {}

  /// Some steps of the rays in the queues, at least one of which is not empty.
  OKTETT_INLINE void advance() {
    this->node_round();
    if (queues_.leaves.size() >= kLeafThreshold || queues_.nodes.size() == 0) this->leaf_round();
    if (queues_.others.size() >= kLeafThreshold || queues_.nodes.size() + queues_.leaves.size() == 0)
      other_round();
  }

  /// Rays that are finished, at a leaf of the table, or on their way out of an instance.
  OKTETT_NOINLINE void other_round() {
    Tails tail = queues_.tails();
    SortedOthers<kEnter> rays(queues_.others.head, tail.other);
    queues_.others.head = tail.other;
    if constexpr (kEnter)
      for (InflightRay** at = rays.at_leaf; at != rays.at_leaf_end; ++at) prefetch_instance(accel_, **at);
    for (InflightRay** at = rays.finished; at != rays.finished_end; ++at) {
      static_cast<Derived*>(this)->finish(**at, tail);
    }
    if constexpr (kEnter)
      for (InflightRay** at = rays.leaving; at != rays.leaving_end; ++at) leave(**at, tail);
    for (InflightRay** at = rays.at_spheres; at != rays.at_spheres_end; ++at) at_spheres(**at, tail);
    for (InflightRay** at = rays.at_leaf; at != rays.at_leaf_end;) {
      const int count = group_at_leaf(at, rays.at_leaf_end, tail);
      if (count == 0) table_leaf(**at, tail);
      at += std::max(count, 1);
    }
    if constexpr (kEnter) go_inside(tail);
    queues_.keep(tail);
  }

  /// Tests rays at the leaf of *begin together, if that pays, and returns how many; these are moved to
  /// `begin`.
  OKTETT_INLINE int group_at_leaf(InflightRay** begin, InflightRay** end, Tails& tail) {
    if (kInstances && (*begin)->in.instance != kNoInstance) return 0;
    const LeafEntry& leaf = accel_.leaves[(*begin)->current.table_index()];
    if (is_exact(leaf.kind)) {
      const int count = rays_at_leaf<kInstances>(begin, end, ExactCode<A>::kLanes);
      exact_together(leaf, begin, count, tail);
      return count;
    }
    const int least = least_group(leaf);
    if (end - begin < least) return 0;
    const int count = rays_at_leaf<kInstances>(begin, end, kGroupRays);
    if (count < least) return 0;
    shapes_together(leaf, begin, count, tail);
    return count;
  }

  OKTETT_INLINE void exact_together(const LeafEntry& leaf, InflightRay* const* rays, int count, Tails& tail) {
    const auto r = gather_rays<ExactCode<A>::kLanes, A>(rays_, rays, count);
    RayState<ExactCode<A>::kLanes, A> state;
    const unsigned lanes = state.set_rays(r.o, r.d, r.tmin, r.tmax) & ((1u << count) - 1);
    if (lanes != 0) leaf_exact(accel_, leaf, state, lanes);
    take_hits(rays, count, found_lanes(state, lanes), state, tail);
  }

  /// Rays at one leaf of closed-form shapes or combinations.
  OKTETT_NOINLINE void shapes_together(const LeafEntry& leaf, InflightRay* const* rays, int count,
                                       Tails& tail) {
    const auto r = gather_rays<kGroupRays, A>(rays_, rays, count);
    RayState<kGroupRays, A> state;
    const unsigned lanes = state.set(r.o, r.d, r.tmin, r.tmax, accel_.bounds) & ((1u << count) - 1);
    if (lanes != 0) table_leaf_packet<Q>(accel_, leaf, state, lanes);
    take_hits(rays, count, found_lanes(state, lanes), state, tail);
  }

  /// Gives the rays in `met` their hits from `state`, and takes each ray to its next node or leaf.
  template <int N>
  OKTETT_INLINE void take_hits(InflightRay* const* rays, int count, unsigned met, const RayState<N, A>& state,
                               Tails& tail) {
    for (int i = 0; i < count; ++i) {
      InflightRay& ray = *rays[i];
      if ((met >> i & 1) != 0) {
        if (ray.candidate < kDecidedHit) {
          // The candidate is decided only now, so the hit may turn out to be no nearer.
          accept_hit(exact_state(ray), 0, state.tmax[i], state.u[i], state.v[i], state.item[i],
                     state.path[i]);
          adopt(ray);
        } else {
          keep_hit(ray, state.hit(i));
        }
      }
      pop(ray, tail);
    }
  }

  OKTETT_INLINE void at_spheres(InflightRay& ray, Tails& tail) {
    // The exact tests also decide what the ray may have hit before, and know instances.
    if (ray.candidate < kDecidedHit || (kInstances && ray.in.instance != kNoInstance))
      return table_leaf(ray, tail);
    const LeafEntry& leaf = accel_.leaves[ray.current.table_index()];
    alignas(64) float t[TriangleBlock::kSize];
    const auto& items = std::get<Sphere::Pool>(accel_.pools).item;
    for (unsigned met = spheres_.meet(&ray - inflight_, ray, leaf, t); met != 0; met &= met - 1) {
      const auto k = static_cast<std::uint32_t>(__builtin_ctz(met));
      if (t[k] <= ray.tmax) keep_hit(ray, {t[k], 0, 0, items[leaf.begin + k], kNoId});
    }
    pop(ray, tail);
  }

  OKTETT_INLINE void table_leaf(InflightRay& ray, Tails& tail) {
    const NodeRef ref = ray.current;
    if constexpr (kEnter) {
      const LeafEntry& leaf = ray.in.accel->leaves[ref.table_index()];
      if (ray.in.instance == kNoInstance && holds_instances(leaf.kind)) {
        ray.in.next = first_instance(leaf), ray.in.end = ray.in.next + leaf.count;
        outer_[&ray - inflight_] = ray;
        return add_entering(ray, tail);
      }
    }
    exact_in(ray.in.instance, exact_state(ray), [&](const Accel& tree, RayState<1, A>& state) {
      table_leaf_single<Q>(tree, tree.leaves[ref.table_index()], state);
    });
    adopt(ray);
    pop(ray, tail);
  }

  /// Takes the ray into the next instance of its leaf, or, after the last one, out of it.
  OKTETT_INLINE void leave(InflightRay& ray, Tails& tail) {
    if (ray.in.next != ray.in.end) return add_entering(ray, tail);
    leave_instance(ray, outer_[&ray - inflight_], accel_);
    pop(ray, tail);
  }

  OKTETT_INLINE void add_entering(InflightRay& ray, Tails& tail) {
    if (entering_.add(ray, outer_[&ray - inflight_], ray.in.next++, accel_)) go_inside(tail);
  }

  /// Takes the rays in `entering_` into their instances, or tests them exactly there and then lets them
  /// leave.
  OKTETT_INLINE void go_inside(Tails& tail) {
    const auto stay = [&](InflightRay& ray, std::uint32_t number) {
      with_instance(accel_, number, [&](const auto& instance, const Accel& child) {
        instance_single<Q>(instance, child, exact_state(ray), IgnoreSteps{});
      });
      adopt(ray);
      if (Q != Query::any || ray.candidate == kNoCandidate) ray.push(NodeRef::way_out(), -1);
      pop(ray, tail);
    };
    const auto enter = [&](InflightRay& ray, NodeRef root) {
      ray.current = root;
      this->enqueue(ray, root, tail);
    };
    const auto miss = [&](InflightRay& ray) {
      if (ray.in.next != ray.in.end)
        ray.push(NodeRef::way_out(), -1);
      else if (ray.in.instance != kNoInstance)
        leave_instance(ray, outer_[&ray - inflight_], accel_);
      pop(ray, tail);
    };
    entering_.go(accel_, enter, miss, stay);
  }

  InflightHead outer_[kEnter ? kInflightRays : 1];
  EnteringRays<kEnter ? kChunk : 1, A> entering_;
  SphereLeaves<kChunk, A> spheres_;
};

}  // namespace oktett
