#pragma once
/// \file PLY files with the same mesh in many forms.

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "io/ply/header.h"
#include "io/ply/ply.h"
#include "tests/io/mesh_test_support.h"

namespace oktett::test {

struct PlyFiles : ParsedFiles<parse_ply> {
  PlyFiles() : ParsedFiles("a.ply") {}
};

/// Writes elements record by record, as text or as bytes.
class PlyWriter {
 public:
  explicit PlyWriter(PlyFormat format) : format_(format) {
    constexpr const char* kNames[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    header_ = std::string("ply\nformat ") + kNames[static_cast<int>(format)] + " 1.0\ncomment of a test\n";
  }

  void element(const char* name, std::size_t count) {
    header_ += std::string("element ") + name + " " + std::to_string(count) + "\n";
  }
  void property(PlyType type, const std::string& name) {
    header_ += std::string("property ") + name_of(type) + " " + name + "\n";
  }
  void list(PlyType length, PlyType type, const std::string& name) {
    header_ += std::string("property list ") + name_of(length) + " " + name_of(type) + " " + name + "\n";
  }

  void value(PlyType type, double x) {
    if (format_ == PlyFormat::ascii) {
      if (!at_line_start_) body_ += ' ';
      body_ +=
          is_whole(type) ? std::to_string(static_cast<std::int64_t>(x)) : exact_text(static_cast<float>(x));
      at_line_start_ = false;
      return;
    }
    with_type(type, format_ == PlyFormat::big_endian, [&]<class T, bool kSwap>() {
      if constexpr (std::integral<T>)
        append_bytes(body_, static_cast<T>(static_cast<std::int64_t>(x)), kSwap);
      else
        append_bytes(body_, static_cast<T>(x), kSwap);
    });
  }
  void end_record() {
    if (format_ == PlyFormat::ascii) body_ += "\n";
    at_line_start_ = true;
  }

  std::string bytes() const { return header_ + "end_header\n" + body_; }

 private:
  static const char* name_of(PlyType type) {
    constexpr const char* kNames[] = {"char", "uint8", "short", "uint16", "int", "uint32", "float", "double"};
    return kNames[static_cast<int>(type)];
  }

  PlyFormat format_;
  std::string header_, body_;
  bool at_line_start_ = true;
};

/// How a model becomes a file.
struct PlyStyle {
  PlyFormat format = PlyFormat::ascii;
  PlyType number = PlyType::float32;
  PlyType length = PlyType::uint8;
  PlyType index = PlyType::int32;
  bool extras = false;  ///< properties, lists and elements that are not read
  bool faces_first = false;
  const char* uv[2] = {"u", "v"};
};

inline void write_vertices(PlyWriter& out, const MeshModel& model, const PlyStyle& style) {
  for (std::size_t i = 0; i < model.positions.size(); ++i) {
    const auto vector = [&](const Vec3f& v) {
      for (const float x : {v.x, v.y, v.z}) out.value(style.number, x);
    };
    if (style.extras) {
      out.value(PlyType::uint8, 3);
      for (int k = 0; k < 3; ++k) out.value(PlyType::int16, -k);
    }
    vector(model.positions[i]);
    if (style.extras) out.value(PlyType::uint16, 4096);
    if (!model.normals.empty()) vector(model.normals[i]);
    if (!model.uvs.empty()) out.value(style.number, model.uvs[i].x), out.value(style.number, model.uvs[i].y);
    out.end_record();
  }
}

inline void write_faces(PlyWriter& out, const MeshModel& model, const PlyStyle& style, bool texcoords) {
  for (const MeshModel::Face& face : model.faces) {
    if (style.extras) out.value(PlyType::float64, 1.5);
    out.value(style.length, static_cast<double>(face.corners.size()));
    for (const std::uint32_t corner : face.corners) out.value(style.index, corner);
    if (style.extras) out.value(PlyType::int8, -7);
    if (texcoords) {
      out.value(PlyType::uint8, 2 * static_cast<double>(face.uvs.size()));
      for (const Vec2f& uv : face.uvs) out.value(style.number, uv.x), out.value(style.number, uv.y);
    }
    out.end_record();
  }
}

inline std::string ply_bytes(const MeshModel& model, const PlyStyle& style = {}) {
  bool texcoords = false;
  for (const MeshModel::Face& face : model.faces) texcoords = texcoords || !face.uvs.empty();
  PlyWriter out(style.format);
  const auto describe_vertices = [&] {
    out.element("vertex", model.positions.size());
    if (style.extras) out.list(PlyType::uint8, PlyType::int16, "ring");
    for (const char* name : {"x", "y", "z"}) out.property(style.number, name);
    if (style.extras) out.property(PlyType::uint16, "quality");
    if (!model.normals.empty())
      for (const char* name : {"nx", "ny", "nz"}) out.property(style.number, name);
    if (!model.uvs.empty())
      for (const char* name : style.uv) out.property(style.number, name);
  };
  const auto describe_faces = [&] {
    out.element("face", model.faces.size());
    if (style.extras) out.property(PlyType::float64, "area");
    out.list(style.length, style.index, "vertex_indices");
    if (style.extras) out.property(PlyType::int8, "flags");
    if (texcoords) out.list(PlyType::uint8, style.number, "texcoord");
  };
  if (style.faces_first) describe_faces();
  describe_vertices();
  if (style.extras) {
    out.element("range", 2);
    out.property(PlyType::int32, "first");
    out.property(PlyType::int32, "last");
    out.element("nothing", 1000000000000);
  }
  if (!style.faces_first) describe_faces();
  if (style.faces_first) write_faces(out, model, style, texcoords);
  write_vertices(out, model, style);
  for (int i = 0; style.extras && i < 2; ++i) {
    out.value(PlyType::int32, i), out.value(PlyType::int32, -i);
    out.end_record();
  }
  if (!style.faces_first) write_faces(out, model, style, texcoords);
  return out.bytes();
}

inline constexpr PlyFormat kPlyFormats[] = {PlyFormat::ascii, PlyFormat::little_endian,
                                            PlyFormat::big_endian};

}  // namespace oktett::test
