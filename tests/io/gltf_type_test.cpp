// Types of the values in the JSON of glTF files: what is written otherwise is read or refused, never left
// out.

#include <nlohmann/json.hpp>

#include "tests/io/gltf_test_support.h"

namespace oktett::test::gltf_type_test {
namespace {

using nlohmann::json;

/// A file that has a property of nearly every kind.
json full_file() {
  std::string bytes;
  for (const float x : {0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f}) append_bytes(bytes, x);
  for (const std::uint32_t i : {0u, 1u, 2u}) append_bytes(bytes, i);
  for (int i = 0; i < 9; ++i) append_bytes(bytes, 0.5f);
  json file = json::parse(R"({
    "asset": {"version": "2.0", "minVersion": "2.0", "generator": "me", "copyright": "mine"},
    "scene": 1, "scenes": [{"name": "none", "nodes": []}, {"nodes": [0, 2]}],
    "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_ior"], "extensionsRequired": ["KHR_lights_punctual"],
    "bufferViews": [
      {"buffer": 0, "byteOffset": 0, "byteLength": 36, "byteStride": 12, "target": 34962, "name": "v"},
      {"buffer": 0, "byteOffset": 36, "byteLength": 12},
      {"buffer": 0, "byteOffset": 48, "byteLength": 36}],
    "accessors": [
      {"bufferView": 0, "byteOffset": 0, "componentType": 5126, "count": 3, "type": "VEC3", "name": "p",
       "min": [0, 0, 0], "max": [1, 1, 0], "normalized": false},
      {"bufferView": 1, "componentType": 5125, "count": 3, "type": "SCALAR"},
      {"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC3",
       "sparse": {"count": 1, "indices": {"bufferView": 1, "byteOffset": 4, "componentType": 5125},
                  "values": {"bufferView": 0, "byteOffset": 0}}}],
    "images": [{"uri": "a.png", "mimeType": "image/png", "name": "i"}],
    "samplers": [{"wrapS": 33648, "wrapT": 33071, "magFilter": 9729, "minFilter": 9987, "name": "s"}],
    "textures": [{"source": 0, "sampler": 0, "name": "t"}],
    "materials": [{"name": "m", "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.25,
      "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1], "metallicFactor": 0.5, "roughnessFactor": 0.25,
        "baseColorTexture": {"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform":
          {"offset": [0, 1], "rotation": 0.5, "scale": [2, 3], "texCoord": 0}}}},
      "normalTexture": {"index": 0, "texCoord": 0, "scale": 2},
      "occlusionTexture": {"index": 0, "texCoord": 0, "strength": 0.5},
      "emissiveTexture": {"index": 0}, "emissiveFactor": [1, 0, 1],
      "extensions": {"KHR_materials_ior": {"ior": 1.25},
        "KHR_materials_sheen": {"sheenColorFactor": [1, 1, 0], "sheenRoughnessFactor": 0.5}}}],
    "cameras": [{"type": "perspective", "name": "c", "perspective":
        {"yfov": 1, "znear": 1, "zfar": 2, "aspectRatio": 1.5}},
      {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 1, "zfar": 2}}],
    "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "name": "l", "intensity": 1, "range": 9,
      "color": [1, 1, 1], "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}}]}},
    "meshes": [{"name": "o", "weights": [0.5], "primitives": [{"attributes": {"POSITION": 0, "NORMAL": 2},
      "indices": 1, "material": 0, "mode": 4, "targets": [{"POSITION": 0}]}]}],
    "skins": [{"joints": [0], "skeleton": 0, "inverseBindMatrices": 0, "name": "k"}],
    "animations": [{"name": "a", "channels": [{"sampler": 0, "target": {"node": 0, "path": "scale"}}],
      "samplers": [{"input": 0, "output": 0, "interpolation": "LINEAR"}]}],
    "nodes": [{"mesh": 0, "name": "n", "translation": [1, 2, 3], "rotation": [0, 0, 0, 1], "scale": [1, 2, 1]},
      {"camera": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]},
      {"children": [1], "extensions": {"KHR_lights_punctual": {"light": 0}}}]
  })");
  file["buffers"] = json::parse(R"([{"byteLength": 84, "name": "b"}])");
  file["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(bytes);
  return file;
}

/// "a[1].b" of "/a/1/b".
std::string place_of(const std::string& pointer) {
  std::string place;
  for (std::size_t at = 1; at <= pointer.size();) {
    const std::size_t end = std::min(pointer.find('/', at), pointer.size());
    const std::string word = pointer.substr(at, end - at);
    if (word.find_first_not_of("0123456789") == std::string::npos)
      place += "[" + word + "]";
    else
      place += (place.empty() ? "" : ".") + word;
    at = end + 1;
  }
  return place;
}

