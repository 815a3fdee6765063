#pragma once
/// \file A mesh file while it is written. Within io/ only.

#include <charconv>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh.h"
#include "io/image/output.h"
#include "io/mesh/reading.h"
#include "render/material.h"

namespace oktett {

/// Gathers text and bytes to large writes. Throws Error of kind io, as OutputFile does.
class MeshOutput {
 public:
  explicit MeshOutput(const std::string& path) : file_(path) { buffer_.reserve(kMost + kMargin); }

  MeshOutput& text(std::string_view words) {
    if (words.size() > kMargin) {
      flush();
      file_.write(words);
    } else {
      buffer_ += words;
      flush_if_full();
    }
    return *this;
  }
  /// The shortest text that reads as `x` again.
  MeshOutput& number(float x) { return digits(x); }
  MeshOutput& number(double x) { return digits(x); }
  MeshOutput& number(std::integral auto x) { return digits(x); }
  /// Three such numbers, with blanks between them.
  template <class T>
  MeshOutput& vector(const Vec3<T>& v) {
    return number(v.x).text(" ").number(v.y).text(" ").number(v.z);
  }
  /// The position `p` of a mesh, its origin added.
  MeshOutput& position(const TriangleMesh& mesh, const Vec3f& p) {
    return mesh.origin == Vec3d{} ? vector(p) : vector(mesh.origin + Vec3d(p));
  }
  /// The bytes of a number or of a struct of numbers, as they are in memory (little-endian).
  template <class T>
  MeshOutput& bytes(const T& value) {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) < kMargin);
    const std::size_t end = buffer_.size();
    buffer_.resize(end + sizeof value);
    std::memcpy(buffer_.data() + end, &value, sizeof value);
    flush_if_full();
    return *this;
  }

  /// Writes what was gathered.
  void flush() {
    file_.write(buffer_);
    buffer_.clear();
  }
  /// The name under which what was flushed can be read before commit().
  const std::string& temporary() { return file_.temporary(); }
  /// Gives the file its name.
  void commit() {
    flush();
    file_.commit();
  }

 private:
  static constexpr std::size_t kMost = std::size_t{1} << 20, kMargin = 256;

  MeshOutput& digits(auto x) {
    char text[64];
    return this->text(
        {text, static_cast<std::size_t>(std::to_chars(text, text + sizeof text, x).ptr - text)});
  }
  void flush_if_full() {
    if (buffer_.size() >= kMost) flush();
  }

  OutputFile file_;
  std::string buffer_;
};

/// What a written file does not say of what was read: "lost: normals", or says otherwise: "changed: ...".
using MeshLosses = std::vector<std::string>;

inline constexpr const char* kLostDigits = "lost: digits of coordinates beyond single precision";

/// "1 material", "2 materials".
inline std::string count_of(std::size_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

/// Notes the attributes for which kept(attribute) is false.
template <class Kept>
void note_lost_attributes(const TriangleMesh& mesh, const Kept& kept, MeshLosses& losses) {
  for (const MeshAttribute& attribute : mesh.attributes)
    if (!kept(attribute)) losses.push_back("lost: the attribute " + quote_name(attribute.name));
}

/// Notes the textures of the materials that are not among those `written`. Tints are colours of vertices,
/// which formats say there.
inline void note_lost_textures(const std::vector<Material>& materials, const std::set<std::uint32_t>& written,
                               const char* format, MeshLosses& losses) {
  std::set<std::uint32_t> lost;
  for (Material m : materials) {
    m.tint_texture = m.tint_opacity_texture = kNoId;
    for_each_texture(m, [&](std::uint32_t index) {
      if (index != kNoId && !written.contains(index)) lost.insert(index);
    });
  }
  if (!lost.empty())
    losses.push_back("lost: " + count_of(lost.size(), "texture") + ", which " + format +
                     " cannot show as they are");
}

}  // namespace oktett
