#include "accel/query.h"

#include "accel/batch_pieces.h"
#include "accel/trace_code.h"

namespace oktett {

void closest_hit(const Accel& accel, const RaySpan& rays, const HitSpan& hits, Isa isa, TraceMode mode) {
  const TraceCode& code = trace_code(isa);
  for_each_piece(rays, [&](std::size_t begin, const RaySpan& piece) {
    code.closest_hit(accel, piece, {hits.part(begin, piece.size)}, mode);
  });
}

void any_hit(const Accel& accel, const RaySpan& rays, std::uint8_t* occluded, Isa isa, TraceMode mode) {
  const TraceCode& code = trace_code(isa);
  for_each_piece(rays, [&](std::size_t begin, const RaySpan& piece) {
    code.any_hit(accel, piece, {occluded + begin}, mode);
  });
}

void closest_hit(const Accel& accel, const RaySpan& rays, const HitSpan& hits, Isa isa) {
  require_same_size(rays.size, hits.size, "closest_hit");
  if (rays.size == 1) return hits.set(0, closest_hit(accel, rays[0], isa));
  closest_hit(accel, rays, hits, isa, TraceMode::automatic);
}

void any_hit(const Accel& accel, const RaySpan& rays, std::span<std::uint8_t> occluded, Isa isa) {
  require_same_size(rays.size, occluded.size(), "any_hit");
  if (rays.size == 1) return void(occluded[0] = any_hit(accel, rays[0], isa));
  any_hit(accel, rays, occluded.data(), isa, TraceMode::automatic);
}

void closest_hit(const Accel& accel, std::span<const Ray> rays, std::span<Hit> hits, Isa isa) {
  require_same_size(rays.size(), hits.size(), "closest_hit");
  if (rays.size() == 1) return void(hits[0] = closest_hit(accel, rays[0], isa));
  const TraceCode& code = trace_code(isa);
  for_each_piece(rays, [&](std::size_t begin, const RaySpan& piece) {
    static thread_local HitBatch columns;
    columns.resize_uninitialized(piece.size);
    code.closest_hit(accel, piece, {columns.span()}, TraceMode::automatic);
    for (std::size_t i = 0; i < piece.size; ++i) hits[begin + i] = columns[i];
  });
}

void any_hit(const Accel& accel, std::span<const Ray> rays, std::span<std::uint8_t> occluded, Isa isa) {
  require_same_size(rays.size(), occluded.size(), "any_hit");
  if (rays.size() == 1) return void(occluded[0] = any_hit(accel, rays[0], isa));
  const TraceCode& code = trace_code(isa);
  for_each_piece(rays, [&](std::size_t begin, const RaySpan& piece) {
    code.any_hit(accel, piece, {occluded.data() + begin}, TraceMode::automatic);
  });
}

Hit closest_hit(const Accel& accel, const Ray& ray, Isa isa) {
  return trace_code(isa).closest_hit_one(accel, ray);
}

bool any_hit(const Accel& accel, const Ray& ray, Isa isa) { return trace_code(isa).any_hit_one(accel, ray); }

}  // namespace oktett
