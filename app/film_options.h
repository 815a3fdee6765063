#pragma once
/// \file Options of `oktett render` that say how samples become pixels and pixels become files.

#include <cstdint>
#include <optional>
#include <string>

#include "app/command_line.h"
#include "render/scene.h"

namespace oktett {

/// The words of the command line, not checked yet. Empty: what the scene says.
struct FilmArguments {
  std::string filter, tone, exposure, clamp, error;
  std::optional<std::uint32_t> max_samples;
  bool denoise = false, cryptomatte = false;
};

void add_tone_option(Verb& verb, std::string& tone);
void add_film_options(Verb& verb, FilmArguments& arguments);

/// Throws Error if the number that is given for `option` is out of range.
void expect_in_range(const char* option, std::uint32_t number, const Range& range);

/// Overrides settings of the scene by the arguments. Throws Error for unknown words and numbers out of range.
void override_film(const FilmArguments& arguments, Scene& scene);

}  // namespace oktett
