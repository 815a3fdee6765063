#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "accel/traverse/trace_counts.h"
#include "app/command_line.h"
#include "app/gltf_words.h"
#include "app/json.h"
#include "app/limits.h"
#include "app/render_options.h"
#include "app/text.h"
#include "core/box.h"
#include "core/mesh_geometry.h"
#include "io/scene/scene_file.h"
#include "io/scene/schema.h"
#include "io/scene/surface_table.h"
#include "kernels/exact_ops.h"
#include "render/camera.h"
#include "render/geometry.h"
#include "render/picture/prepared_scene.h"
#include "render/scene.h"

namespace oktett {

// ---- Counting what a scene holds.

/// Things that instances show several times count once, unless stated otherwise.
struct SceneSummary {
  std::uint64_t meshes = 0;
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;
  std::uint64_t mesh_bytes = 0;
  std::uint64_t other_shapes = 0;  ///< objects that are neither mesh nor instance; a list of spheres, points
                                   ///< and lines count each
  std::uint64_t instances = 0;
  double triangles_shown = 0;        ///< counting every instance
  std::uint64_t unbounded = 0;       ///< infinite planes
  Box bounds;                        ///< of all that is shown and bounded; empty if nothing is
  std::uint64_t open_edges = 0;      ///< summed over meshes; see find_open_edges
  std::set<std::string> attributes;  ///< names of what meshes carry
};

namespace {

void grow(Box& box, const Vec3d& p) { box.grow(Box{round_down(p), round_up(p)}); }

/// Bounds of one shape in its own space; empty if it is unbounded.
struct ShapeBounds {
  const std::vector<Box>& prototypes;

  Box operator()(const MeshShape& shape) const {
    Box box = shape.mesh ? corner_box(*shape.mesh) : Box{};
    const auto r = static_cast<float>(shape.stroke_width / 2);
    if (!box.empty() && r > 0) box.grow(box.lo - Vec3f{r, r, r}), box.grow(box.hi + Vec3f{r, r, r});
    return box;
  }
  template <class T>
  Box operator()(const T& shape) const {
    if constexpr (requires { shape.bounds(); })
      return shape.bounds();
    else
      return {};
  }
  Box operator()(const ExactShape& shape) const { return exact_bounds(shape, {}); }
  Box operator()(const CsgShape& shape) const;
  Box operator()(const InstanceShape& shape) const {
    return shape.prototype < prototypes.size() ? prototypes[shape.prototype] : Box{};
  }
};

/// Tight for a mesh, whose box would grow when it is turned.
Box object_bounds(const Object& object, const std::vector<Box>& prototypes) {
  const auto* shape = std::get_if<MeshShape>(&object.shape);
  if (shape == nullptr || shape->stroke_width > 0 || object.transform.is_identity()) {
    const Box box = std::visit(ShapeBounds{prototypes}, object.shape);
    return box.empty() || object.transform.is_identity() ? box : transform_bounds(object.transform, box);
  }
  Box box;
  each_corner(*shape->mesh,
              [&](const Vec3f& p) { grow(box, object.transform.point(static_cast<Vec3d>(p))); });
  return box;
}

/// Bounds of all operands together: what remains of them is known only after building the combination.
Box ShapeBounds::operator()(const CsgShape& shape) const {
  Box box;
  for (const Object& object : *shape.operands) box.grow(object_bounds(object, prototypes));
  return box;
}

class Counter {
 public:
  explicit Counter(const Scene& scene) {
    // A prototype holds instances of those before it only.
    for (const Prototype& prototype : scene.prototypes) {
      prototype_triangles_.push_back(count(prototype.objects));
      prototype_bounds_.push_back(std::exchange(summary_.bounds, {}));
    }
    summary_.triangles_shown = count(scene.objects);
  }

  const SceneSummary& summary() const { return summary_; }

 private:
  /// Returns the triangles that the objects show, including the contents of instances, and grows the bounds.
  double count(const std::vector<Object>& objects) {
    double triangles = 0;
    for (const Object& object : objects) {
      summary_.bounds.grow(object_bounds(object, prototype_bounds_));
      triangles += count_shape(object.shape);
    }
    return triangles;
  }

  /// Returns the triangles that the shape shows.
  double count_shape(const Shape& shape) {
    if (const auto* mesh = std::get_if<MeshShape>(&shape)) return count_mesh(*mesh);
    if (const auto* instance = std::get_if<InstanceShape>(&shape)) {
      ++summary_.instances;
      return instance->prototype < prototype_triangles_.size() ? prototype_triangles_[instance->prototype]
                                                               : 0;
    }
    const auto* spheres = std::get_if<SpheresShape>(&shape);
    summary_.other_shapes += spheres != nullptr ? spheres->spheres.size() : 1;
    summary_.unbounded += std::holds_alternative<PlaneShape>(shape) ? 1 : 0;
    return 0;
  }

