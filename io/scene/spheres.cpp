#include "io/scene/spheres.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "io/scene/number_line.h"
#include "io/scene/shape_reader.h"

namespace oktett {
namespace {

void count_spheres(SceneLoad& load, std::size_t count, const Location& place) {
  load.spheres += count;
  if (load.spheres > kMaxSpheres)
    throw Error(place, "the scene has more than " + std::to_string(kMaxSpheres) + " spheres in lists");
}

void warn_zero_radius(SceneLoad& load, const Location& first, std::size_t count) {
  if (count == 0) return;
  load.warn(first, count == 1 ? "the radius is zero; the sphere is skipped"
                              : "the radius is zero; this and " + std::to_string(count - 1) +
                                    " other spheres are skipped");
}

/// Adds the spheres that have a radius and warns once of the others.
class SphereList {
 public:
  explicit SphereList(SceneLoad& load) : load_(load) {}
  void add(const SphereShape& sphere, const Location& place) {
    if (sphere.radius > 0) return shape_.spheres.push_back(sphere);
    if (skipped_++ == 0) first_skipped_ = place;
  }
  SpheresShape finish() {
    warn_zero_radius(load_, first_skipped_, skipped_);
    return std::move(shape_);
  }

 private:
  SceneLoad& load_;
  SpheresShape shape_;
  Location first_skipped_;
  std::size_t skipped_ = 0;
};

SphereShape sphere_of(NumberLine& line) {
  SphereShape s;
  for (int axis = 0; axis < 3; ++axis) s.center[axis] = line.number();
  s.radius = line.number();
  if (s.radius < 0) line.reject("expected a radius of at least 0");
  line.finish();
  return s;
}

SpheresShape read_sphere_file(SceneLoad& load, const YamlNode& node) {
  const std::string path = load.values.existing_file(node);
  const std::string text = read_text_file(path, kMaxSphereFileBytes);
  load.sphere_file_bytes += text.size();
  if (load.sphere_file_bytes > kMaxSphereFileBytes)
    throw Error(node.where(), "the sphere files are larger than " +
                                  std::to_string(kMaxSphereFileBytes >> 20) + " MiB in all");
  SphereList list(load);
  Location place{path, 0, 1};
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    ++place.line;
    NumberLine line(std::string_view(text).substr(begin, end - begin), place, "4 numbers (x y z radius)");
    if (!line.empty()) {
      count_spheres(load, 1, place);
      list.add(sphere_of(line), place);
    }
    begin = end + 1;
  }
  return list.finish();
}

SpheresShape read_centers(SceneLoad& load, const Fields& fields) {
  double radius = 1;
  load.values.read(fields["radius"], radius, kNonNegative);
  SphereList list(load);
  for (const YamlNode* center : list_items(fields.require("centers"), "centers")) {
    count_spheres(load, 1, center->where());
    list.add({load.values.vector(*center), radius}, center->where());
  }
  return list.finish();
}

}  // namespace

SpheresShape read_spheres(SceneLoad& load, const YamlNode& node) {
  if (node.kind == YamlKind::sequence) {
    SphereList list(load);
    for (const YamlNode* item : node.items) {
      count_spheres(load, 1, item->where());
      SphereShape sphere;
      read_described(load, *item, "sphere", sphere);
      list.add(sphere, item->where());
    }
    return list.finish();
  }
  const Fields fields(node, "spheres", {"centers", "radius", "file"});
  const YamlNode* file = fields["file"];
  if (!file) return read_centers(load, fields);
  for (const char* other : {"centers", "radius"})
    if (const YamlNode* value = fields[other])
      throw Error(value->where(), std::string("spheres from a file have no '") + other + "'");
  return read_sphere_file(load, *file);
}

}  // namespace oktett