/// The pointers of all values but the whole file, containers included.
std::vector<std::string> pointers_in(const json& value, const std::string& prefix = "") {
  std::vector<std::string> all;
  const auto add = [&](const std::string& key, const json& item) {
    all.push_back(prefix + "/" + key);
    const std::vector<std::string> inner = pointers_in(item, all.back());
    all.insert(all.end(), inner.begin(), inner.end());
  };
  if (value.is_object())
    for (const auto& [key, item] : value.items()) add(key, item);
  if (value.is_array())
    for (std::size_t i = 0; i < value.size(); ++i) add(std::to_string(i), value[i]);
  return all;
}

TEST(GltfTypes, TheFullFileIsRead) {
  const GltfFiles files;
  const MeshFile file = files.load(full_file().dump(), "a.gltf");
  EXPECT_EQ(file.mesh.triangle_count(), 1u);
  // Half of the morph target is added, then comes the node.
  EXPECT_EQ(file.mesh.positions[1], (Vec3f{2.5f, 2, 3}));
  EXPECT_EQ(file.materials.at(0).color, (Color{1, 0, 0}));
}

// As it is, with 36.0 for 36, and with 3.6e1 for 36, all of a file is the same.
TEST(GltfTypes, WholeNumbersMayBeWrittenAsOthers) {
  const GltfFiles files;
  const json good = full_file();
  const MeshFile expected = files.load(good.dump(), "a.gltf");
  int changed = 0;
  for (const std::string& pointer : pointers_in(good)) {
    json file = good;
    json& value = file[json::json_pointer(pointer)];
    if (!value.is_number_integer()) continue;
    ++changed;
    const std::string word = std::to_string(value.get<int>());
    for (const std::string& other : {word + ".0", word + (word == "0" ? "e0" : "0e-1")}) {
      value = "HERE";
      std::string text = file.dump();
      text.replace(text.find("\"HERE\""), 6, other);
      const MeshFile read = files.load(text, "a.gltf");
      EXPECT_EQ(to_vector(read.mesh.positions), to_vector(expected.mesh.positions)) << pointer;
      EXPECT_EQ(to_vector(read.mesh.normals), to_vector(expected.mesh.normals)) << pointer;
      EXPECT_EQ(to_vector(read.mesh.indices), to_vector(expected.mesh.indices)) << pointer;
      EXPECT_EQ(read.materials, expected.materials) << pointer;
      EXPECT_EQ(read.textures, expected.textures) << pointer;
      EXPECT_EQ(files.files.as_text(read.warnings), files.files.as_text(expected.warnings)) << pointer;
    }
  }
  EXPECT_GT(changed, 90);
}

enum class Kind { none, flag, number, text, list, object };

Kind kind_of(const json& value) {
  if (value.is_number()) return Kind::number;
  if (value.is_string()) return Kind::text;
  if (value.is_boolean()) return Kind::flag;
  return value.is_array() ? Kind::list : value.is_object() ? Kind::object : Kind::none;
}

// No value of another type is taken for one that is not there.
TEST(GltfTypes, WrongTypesAreRefusedWithTheirPlace) {
  const GltfFiles files;
  const json good = full_file();
  int refused = 0;
  for (const std::string& pointer : pointers_in(good)) {
    if (pointer == "/asset" || pointer == "/asset/version") continue;
    for (const json& other : {json("3"), json(1.5), json(true), json(nullptr), json::object({{"a", 0}}),
                              json::array({nullptr})}) {
      json file = good;
      json& value = file[json::json_pointer(pointer)];
      if (kind_of(value) == kind_of(other) && !other.is_array()) continue;
      value = other;
      const std::string error = files.error(file.dump(), "a.gltf"), place = "a.gltf: " + place_of(pointer);
      EXPECT_EQ(error.substr(0, place.size()), place) << pointer << " " << other << ": " << error;
      EXPECT_NE(error.find(": expected "), std::string::npos) << pointer << " " << other << ": " << error;
      ++refused;
    }
  }
  EXPECT_GT(refused, 800);
}

// Numbers of things and of bytes are whole and not negative.
TEST(GltfTypes, BrokenAndNegativeIndicesAreRefused) {
  const GltfFiles files;
  const json good = full_file();
  int refused = 0;
  for (const std::string& pointer : pointers_in(good)) {
    const std::string key = pointer.substr(pointer.rfind('/') + 1);
    const bool is_index =
        key == "buffer" || key == "bufferView" || key == "byteOffset" || key == "byteLength" ||
        key == "byteStride" || key == "count" || key == "componentType" || key == "source" ||
        key == "sampler" || key == "index" || key == "texCoord" || key == "material" || key == "mesh" ||
        key == "camera" || key == "light" || key == "scene" || key == "POSITION" || key == "NORMAL" ||
        key == "mode" || key == "wrapS" || key == "input" || key == "output" || key == "skeleton" ||
        key == "target" || pointer.find("/children/") != std::string::npos ||
        pointer.find("/joints/") != std::string::npos;
    if (!is_index || !good[json::json_pointer(pointer)].is_number()) continue;
    for (const json& other : {json(-1), json(0.5), json(1e17), json(-0.5)}) {
      json file = good;
      file[json::json_pointer(pointer)] = other;
      EXPECT_EQ(
          files.error(file.dump(), "a.gltf"),
          "a.gltf: " + place_of(pointer) + ": expected a whole number of 0 or more, found " + other.dump());
      ++refused;
    }
  }
  EXPECT_GT(refused, 150);
}

