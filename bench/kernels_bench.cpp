/// \file Every kernel by itself: variants, widths, instruction sets. Items are pairs of a ray and a shape.

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <vector>

#include "core/random.h"
#include "verify/cases/kernel_cases.h"

namespace oktett::bench {
namespace {

constexpr std::size_t kPairs = 4096;

/// Rays from around the unit ball towards shapes in it; about half of them hit.
struct KernelData : KernelCases {
  Column<float> t{kPairs}, u{kPairs}, v{kPairs};
  Column<std::uint8_t> hit{kPairs};

  float number(std::size_t i, std::uint32_t dimension) const {
    return 2 * random_float(pixel_key(1, i), 0, dimension) - 1;
  }
  Vec3f vector(std::size_t i, std::uint32_t dimension) const {
    return {number(i, dimension), number(i, dimension + 1), number(i, dimension + 2)};
  }

  explicit KernelData(KernelId id) {
    for (std::size_t i = 0; i < kPairs; ++i) {
      const Vec3f from = vector(i, 0) * 3.0f, at = vector(i, 3) * 0.5f;
      rays.push_back({from, 0, at - from});
      for (std::uint32_t k = 0; k < 3; ++k) {
        const Vec3f p = vector(i, 6 + 3 * k);
        for (int axis = 0; axis < 3; ++axis) {
          const float value = id == KernelId::slab ? (k == 0 ? -0.5f : 0.5f) * std::abs(p[axis]) : p[axis];
          corner[k][axis].push_back(value);
        }
      }
      fill_shape(id, i);
    }
  }

  void fill_shape(KernelId id, std::size_t i) {
    double value[12] = {};
    const Vec3f n = normalize(vector(i, 20));
    const auto put = [&](int k, const Vec3f& p) { value[k] = p.x, value[k + 1] = p.y, value[k + 2] = p.z; };
    if (id == KernelId::plane) {
      put(0, n), value[3] = 0.3 * number(i, 24);
    } else if (id == KernelId::disk) {
      put(0, vector(i, 25) * 0.3f), put(3, n), value[6] = 1;
    } else if (id == KernelId::box) {
      for (int k = 0; k < 3; ++k) value[5 * k] = 1.5;
    } else {
      put(0, vector(i, 25) * 0.3f), value[3] = 0.8;
    }
    for (int k = 0; k < 12; ++k) shape[k].push_back(value[k]);
  }

  KernelProbe probe() {
    KernelProbe r = run(0, kPairs);
    r.t = t.data(), r.u = u.data(), r.v = v.data(), r.hit = hit.data();
    return r;
  }
};

void run_kernel(benchmark::State& state, KernelId id, Isa isa, int width) {
  KernelData data(id);
  const KernelProbe probe = data.probe();
  for (auto _ : state) {
    probe_kernel(isa, id, width, probe);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kPairs));
  std::size_t hits = 0;
  for (std::uint8_t h : data.hit) hits += h;
  state.counters["hit_share"] = static_cast<double>(hits) / kPairs;
}

/// Runs before main().
[[maybe_unused]] const bool registered = [] {
  const std::pair<KernelId, const char*> kernels[] = {
      {KernelId::triangle_watertight, "triangle/watertight"},
      {KernelId::triangle_moller_trumbore, "triangle/moller_trumbore"},
      {KernelId::triangle_badouel, "triangle/badouel"},
      {KernelId::triangle_segura_feito, "triangle/segura_feito"},
      {KernelId::sphere_geometric, "sphere/geometric"},
      {KernelId::sphere_algebraic, "sphere/algebraic"},
      {KernelId::sphere_in_range, "sphere/in_range"},
      {KernelId::plane, "plane"},
      {KernelId::disk, "disk"},
      {KernelId::box, "box"},
      {KernelId::slab, "slab"},
  };
  for (const auto& [id, name] : kernels)
    for (Isa isa : available_isas())
      for (int width : probe_widths(isa))
        benchmark::RegisterBenchmark(
            fmt::format("{}/{}/{}", name, to_string(isa), width).c_str(),
            [kernel = id, isa, width](benchmark::State& s) { run_kernel(s, kernel, isa, width); });
  return true;
}();

}  // namespace
}  // namespace oktett::bench
