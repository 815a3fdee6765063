/// \file Questions about points: nearest points, inside or outside, winding numbers and signed distances, by
/// instruction set.
/// One thread. The mesh is OKTETT_BENCH_MESH or a generated one; `spheres` are 100 000 that do not touch,
/// `instances` are 1000 of a small mesh under any maps.

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <memory>
#include <vector>

#include "accel/point_query.h"
#include "bench/bench_mesh.h"
#include "verify/cases/kernel_cases.h"
#include "verify/oracles/mesh.h"

namespace oktett::bench {
namespace {

enum class Place { grid, anywhere, near };

std::shared_ptr<const Accel> spheres() {
  SpheresShape all;
  CaseRandom random(1);
  for (int i = 0; i < 100000; ++i) all.spheres.push_back({random.vector(), 0.003});
  return build_accel({{all, {}, kNoId}});
}

std::shared_ptr<const Accel> instances() {
  static const OracleMesh ball = make_icosphere(3);
  const auto child = build_accel({{MeshGeometry{&ball.mesh}, {}, kNoId}});
  InstanceList list{{child}, {}};
  CaseRandom random(2);
  for (int i = 0; i < 1000; ++i) {
    InstancePlace place{{}, 0, kNoId};
    const Affine m = Affine::translation(random.vector()) * Affine::rotation(random.vector() * 180.0) *
                     Affine::scaling({0.03 + 0.03 * random.unit(), 0.05, 0.05});
    m.to_rows(place.to_list);
    list.places.push_back(place);
  }
  return build_accel({{list, {}, kNoId}});
}

const Accel& scene(int number) {
  static const std::shared_ptr<const Accel> all[] = {build_accel({{MeshGeometry{&bench_mesh()}, {}, kNoId}}),
                                                     spheres(), instances()};
  return *all[number];
}

/// 64^3 points of a grid over the bounds, or as many anywhere in them, or near the surface of the mesh.
std::vector<Vec3f> points(const Accel& accel, Place place) {
  constexpr int kSide = 64;
  std::vector<Vec3f> all;
  CaseRandom random(3);
  const Box box = bounds(accel);
  const Vec3f extent = box.extent();
  for (int i = 0; i < kSide * kSide * kSide; ++i) {
    Vec3f unit(Vec3d{random.unit(), random.unit(), random.unit()});
    if (place == Place::grid)
      unit = Vec3f{static_cast<float>(i % kSide) + 0.5f, static_cast<float>(i / kSide % kSide) + 0.5f,
                   static_cast<float>(i / (kSide * kSide)) + 0.5f} *
             (1.0f / kSide);
    const TriangleMesh& mesh = bench_mesh();
    if (place == Place::near)
      all.push_back(mesh.positions[random.bits() % mesh.positions.size()] +
                    extent * (unit - Vec3f{0.5f, 0.5f, 0.5f}) * 0.01f);
    else
      all.push_back(box.lo + extent * unit);
  }
  return all;
}

template <class Answer, class Ask>
void ask(benchmark::State& state, int number, Place place, const Ask& query) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const std::vector<Vec3f> all = points(scene(number), place);
  std::vector<Answer> answers(all.size());
  for (auto _ : state) {
    query(scene(number), all, answers);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(all.size()));
}

/// Runs before main().
[[maybe_unused]] const bool registered = [] {
  const auto add = [](const std::string& name, auto&& run) {
    benchmark::RegisterBenchmark(name.c_str(), run)->Unit(benchmark::kMillisecond);
  };
  const char* const scenes[] = {"mesh", "spheres", "instances"};
  const std::pair<Place, const char*> places[] = {
      {Place::grid, "grid"}, {Place::anywhere, "anywhere"}, {Place::near, "near"}};
  for (const Isa isa : available_isas())
    for (int number = 0; number < 3; ++number)
      for (const auto& [place, name] : places) {
        if (number > 0 && place == Place::near) continue;
        add(fmt::format("closest_point/{}/{}/{}", scenes[number], name, to_string(isa)),
            [number, where = place, isa](benchmark::State& state) {
              ask<ClosestPoint>(state, number, where,
                                [&](const Accel& accel, const std::vector<Vec3f>& p,
                                    std::vector<ClosestPoint>& a) { closest_point(accel, p, a, isa); });
            });
        add(fmt::format("signed_distance/{}/{}/{}", scenes[number], name, to_string(isa)),
            [number, where = place, isa](benchmark::State& state) {
              ask<float>(state, number, where,
                         [&](const Accel& accel, const std::vector<Vec3f>& p, std::vector<float>& a) {
                           signed_distance(accel, p, a, isa);
                         });
            });
        add(fmt::format("inside/{}/{}/{}", scenes[number], name, to_string(isa)),
            [number, where = place, isa](benchmark::State& state) {
              ask<std::uint8_t>(state, number, where,
                                [&](const Accel& accel, const std::vector<Vec3f>& p,
                                    std::vector<std::uint8_t>& a) { inside(accel, p, a, isa); });
            });
        add(fmt::format("inside_winding/{}/{}/{}", scenes[number], name, to_string(isa)),
            [number, where = place, isa](benchmark::State& state) {
              ask<std::uint8_t>(
                  state, number, where,
                  [&](const Accel& accel, const std::vector<Vec3f>& p, std::vector<std::uint8_t>& a) {
                    inside(accel, p, a, InsideRule::winding, isa);
                  });
            });
        add(fmt::format("winding_number/{}/{}/{}", scenes[number], name, to_string(isa)),
            [number, where = place, isa](benchmark::State& state) {
              ask<float>(state, number, where,
                         [&](const Accel& accel, const std::vector<Vec3f>& p, std::vector<float>& a) {
                           winding_number(accel, p, a, 1e-4, isa);
                         });
            });
      }
  return true;
}();

}  // namespace
}  // namespace oktett::bench
