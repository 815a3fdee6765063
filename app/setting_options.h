#pragma once
/// \file Options of `oktett render` that override settings of the film and the integrator. Each is a row of
/// setting_options.cpp. Its values and limits come from the description of the setting (core/description.h).

#include <map>
#include <string>
#include <string_view>

#include "app/command_line.h"
#include "render/scene.h"

namespace oktett {

/// What the command line says of an option.
struct SettingWord {
  std::string text;   ///< not checked yet; empty: not given
  bool flag = false;  ///< given, of those that take no value
};
/// By the names of options.
using SettingWords = std::map<std::string, SettingWord, std::less<>>;

bool is_given(const SettingWords& words, std::string_view option);

/// Adds all such options, or one of them.
void add_setting_options(Verb& verb, SettingWords& words);
void add_setting_option(Verb& verb, std::string_view name, SettingWords& words);

/// The option that overrides the setting of that key of scene files; null: there is none.
const char* option_of_setting(std::string_view key);

/// Overrides settings of the scene by the words. Throws Error for unknown words and numbers out of range.
void override_settings(const SettingWords& words, Scene& scene);

}  // namespace oktett
