#include "io/ply/attributes.h"

#include <algorithm>
#include <array>
#include <string>

#include "io/image/color.h"

namespace oktett {

void PlyExtra::place(TriangleMesh& mesh) {
  if (meaning == PlyMeaning::slot) {
    slots = mesh.material_slots.data();
    return;
  }
  MeshAttribute& a = mesh.attributes[attribute];
  step = a.components;
  if (!a.floats.empty()) floats = a.floats.data() + component;
  if (!a.srgb.empty()) bytes = a.srgb.data() + component;
}

void PlyExtra::put_other(std::uint64_t i, double x) const {
  if (meaning == PlyMeaning::slot) {
    slots[i] = x >= 0 && x < textures ? static_cast<std::uint16_t>(x) : textures;
    return;
  }
  if (meaning == PlyMeaning::srgb) {
    floats[i * step] = srgb_to_linear(x > 0 ? static_cast<float>(x) : 0);
    return;
  }
  const double most = meaning == PlyMeaning::srgb8 || meaning == PlyMeaning::part8 ? 255 : 65535;
  const auto part = static_cast<float>(x > 0 ? std::min(x / most, 1.0) : 0);
  const bool curve = meaning == PlyMeaning::srgb8 || meaning == PlyMeaning::srgb16;
  floats[i * step] = curve ? srgb_to_linear(part) : part;
}

namespace {

using Names = std::array<const char*, 4>;
constexpr Names kColorNames[] = {{"red", "green", "blue", "alpha"},
                                 {"diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"},
                                 {"r", "g", "b", "a"}};

class Choosing {
 public:
  Choosing(const PlyElement& element, std::span<const int> used, AttributeDomain domain,
           std::vector<MeshAttribute>& attributes)
      : properties_(element.properties),
        free_(properties_.size(), true),
        domain_(domain),
        attributes_(attributes) {
    for (std::size_t i = 0; i < free_.size(); ++i) free_[i] = !properties_[i].is_list;
    for (const int i : used)
      if (i != PlyElement::kNone) free_[static_cast<std::size_t>(i)] = false;
  }

  std::vector<PlyExtra> run() {
    if (!take_linear_colors())
      for (const Names& names : kColorNames)
        if (take_colors(names)) break;
    for (std::size_t i = 0; i < properties_.size(); ++i)
      if (free_[i]) take_numbers(i);
    return std::move(extras_);
  }

 private:
  /// The free property of that name, or the number of properties.
  std::size_t find(std::string_view name) const {
    for (std::size_t i = 0; i < properties_.size(); ++i)
      if (free_[i] && properties_[i].name == name) return i;
    return properties_.size();
  }

  /// Those in linear floats, in place of the bytes beside them.
  bool take_linear_colors() {
    std::size_t at = properties_.size();
    for (const char separator : kPlyComponents)
      at = std::min(at, find(std::string(kColorAttribute) + separator + "0"));
    if (at == properties_.size()) return false;
    take_numbers(at);
    for (const char* name : kColorNames[0])
      if (const std::size_t i = find(name); i != properties_.size()) free_[i] = false;
    return true;
  }

  bool take_colors(const Names& names) {
    std::array<std::size_t, 4> at{};
    for (std::size_t k = 0; k < 4; ++k) at[k] = find(names[k]);
    if (std::max({at[0], at[1], at[2]}) == properties_.size()) return false;
    const std::uint32_t components = at[3] == properties_.size() ? 3 : 4;
    // Few write whole numbers of more than 8 bits, and then mean these.
    const auto is_byte = [&](std::size_t i) {
      return is_whole(properties_[i].type) && properties_[i].type != PlyType::uint16;
    };
    const bool bytes = std::all_of(at.begin(), at.begin() + components, is_byte);
    const std::size_t attribute = add(kColorAttribute, components);
    if (attribute == kNone) return false;
    for (std::uint32_t k = 0; k < components; ++k) {
      const PlyType type = properties_[at[k]].type;
      PlyMeaning meaning = PlyMeaning::byte;
      if (!bytes && !is_whole(type)) meaning = k < 3 ? PlyMeaning::srgb : PlyMeaning::number;
      if (!bytes && is_byte(at[k])) meaning = k < 3 ? PlyMeaning::srgb8 : PlyMeaning::part8;
      if (!bytes && type == PlyType::uint16) meaning = k < 3 ? PlyMeaning::srgb16 : PlyMeaning::part16;
      take(at[k], attribute, k, meaning);
    }
    return true;
  }

  /// A property, and those behind it that are further components.
  void take_numbers(std::size_t first) {
    const std::string_view name = properties_[first].name;
    std::size_t count = 1;
    if (name.size() > 2 && name.back() == '0' &&
        kPlyComponents.find(name[name.size() - 2]) != kPlyComponents.npos) {
      std::string next(name);
      while (first + count < properties_.size() && free_[first + count]) {
        next.back() = static_cast<char>('0' + count);
        if (count > 9 || properties_[first + count].name != next) break;
        ++count;
      }
    }
    const bool is_vector = count > 1 && count <= 4;
    if (!is_vector) count = 1;
    const std::size_t attribute =
        add(is_vector ? name.substr(0, name.size() - 2) : name, static_cast<std::uint32_t>(count));
    if (attribute == kNone) return;
    for (std::size_t k = 0; k < count; ++k)
      take(first + k, attribute, static_cast<std::uint32_t>(k), PlyMeaning::number);
  }

  /// The index of a new attribute, or kNone if its name is taken.
  std::size_t add(std::string_view name, std::uint32_t components) {
    const auto taken = [&](std::string_view n) {
      return std::ranges::find(attributes_, n, &MeshAttribute::name) != attributes_.end();
    };
    MeshAttribute attribute;
    attribute.name = name;
    if (taken(attribute.name)) attribute.name = "face_" + attribute.name;
    if (taken(attribute.name) || (domain_ == AttributeDomain::vertex && attribute.name != name)) return kNone;
    attribute.domain = domain_;
    attribute.components = components;
    attributes_.push_back(std::move(attribute));
    return attributes_.size() - 1;
  }

  void take(std::size_t property, std::size_t attribute, std::uint32_t component, PlyMeaning meaning) {
    free_[property] = false;
    extras_.push_back({.property = static_cast<int>(property),
                       .meaning = meaning,
                       .attribute = static_cast<std::uint32_t>(attribute),
                       .component = component});
  }

  static constexpr std::size_t kNone = ~std::size_t{0};
  const std::vector<PlyProperty>& properties_;
  std::vector<bool> free_;
  const AttributeDomain domain_;
  std::vector<MeshAttribute>& attributes_;
  std::vector<PlyExtra> extras_;
};

}  // namespace

std::vector<PlyExtra> choose_attributes(const PlyElement& element, std::span<const int> used,
                                        AttributeDomain domain, std::vector<MeshAttribute>& attributes) {
  return Choosing(element, used, domain, attributes).run();
}

}  // namespace oktett
