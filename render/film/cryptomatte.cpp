#include "render/film/cryptomatte.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <map>

#include "core/parallel.h"

namespace oktett {

std::uint32_t murmur_hash(std::string_view text) {
  const auto scrambled = [](std::uint32_t k) { return std::rotl(k * 0xcc9e2d51u, 15) * 0x1b873593u; };
  std::uint32_t hash = 0;
  std::size_t at = 0;
  for (; at + 4 <= text.size(); at += 4) {
    std::uint32_t word = 0;
    for (std::size_t k = 4; k-- > 0;) word = word << 8 | static_cast<std::uint8_t>(text[at + k]);
    hash = std::rotl(hash ^ scrambled(word), 13) * 5 + 0xe6546b64u;
  }
  std::uint32_t rest = 0;
  for (std::size_t k = text.size(); k-- > at;) rest = rest << 8 | static_cast<std::uint8_t>(text[k]);
  hash ^= scrambled(rest) ^ static_cast<std::uint32_t>(text.size());
  hash = (hash ^ hash >> 16) * 0x85ebca6bu;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
  return hash ^ hash >> 16;
}

/// The specification's uint32_to_float32: exponents of zero, subnormal and infinite numbers are flipped.
static std::uint32_t id_bits(std::string_view name) {
  const std::uint32_t hash = murmur_hash(name), exponent = hash >> 23 & 0xff;
  return exponent == 0 || exponent == 0xff ? hash ^ 1u << 23 : hash;
}

float matte_id(std::string_view name) { return std::bit_cast<float>(id_bits(name)); }

void MatteSums::add(float id) {
  for (Entry& entry : entries_)
    if (entry.id == id) {
      ++entry.count;
      return;
    }
  entries_.push_back({id, 1});
}

void MatteSums::write(Picture& picture, std::size_t first, std::size_t at, std::uint32_t samples) const {
  std::vector<Entry> sorted = entries_;
  // By id where parts are equal, so that the order of samples does not matter.
  std::sort(sorted.begin(), sorted.end(), [](const Entry& a, const Entry& b) {
    return a.count != b.count ? a.count > b.count
                              : std::bit_cast<std::uint32_t>(a.id) < std::bit_cast<std::uint32_t>(b.id);
  });
  sorted.resize(std::min<std::size_t>(sorted.size(), kMatteLevels));
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    picture.planes[first + 2 * k].values[at] = sorted[k].id;
    picture.planes[first + 2 * k + 1].values[at] =
        static_cast<float>(sorted[k].count) / static_cast<float>(samples);
  }
}

static std::string name_or(const std::string& name, const char* kind, std::size_t number) {
  return name.empty() ? fmt::format("{}{}", kind, number) : name;
}

static std::vector<std::string> object_names(const World& world) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < world.objects.size(); ++i)
    names.push_back(name_or(world.objects[i].name, "object", i));
  return names;
}

static std::vector<std::string> material_names(const World& world) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i + 1 < world.materials.size(); ++i)
    names.push_back(name_or(world.materials[i].name, "material", i));
  names.emplace_back("default");
  return names;
}

/// A JSON string.
static std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += fmt::format("\\{}", c);
    else if (static_cast<unsigned char>(c) < 0x20)
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      out += c;
  }
  return out + '"';
}

void add_matte_planes(Picture& picture) {
  const std::size_t size = static_cast<std::size_t>(picture.width) * picture.height;
  for (const char* layer : {kObjectLayer, kMaterialLayer})
    for (int k = 0; k < 2 * kMatteLevels; ++k)
      picture.planes.push_back({fmt::format("{}{:02}.{}", layer, k / 4, "RGBA"[k % 4]),
                                PlaneType::single_float,
                                filled_column(size, 0.0f),
                                {}});
}

std::size_t first_matte_plane(const Picture& picture, const char* layer) {
  const std::string name = fmt::format("{}00.R", layer);
  const auto is_first = [&](const PicturePlane& plane) { return plane.name == name; };
  return static_cast<std::size_t>(std::ranges::find_if(picture.planes, is_first) - picture.planes.begin());
}

static void add_attributes(const std::string& layer, const std::vector<std::string>& names, Mattes& mattes) {
  std::map<std::string, std::uint32_t> sorted;
  for (const std::string& name : names) sorted[name] = id_bits(name);
  std::string manifest;
  for (const auto& [name, bits] : sorted)
    manifest += fmt::format("{}{}:\"{:08x}\"", manifest.empty() ? "{" : ",", quoted(name), bits);
  manifest += manifest.empty() ? "{}" : "}";
  const std::string key = fmt::format("cryptomatte/{:.7}/", fmt::format("{:08x}", id_bits(layer)));
  mattes.attributes.push_back({key + "name", layer});
  mattes.attributes.push_back({key + "hash", "MurmurHash3_32"});
  mattes.attributes.push_back({key + "conversion", "uint32_to_float32"});
  mattes.attributes.push_back({key + "manifest", manifest});
}

static std::vector<float> ids_of(const std::vector<std::string>& names) {
  std::vector<float> ids;
  for (const std::string& name : names) ids.push_back(matte_id(name));
  return ids;
}

Mattes mattes_of(const World& world) {
  const std::vector<std::string> objects = object_names(world), materials = material_names(world);
  Mattes mattes{ids_of(objects), ids_of(materials), {}};
  add_attributes(kObjectLayer, objects, mattes);
  add_attributes(kMaterialLayer, materials, mattes);
  return mattes;
}

}  // namespace oktett
