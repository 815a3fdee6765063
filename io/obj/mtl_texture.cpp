#include "io/obj/mtl_texture.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "io/mesh/reading.h"
#include "io/obj/names.h"
#include "io/text/number.h"

namespace oktett {

MtlLine::MtlLine(const char* p, const std::string& path, LineCounter& lines, std::vector<Warning>& warnings)
    : start_(p), next_(p), path_(path), lines_(lines), warnings_(warnings), keyword_(take()) {
  for (char& c : keyword_)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
}

std::string_view MtlLine::peek() const { return word_at(next_word(next_)); }

std::string_view MtlLine::take() {
  const std::string_view word = peek();
  next_ = word.data() + word.size();
  return word;
}

std::string MtlLine::take_rest() {
  // Unlike elsewhere, a `#` may be part of a name.
  next_ = skip_blanks(next_);
  std::string rest;
  for (;;) {
    const LineShape line = measure_line(next_);
    const bool joint = line.end > next_ && line.ends_in_joint();
    rest += trimmed(next_, line.end - (joint ? 1 : 0));
    next_ = line.end;
    if (!joint || *line.end == '\0') return rest;
    next_ = skip_line_end(line.end);
    rest += ' ';
  }
}

bool MtlLine::has_more_than_one_word() const { return count_words(next_) > 1; }

std::optional<float> MtlLine::take_number_if_any() {
  const char* p = next_word(next_);
  NumberProblem problem = NumberProblem::none;
  float value = 0;
  const char* end = is_line_end(*p) ? nullptr : scan_float(p, value, problem);
  if (end == nullptr || !std::isfinite(value)) return std::nullopt;
  next_ = end;
  return value;
}

std::optional<float> MtlLine::take_number() {
  const std::optional<float> value = take_number_if_any();
  if (value) return value;
  const std::string_view word = peek();
  warn(word.empty() ? "expected a number, found the end of the line"
                    : "expected a finite number, found " + quote_word(word.data()));
  return std::nullopt;
}

std::optional<Color> MtlLine::take_color() {
  const std::string_view word = peek();
  if (word == "spectral" || word == "xyz") {
    warn(quote_name(word) + " colours are not supported; the default is kept");
    return std::nullopt;
  }
  const std::optional<float> r = take_number();
  if (!r) return std::nullopt;
  const bool grey = peek().empty();
  const std::optional<float> g = grey ? r : take_number();
  const std::optional<float> b = grey ? r : g ? take_number() : std::nullopt;
  if (!b) return std::nullopt;
  if (*r >= 0 && *g >= 0 && *b >= 0) return Color{*r, *g, *b};
  warn("a colour has a negative part; it counts as 0");
  return max(Color{*r, *g, *b}, Color{0, 0, 0});
}

Location MtlLine::where() const {
  const TextPosition line = lines_.at(start_);
  return {path_, line.line, line.column};
}

void MtlLine::warn(const std::string& message) const {
  // Past the end of the keyword, so that the position is where reading stopped.
  const TextPosition line = lines_.at(start_);
  const char* p = next_word(next_);
  const int column = p >= start_ ? line.column + static_cast<int>(p - start_) : line.column;
  warnings_.push_back({Location{path_, line.line, column}, message});
}

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
                                                                     {"m", ImageChannel::alpha},
                                                                     {"l", ImageChannel::luminance}};
  const std::string_view word = line.peek();
  for (const auto& [name, value] : kChannels)
    if (word == name) channel = value;
  if (word == "z")
    line.warn("the channel 'z' is not supported; expected r, g, b, m or l");
  else if (std::ranges::none_of(kChannels, [&](const auto& known) { return known.first == word; }))
    line.warn("unknown channel " + quote_name(std::string(word)) + "; expected r, g, b, m or l");
  line.take();
}

/// `-colorspace`, which is no part of the format: how the colours are encoded.
void read_color_space(MtlLine& line, TextureColors& colors) {
  std::string name(line.take());
  for (char& c : name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  constexpr std::string_view kLinear[] = {"linear", "lin_rec709", "non-color", "noncolor", "raw", "none"};
  if (name == "srgb" || name == "srgb_texture")
    colors = TextureColors::srgb;
  else if (std::ranges::find(kLinear, name) != std::end(kLinear))
    colors = TextureColors::linear;
  else
    line.warn("unknown colour space " + quote_name(name) + "; expected sRGB or linear");
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
  } else if (name == "-colorspace") {
    read_color_space(line, texture.color_space);
  } else if (name == "-clamp") {
    texture.lookup = line.take() == "on" ? kClampedTexture : TextureLookup{};
  } else if (name == "-blendu" || name == "-blendv" || name == "-cc" || name == "-boost" ||
             name == "-texres" || name == "-type") {
    line.take();
  } else {
    return false;
  }
  return true;
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

std::optional<MtlTexture> read_mtl_texture(MtlLine& line, const std::string& directory,
                                           ImageChannel channel) {
  MtlTexture result;
  result.texture.channel = channel;
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
  result.texture.path = find_named_file(directory, name);
  return result;
}

}  // namespace oktett
