#include "app/setting_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <type_traits>
#include <utility>

#include "app/text.h"
#include "core/error.h"

namespace oktett {
namespace {

struct SettingOption {
  const char* name;
  std::string_view key;  ///< of the setting in a scene's `film` or `integrator`
  const char* value;     ///< the word for its value in the help text; not of flags
  const char* help;
};

/// Its words stand for two settings.
constexpr const char* kSize = "--size";

/// In the order of the help text.
constexpr SettingOption kOptions[] = {
    {"--spp", "samples", "N", "Samples per pixel"},
    {kSize, "", "WxH", "Size of the full frame in pixels"},
    {"--cropwindow", "crop", "x0,x1,y0,y1", "Part of the frame to render, as fractions of it"},
    {"--seed", "seed", "N", "Seed of the random numbers"},
    {"--integrator", "kind", "K", "What is computed for a pixel"},
    {"--filter", "filter", "K", "Filter of pixels"},
    {"--tone", "tone", "K", "Tone curve of 8-bit pictures"},
    {"--exposure", "exposure", "STOPS", "Exposure of 8-bit pictures"},
    {"--clamp", "clamp", "RADIANCE",
     "Darken samples that are brighter; loses light, but removes bright dots"},
    {"--error", "error", "E",
     "Adaptive sampling: up to --max-spp samples where the relative error is greater than E"},
    {"--max-spp", "max_samples", "N", "Most samples per pixel of adaptive sampling"},
    {"--cryptomatte", "cryptomatte", "", "Also write mattes of objects and materials (EXR only)"}};

/// Calls act(parameter, value) for each setting.
template <class Act>
class SettingVisitor : public ParameterVisitor<SettingVisitor<Act>> {
 public:
  explicit SettingVisitor(Act act) : act_(std::move(act)) {}
  bool visit(const Parameter& parameter, auto& value) { return act_(parameter, value); }

 private:
  Act act_;
};

template <class Act>
void each_setting(Film& film, IntegratorSettings& integrator, Act act) {
  SettingVisitor<Act> visitor(std::move(act));
  film.describe(visitor);
  integrator.describe(visitor);
}

/// Adds an option as the type of its setting asks for.
void add_option(Verb& verb, const SettingOption& option, SettingWords& words) {
  SettingWord& word = words[option.name];
  if (option.key.empty()) verb.option(option.name, &word.text, option.value, option.help);
  Film film;
  IntegratorSettings integrator;
  each_setting(film, integrator, [&]<class T>(const Parameter& parameter, T& setting) {
    if (parameter.key != option.key) return false;
    if constexpr (std::is_same_v<T, bool>)
      verb.flag(option.name, word.flag, option.help);
    else if constexpr (std::is_integral_v<T>)
      verb.number(option.name, word.text, option.value, option.help);
    else if constexpr (requires { setting.choices; })
      verb.choice(option.name, word.text, option.value, option.help, names_of(setting.choices));
    else
      verb.option(option.name, &word.text, option.value, option.help);
    return false;
  });
}

void parse_size(const std::string& text, Film& film) {
  const std::size_t cross = text.find('x');
  const bool good = cross != std::string::npos && parse_number(text.substr(0, cross), film.width) &&
                    parse_number(text.substr(cross + 1), film.height);
  if (!good) throw Error(fmt::format("--size: '{}' is not of the form WxH, e.g. 960x540", text));
  const bool fits = kFilmSides.contains(film.width) && kFilmSides.contains(film.height) &&
                    std::uint64_t{film.width} * film.height <= kMostFilmPixels;
  if (!fits)
    throw Error(fmt::format("--size: {} is out of range; expected sides of 1 to {} and at most {} pixels",
                            text, kMostFilmSide, kMostFilmPixels));
}

void parse_crop(const std::string& text, double (&crop)[4]) {
  std::string_view rest = text;
  bool good = true;
  for (int i = 0; i < 4; ++i) {
    const std::size_t comma = rest.find(',');
    good = good && parse_number(rest.substr(0, comma), crop[i]) && kUnitInterval.contains(crop[i]);
    good = good && (comma == std::string_view::npos) == (i == 3);
    rest = comma == std::string_view::npos ? std::string_view{} : rest.substr(comma + 1);
  }
  if (!good || crop[0] >= crop[1] || crop[2] >= crop[3])
    throw Error(fmt::format(
        "--cropwindow: '{}' is not of the form x0,x1,y0,y1 with 0 <= x0 < x1 <= 1 and 0 <= y0 < y1 <= 1",
        text));
}

/// The number of that word for an option.
template <class T>
T checked_number(const char* option, const std::string& text, const Range& range) {
  T number{};
  if (!parse_number(text, number)) throw Error(fmt::format("{}: '{}' is no number", option, text));
  if (!std::isfinite(static_cast<double>(number)) || !range.contains(number))
    throw Error(fmt::format("{}: {} is out of range; expected {} to {}", option, text, range.lo, range.hi));
  return number;
}

}  // namespace

bool is_given(const SettingWords& words, std::string_view option) {
  const auto found = words.find(option);
  return found != words.end() && (found->second.flag || !found->second.text.empty());
}

void add_setting_options(Verb& verb, SettingWords& words) {
  for (const SettingOption& option : kOptions) add_option(verb, option, words);
}

void add_setting_option(Verb& verb, std::string_view name, SettingWords& words) {
  add_option(verb, *std::ranges::find(kOptions, name, &SettingOption::name), words);
}

const char* option_of_setting(std::string_view key) {
  const auto* const option = std::ranges::find(kOptions, key, &SettingOption::key);
  return option == std::end(kOptions) ? nullptr : option->name;
}

void override_settings(const SettingWords& words, Scene& scene) {
  if (is_given(words, kSize)) parse_size(words.at(kSize).text, scene.film);
  each_setting(scene.film, scene.integrator, [&]<class T>(const Parameter& parameter, T& setting) {
    const char* const option = option_of_setting(parameter.key);
    if (option == nullptr || !is_given(words, option)) return false;
    const std::string& text = words.at(option).text;
    if constexpr (std::is_same_v<T, bool>)
      setting = true;
    else if constexpr (std::is_arithmetic_v<T>)
      setting = checked_number<T>(option, text, parameter.range);
    else if constexpr (requires { setting.choices; })
      setting.value = choice_of(option, text, setting.choices);
    else if constexpr (std::is_array_v<T>)
      parse_crop(text, setting);
    return true;
  });
}

}  // namespace oktett
