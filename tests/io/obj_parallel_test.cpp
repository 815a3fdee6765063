#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "io/obj/obj.h"
#include "tests/io/obj_test_support.h"

namespace oktett::test::obj_parallel_test {
namespace {

/// The contents of a file of triangles, as read by a simple reader.
struct Reference {
  std::vector<Vec3f> positions, normals;
  std::vector<Vec2f> uvs;
  Indices indices, uv_indices, normal_indices;
  std::vector<std::uint16_t> slots;
  std::vector<std::string> materials;
};

std::uint32_t resolve(const std::string& text, std::size_t count) {
  if (text.empty()) return kNoId;
  const long long i = std::stoll(text);
  return static_cast<std::uint32_t>(i > 0 ? i - 1 : static_cast<long long>(count) + i);
}

void read_corner(const std::string& word, Reference& r) {
  std::string part[3];
  std::istringstream stream(word);
  for (std::string& p : part) std::getline(stream, p, '/');
  r.indices.push_back(resolve(part[0], r.positions.size()));
  r.uv_indices.push_back(resolve(part[1], r.uvs.size()));
  r.normal_indices.push_back(resolve(part[2], r.normals.size()));
}

/// Line by line, with strtof. Knows LF, joined lines and comments, but no polygons.
Reference read_plainly(std::string text) {
  for (std::size_t at; (at = text.find("\\\n")) != std::string::npos;) text.replace(at, 2, " ");
  Reference r;
  std::map<std::string, std::uint16_t> slots;
  std::string material;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    line = line.substr(0, line.find('#'));
    std::istringstream words(line);
    std::string keyword, word;
    if (!(words >> keyword)) continue;
    std::vector<std::string> rest;
    while (words >> word) rest.push_back(word);
    const auto number = [&](std::size_t i) { return std::strtof(rest.at(i).c_str(), nullptr); };
    if (keyword == "v") r.positions.push_back({number(0), number(1), number(2)});
    if (keyword == "vn") r.normals.push_back({number(0), number(1), number(2)});
    if (keyword == "vt") r.uvs.push_back({number(0), number(1)});
    if (keyword == "usemtl") material = rest.at(0);
    if (keyword != "f") continue;
    for (const std::string& corner : rest) read_corner(corner, r);
    if (slots.emplace(material, static_cast<std::uint16_t>(slots.size())).second)
      r.materials.push_back(material);
    r.slots.push_back(slots[material]);
  }
  return r;
}

/// Writes files of triangles in every form the plain reader knows.
class Writer {
 public:
  explicit Writer(std::uint32_t seed) : random_(seed) {}

  std::string write(int lines) {
    for (int i = 0; i < 4; ++i) add_vertices();
    for (int i = 0; i < lines; ++i) add_line();
    return text_;
  }

 private:
  std::uint32_t below(std::uint32_t n) { return random_() % n; }
  std::string blank() { return below(20) ? " " : below(2) ? "\t  " : below(2) ? " \\\n " : "  "; }
  std::string number() {
    static const char* const forms[] = {"%.6f", "%g",    "%.9g", "%.17g", "%e",
                                        "%.1f", "%+.3f", "%.0f", "%.25g"};
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, forms[below(9)],
                  (static_cast<double>(random_()) / 65536 - 32768) * (below(9) ? 1 : 1e-9));
    return buffer;
  }
  void end_line() { text_ += below(30) ? "\n" : below(2) ? " # f 1 2 3\n" : "  \n\n"; }
  void add_numbers(const char* keyword, int count) {
    text_ += keyword;
    for (int i = 0; i < count; ++i) text_ += blank() + number();
    end_line();
  }
  void add_vertices() {
    add_numbers("v", 3), ++v_;
    add_numbers("vt", 2), ++vt_;
    add_numbers("vn", 3), ++vn_;
  }
  std::string index(int count) {
    const int i = 1 + static_cast<int>(below(static_cast<std::uint32_t>(count)));
    return std::to_string(below(3) ? i : -i);
  }
  void add_line() {
    const std::uint32_t kind = below(100);
    if (kind < 40) return add_vertices();
    if (kind < 45) text_ += "usemtl m" + std::to_string(below(5)) + "\n";
    if (kind < 48) text_ += "# comment / with a slash\n\n";
    if (kind < 50) text_ += "g part\ns 1\no x\n";
    if (kind < 50) return;
    const std::uint32_t form = below(4);
    text_ += below(50) ? "f" : " \tf";
    for (int i = 0; i < 3; ++i) {
      text_ += blank() + index(v_);
      if (form == 1 || form == 3) text_ += "/" + index(vt_);
      if (form == 2) text_ += "/";
      if (form >= 2) text_ += "/" + index(vn_);
    }
    end_line();
  }

