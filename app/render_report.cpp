#include "app/render_report.h"

#include <fmt/format.h>

#include <cstdint>

#include "app/json.h"
#include "app/units.h"

namespace oktett {

namespace {

std::uint64_t rays_of(const RenderReport& r) {
  return r.camera_rays + r.shadow_rays + r.reflected_rays + r.refracted_rays;
}

double rays_per_second(const RenderReport& report) {
  return report.render_seconds > 0 ? static_cast<double>(rays_of(report)) / report.render_seconds : 0;
}

double bytes_per_triangle(const RenderReport& report) {
  const double bytes = static_cast<double>(report.geometry_bytes) + static_cast<double>(report.bvh_bytes);
  return report.triangles > 0 ? bytes / static_cast<double>(report.triangles) : 0;
}

}  // namespace

std::string times_text(const StageTimes& times, const RenderReport& report) {
  return fmt::format("load {}, build {}, render {} ({}rays/s), write {}", duration_text(times.load),
                     duration_text(times.build), duration_text(times.render),
                     with_prefix(rays_per_second(report)), duration_text(times.write));
}

std::string stats_text(const RenderReport& report) {
  std::string text;
  const auto line = [&](const char* name, const std::string& value) {
    text += fmt::format("{:<20}{:>16}\n", name, value);
  };
  line("rays", grouped(rays_of(report)));
  line("  camera", grouped(report.camera_rays));
  line("  shadow", grouped(report.shadow_rays));
  line("  reflected", grouped(report.reflected_rays));
  line("  refracted", grouped(report.refracted_rays));
  line("triangles", grouped(report.triangles));
  line("primitives", grouped(report.primitives));
  line("geometry", bytes_text(report.geometry_bytes));
  line("bvh", bytes_text(report.bvh_bytes));
  line("bytes per triangle", fmt::format("{:.1f}", bytes_per_triangle(report)));
  line("sah cost", fmt::format("{:.2f}", report.sah_cost));
  line("bad samples", grouped(report.bad_samples));
  return text;
}

std::string stats_json(const StageTimes& times, const RenderReport& report, const std::string& output) {
  JsonObject seconds;
  seconds.add("load", times.load);
  seconds.add("build", times.build);
  seconds.add("render", times.render);
  seconds.add("write", times.write);
  JsonObject rays;
  rays.add("camera", report.camera_rays);
  rays.add("shadow", report.shadow_rays);
  rays.add("reflected", report.reflected_rays);
  rays.add("refracted", report.refracted_rays);
  rays.add("total", rays_of(report));
  JsonObject all;
  all.add("output", output);
  all.add("seconds", seconds);
  all.add("rays", rays);
  all.add("rays_per_second", rays_per_second(report));
  all.add("triangles", report.triangles);
  all.add("primitives", report.primitives);
  all.add("geometry_bytes", report.geometry_bytes);
  all.add("bvh_bytes", report.bvh_bytes);
  all.add("bytes_per_triangle", bytes_per_triangle(report));
  all.add("sah_cost", report.sah_cost);
  all.add("bad_samples", report.bad_samples);
  all.add("stopped", report.stopped);
  return all.text();
}

}  // namespace oktett
