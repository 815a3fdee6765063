#include <algorithm>
#include <filesystem>
#include <limits>
#include <system_error>
#include <unordered_map>
#include <utility>

#include "core/error.h"
#include "io/obj/parsed_obj.h"
#include "render/material.h"

namespace oktett {
namespace {

namespace fs = std::filesystem;

struct Library {
  std::vector<Material> materials;
  std::vector<Texture> textures;
  MtlPlaces places;
  std::unordered_map<std::string, std::size_t> by_name;
  bool complete = true;  ///< every file could be read
};

bool is_file(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

/// `name` in `directory`; with slashes for the backslashes of Windows if only that exists.
std::string resolve(const std::string& directory, std::string_view name) {
  const std::string path = (fs::path(directory) / fs::path(name)).string();
  if (is_file(path) || name.find('\\') == std::string_view::npos) return path;
  std::string slashes(name);
  std::replace(slashes.begin(), slashes.end(), '\\', '/');
  const std::string other = (fs::path(directory) / fs::path(slashes)).string();
  return is_file(other) ? other : path;
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
  for (std::size_t i = 0; i < library.materials.size(); ++i)
    library.by_name.emplace(library.materials[i].name, i);
  return library;
}

/// Adds the materials of the slots in their order.
class SlotMaterials {
 public:
  SlotMaterials(const Library& library, ObjFile& obj, std::vector<MeshStatement>& notices)
      : library_(library), obj_(obj), notices_(notices), textures_(library.textures.size(), kNoId) {}

  void add(const MeshStatement& slot) {
    const auto found = library_.by_name.find(slot.words);
    if (found != library_.by_name.end()) {
      Material material = library_.materials[found->second];
      for_each_texture(material, [this](std::uint32_t& texture) { texture = take_texture(texture); });
      obj_.material_places.resize(obj_.materials.size());
      obj_.material_places.push_back(library_.places.materials[found->second]);
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

  const Library& library_;
  ObjFile& obj_;
  std::vector<MeshStatement>& notices_;
  std::vector<std::uint32_t> textures_;
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
  ObjMaterialUse use;  ///< `triangle` counted from the start of the file
};

/// The statements that some face follows before the next one, in order.
std::vector<Run> collect_runs(std::vector<ObjChunk>& chunks, std::uint64_t triangle_count) {
  std::vector<Run> runs;
  for (ObjChunk& chunk : chunks) {
    for (ObjMaterialUse use : chunk.material_uses) {
      use.triangle += chunk.before.triangles;
      if (!runs.empty() && runs.back().use.triangle == use.triangle) runs.pop_back();
      runs.push_back({&chunk, use});
    }
  }
  if (!runs.empty() && runs.back().use.triangle == triangle_count) runs.pop_back();
  return runs;
}

}  // namespace

std::vector<std::string> split_library_names(std::string_view text, const std::string& directory) {
  if (text.empty()) return {};
  const std::string whole = resolve(directory, text);
  if (is_file(whole)) return {whole};
  std::vector<std::string> paths;
  std::size_t begin = 0;
  while (begin < text.size()) {
    // Up to the first blank behind `.mtl`, or all that is left.
    std::size_t end = begin;
    do {
      end = std::min(text.find_first_of(" \t", end + 1), text.size());
    } while (end < text.size() && !ends_like_library(text.substr(begin, end - begin)));
    paths.push_back(resolve(directory, text.substr(begin, end - begin)));
    begin = std::min(text.find_first_not_of(" \t", end), text.size());
  }
  return paths;
}

void assign_slots(std::vector<ObjChunk>& chunks, const char* text, ParsedMesh& parsed) {
  const auto offset = [text](const char* where) { return static_cast<std::uint64_t>(where - text); };
  for (const ObjChunk& chunk : chunks)
    for (const ObjLibrary& library : chunk.libraries)
      parsed.libraries.push_back({offset(library.where), std::string(library.names), {}});
  const std::size_t count = parsed.mesh.triangle_count();
  const std::vector<Run> runs = collect_runs(chunks, count);
  if (runs.empty()) return;

  constexpr std::size_t max_slots = std::numeric_limits<std::uint16_t>::max();
  Slots slots(parsed.materials);
  parsed.mesh.material_slots.resize_uninitialized(count);
  std::uint16_t* const out = parsed.mesh.material_slots.data();
  const std::uint64_t first = runs.front().use.triangle;
  if (first > 0) std::fill_n(out, first, static_cast<std::uint16_t>(slots.of("", MeshStatement::kNowhere)));
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const ObjMaterialUse& use = runs[i].use;
    const std::uint64_t end = i + 1 < runs.size() ? runs[i + 1].use.triangle : count;
    const std::size_t slot = slots.of(use.name, offset(use.where));
    if (slot >= max_slots) {
      runs[i].chunk->fail(use.where, "more than " + std::to_string(max_slots) + " materials");
      return;
    }
    std::fill(out + use.triangle, out + end, static_cast<std::uint16_t>(slot));
  }
}

void resolve_materials(const std::vector<MeshStatement>& libraries,
                       const std::vector<MeshStatement>& materials, const std::string& obj_path, ObjFile& obj,
                       std::vector<MeshStatement>& notices) {
  const Library library = load_libraries(libraries, obj_path, obj, notices);
  SlotMaterials slots(library, obj, notices);
  for (const MeshStatement& material : materials) slots.add(material);
}

}  // namespace oktett