  std::mt19937 random_;
  std::string text_;
  int v_ = 0, vt_ = 0, vn_ = 0;
};

void expect_equal(const ObjFile& file, const Reference& r) {
  EXPECT_EQ(to_vector(file.mesh.positions), r.positions);
  EXPECT_EQ(to_vector(file.mesh.normals), r.normals);
  EXPECT_EQ(to_vector(file.mesh.uvs), r.uvs);
  EXPECT_EQ(indices_of(file), r.indices);
  EXPECT_EQ(to_vector(file.mesh.uv_indices), r.uv_indices);
  EXPECT_EQ(to_vector(file.mesh.normal_indices), r.normal_indices);
  EXPECT_EQ(to_vector(file.mesh.material_slots), r.slots);
  ASSERT_EQ(file.materials.size(), r.materials.size());
  for (std::size_t i = 0; i < r.materials.size(); ++i)
    EXPECT_EQ(file.materials[i].name, r.materials[i].empty() ? "default" : r.materials[i]);
}

bool same(const ObjFile& a, const ObjFile& b) {
  return to_vector(a.mesh.positions) == to_vector(b.mesh.positions) &&
         to_vector(a.mesh.normals) == to_vector(b.mesh.normals) &&
         to_vector(a.mesh.uvs) == to_vector(b.mesh.uvs) && indices_of(a) == indices_of(b) &&
         to_vector(a.mesh.uv_indices) == to_vector(b.mesh.uv_indices) &&
         to_vector(a.mesh.normal_indices) == to_vector(b.mesh.normal_indices) &&
         to_vector(a.mesh.material_slots) == to_vector(b.mesh.material_slots) && a.materials == b.materials;
}

TEST(ObjParallel, EqualsThePlainReader) {
  const ObjFiles files;
  for (std::uint32_t seed = 0; seed < 30; ++seed) {
    const std::string text = Writer(seed).write(500);
    const Reference reference = read_plainly(text);
    for (const std::size_t chunk_bytes :
         {std::size_t{1} << 20, std::size_t{1000}, std::size_t{37}, std::size_t{1}})
      expect_equal(files.load(text, {.chunk_bytes = chunk_bytes}), reference);
    if (HasFailure()) break;
  }
}

TEST(ObjParallel, EqualsThePlainReaderOnALargeFile) {
  const std::string text = Writer(99).write(50000);
  ASSERT_GT(text.size(), std::size_t{2} << 20);
  expect_equal(ObjFiles().load(text), read_plainly(text));
}

// Every byte gets to be the last of a chunk, in every kind of line end.
TEST(ObjParallel, ChunksMayEndAnywhere) {
  const ObjFiles files;
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string text;
    for (const char c : "vertices {\n" + kSquare +
                            "}\n\ntriangles {\n# c \\\nf 1 2 \\\n3\nusemtl a\\\nb\nf 1 3 4 # x\n}\nf 1 2 3 4")
      text += c == '\n' ? end : std::string(1, c);
    const ObjFile whole = files.load(text);
    ASSERT_EQ(whole.mesh.triangle_count(), 4u);
    for (std::size_t chunk_bytes = 1; chunk_bytes <= text.size() + 1; ++chunk_bytes)
      EXPECT_TRUE(same(whole, files.load(text, {.chunk_bytes = chunk_bytes}))) << chunk_bytes;
  }
}

