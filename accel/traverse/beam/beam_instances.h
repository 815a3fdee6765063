#pragma once
/// \file Rays of a beam that go into instances. The beam walks the tree above the instances once for all its
/// rays. Rays that may meet an instance are transformed together and go through what it shows in flight
/// (accel/traverse/inflight/inflight_traversal.h). What they hit shortens the rays of the beam.

#include <cmath>
#include <cstring>
#include <utility>

#include "accel/traverse/beam/beam_task.h"
#include "accel/traverse/inflight/inflight_traversal.h"

namespace oktett {

/// A beam is given up if on average fewer than kRaysPerInstance rays may meet the first kInstanceVisits
/// instances.
template <Query Q>
inline constexpr int kInstanceVisits = Q == Query::any ? 16 : 8;
template <Query Q>
inline constexpr int kRaysPerInstance = Q == Query::any ? 1 : 12;
/// Nodes and leaves that a beam may visit more for each instance that it meets.
inline constexpr int kStepsPerInstance = 8;

/// Rays of one beam after the other in the instances of `accel`.
template <Query Q, class A>
class BeamInstances : InflightTraversal<BeamInstances<Q, A>, Q, A, InflightTrees::inside> {
  using Base = InflightTraversal<BeamInstances, Q, A, InflightTrees::inside>;

 public:
  explicit BeamInstances(const Accel& accel) : Base(accel) {}

  /// The rays that follow are of the beam `task`. Forgets all rays of earlier beams.
  void begin(BeamTask<Q, A>& task) {
    task_ = &task, rays_ = task.rays;
    queues_.clear(), pending_.clear();
    free_size_ = 0;
    for (InflightRay& ray : inflight_) free_[free_size_++] = &ray;
    std::memset(busy_, 0, sizeof busy_);
    dirty_ = 0, visits_ = 0, listed_ = 0;
  }

  /// Groups of the beam go into instance `number`; `met(g)` are the rays of group `g` that may meet it.
  /// False if the instance shows unbounded shapes; then the rays have to be tested otherwise.
  template <class Met>
  OKTETT_INLINE bool visit(std::uint32_t number, unsigned groups, Met&& met) {
    bool inside = false;
    with_instance(accel_, number, [&](const auto& instance, const Accel& child) {
      if (!child.unbounded.empty()) return;
      inside = true, ++visits_;
      // Rays that are still in an instance that the beam has met before wait, because they may be hit there.
      unsigned waiting[kBeamGroups], wait = 0;
      enter_all(number, instance, child, groups, [&](int g) {
        const unsigned rays = met(g);
        waiting[g] = rays & busy_[g], wait |= static_cast<unsigned>(waiting[g] != 0) << g;
        return rays & ~busy_[g];
      });
      if (wait == 0) return;
      for (unsigned rest = wait; rest != 0; rest &= rest - 1)
        while ((waiting[__builtin_ctz(rest)] & busy_[__builtin_ctz(rest)]) != 0) this->advance();
      enter_all(number, instance, child, wait, [&](int g) { return waiting[g] & met(g); });
    });
    return inside;
  }

  /// So few rays of the beam may meet an instance on average that they are better traced alone.
  bool sparse() const { return visits_ == kInstanceVisits<Q> && listed_ < kRaysPerInstance<Q> * visits_; }

  /// Groups with new hits since the last call.
  unsigned take_dirty() { return std::exchange(dirty_, 0u); }

  /// Finishes all rays that have gone into instances.
  OKTETT_NOINLINE void finish_rays() {
    while (!queues_.empty()) this->advance();
    if constexpr (Q == Query::closest) decide();
  }

 private:
  friend Base;
  using Base::accel_, Base::rays_, Base::queues_, Base::pending_, Base::chunk_, Base::inflight_,
      Base::states_, Base::kChunk;
  using typename Base::Tails;
  using F = Simd<float, kChunk, A>;
  using I = Simd<std::int32_t, kChunk, A>;

