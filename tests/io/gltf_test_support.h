#pragma once
/// \file glTF files for tests.

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string>
#include <vector>

#include "io/gltf/gltf.h"
#include "tests/io/mesh_test_support.h"

namespace oktett::test {

inline constexpr int kInt8 = 5120, kUint8 = 5121, kInt16 = 5122, kUint16 = 5123, kUint32 = 5125,
                     kFloat = 5126;

inline std::string base64(const std::string& bytes) {
  static const char* const kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return i + k < bytes.size() ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i + k])) : 0;
    };
    const std::uint32_t bits = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

/// A GLB file of chunks, each a kind and its bytes.
inline std::string glb_of(const std::string& json, const std::string& binary) {
  std::string text = json, data = binary;
  while (text.size() % 4 != 0) text += ' ';
  while (data.size() % 4 != 0) data += '\0';
  std::string bytes = "glTF";
  append_bytes(bytes, std::uint32_t{2});
  append_bytes(bytes,
               static_cast<std::uint32_t>(12 + 8 + text.size() + (data.empty() ? 0 : 8 + data.size())));
  append_bytes(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += "JSON" + text;
  if (data.empty()) return bytes;
  append_bytes(bytes, static_cast<std::uint32_t>(data.size()));
  return bytes + std::string("BIN\0", 4) + data;
}

/// Gathers views and accessors with their bytes.
class GltfWriter {
 public:
  std::string binary, views, accessors;
  std::string buffers;  ///< instead of the buffer of `binary`

  std::size_t view(const std::string& bytes, std::size_t stride = 0, const std::string& more = "") {
    while (binary.size() % 4 != 0) binary += '\0';
    add(views, "{\"buffer\":0,\"byteOffset\":" + std::to_string(binary.size()) +
                   ",\"byteLength\":" + std::to_string(bytes.size()) +
                   (stride > 0 ? ",\"byteStride\":" + std::to_string(stride) : "") + more + "}");
    binary += bytes;
    return view_count_++;
  }
  std::size_t accessor(std::size_t view, int number, std::size_t count, const char* type,
                       const std::string& more = "") {
    add(accessors, "{\"bufferView\":" + std::to_string(view) +
                       ",\"componentType\":" + std::to_string(number) +
                       ",\"count\":" + std::to_string(count) + ",\"type\":\"" + type + "\"" + more + "}");
    return accessor_count_++;
  }
  /// An accessor of its own view.
  template <class T>
  std::size_t array(const std::vector<T>& values, int number, const char* type, std::size_t per_element,
                    const std::string& more = "") {
    std::string bytes;
    for (const T& value : values) append_bytes(bytes, value);
    return accessor(view(bytes), number, values.size() / per_element, type, more);
  }
  std::size_t vectors(const std::vector<Vec3f>& points) {
    std::vector<float> numbers;
    for (const Vec3f& p : points) numbers.insert(numbers.end(), {p.x, p.y, p.z});
    return array(numbers, kFloat, "VEC3", 3);
  }

  /// The JSON with `rest`, which follows the lists.
  std::string json(const std::string& rest, const std::string& uri = "") const {
    const std::string own = "{\"byteLength\":" + std::to_string(binary.size()) +
                            (uri.empty() ? "" : ",\"uri\":\"" + uri + "\"") + "}";
    return "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[" + (buffers.empty() ? own : buffers) +
           "],\"bufferViews\":[" + views + "],\"accessors\":[" + accessors + "]," + rest + "}";
  }
  std::string glb(const std::string& rest) const { return glb_of(json(rest), binary); }
  std::string text(const std::string& rest) const {
    return json(rest, "data:application/octet-stream;base64," + base64(binary));
  }

 private:
  static void add(std::string& list, const std::string& item) { list += (list.empty() ? "" : ",") + item; }
  std::size_t view_count_ = 0, accessor_count_ = 0;
};

/// One node with one mesh of these primitives.
inline std::string one_node(const std::string& primitives) {
  return "\"meshes\":[{\"primitives\":[" + primitives +
         "]}],\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]";
}

struct GltfFiles {
  ObjFiles files;

  MeshFile load(const std::string& bytes, const char* name = "a.glb") const {
    return load_mesh(files.write(name, bytes));
  }
  FileScene scene(const std::string& bytes, const char* name = "a.glb") const {
    return load_gltf_scene(files.write(name, bytes));
  }
  std::vector<std::string> warnings(const std::string& bytes) const {
    return files.as_text(load(bytes).warnings);
  }
  /// The message of the error, or "no error".
  std::string error(const std::string& bytes, const char* name = "a.glb") const {
    try {
      load(bytes, name);
    } catch (const Error& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      return files.without_directory(e.what());
    }
    return "no error";
  }
};

}  // namespace oktett::test