// A long run of joined lines is one line, whatever its length.
TEST(ObjParallel, OneFaceMayCoverManyChunks) {
  std::string text = kSquare + "f";
  for (int i = 0; i < 1000; ++i) text += " \\\n" + std::to_string(1 + i % 4);
  const ObjFile file = ObjFiles().load(text + "\nf 1 2 3\n", {.chunk_bytes = 16});
  EXPECT_EQ(file.mesh.triangle_count(), 999u);
}

/// One small change: a byte, a piece taken out, doubled, or put in from a list of awkward words.
std::string mutate(std::string text, std::mt19937& random) {
  static const std::vector<std::string> awkward{"\n",
                                                "\r",
                                                " ",
                                                "\\\n",
                                                "#",
                                                "/",
                                                "//",
                                                "-",
                                                "f ",
                                                "v ",
                                                "vt ",
                                                "vn ",
                                                "{",
                                                "}",
                                                "nan",
                                                "1e99",
                                                "0",
                                                "-1",
                                                "99999999999",
                                                "usemtl x\n",
                                                "mtllib y\n",
                                                std::string(1, '\0'),
                                                "\xff",
                                                "l 1 2\n",
                                                "\t",
                                                ".",
                                                "e",
                                                "+",
                                                "vertices {\n",
                                                "f 1 2 3 4 5\n"};
  const auto below = [&random](std::size_t n) { return random() % n; };
  for (std::size_t i = 0, changes = 1 + below(4); i < changes; ++i) {
    const std::size_t at = below(text.size() + 1), length = below(12);
    switch (below(4)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(random());
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, text.substr(at, length));
        break;
      default:
        text.insert(at, awkward[below(awkward.size())]);
    }
  }
  return text;
}

// Damaged files load or are refused with a place in the file, and the number of tasks does not matter.
TEST(ObjParallel, DamagedFilesLoadOrAreRefused) {
  const ObjFiles files;
  std::mt19937 random(7);
  const std::string base = "vertices {\n" + kSquare +
                           "v 2 0 1\n}\nvt 0 0\nvn 0 0 1\nusemtl a\nf 1 2 3\nf 1/1/1 -1/1/1 2//1 3\n" +
                           "usemtl b\nf 1 2 3 4 5\ng x\nf 5 \\\n4 3\n# end\n";
  int loaded = 0, refused = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::string text = mutate(base, random);
    const std::string path = files.write("mesh.obj", text);
    std::string whole_error, parts_error;
    ObjFile whole, parts;
    try {
      whole = load_obj(path);
      ++loaded;
    } catch (const Error& e) {
      whole_error = e.what();
      EXPECT_EQ(e.kind(), ErrorKind::bad_input);
      EXPECT_GT(e.where().line, 0);
      ++refused;
    }
    try {
      parts = load_obj(path, {.chunk_bytes = 1 + random() % 60});
    } catch (const Error& e) {
      parts_error = e.what();
    }
    ASSERT_EQ(whole_error, parts_error) << text;
    for (const std::uint32_t index : whole.mesh.indices) ASSERT_LT(index, whole.mesh.positions.size());
    for (const std::uint16_t slot : whole.mesh.material_slots) ASSERT_LT(slot, whole.materials.size());
    // NaN normals are not equal to themselves.
    ASSERT_TRUE(same(whole, parts) || text.find("nan") != std::string::npos) << text;
    ASSERT_EQ(files.as_text(whole.warnings), files.as_text(parts.warnings)) << text;
  }
  EXPECT_GT(loaded, 300);
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace oktett::test::obj_parallel_test