  /// Takes rays(g) of each group g into an instance.
  template <class Instance, class Rays>
  OKTETT_INLINE void enter_all(std::uint32_t number, const Instance& instance, const Accel& child,
                               unsigned groups, Rays&& rays) {
    size_ = 0;
    for (; groups != 0; groups &= groups - 1) {
      const int g = __builtin_ctz(groups);
      size_ += store_set_bits<A>(rays(g), g * kBeamGroup, place_ + size_);
    }
    listed_ += size_;
    for (int i = 0; i < size_; i += kChunk) enter(number, instance, child, i);
  }

  /// Ray `place` of the beam in the batch.
  OKTETT_INLINE std::int32_t index_of(std::int32_t place) const {
    return task_->beam.sorted ? task_->beam.order[place] : place;
  }

  /// Takes the rays from place `first` of the list on, one in each lane, into an instance.
  template <class Instance>
  OKTETT_NOINLINE void enter(std::uint32_t number, const Instance& instance, const Accel& child, int first) {
    const BeamRays<A>& beam = task_->beam;
    const int count = std::min(size_ - first, kChunk);
    alignas(64) std::int32_t index[kChunk];
    for (int i = count; i < kChunk; ++i) place_[first + i] = place_[first];
    for (int i = 0; i < kChunk; ++i) index[i] = index_of(place_[first + i]);
    const I at = I::load(index);
    const auto column = [&](const float* from) { return gather(from, at); };
    const auto vec = [&](const float* const(&from)[3]) {
      return Vec3<F>{column(from[0]), column(from[1]), column(from[2])};
    };
    const float infinity = std::numeric_limits<float>::infinity();
    RayLanes<F> outer{beam.at_end ? vec(rays_.origin) : broadcast<F>(rays_[0].origin),
                      flush_direction(vec(rays_.direction)), column(rays_.tmin),
                      beam.ranged ? column(rays_.tmax) : F(infinity)};
    F least = outer.tmax;
    if constexpr (Q == Query::closest) {
      // Bounds on the distance of the nearest hit so far.
      const I place = I::load(place_ + first);
      const F* d[3] = {&outer.d.x, &outer.d.y, &outer.d.z};
      const F dz = abs(*d[beam.axis[2]]);
      const auto distance = [&](const float* s, float slack) { return F(slack) / (gather(s, place) * dz); };
      least = min(outer.tmax, distance(beam.hit_hi, 1 - kBeamPointSlack));
      outer.tmax = min(outer.tmax, distance(beam.hit_lo, 1 + kBeamPointSlack));
    }
    RayLanes<F> rays = outer;
    transform_rays(instance, outer, rays.o, rays.d);
    chunk_.set(rays, (2u << (count - 1)) - 1, F(box_extent(child.bounds)));
    const Box& box = child.bounds;
    const unsigned met = chunk_.meets(broadcast<F>(box.lo), broadcast<F>(box.hi));
    alignas(64) float end[kChunk];
    least.store(end);
    for (unsigned rest = ((2u << (count - 1)) - 1) & ~chunk_.tame; rest != 0; rest &= rest - 1)
      exactly(number, place_[first + __builtin_ctz(rest)]);
    for (unsigned rest = met & chunk_.tame; rest != 0; rest &= rest - 1) {
      const int i = __builtin_ctz(rest);
      start(number, child, place_[first + i], i, end[i]);
    }
  }