  double count_mesh(const MeshShape& shape) {
    if (!shape.mesh) return 0;
    const TriangleMesh& mesh = *shape.mesh;
    if (shape.stroke_width > 0) {
      summary_.other_shapes += mesh.triangle_count();
      for (const MeshAttribute& a : mesh.attributes) summary_.attributes.insert(a.name);
      return 0;
    }
    if (seen_.insert(&mesh).second) {
      ++summary_.meshes;
      summary_.triangles += mesh.triangle_count();
      summary_.vertices += mesh.positions.size();
      summary_.mesh_bytes += mesh.bytes();
      summary_.open_edges += find_open_edges(mesh).count;
      for (const MeshAttribute& a : mesh.attributes) summary_.attributes.insert(a.name);
    }
    return static_cast<double>(mesh.triangle_count());
  }

  SceneSummary summary_;
  std::set<const TriangleMesh*> seen_;
  std::vector<Box> prototype_bounds_;
  std::vector<double> prototype_triangles_;
};

}  // namespace

static SceneSummary summarize(const Scene& scene) { return Counter(scene).summary(); }

namespace {

struct InfoArguments {
  std::string file;
  LimitArguments limits;
  std::vector<std::string> definitions;
  std::string pov_files;
  GltfWords gltf;
  std::string bvh;
  bool json = false;
  bool trace = false;
};

std::string closed_text(const SceneSummary& summary) {
  if (summary.meshes == 0) return "-";
  return summary.open_edges == 0 ? "closed" : grouped(summary.open_edges) + " open edges";
}

/// A double, because recursive instances can show more triangles than an integer holds.
std::string count_text(double count) {
  return count < 1e15 ? grouped(static_cast<std::uint64_t>(count)) : fmt::format("{:.3g}", count);
}

/// `origin`: of the scene.
std::string bounds_text(const Box& box, const Vec3d& origin) {
  if (box.empty()) return "none";
  if (!(origin == Vec3d{})) {
    const Vec3d lo = origin + Vec3d(box.lo), hi = origin + Vec3d(box.hi);
    return fmt::format("[{:.10g}, {:.10g}, {:.10g}] to [{:.10g}, {:.10g}, {:.10g}]", lo.x, lo.y, lo.z, hi.x,
                       hi.y, hi.z);
  }
  return fmt::format("[{:g}, {:g}, {:g}] to [{:g}, {:g}, {:g}]", box.lo.x, box.lo.y, box.lo.z, box.hi.x,
                     box.hi.y, box.hi.z);
}

struct TreeSummary {
  World world;
  double build_seconds = 0;
  std::optional<TraceCounts> counts;
};

/// The rays through the centres of the pixels of a frame, at most about a million.
RayBatch camera_rays(const Scene& scene, const Box& bounds) {
  Film film = scene.film;
  constexpr std::uint32_t kMostPixels = 1024;
  film.width = std::min(film.width, kMostPixels), film.height = std::min(film.height, kMostPixels);
  const Camera camera = scene.camera_given ? scene.camera : frame_bounds(bounds, scene.camera, film);
  const CameraFrame frame = camera_frame(camera, film);
  RayBatch rays;
  for (std::uint32_t y = 0; y < film.height; ++y)
    for (std::uint32_t x = 0; x < film.width; ++x) rays.push_back(camera_ray(frame, x + 0.5, y + 0.5));
  return rays;
}

TreeSummary build_trees(const Scene& scene, const InfoArguments& arguments) {
  const BuildOptions options = parse_bvh_option(arguments.bvh);
  const auto start = std::chrono::steady_clock::now();
  TreeSummary tree;
  tree.world = build_world(scene, options);
  tree.build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (arguments.trace)
    tree.counts = trace_counts(*tree.world.accel, camera_rays(scene, tree.world.bounds).span());
  return tree;
}

/// What one ray met on average, in the order in which it is printed.
std::vector<std::pair<const char*, double>> per_ray(const TraceCounts& c) {
  const double rays = static_cast<double>(std::max<std::uint64_t>(c.rays, 1));
  const auto mean = [&](std::uint64_t n) { return static_cast<double>(n) / rays; };
  return {{"nodes", mean(c.nodes)},   {"boxes", mean(c.boxes)},
          {"blocks", mean(c.blocks)}, {"triangles", mean(c.triangles)},
          {"other", mean(c.other)},   {"instances", mean(c.instances)},
          {"hits", mean(c.hits)}};
}

void print_text(const Scene& scene, const SceneSummary& summary, const TreeSummary& tree) {
  const auto line = [](const char* name, const std::string& value) { fmt::print("{:<18}{}\n", name, value); };
  line("file", scene.source);
  line("meshes", grouped(summary.meshes));
  line("triangles", grouped(summary.triangles));
  if (summary.instances > 0) line("  with instances", count_text(summary.triangles_shown));
  line("vertices", grouped(summary.vertices));
  line("surface", closed_text(summary));
  if (!summary.attributes.empty()) line("attributes", fmt::format("{}", fmt::join(summary.attributes, ", ")));
  line("other shapes", grouped(summary.other_shapes));
  if (summary.unbounded > 0) line("  unbounded", grouped(summary.unbounded));
  line("instances", grouped(summary.instances));
  line("prototypes", grouped(scene.prototypes.size()));
  line("materials", grouped(scene.materials.size()));
  line("textures", grouped(scene.textures.size()));
  line("lights", scene.lights_given ? grouped(scene.lights.size()) : "default");
  line("camera", scene.camera_given ? "given" : "default");
  line("bounds", bounds_text(summary.bounds, scene.origin));
  line("mesh memory", bytes_text(summary.mesh_bytes));
  line("BVH memory", bytes_text(tree.world.bvh_bytes));
  if (tree.world.triangles > 0) {
    const double all = static_cast<double>(tree.world.bvh_bytes + summary.mesh_bytes);
    line("  per triangle",
         fmt::format("{:.1f} bytes with the mesh", all / static_cast<double>(tree.world.triangles)));
  }
  line("BVH cost", fmt::format("{:.2f} (expected nodes and leaves per ray)", tree.world.sah_cost));
  line("BVH build", fmt::format("{:.3g} s", tree.build_seconds));
  if (!tree.counts) return;
  line("camera rays", grouped(tree.counts->rays));
  for (const auto& [name, mean] : per_ray(*tree.counts))
    line(fmt::format("  {}", name).c_str(), fmt::format("{:.3g} per ray", mean));
}

void print_json(const Scene& scene, const SceneSummary& summary, const TreeSummary& tree) {
  JsonObject all{{"file", scene.source},
                 {"meshes", summary.meshes},
                 {"triangles", summary.triangles},
                 {"triangles_shown", summary.triangles_shown},
                 {"vertices", summary.vertices},
                 {"open_edges", summary.open_edges},
                 {"closed", summary.meshes > 0 && summary.open_edges == 0},
                 {"other_shapes", summary.other_shapes},
                 {"unbounded", summary.unbounded},
                 {"instances", summary.instances},
                 {"prototypes", scene.prototypes.size()},
                 {"materials", scene.materials.size()},
                 {"textures", scene.textures.size()},
                 {"lights", scene.lights.size()},
                 {"camera_given", scene.camera_given}};
  if (const Box& box = summary.bounds; !box.empty())
    for (const auto& [key, corner] : {std::pair{"bounds_min", box.lo}, {"bounds_max", box.hi}}) {
      const Vec3d there = scene.origin + Vec3d(corner);
      all.add({{key, std::vector<double>{there.x, there.y, there.z}}});
    }
  all.add({{"mesh_bytes", summary.mesh_bytes},
           {"bvh_bytes", tree.world.bvh_bytes},
           {"sah_cost", tree.world.sah_cost},
           {"build_seconds", tree.build_seconds}});
  if (tree.counts) {
    JsonObject counts{{"rays", tree.counts->rays}};
    for (const auto& [name, mean] : per_ray(*tree.counts)) counts.add(name, mean);
    all.add("per_camera_ray", counts);
  }
  fmt::print("{}\n", all.text());
}

int run_info(const InfoArguments& arguments) {
  apply_limits(arguments.limits);
  const Scene scene = load_scene(arguments.file, parse_definitions(arguments.definitions), std::nullopt,
                                 gltf_options(arguments.gltf), {kPovFilm, arguments.pov_files});
  print_warnings(scene.warnings);
  const SceneSummary summary = summarize(scene);
  const TreeSummary tree = build_trees(scene, arguments);
  if (arguments.json)
    print_json(scene, summary, tree);
  else
    print_text(scene, summary, tree);
  return 0;
}

}  // namespace

void add_info_command(CommandLine& line) {
  const auto arguments = std::make_shared<InfoArguments>();
  Verb verb = line.add_verb("info", "Print what a scene file or a mesh holds",
                            [arguments] { return run_info(*arguments); });
  verb.positional("file", arguments->file, "FILE", "Scene file (.yaml, .pov) or mesh");
  verb.option("-D", &arguments->definitions, "k=v", "Define ${k} of the scene file; may be repeated");
  add_pov_files_option(verb, arguments->pov_files);
  add_gltf_options(verb, arguments->gltf, false);
  add_stroke_option(verb, arguments->gltf);
  add_bvh_option(verb, arguments->bvh);
  verb.flag("--trace", arguments->trace, "Trace the camera's rays and print what they met in the tree");
  verb.flag("--json", arguments->json, "Print one JSON object");
  add_limit_options(verb, arguments->limits);
  verb.notice("--shapes", surface_table, "Print the shapes of scene files as a table and exit");
  verb.notice("--patterns", pattern_table, "Print the patterns of textures as a table and exit");
  verb.notice("--schema", scene_schema, "Print the JSON Schema of scene files and exit");
}

}  // namespace oktett
