#pragma once
/// \file Meshes that are written in several formats, for tests of their readers.

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <new>
#include <random>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/mesh/load/load_mesh.h"
#include "io/mesh/reading.h"
#include "tests/io/obj_test_support.h"
#include "tests/support/sanitizers.h"

namespace oktett::test {

/// A mesh as a file states it.
struct MeshModel {
  struct Face {
    std::vector<std::uint32_t> corners;
    std::vector<Vec2f> uvs;  ///< one for each corner, or none
  };
  std::vector<Vec3f> positions, normals;  ///< normals and uvs: one for each position, or none
  std::vector<Vec2f> uvs;
  std::vector<Face> faces;
};

/// The shortest text that reads as `x` again.
inline std::string exact_text(float x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", static_cast<double>(x));
  return text;
}

inline std::string obj_text(const MeshModel& model) {
  std::string text;
  const auto line = [&](const char* keyword, std::initializer_list<float> values) {
    text += keyword;
    for (const float x : values) text.append(" ").append(exact_text(x));
    text += "\n";
  };
  for (const Vec3f& p : model.positions) line("v", {p.x, p.y, p.z});
  for (const Vec3f& n : model.normals) line("vn", {n.x, n.y, n.z});
  for (const Vec2f& t : model.uvs) line("vt", {t.x, t.y});
  for (const MeshModel::Face& face : model.faces)
    for (const Vec2f& t : face.uvs) line("vt", {t.x, t.y});
  std::size_t next_uv = 1;
  for (const MeshModel::Face& face : model.faces) {
    text += "f";
    for (const std::uint32_t corner : face.corners) {
      const std::string index = std::to_string(corner + 1);
      std::string uv = model.uvs.empty() ? "" : index;
      if (!face.uvs.empty()) uv = std::to_string(next_uv++);
      text.append(" ").append(index).append("/").append(uv).append("/");
      if (!model.normals.empty()) text += index;
    }
    text += "\n";
  }
  return text;
}

template <class T>
bool same_bytes(const Column<T>& a, const Column<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

inline void expect_same_mesh(const TriangleMesh& a, const TriangleMesh& b) {
  EXPECT_TRUE(same_bytes(a.positions, b.positions));
  EXPECT_TRUE(same_bytes(a.normals, b.normals));
  EXPECT_TRUE(same_bytes(a.uvs, b.uvs));
  EXPECT_EQ(to_vector(a.indices), to_vector(b.indices));
  EXPECT_EQ(to_vector(a.normal_indices), to_vector(b.normal_indices));
  EXPECT_EQ(to_vector(a.uv_indices), to_vector(b.uv_indices));
  EXPECT_EQ(to_vector(a.material_slots), to_vector(b.material_slots));
}

/// Polygons of three to six corners on random points; some with coordinates that are hard to write.
inline MeshModel random_model(std::mt19937& random, bool normals, bool uvs, bool corner_uvs) {
  std::normal_distribution<float> normal;
  const auto number = [&] {
    return random() % 8 == 0 ? std::ldexp(normal(random), static_cast<int>(random() % 60) - 30)
                             : normal(random);
  };
  MeshModel model;
  const auto count = static_cast<std::uint32_t>(3 + random() % 30);
  for (std::uint32_t i = 0; i < count; ++i) {
    model.positions.push_back({number(), number(), number()});
    if (normals) model.normals.push_back({number(), number(), number()});
    if (uvs) model.uvs.push_back({number(), number()});
  }
  const bool triangles = random() % 2 == 0;
  for (std::size_t i = random() % 40; i > 0; --i) {
    MeshModel::Face& face = model.faces.emplace_back();
    for (std::size_t k = triangles ? 3 : 3 + random() % 4; k > 0; --k)
      face.corners.push_back(static_cast<std::uint32_t>(random() % count));
    if (corner_uvs && random() % 4 != 0)
      for (std::size_t k = 0; k < face.corners.size(); ++k) face.uvs.push_back({number(), number()});
  }
  return model;
}

/// Appends the bytes of a number, turned around if `swap`.
template <class T>
void append_bytes(std::string& bytes, T value, bool swap = false) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (swap) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

/// Files of one format for one test.
template <ParsedMesh parse(const std::string&, const MeshReadOptions&)>
class ParsedFiles {
 public:
  explicit ParsedFiles(const char* name) : name_(name) {}

  ParsedMesh parse_bytes(const std::string& bytes, const MeshReadOptions& options = {}) const {
    return parse(files_.write(name_, bytes), options);
  }
  MeshFile load(const std::string& bytes, const MeshOptions& options = {}) const {
    return load_mesh(files_.write(name_, bytes), options);
  }
  std::vector<std::string> warnings(const std::string& bytes) const {
    return files_.as_text(load(bytes).warnings);
  }
  /// The message of the error, or "no error".
  std::string error(const std::string& bytes, const MeshReadOptions& options = {}) const {
    try {
      parse_bytes(bytes, options);
    } catch (const Error& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      return files_.without_directory(e.what());
    }
    return "no error";
  }
  const ObjFiles& files() const { return files_; }

 private:
  const char* name_;
  ObjFiles files_;
};

/// Runs f() with 256 MB of address space beside what the process has; std::bad_alloc fails the test.
template <class F>
void with_little_memory(const F& f) {
  if (kSanitized) return f();  // sanitizers need terabytes of address space
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  rlimit small = limit;
  small.rlim_cur = pages * 4096 + (std::size_t{256} << 20);
  setrlimit(RLIMIT_AS, &small);
  bool enough = true;
  try {
    f();
  } catch (const std::bad_alloc&) {
    enough = false;
  }
  setrlimit(RLIMIT_AS, &limit);
  EXPECT_TRUE(enough) << "more memory was asked for than the file justifies";
}

}  // namespace oktett::test
