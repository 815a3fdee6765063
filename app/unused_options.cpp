#include "app/unused_options.h"

#include <fmt/format.h>

#include "app/text.h"
#include "core/error.h"
#include "io/image/image.h"

namespace oktett {

void check_target_options(const RenderArguments& arguments, const PictureTarget& target) {
  const bool exr = !target.picture.empty() && keeps_all_planes(target.picture);
  if (is_given(arguments.settings, "--cryptomatte") && !exr && !target.film)
    throw Error("--cryptomatte needs an EXR file, the only one that holds mattes; expected -o FILE.exr");
  if (arguments.denoise && target.film)
    throw Error("--denoise: a film keeps the noise; expected it at oktett merge, which makes the picture");
  const bool shows = !arguments.show.empty() || !arguments.display_server.empty();
  if (arguments.denoise && target.picture.empty() && !shows)
    throw Error("--denoise: there is no picture to smooth; expected --outfile or --show");
  if (!shows) warn_of_unused_tone(arguments.settings, target.picture);
}

void warn_of_unused_tone(const SettingWords& words, const std::string& picture) {
  if (picture.empty() || !keeps_light(picture)) return;
  for (const char* option : {"--tone", "--exposure"})
    if (is_given(words, option))
      say("warning: {} has no effect on EXR and HDR files, which keep the light\n", option);
}

void check_light_options(const RenderArguments& arguments, Scene& scene) {
  const IntegratorSettings& settings = scene.integrator;
  const auto given = [&](const char* option) { return is_given(arguments.settings, option); };
  if (arguments.caustics && !traits(settings.kind).traces_paths)
    throw Error("--caustics needs the integrator 'path'");
  if (given("--max-spp") && settings.error == 0)
    throw Error("--max-spp is for adaptive sampling; expected --error, too, or 'error' in the scene");
  const bool asked = given("--max-spp") || given("--spp") || given("--error");
  if (!asked || settings.error == 0) return;
  if (settings.max_samples < settings.samples)
    throw Error(fmt::format("--max-spp: {} is less than the {} samples that every pixel gets first (--spp)",
                            settings.max_samples, settings.samples));
  if (settings.max_samples / settings.samples >= 2) return;
  Warning& warning = scene.warnings.emplace_back();
  warning.message =
      fmt::format("--error has no effect: after {} samples the next step is {}, but --max-spp is {}",
                  settings.samples, 2 * std::uint64_t{settings.samples}, settings.max_samples);
}

}  // namespace oktett
