#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>
#include <system_error>
#include <unordered_map>
#include <utility>

#include "core/error.h"
#include "io/image/contents.h"
#include "io/obj/names.h"
#include "io/obj/parsed_obj.h"
#include "render/material.h"

namespace oktett {
namespace {

namespace fs = std::filesystem;

struct Library {
  std::vector<Material> materials;
  std::vector<Texture> textures;
  MtlPlaces places;
  std::unordered_map<std::string, std::size_t> by_name, by_plain_name;
  bool complete = true;  ///< every file could be read
};

bool is_file(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

bool ends_like_library(std::string_view name) {
  constexpr std::string_view suffix = ".mtl";
  if (name.size() < suffix.size()) return false;
  const std::string_view end = name.substr(name.size() - suffix.size());
  return std::equal(end.begin(), end.end(), suffix.begin(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + ('a' - 'A') : a) == b; });
}

Library load_libraries(const std::vector<MeshStatement>& statements, const std::string& obj_path,
                       ObjFile& obj, std::vector<MeshStatement>& notices) {
  Library library;
  const std::string directory = fs::path(obj_path).parent_path().string();
  std::unordered_map<std::string, bool> seen;
  for (const MeshStatement& statement : statements) {
    for (const std::string& path : split_library_names(statement.words, directory)) {
      if (!seen.emplace(path, true).second) continue;
      try {
        load_mtl(path, library.materials, library.textures, obj.warnings, &library.places);
      } catch (const Error& error) {
        library.complete = false;
        notices.push_back(
            {statement.at, std::string(error.what()) + "; its materials are replaced by a grey one", {}});
      }
    }
  }
  // The first definition of a name counts.
  for (std::size_t i = 0; i < library.materials.size(); ++i) {
    library.by_name.emplace(library.materials[i].name, i);
    library.by_plain_name.emplace(plain_material_name(library.materials[i].name), i);
  }
  return library;
}

/// Adds the materials of the slots in their order.
class SlotMaterials {
 public:
  SlotMaterials(Library& library, ObjFile& obj, std::vector<MeshStatement>& notices)
      : library_(library), obj_(obj), notices_(notices), textures_(library.textures.size(), kNoId) {}

  void add(const MeshStatement& slot) {
    if (const std::optional<std::size_t> found = find(slot.words)) {
      Material material = library_.materials[*found];
      settle_maps(material);
      for_each_texture(material, [this](std::uint32_t& texture) { texture = take_texture(texture); });
      obj_.material_places.resize(obj_.materials.size());
      obj_.material_places.push_back(library_.places.materials[*found]);
      obj_.materials.push_back(std::move(material));
      return;
    }
    Material material;
    material.name = slot.words.empty() ? "default" : slot.words;
    obj_.materials.push_back(std::move(material));
    // Of a library that is missing, one warning is enough.
    if (slot.at == MeshStatement::kNowhere || slot.words.empty() || !library_.complete) return;
    notices_.push_back({slot.at,
                        "material " + quote_name(slot.words) + " is not defined; a grey one is used" +
                            suggestion(slot.words),
                        {}});
  }

 private:
  std::optional<std::size_t> find(const std::string& name) const {
    if (const auto found = library_.by_name.find(name); found != library_.by_name.end()) return found->second;
    const auto found = library_.by_plain_name.find(plain_material_name(name));
    return found != library_.by_plain_name.end() ? std::optional(found->second) : std::nullopt;
  }

  /// Decides what only images can say: Blender writes normal maps as `map_Bump`, and `map_d` means the alpha
  /// of an image that has some.
  void settle_maps(Material& m) {
    if (m.bump_texture != kNoId && contents_of(m.bump_texture).normals) {
      if (m.normal_texture == kNoId) m.normal_texture = m.bump_texture;
      m.bump_texture = kNoId;
      m.bump_scale = 1;
    }
    if (m.opacity_texture == kNoId || !contents_of(m.opacity_texture).alpha) return;
    Texture masked = library_.textures[m.opacity_texture];
    if (masked.channel != ImageChannel::luminance) return;
    masked.channel = ImageChannel::alpha;
    const Location place = library_.places.textures[m.opacity_texture];
    m.opacity_texture = static_cast<std::uint32_t>(library_.textures.size());
    library_.textures.push_back(std::move(masked));
    library_.places.textures.push_back(place);
    textures_.push_back(kNoId);
  }

  const ImageContents& contents_of(std::uint32_t texture) {
    const auto [entry, is_new] = contents_.try_emplace(library_.textures[texture].path);
    if (is_new) entry->second = image_contents(entry->first);
    return entry->second;
  }

  /// For the first that are not defined: a file may have many, and many materials that each is compared to.
  std::string suggestion(const std::string& name) {
    constexpr int kMost = 20;
    if (suggested_++ >= kMost) return "";
    std::vector<std::string> known;
    for (const Material& material : library_.materials) known.push_back(material.name);
    return did_you_mean(name, known);
  }

  /// Keeps only textures that some used material refers to.
  std::uint32_t take_texture(std::uint32_t texture) {
    if (texture == kNoId) return kNoId;
    if (textures_[texture] == kNoId) {
      textures_[texture] = static_cast<std::uint32_t>(obj_.textures.size());
      obj_.textures.push_back(library_.textures[texture]);
      obj_.texture_places.push_back(library_.places.textures[texture]);
    }
    return textures_[texture];
  }