TEST(GltfTypes, MessagesSayWhatWasExpected) {
  const GltfFiles files;
  const auto error = [&](const char* pointer, const json& value) {
    json file = full_file();
    file[json::json_pointer(pointer)] = value;
    return files.error(file.dump(), "a.gltf");
  };
  EXPECT_EQ(error("/meshes/0/primitives/0/indices", "3"),
            "a.gltf: meshes[0].primitives[0].indices: expected a whole number of 0 or more, found '3'");
  EXPECT_EQ(error("/bufferViews/1/byteOffset", 36.5),
            "a.gltf: bufferViews[1].byteOffset: expected a whole number of 0 or more, found 36.5");
  EXPECT_EQ(error("/scene", -1), "a.gltf: scene: expected a whole number of 0 or more, found -1");
  EXPECT_EQ(error("/nodes/0/translation/1", "2"),
            "a.gltf: nodes[0].translation[1]: expected a number, found '2'");
  EXPECT_EQ(error("/materials/0/pbrMetallicRoughness/baseColorFactor", json::array({1, 0, 0})),
            "a.gltf: materials[0].pbrMetallicRoughness.baseColorFactor: expected 4 numbers, found 3");
  EXPECT_EQ(
      error("/materials/0/pbrMetallicRoughness/baseColorFactor", "red"),
      "a.gltf: materials[0].pbrMetallicRoughness.baseColorFactor: expected a list of numbers, found 'red'");
  EXPECT_EQ(error("/materials/0/alphaMode", 1), "a.gltf: materials[0].alphaMode: expected a text, found 1");
  EXPECT_EQ(error("/materials/0/doubleSided", "true"),
            "a.gltf: materials[0].doubleSided: expected true or false, found 'true'");
  EXPECT_EQ(error("/scenes/1/nodes", json::object({{"a", 0}})),
            "a.gltf: scenes[1].nodes: expected a list of whole numbers, found an object");
  EXPECT_EQ(error("/meshes/0/primitives", "x"),
            "a.gltf: meshes[0].primitives: expected a list of objects, found 'x'");
  EXPECT_EQ(error("/asset/minVersion", "2.1"),
            "a.gltf: asset.minVersion: needs glTF version '2.1'; 2.0 is read");
  // Beyond what doubles count.
  EXPECT_EQ(error("/accessors/0/count", 1e30),
            "a.gltf: accessors[0].count: expected a whole number of 0 or more, found 1e+30");
}

TEST(GltfTypes, WhatIsRequiredMustBeThere) {
  const GltfFiles files;
  const auto error = [&](const std::string& pointer) {
    json file = full_file();
    const std::size_t slash = pointer.rfind('/');
    file[json::json_pointer(pointer.substr(0, slash))].erase(pointer.substr(slash + 1));
    return files.error(file.dump(), "a.gltf");
  };
  EXPECT_EQ(error("/accessors/0/count"), "a.gltf: accessors[0]: 'count' is missing");
  EXPECT_EQ(error("/meshes/0/primitives"), "a.gltf: meshes[0]: 'primitives' is missing");
  EXPECT_EQ(error("/materials/0/emissiveTexture/index"),
            "a.gltf: materials[0].emissiveTexture: 'index' is missing");
  EXPECT_EQ(error("/cameras/0/perspective"), "a.gltf: cameras[0]: 'perspective' is missing");
  EXPECT_EQ(error("/nodes/2/extensions/KHR_lights_punctual/light"),
            "a.gltf: nodes[2].extensions.KHR_lights_punctual: 'light' is missing");
  EXPECT_EQ(error("/buffers/0/uri"),
            "a.gltf: buffers[0]: has no uri, and the file no bytes of its own for it");
}

// What nothing knows may be anything.
TEST(GltfTypes, ExtrasAndUnknownExtensionsAreFree) {
  const GltfFiles files;
  json file = full_file();
  for (const char* const pointer : {"", "/nodes/0", "/materials/0", "/materials/0/normalTexture"}) {
    json& object = file[json::json_pointer(pointer)];
    object["extras"] = json::array({1, "a", nullptr});
    object["extensions"]["EXT_of_mine"] = json::object({{"index", "none"}});
    object["mine"] = "anything";
  }
  EXPECT_EQ(files.error(file.dump(), "a.gltf"), "no error");
}

}  // namespace
}  // namespace oktett::test::gltf_type_test
