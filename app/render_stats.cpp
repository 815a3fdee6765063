#include "app/render_stats.h"

#include <fmt/format.h>

#include <cstdio>
#include <vector>

#include "app/command_line.h"
#include "app/json.h"
#include "app/text.h"

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

/// "load 0.012 s, build 0.345 s, render 1.23 s (12.3 Mrays/s), write 0.056 s".
std::string times_text(const StageTimes& times, const RenderReport& report) {
  const std::string photons =
      report.photon_seconds > 0 ? fmt::format("photons {}, ", duration_text(report.photon_seconds)) : "";
  const std::string denoised =
      times.denoise > 1e-3 ? fmt::format(", denoise {}", duration_text(times.denoise)) : "";
  return fmt::format("load {}, build {}, {}render {} ({}rays/s){}, write {}", duration_text(times.load),
                     duration_text(times.build), photons, duration_text(times.render),
                     with_prefix(rays_per_second(report)), denoised, duration_text(times.write));
}

/// part / whole, 0 for 0 / 0.
double share(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

/// A number for each bounce.
template <class Of>
std::vector<double> by_bounce(const RenderReport& report, const Of& of) {
  std::vector<double> values;
  for (const BounceReport& b : report.bounces) values.push_back(of(b));
  return values;
}

/// A table of counts, one per line.
std::string stats_text(const StageTimes& times, const RenderReport& report) {
  std::string text;
  const auto line = [&](const char* name, const std::string& value) {
    text += fmt::format("{:<20}{:>16}\n", name, value);
  };
  line("rays", grouped(rays_of(report)));
  line("  camera", grouped(report.camera_rays));
  line("  shadow", grouped(report.shadow_rays));
  line("  reflected", grouped(report.reflected_rays));
  line("  refracted", grouped(report.refracted_rays));
  for (std::size_t i = 0; i < report.bounces.size(); ++i) {
    const BounceReport& b = report.bounces[i];
    text += fmt::format("  bounce {:<11}{:>16} in batches of {:.0f}, {} shadow rays", i, grouped(b.rays),
                        share(b.rays, b.batches), grouped(b.shadow_rays));
    text += b.lanes > 0 ? fmt::format(", {:.0f} % of shading lanes filled\n", 100 * share(b.shaded, b.lanes))
                        : "\n";
  }
  line("triangles", grouped(report.triangles));
  line("primitives", grouped(report.primitives));
  line("geometry", bytes_text(report.geometry_bytes));
  line("bvh", bytes_text(report.bvh_bytes));
  line("bytes per triangle", fmt::format("{:.1f}", bytes_per_triangle(report)));
  line("sah cost", fmt::format("{:.2f}", report.sah_cost));
  line("bad samples", grouped(report.bad_samples));
  line("given up", grouped(times.given_up));
  return text;
}

/// The same counts and the times as one JSON object on one line. `output` is the picture that was written.
std::string stats_json(const StageTimes& times, const RenderReport& report, const std::string& output) {
  const JsonObject seconds{
      {"load", times.load}, {"build", times.build}, {"render", times.render}, {"write", times.write}};
  const JsonObject rays{{"camera", report.camera_rays},
                        {"shadow", report.shadow_rays},
                        {"reflected", report.reflected_rays},
                        {"refracted", report.refracted_rays},
                        {"total", rays_of(report)}};
  const auto number = [](std::uint64_t BounceReport::*count) {
    return [count](const BounceReport& b) { return static_cast<double>(b.*count); };
  };
  const JsonObject bounces{
      {"rays", by_bounce(report, number(&BounceReport::rays))},
      {"shadow_rays", by_bounce(report, number(&BounceReport::shadow_rays))},
      {"batches", by_bounce(report, number(&BounceReport::batches))},
      {"lanes_filled", by_bounce(report, [](const BounceReport& b) { return share(b.shaded, b.lanes); })}};
  const JsonObject all{{"output", output},
                       {"seconds", seconds},
                       {"rays", rays},
                       {"rays_per_second", rays_per_second(report)},
                       {"bounces", bounces},
                       {"triangles", report.triangles},
                       {"primitives", report.primitives},
                       {"geometry_bytes", report.geometry_bytes},
                       {"bvh_bytes", report.bvh_bytes},
                       {"bytes_per_triangle", bytes_per_triangle(report)},
                       {"sah_cost", report.sah_cost},
                       {"bad_samples", report.bad_samples},
                       {"given_up", times.given_up},
                       {"stopped", report.stopped}};
  return all.text();
}

}  // namespace

void print_summary(const RenderArguments& arguments, const StageTimes& times, const RenderReport& report,
                   const std::string& output) {
  const bool json = arguments.stats == "json";
  if (arguments.stats == "text") fmt::print("{}", stats_text(times, report));
  if (json) fmt::print("{}\n", stats_json(times, report, output));
  const std::string end = fmt::format("{}\n{}", times_text(times, report),
                                      output.empty() ? "" : fmt::format("wrote {}\n", output));
  // With --stats=json standard output holds nothing but JSON.
  if (!arguments.quiet && json) say("{}", end);
  if (!arguments.quiet && !json) fmt::print("{}", end);
  std::fflush(stdout);
  if (report.bad_samples > 0)
    say("warning: {} samples were NaN or infinite and were left out\n", report.bad_samples);
  if (times.given_up > 0)
    say("warning: {} times, finding where a ray meets a surface took too many steps and was given up\n",
        times.given_up);
}

}  // namespace oktett