  Library& library_;
  ObjFile& obj_;
  std::vector<MeshStatement>& notices_;
  std::vector<std::uint32_t> textures_;
  std::unordered_map<std::string, ImageContents> contents_;  ///< by path
  int suggested_ = 0;
};

/// Hands out slots in the order of first use.
class Slots {
 public:
  explicit Slots(std::vector<MeshStatement>& materials) : materials_(materials) {}

  /// The slot of `name`, which is the last one if it is new.
  std::size_t of(std::string_view name, std::uint64_t at) {
    const auto [entry, is_new] = by_name_.try_emplace(std::string(name), materials_.size());
    if (is_new) materials_.push_back({at, entry->first, {}});
    return entry->second;
  }

 private:
  std::vector<MeshStatement>& materials_;
  std::unordered_map<std::string, std::size_t> by_name_;
};

struct Run {
  ObjChunk* chunk;
  ObjMaterialUse use;  ///< `triangle` and `stroke` counted from the start of the file
};

/// The statements that some face, point or line follows before the next one, in order.
std::vector<Run> collect_runs(std::vector<ObjChunk>& chunks, std::uint64_t triangles, std::uint64_t strokes) {
  std::vector<Run> runs;
  const auto is_at = [](const Run& run, std::uint64_t triangle, std::uint64_t stroke) {
    return run.use.triangle == triangle && run.use.stroke == stroke;
  };
  for (ObjChunk& chunk : chunks) {
    for (ObjMaterialUse use : chunk.material_uses) {
      use.triangle += chunk.before.triangles, use.stroke += chunk.before.strokes;
      if (!runs.empty() && is_at(runs.back(), use.triangle, use.stroke)) runs.pop_back();
      runs.push_back({&chunk, use});
    }
  }
  if (!runs.empty() && is_at(runs.back(), triangles, strokes)) runs.pop_back();
  return runs;
}

}  // namespace

std::vector<std::string> split_library_names(std::string_view text, const std::string& directory) {
  if (text.empty()) return {};
  const std::string whole = find_named_file(directory, text);
  if (is_file(whole)) return {whole};
  std::vector<std::string> paths;
  text = without_comment(text);
  const auto next_blank = [&](std::size_t from) {
    std::size_t at = from;
    do {
      at = std::min(text.find_first_of(" \t", at + 1), text.size());
    } while (at < text.size() && text[at - 1] == '\\');
    return at;
  };
  std::size_t begin = 0;
  while (begin < text.size()) {
    // Up to the first blank behind `.mtl`, or all that is left.
    std::size_t end = begin;
    do {
      end = next_blank(end);
    } while (end < text.size() && !ends_like_library(text.substr(begin, end - begin)));
    paths.push_back(find_named_file(directory, text.substr(begin, end - begin)));
    begin = std::min(text.find_first_not_of(" \t", end), text.size());
  }
  return paths;
}

void assign_slots(std::vector<ObjChunk>& chunks, const char* text, ParsedMesh& parsed) {
  const auto offset = [text](const char* where) { return static_cast<std::uint64_t>(where - text); };
  for (const ObjChunk& chunk : chunks)
    for (const ObjLibrary& library : chunk.libraries)
      parsed.libraries.push_back({offset(library.where), std::string(library.names), {}});
  const std::size_t count = parsed.mesh.triangle_count(), strokes = parsed.strokes.size() / 2;
  const std::vector<Run> runs = collect_runs(chunks, count, strokes);
  if (runs.empty()) return;

  constexpr std::size_t max_slots = std::numeric_limits<std::uint16_t>::max();
  Slots slots(parsed.materials);
  parsed.mesh.material_slots.resize_uninitialized(count);
  parsed.stroke_slots.resize_uninitialized(strokes);
  std::uint16_t* const out = parsed.mesh.material_slots.data();
  std::uint16_t* const of_strokes = parsed.stroke_slots.data();
  const ObjMaterialUse& first = runs.front().use;
  if (first.triangle + first.stroke > 0) {
    const auto slot = static_cast<std::uint16_t>(slots.of("", MeshStatement::kNowhere));
    std::fill_n(out, first.triangle, slot), std::fill_n(of_strokes, first.stroke, slot);
  }
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const ObjMaterialUse& use = runs[i].use;
    const bool is_last = i + 1 == runs.size();
    const std::uint64_t end = is_last ? count : runs[i + 1].use.triangle,
                        stroke_end = is_last ? strokes : runs[i + 1].use.stroke;
    const std::size_t slot = slots.of(use.name, offset(use.where));
    if (slot >= max_slots) {
      runs[i].chunk->fail(use.where, "more than " + std::to_string(max_slots) + " materials");
      return;
    }
    std::fill(out + use.triangle, out + end, static_cast<std::uint16_t>(slot));
    std::fill(of_strokes + use.stroke, of_strokes + stroke_end, static_cast<std::uint16_t>(slot));
  }
}

void resolve_materials(const std::vector<MeshStatement>& libraries,
                       const std::vector<MeshStatement>& materials, const std::string& obj_path, ObjFile& obj,
                       std::vector<MeshStatement>& notices) {
  Library library = load_libraries(libraries, obj_path, obj, notices);
  SlotMaterials slots(library, obj, notices);
  for (const MeshStatement& material : materials) slots.add(material);
}

}  // namespace oktett
