#include "bench/peer_trace.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/peer_timing.h"

namespace oktett::bench {

std::vector<Workload> make_workloads(const Accel& accel, const View& view, const PeerOptions& options,
                                     Isa isa) {
  const Box box = bounds(accel);
  const float infinity = std::numeric_limits<float>::infinity();
  const float reach = 0.2f * 0.5f * length(box.extent());
  // The sum of three works decides what Work::equal compares.
  const bool equal = options.wants(Work::equal);
  const bool shadow = options.wants(Work::shadow) || equal, diffuse = options.wants(Work::diffuse) || equal;
  const bool occlusion = options.wants(Work::ambient_occlusion);
  std::vector<Workload> works;
  works.reserve(4);
  works.push_back({Work::primary, "primary", primary_rays(box, view), false});
  const RayBatch& primary = works.front().rays;
  if (!shadow && !diffuse && !occlusion) return works;
  HitBatch hits;
  hits.resize_uninitialized(primary.size());
  closest_hit(accel, primary.span(), hits.span(), isa);
  if (shadow)
    works.push_back({Work::shadow, "point-light shadow", shadow_rays(accel, primary, hits, box, view), true});
  if (diffuse)
    works.push_back({Work::diffuse, "diffuse", diffuse_rays(accel, primary, hits, box, 1, infinity), false});
  if (occlusion)
    works.push_back({Work::ambient_occlusion, "ambient occlusion",
                     diffuse_rays(accel, primary, hits, box, 4, reach), true});
  return works;
}

void trace(const Accel& accel, const Workload& work, Isa isa, int threads, Answers& answers) {
  const RaySpan span = work.rays.span();
  const HitSpan hits = answers.hits.span();
  in_pieces(threads, span.size, [&](std::size_t b, std::size_t n) {
    if (work.any)
      any_hit(accel, span.part(b, n), {answers.occluded.data() + b, n}, isa);
    else
      closest_hit(accel, span.part(b, n), hits.part(b, n), isa);
  });
}

static void trace_piece(const EmbreeScene& scene, EmbreeMode mode, const Workload& work, Answers& answers,
                        std::size_t b, std::size_t n) {
  const RaySpan span = work.rays.span();
  if (work.any)
    scene.any_hit(span.part(b, n), answers.occluded.data() + b, mode);
  else
    scene.closest_hit(span.part(b, n), answers.hits.span().part(b, n), mode);
}

void trace(const EmbreeScene& scene, EmbreeMode mode, const Workload& work, int threads, Answers& answers) {
  in_pieces(threads, work.rays.size(),
            [&](std::size_t b, std::size_t n) { trace_piece(scene, mode, work, answers, b, n); });
}

void trace_nothing(const Workload& work, int threads, Answers& answers) {
  const RaySpan span = work.rays.span();
  const HitSpan hits = answers.hits.span();
  in_pieces(threads, span.size, [&](std::size_t b, std::size_t n) {
    for (std::size_t i = b; i < b + n; ++i) {
      const Ray r = span[i];
      if (work.any)
        answers.occluded[i] = r.direction.x > 2;
      else
        hits.set(i, {r.tmax, r.origin.x, r.direction.x, kNoId, kNoId});
    }
  });
}

EmbreeChoice fastest_mode(const std::vector<const EmbreeScene*>& scenes, const Workload& work) {
  constexpr std::size_t kPiece = 4096, kStride = 8, kFinalists = 3;
  Answers answers(work);
  const std::size_t size = work.rays.size();
  const auto sample = [&](const EmbreeChoice& c) {
    flush_denormals();
    for (std::size_t b = 0; b < size; b += kPiece * kStride)
      trace_piece(*c.scene, c.mode, work, answers, b, std::min(kPiece, size - b));
  };
  const auto all = [&](const EmbreeChoice& c) { trace(*c.scene, c.mode, work, 1, answers); };
  const auto twice = [](const std::function<void()>& f) {
    f();
    return std::min(seconds(f), seconds(f));
  };
  const auto by_time = [](const EmbreeChoice& a, const EmbreeChoice& b) { return a.seconds < b.seconds; };
  std::vector<EmbreeChoice> choices;
  for (const EmbreeScene* scene : scenes)
    for (const EmbreeMode mode : embree_modes()) choices.push_back({scene, mode, 0});
  for (EmbreeChoice& c : choices) c.seconds = twice([&] { sample(c); });
  std::sort(choices.begin(), choices.end(), by_time);
  choices.resize(std::min(choices.size(), kFinalists));
  for (EmbreeChoice& c : choices) c.seconds = twice([&] { all(c); });
  return *std::min_element(choices.begin(), choices.end(), by_time);
}

std::string to_string(EmbreeMode mode) {
  return std::to_string(mode.width) + (mode.coherent ? " coherent" : " incoherent");
}

Agreement compare(const Workload& work, const Answers& a, const Answers& b) {
  Agreement agreement;
  agreement.work = to_string(work.work);
  agreement.rays = work.rays.size();
  for (std::size_t i = 0; i < work.rays.size(); ++i) {
    if (work.any) {
      agreement.hit_or_miss += a.occluded[i] != b.occluded[i];
      continue;
    }
    const bool hit = a.hits.item[i] != kNoId;
    if (hit != (b.hits.item[i] != kNoId))
      ++agreement.hit_or_miss;
    else if (hit && std::abs(a.hits.t[i] - b.hits.t[i]) > 1e-3f * std::abs(b.hits.t[i]))
      ++agreement.distance;
  }
  return agreement;
}

}  // namespace oktett::bench
