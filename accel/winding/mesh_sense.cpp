#include "accel/winding/mesh_sense.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <tuple>

#include "accel/hit_place.h"
#include "core/mesh_geometry.h"
#include "core/parallel.h"

namespace oktett {
namespace {

std::uint64_t mixed_bits(std::uint64_t x) {
  x = (x ^ x >> 32) * 0xd6e8feb86659fd93u;
  x = (x ^ x >> 32) * 0xd6e8feb86659fd93u;
  return x ^ x >> 32;
}

/// Sums over the edges of triangles. `balance` is zero if each edge is traversed as often in one direction as
/// in the other, `parity` if it has an even number of triangles; else that happens once in 2^64.
struct EdgeSums {
  std::uint64_t balance = 0, parity = 0;
  double volume = 0;
};

void add_edges(EdgeSums& sums, const TriangleMesh& mesh, std::size_t t, const Vec3d& origin) {
  Vec3f v[3];
  std::uint64_t number[3];
  for (std::size_t k = 0; k < 3; ++k) {
    v[k] = mesh.positions[mesh.indices[3 * t + k]];
    if (!is_finite(v[k])) return;
    number[k] = place_number(v[k]);
  }
  for (int k = 0; k < 3; ++k) {
    const std::uint64_t a = number[k], b = number[(k + 1) % 3];
    sums.balance += edge_number(a, b);
    sums.parity ^= a == b ? 0 : edge_number(std::min(a, b), std::max(a, b));
  }
  sums.volume += dot(Vec3d(v[0]) - origin, cross(Vec3d(v[1]) - origin, Vec3d(v[2]) - origin));
}

MeshSense sense_of(const TriangleMesh& mesh) {
  if (mesh.triangle_count() == 0) return MeshSense::closed;
  const Vec3d origin(mesh.positions[mesh.indices[0]]);
  const Chunks chunks(mesh.triangle_count(), 1u << 13);
  std::vector<EdgeSums> parts(chunks.count);
  chunks.each(true, [&](std::size_t c, std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) add_edges(parts[c], mesh, t, origin);
  });
  EdgeSums sums;
  for (const EdgeSums& p : parts) sums.balance += p.balance, sums.parity ^= p.parity, sums.volume += p.volume;
  if (sums.balance == 0) return MeshSense::closed;
  if (sums.parity == 0) return MeshSense::even;
  return sums.volume < 0 ? MeshSense::inverted : MeshSense::open;
}

void find_senses(const Accel& accel) {
  std::vector<MeshSense> senses(accel.geometries.size(), MeshSense::closed);
  for (std::size_t g = 0; g < senses.size(); ++g)
    if (const auto* shape = std::get_if<MeshGeometry>(&accel.geometries[g].shape))
      senses[g] = sense_of(*shape->mesh);
  accel.answers->senses = std::move(senses);
}

/// How many times a ray is deeper inside after a crossing.
int deeper(const Crossing& c) { return c.turn < 0 ? 1 : -1; }

/// The depth at which a ray begins in a closed mesh: 0 at its end.
int first_depth(std::span<const Crossing> crossings) {
  int depth = 0;
  for (const Crossing& c : crossings) depth -= deeper(c);
  return depth;
}

/// A crossing of a mesh, and which.
struct MeshCrossing {
  std::uint32_t instance, item;  ///< those of CrossedSolid
  float t;
  std::uint32_t index;
  MeshSense sense;

  bool is_same_mesh(const MeshCrossing& b) const { return instance == b.instance && item == b.item; }
};

/// Sets the turns of the crossings of one closed or even mesh, which are in order.
void set_turns(std::span<const MeshCrossing> crossed, std::span<const Crossing> crossings,
               std::vector<float>& turns) {
  int depth = 0;
  if (crossed[0].sense == MeshSense::even)
    depth = static_cast<int>(crossed.size() % 2);
  else
    for (const MeshCrossing& c : crossed) depth -= deeper(crossings[c.index]);
  for (const MeshCrossing& c : crossed) {
    const bool before = depth != 0;
    depth = c.sense == MeshSense::even ? 1 - depth : depth + deeper(crossings[c.index]);
    const bool after = depth != 0;
    turns[c.index] = before == after ? 0.0f : after ? -1.0f : 1.0f;
  }
}

}  // namespace

std::uint64_t place_number(const Vec3f& p) {
  const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x + 0.0f)}; };
  return mixed_bits(mixed_bits(bits(p.x) << 32 | bits(p.y)) + bits(p.z) + 0x9e3779b97f4a7c15u);
}

std::uint64_t edge_number(std::uint64_t a, std::uint64_t b) {
  return mixed_bits(a + std::rotl(b, 17)) - mixed_bits(b + std::rotl(a, 17));
}

MeshSense mesh_sense(const Accel& accel, std::uint32_t geometry) {
  // A thread that waits in here takes no other task: that could ask for the same.
  std::call_once(accel.answers->senses_once,
                 [&] { tbb::this_task_arena::isolate([&] { find_senses(accel); }); });
  return accel.answers->senses[geometry];
}

bool begins_inside(MeshSense sense, std::span<const Crossing> crossings) {
  if (sense == MeshSense::even) return crossings.size() % 2 == 1;
  if (sense == MeshSense::closed) return first_depth(crossings) != 0;
  int sum = 0, least = 0;
  for (const Crossing& c : crossings) {
    sum += sense == MeshSense::inverted ? -deeper(c) : deeper(c);
    least = std::min(least, sum);
  }
  return least < 0;
}

std::span<const float> solid_turns(const Accel& accel, std::span<const Crossing> crossings) {
  static thread_local std::vector<float> turns;
  static thread_local std::vector<MeshCrossing> crossed;
  turns.resize(crossings.size()), crossed.clear();
  for (std::uint32_t i = 0; i < crossings.size(); ++i) {
    turns[i] = crossings[i].turn;
    const CrossedSolid solid = crossed_solid(accel, crossings[i].hit);
    if (static_cast<Kind>(solid.accel->kinds[solid.geometry]) != Kind::triangle) continue;
    const MeshSense sense = mesh_sense(*solid.accel, solid.geometry);
    if (sense == MeshSense::inverted) turns[i] = -turns[i];
    if (sense == MeshSense::closed || sense == MeshSense::even)
      crossed.push_back({solid.instance, solid.item, crossings[i].hit.t, i, sense});
  }
  std::sort(crossed.begin(), crossed.end(), [&](const MeshCrossing& a, const MeshCrossing& b) {
    return std::tuple(a.instance, a.item, a.t, crossings[a.index].hit.item, a.index) <
           std::tuple(b.instance, b.item, b.t, crossings[b.index].hit.item, b.index);
  });
  for (std::size_t begin = 0, end; begin < crossed.size(); begin = end) {
    end = begin;
    while (end < crossed.size() && crossed[end].is_same_mesh(crossed[begin])) ++end;
    set_turns({&crossed[begin], end - begin}, crossings, turns);
  }
  return turns;
}

}  // namespace oktett
