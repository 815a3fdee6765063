#include "app/film_options.h"

#include <fmt/format.h>

#include <cmath>
#include <span>
#include <string_view>

#include "app/command_line.h"
#include "app/text.h"
#include "core/error.h"

namespace oktett {
namespace {

/// Reads the value of `option` if there is one.
void read_number(const char* option, std::string_view text, const Range& range, double& value) {
  if (text.empty()) return;
  double number = 0;
  if (!parse_number(text, number)) throw Error(fmt::format("{}: '{}' is no number", option, text));
  if (!std::isfinite(number) || !range.contains(number))
    throw Error(fmt::format("{}: {} is out of range; expected {} to {}", option, text, range.lo, range.hi));
  value = number;
}

}  // namespace

void expect_in_range(const char* option, std::uint32_t number, const Range& range) {
  if (!range.contains(number))
    throw Error(fmt::format("{}: {} is out of range; expected {} to {}", option, number, range.lo, range.hi));
}

void add_tone_option(Verb& verb, std::string& tone) {
  verb.choice("--tone", tone, "K", "Tone curve of 8-bit pictures", names_of<ToneKind>(kToneKinds));
}

void add_film_options(Verb& verb, FilmArguments& a) {
  verb.choice("--filter", a.filter, "K", "Filter of pixels", names_of<FilterKind>(kFilterKinds));
  add_tone_option(verb, a.tone);
  verb.option("--exposure", &a.exposure, "STOPS", "Exposure of 8-bit pictures");
  verb.option("--clamp", &a.clamp, "RADIANCE",
              "Darken samples that are brighter; loses light, but removes bright dots");
  verb.option("--error", &a.error, "E",
              "Adaptive sampling: up to --max-spp samples where the relative error is greater than E");
  verb.option("--max-spp", &a.max_samples, "N", "Most samples per pixel of adaptive sampling");
  verb.flag("--cryptomatte", a.cryptomatte, "Also write mattes of objects and materials (EXR only)");
  verb.flag("--denoise", a.denoise, "Smooth the noise of the finished picture");
}

void override_film(const FilmArguments& a, Scene& scene) {
  Film& film = scene.film;
  if (!a.filter.empty()) {
    film.filter = choice_of<FilterKind>("--filter", a.filter, kFilterKinds);
    film.filter_radius = 0;
  }
  if (!a.tone.empty()) film.tone.kind = choice_of<ToneKind>("--tone", a.tone, kToneKinds);
  read_number("--exposure", a.exposure, kExposures, film.tone.exposure);
  read_number("--clamp", a.clamp, kNonNegative, scene.integrator.clamp);
  read_number("--error", a.error, kErrors, scene.integrator.error);
  if (a.cryptomatte) film.cryptomatte = true;
  if (!a.max_samples) return;
  expect_in_range("--max-spp", *a.max_samples, kPixelSamples);
  scene.integrator.max_samples = *a.max_samples;
}

}  // namespace oktett
