#include "bench/peer_trace.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/peer_timing.h"

namespace oktett::bench {

/// Adds one workload.
static void add(std::vector<Workload>& works, Work work, const std::string& name, RayBatch rays,
                Query query = Query::closest) {
  works.push_back({work, name, std::make_shared<RayBatch>(std::move(rays)), query});
}

/// Calls of few rays: rays that run together, and rays that do not.
static void add_calls(std::vector<Workload>& works, const Workload& coherent, const Workload& incoherent) {
  for (const Workload* kind : {&coherent, &incoherent})
    for (const Query query : {Query::closest, Query::any})
      for (const std::size_t batch : {1u, 8u, 64u, 1024u})
        works.push_back({Work::calls,
                         std::to_string(batch) + (batch == 1 ? " ray" : " rays") + " a call, " +
                             (query == Query::any ? "any hit, " : "") + kind->name,
                         kind->rays, query, batch});
}

std::vector<Workload> make_workloads(const Accel& accel, const Box& framed, const View& view,
                                     const PeerOptions& options, Isa isa) {
  const float infinity = std::numeric_limits<float>::infinity();
  const float reach = 0.2f * 0.5f * length(framed.extent());
  // The sum of three works decides what Work::equal compares.
  const bool equal = options.wants(Work::equal);
  std::vector<Workload> works;
  add(works, Work::primary, "primary", primary_rays(framed, view));
  const Workload primary = works.front();
  const RayBatch& rays = *primary.rays;
  HitBatch hits;
  hits.resize_uninitialized(rays.size());
  closest_hit(accel, rays.span(), hits.span(), isa);
  if (options.wants(Work::shadow) || equal)
    add(works, Work::shadow, "point-light shadow", shadow_rays(accel, rays, hits, framed, view), Query::any);
  if (options.wants(Work::diffuse) || equal)
    add(works, Work::diffuse, "diffuse", diffuse_rays(accel, rays, hits, framed, 1, infinity));
  if (options.wants(Work::ambient_occlusion))
    add(works, Work::ambient_occlusion, "ambient occlusion",
        diffuse_rays(accel, rays, hits, framed, 4, reach), Query::any);
  if (options.wants(Work::bounces))
    add(works, Work::bounces, "bounce 2 to 4", bounce_rays(accel, rays, hits, framed, isa));
  if (!options.wants(Work::calls) && !options.wants(Work::all_hits)) return works;
  const auto segments = std::make_shared<RayBatch>(random_segments(bounds(accel), rays.size()));
  if (options.wants(Work::calls))
    add_calls(works, {Work::calls, "camera", primary.rays}, {Work::calls, "random", segments});
  if (options.wants(Work::all_hits)) {
    works.push_back({Work::all_hits, "all hits, camera", primary.rays, Query::all});
    works.push_back({Work::all_hits, "all hits, random", segments, Query::all});
  }
  return works;
}

/// All hits of each ray, as Answers holds them.
static void trace_all(const Accel& accel, const RaySpan& rays, const HitSpan& hits, std::size_t batch,
                      Isa isa) {
  static thread_local HitLists lists;
  for (std::size_t b = 0; b < rays.size; b += batch) {
    const std::size_t n = std::min(batch, rays.size - b);
    all_hits(accel, rays.part(b, n), lists, isa);
    for (std::size_t i = 0; i < n; ++i) {
      const std::span<const Hit> found = lists.of_ray(i);
      hits.item[b + i] = static_cast<std::uint32_t>(found.size()), hits.t[b + i] = 0;
      for (const Hit& hit : found) hits.t[b + i] += hit.t;
    }
  }
}

void trace(const Accel& accel, const Workload& work, Isa isa, int threads, Answers& answers) {
  const RaySpan span = work.rays->span();
  const HitSpan hits = answers.hits.span();
  in_pieces(threads, span.size, [&](std::size_t begin, std::size_t count) {
    if (work.query == Query::all)
      return trace_all(accel, span.part(begin, count), hits.part(begin, count), work.batch, isa);
    if (work.batch == 1) {
      for (std::size_t i = begin; i < begin + count; ++i)
        if (work.query == Query::any)
          answers.occluded[i] = any_hit(accel, span[i], isa);
        else
          hits.set(i, closest_hit(accel, span[i], isa));
      return;
    }
    for (std::size_t b = begin; b < begin + count; b += work.batch) {
      const std::size_t n = std::min(work.batch, begin + count - b);
      if (work.query == Query::any)
        any_hit(accel, span.part(b, n), {answers.occluded.data() + b, n}, isa);
      else
        closest_hit(accel, span.part(b, n), hits.part(b, n), isa);
    }
  });
}

static void trace_piece(const EmbreeScene& scene, EmbreeMode mode, const Workload& work, Answers& answers,
                        std::size_t b, std::size_t n) {
  const RaySpan rays = work.rays->span().part(b, n);
  if (work.query == Query::any)
    scene.any_hit(rays, answers.occluded.data() + b, mode);
  else if (work.query == Query::closest)
    scene.closest_hit(rays, answers.hits.span().part(b, n), mode);
  else
    scene.all_hits(rays, answers.hits.span().part(b, n), mode);
}

void trace(const EmbreeScene& scene, EmbreeMode mode, const Workload& work, int threads, Answers& answers) {
  in_pieces(threads, work.size(),
            [&](std::size_t b, std::size_t n) { trace_piece(scene, mode, work, answers, b, n); });
}

void trace_nothing(const Workload& work, int threads, Answers& answers) {
  const RaySpan span = work.rays->span();
  const HitSpan hits = answers.hits.span();
  in_pieces(threads, span.size, [&](std::size_t b, std::size_t n) {
    for (std::size_t i = b; i < b + n; ++i) {
      const Ray r = span[i];
      if (work.query == Query::any)
        answers.occluded[i] = r.direction.x > 2;
      else
        hits.set(i, {r.tmax, r.origin.x, r.direction.x, kNoId, kNoId});
    }
  });
}

EmbreeChoice fastest_mode(const std::vector<const EmbreeScene*>& scenes, const Workload& work) {
  constexpr std::size_t kPiece = 4096, kStride = 8, kFinalists = 3;
  Answers answers(work);
  const std::size_t size = work.size();
  const auto sample = [&](const EmbreeChoice& c) {
    flush_denormals();
    for (std::size_t b = 0; b < size; b += kPiece * kStride)
      trace_piece(*c.scene, c.mode, work, answers, b, std::min(kPiece, size - b));
  };
  const auto all = [&](const EmbreeChoice& c) { trace(*c.scene, c.mode, work, 1, answers); };
  const auto twice = [](const std::function<void()>& f) {
    f();
    return std::min(thread_seconds(f), thread_seconds(f));
  };
  const auto by_time = [](const EmbreeChoice& a, const EmbreeChoice& b) { return a.seconds < b.seconds; };
  std::vector<EmbreeChoice> choices;
  for (const EmbreeScene* scene : scenes)
    for (const EmbreeMode mode : embree_modes())
      if (static_cast<std::size_t>(mode.width) <= work.batch &&
          scene->comes_back(mode, work.query == Query::any))
        choices.push_back({scene, mode, 0});
  for (EmbreeChoice& c : choices) c.seconds = twice([&] { sample(c); });
  std::sort(choices.begin(), choices.end(), by_time);
  choices.resize(std::min(choices.size(), kFinalists));
  for (EmbreeChoice& c : choices) c.seconds = twice([&] { all(c); });
  return *std::min_element(choices.begin(), choices.end(), by_time);
}

std::string to_string(EmbreeMode mode) {
  return std::to_string(mode.width) + (mode.coherent ? " coherent" : " incoherent");
}

std::string to_string(const EmbreeChoice& choice) {
  return to_string(choice.mode) + (choice.scene->kind().quality == 1 ? ", medium" : ", high");
}

void compare(const Workload& work, const Answers& a, const Answers& b, int rival, Agreement& agreement) {
  std::size_t& hit_or_miss = agreement.hit_or_miss[rival];
  for (std::size_t i = 0; i < work.size(); ++i) {
    if (work.query == Query::any) {
      hit_or_miss += a.occluded[i] != b.occluded[i];
      continue;
    }
    const std::uint32_t ours = a.hits.item[i], theirs = b.hits.item[i];
    if (work.query == Query::all ? ours != theirs : (ours == kNoId) != (theirs == kNoId))
      ++hit_or_miss;
    else if (std::abs(a.hits.t[i] - b.hits.t[i]) > 1e-3f * std::abs(b.hits.t[i]))
      ++agreement.distance[rival];
  }
}

}  // namespace oktett::bench