  /// Starts lane `i` of the chunk, which is ray `place` of the beam, in an instance.
  OKTETT_INLINE void start(std::uint32_t number, const Accel& child, std::int32_t place, int i, float end) {
    while (free_size_ == 0) this->advance();
    InflightRay& ray = *free_[--free_size_];
    set_lines(ray, chunk_, i);
    ray.tmin = chunk_.tmin[i], ray.hit_lo = end;
    ray.set_end(chunk_.tmax[i]);
    ray.candidate = kNoCandidate, ray.has_state = 0, ray.size = 0;
    ray.push(NodeRef::none(), -1);
    ray.index = static_cast<std::uint32_t>(index_of(place)), ray.place = static_cast<std::uint32_t>(place);
    ray.in.accel = &child, ray.in.bytes = TreeBytes(child), ray.in.instance = number;
    ray.current = child.root;
    busy_[place / kBeamGroup] |= static_cast<std::uint16_t>(1u << place % kBeamGroup);
    Tails tail = queues_.tails();
    this->enqueue(ray, child.root, tail);
    queues_.keep(tail);
  }

  /// Ray `place` of the beam, whose numbers do not suit rays in flight, in an instance.
  OKTETT_NOINLINE void exactly(std::uint32_t number, std::int32_t place) {
    const Ray ray = rays_[static_cast<std::size_t>(index_of(place))];
    RayState<1, A> r;
    if (r.set(ray, accel_.bounds) == 0) return;
    with_instance(accel_, number, [&](const auto& instance, const Accel& child) {
      instance_single<Q>(instance, child, r, IgnoreSteps{});
    });
    if (r.item[0] != kNoId) found(place, r.hit(0));
  }

  /// Ray `place` of the beam has a decided hit.
  OKTETT_INLINE void found(std::int32_t place, const Hit& h) {
    BeamRays<A>& beam = task_->beam;
    if constexpr (Q == Query::any) {
      beam.hit_lo[place] = std::numeric_limits<float>::infinity();
    } else if (h.valid()) {
      begin_decisions(*task_);
      const float dz = std::fabs(rays_.direction[beam.axis[2]][place]);
      accept_beam(task_->out.hits, beam, dz, static_cast<std::size_t>(place), h);
    }
    dirty_ |= 1u << place / kBeamGroup;
  }

  /// Takes the result of a ray, which is back from its instance.
  OKTETT_INLINE void finish(InflightRay& ray, Tails&) {
    const auto place = static_cast<std::int32_t>(ray.place);
    free_[free_size_++] = &ray;
    busy_[place / kBeamGroup] &= static_cast<std::uint16_t>(~(1u << place % kBeamGroup));
    if (ray.candidate == kNoCandidate) return;
    if constexpr (Q == Query::any) return found(place, {});
    if (ray.candidate == kDecidedHit) return found(place, states_[&ray - inflight_].hit(0));
    raise(place, ray.hit_lo, ray.tmax);
    if (pending_.add(ray.index, ray.candidate, ray.in.candidate_instance)) decide();
  }

  /// Ray `place` of the beam surely has a hit at lo <= t <= hi.
  OKTETT_INLINE void raise(std::int32_t place, float lo, float hi) {
    BeamRays<A>& beam = task_->beam;
    const float dz = std::fabs(rays_.direction[beam.axis[2]][place]);
    beam.hit_lo[place] = std::max(beam.hit_lo[place], (1 - kBeamPointSlack) / (hi * dz));
    beam.hit_hi[place] = std::max(beam.hit_hi[place], (1 + kBeamPointSlack) / (lo * dz));
    dirty_ |= 1u << place / kBeamGroup;
  }

  void decide() {
    pending_.decide(accel_, rays_,
                    [&](std::uint32_t ray, const Hit& h) { found(static_cast<std::int32_t>(ray), h); });
  }

  BeamTask<Q, A>* task_ = nullptr;
  InflightRay* free_[kInflightRays];
  int free_size_ = 0;
  std::uint16_t busy_[kBeamGroups];  ///< rays of each group that are in flight, a bit each
  unsigned dirty_ = 0;               ///< groups with new hits
  int visits_ = 0, listed_ = 0;      ///< instances that the beam has met, and rays that may meet them, in all
  int size_ = 0;
  alignas(64) std::int32_t place_[kBeamRays + kBeamGroup];  ///< rays that go into an instance next
};

}  // namespace oktett
