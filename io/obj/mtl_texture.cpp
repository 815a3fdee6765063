#include "io/obj/mtl_texture.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "io/mesh/failure.h"

namespace oktett {
namespace {

/// One to three numbers; those left out keep their value. The last word of the line is the file name, even if
/// it looks like a number.
void read_up_to_three(MtlLine& line, Vec3f& v) {
  for (int i = 0; i < 3 && line.has_more_than_one_word(); ++i) {
    const std::optional<float> x = i == 0 ? line.take_number() : line.take_number_if_any();
    if (!x) return;
    v[i] = *x;
  }
}

void read_option_number(MtlLine& line, float& value) {
  if (const std::optional<float> x = line.take_number()) value = *x;
}

/// `-imfchan`: the channel that a number is taken from.
void read_channel(MtlLine& line, ImageChannel& channel) {
  constexpr std::pair<std::string_view, ImageChannel> kChannels[] = {{"r", ImageChannel::red},
                                                                     {"g", ImageChannel::green},
                                                                     {"b", ImageChannel::blue},
                                                                     {"m", ImageChannel::alpha}};
  const std::string_view word = line.peek();
  for (const auto& [name, value] : kChannels)
    if (word == name) channel = value;
  if (word == "l" || word == "z")
    line.warn("the channel '" + std::string(word) + "' is not supported; expected r, g, b or m");
  else if (std::ranges::none_of(kChannels, [&](const auto& known) { return known.first == word; }))
    line.warn("unknown channel " + quote_name(std::string(word)) + "; expected r, g, b or m");
  line.take();
}

/// Reads the option that was taken from the line. False if its name is unknown.
bool read_option(const std::string& name, MtlLine& line, MtlTexture& result) {
  Texture& texture = result.texture;
  if (name == "-o") {
    read_up_to_three(line, texture.offset);
  } else if (name == "-s") {
    read_up_to_three(line, texture.scale);
  } else if (name == "-t") {
    Vec3f turbulence;
    read_up_to_three(line, turbulence);
  } else if (name == "-mm") {
    read_option_number(line, texture.base);
    read_option_number(line, texture.gain);
  } else if (name == "-bm") {
    read_option_number(line, result.bump_scale);
  } else if (name == "-imfchan") {
    read_channel(line, texture.channel);
  } else if (name == "-clamp") {
    texture.clamp = line.take() == "on";
  } else if (name == "-blendu" || name == "-blendv" || name == "-cc" || name == "-boost" ||
             name == "-texres" || name == "-type") {
    line.take();
  } else {
    return false;
  }
  return true;
}

std::string resolve(const std::string& directory, std::string name) {
  const auto join = [&directory](const std::string& n) {
    return (std::filesystem::path(directory) / n).string();
  };
  const std::string path = join(name);
  std::error_code error;
  if (name.find('\\') == std::string::npos || std::filesystem::exists(path, error)) return path;
  std::replace(name.begin(), name.end(), '\\', '/');
  return join(name);
}

}  // namespace

TextureList::TextureList(std::vector<Texture>& textures) : textures_(textures) {
  for (std::size_t i = 0; i < textures.size(); ++i)
    by_path_.emplace(textures[i].path, static_cast<std::uint32_t>(i));
}

std::uint32_t TextureList::add(const Texture& texture) {
  const auto [begin, end] = by_path_.equal_range(texture.path);
  for (auto it = begin; it != end; ++it)
    if (textures_[it->second] == texture) return it->second;
  const auto index = static_cast<std::uint32_t>(textures_.size());
  textures_.push_back(texture);
  by_path_.emplace(texture.path, index);
  return index;
}

std::optional<MtlTexture> read_mtl_texture(MtlLine& line, const std::string& directory) {
  MtlTexture result;
  while (line.peek().starts_with('-') && line.has_more_than_one_word()) {
    const std::string option(line.peek());
    if (option.find('.') != std::string::npos) break;  // a file name after all
    line.take();
    if (!read_option(option, line, result)) line.warn("unknown texture option " + quote_name(option));
  }
  const std::string name = line.take_rest();
  if (name.empty()) {
    line.warn("expected the name of a texture file");
    return std::nullopt;
  }
  result.texture.path = resolve(directory, name);
  return result;
}

}  // namespace oktett
