#include <utility>

#include "io/scene/number_line.h"
#include "io/scene/readers.h"
#include "io/scene/schema.h"

namespace oktett {
namespace {

/// Adds the spheres that have a radius and warns once of the others.
class SphereList {
 public:
  explicit SphereList(SceneLoad& load) : load_(load) {}

  /// Counts a sphere that is about to be read at `place`.
  void count(const Location& place) {
    if (++load_.spheres > kMaxSpheres)
      throw Error(place, "the scene has more than " + std::to_string(kMaxSpheres) + " spheres in lists");
  }
  void add(const SphereShape& sphere, const Location& place) {
    if (sphere.radius > 0) return shape_.spheres.push_back(sphere);
    if (skipped_++ == 0) first_skipped_ = place;
  }
  std::optional<Shape> finish(const YamlNode& key) {
    if (skipped_ > 0)
      load_.warn(first_skipped_, skipped_ == 1
                                     ? "the radius is zero; the sphere is skipped"
                                     : "the radius is zero; this and " + std::to_string(skipped_ - 1) +
                                           " other spheres are skipped");
    if (!shape_.spheres.empty()) return std::move(shape_);
    load_.warn(key.where(), "there are no spheres; the object is skipped");
    return std::nullopt;
  }

 private:
  SceneLoad& load_;
  SpheresShape shape_;
  Location first_skipped_;
  std::size_t skipped_ = 0;
};

/// Spheres of one radius, or those of a file.
struct SpheresKeys {
  double radius = 1;

  void describe(auto& p) {
    p.optional("centers", ByHand{"list of points", "points"}, "the centres");
    p.field("radius", radius, kNonNegative, "of all of them");
    p.optional("file", ByHand{"file", "file"}, "text of lines `x y z radius`");
    p.one_of({"centers", "file"});
    p.not_both("file", "centers", "spheres from a file have no 'centers'", "centers");
    p.not_both("file", "radius", "spheres from a file have no 'radius'", "radius");
  }
};

SphereShape sphere_of(NumberLine& line) {
  SphereShape s;
  for (int axis = 0; axis < 3; ++axis) s.center[axis] = line.number();
  s.radius = line.number();
  if (s.radius < 0) line.reject("expected a radius of at least 0");
  line.finish();
  return s;
}

}  // namespace

std::optional<Shape> read_spheres(SceneLoad& load, const YamlNode& key, const YamlNode& node) {
  SphereList list(load);
  if (node.kind == YamlKind::sequence || node.kind == YamlKind::null) {
    for (const YamlNode* item : list_items(node, "spheres"))
      attempt(*item, [&] {
        list.count(item->where());
        SphereShape sphere;
        read_described(load, *item, "sphere", sphere);
        list.add(sphere, item->where());
      });
    return list.finish(key);
  }
  SpheresKeys keys;
  const Fields fields = read_described(load, node, "spheres", keys);
  if (const YamlNode* file = fields["file"]) {
    read_number_file(load, *file, kMaxSphereFileBytes, "the sphere files", "4 numbers (x y z radius)",
                     [&](NumberLine& line) {
                       list.count(line.place());
                       list.add(sphere_of(line), line.place());
                     });
    return list.finish(key);
  }
  for (const YamlNode* center : list_items(fields.require("centers"), "centers")) {
    list.count(center->where());
    list.add({load.values.vector(*center), keys.radius}, center->where());
  }
  return list.finish(key);
}

std::string spheres_schema(Schema& schema) {
  const std::string sphere = schema.map(SphereShape::kShapeInfo.key, SphereShape{});
  return Schema::any_of({Schema::list(sphere), schema.map("spheres", SpheresKeys{})});
}

}  // namespace oktett
