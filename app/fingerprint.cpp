#include "app/fingerprint.h"

#include <fmt/format.h>

#include <filesystem>

namespace oktett {

static const char* filter_name(FilterKind kind) {
  for (const Choice<FilterKind>& known : kFilterKinds)
    if (known.value == kind) return known.name;
  return "";
}

FilmFingerprint fingerprint_of(const Scene& scene, const std::vector<std::string>& files,
                               const RenderArguments& arguments, bool data_layers) {
  FilmFingerprint fingerprint;
  const auto add = [&](const char* name, const auto& value) {
    fingerprint.settings.emplace_back(name, fmt::format("{}", value));
  };
  const Film& film = scene.film;
  const IntegratorSettings& integrator = scene.integrator;
  add("the version", program_version());
  add("--size", fmt::format("{}x{}", film.width, film.height));
  add("--cropwindow", fmt::format("{},{},{},{}", film.crop[0], film.crop[1], film.crop[2], film.crop[3]));
  add("--integrator", to_string(integrator.kind));
  add("--spp", integrator.samples);
  add("--seed", integrator.seed);
  add("the depth", integrator.depth);
  add("--clamp", integrator.clamp);
  add("--error", integrator.error);
  if (integrator.error > 0) add("--max-spp", integrator.max_samples);
  add("--filter", filter_name(film.filter));
  add("the radius of the filter", film.filter_radius);
  add("--cryptomatte", film.cryptomatte);
  add("the use of data layers", data_layers);
  add("the number of photons", integrator.caustics.photons);
  add("the number of photon passes", integrator.caustics.passes);
  add("--look", arguments.look.empty() ? "default" : arguments.look);
  add("--up", arguments.up.empty() ? "default" : arguments.up);
  add("--view", arguments.viewpoint.empty() ? "default" : arguments.viewpoint);
  for (const auto& [name, value] : parse_definitions(arguments.definitions))
    fingerprint.settings.emplace_back("-D " + name, value);
  fingerprint.files = hash_files(files, std::filesystem::path(arguments.scene).parent_path().string());
  return fingerprint;
}

}  // namespace oktett
