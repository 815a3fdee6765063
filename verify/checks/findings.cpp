#include "verify/checks/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <functional>
#include <memory>
#include <sstream>

#include "io/scene/scene_file.h"
#include "io/scene/write_scene.h"
#include "verify/oracles/known_shapes.h"

namespace oktett {

namespace {

/// Rays of one trial of an exact surface, and of one tree.
constexpr std::uint64_t kOneTrial = 1;

Finding with_ray(const std::string& what, const std::string& repeat) {
  Finding finding{what, repeat, {}, {}};
  if (const std::optional<Ray> ray = ray_in_text(what)) finding.rays.push_back(*ray);
  return finding;
}

Object object_of(Shape shape, const Affine& transform, std::string name = "") {
  Object object;
  object.shape = std::move(shape), object.transform = transform, object.name = std::move(name);
  return object;
}

/// The shape of a kernel's pair, if scenes have such shapes.
void add_shape(KernelId id, const KernelCases& cases, std::vector<Object>& objects) {
  const auto corner = [&](int k) {
    return Vec3d(Vec3f{cases.corner[k][0][0], cases.corner[k][1][0], cases.corner[k][2][0]});
  };
  const auto& s = cases.shape;
  const auto vec = [&](int k) { return Vec3d{s[k][0], s[k + 1][0], s[k + 2][0]}; };
  switch (id) {
    case KernelId::sphere_geometric:
    case KernelId::sphere_algebraic:
    case KernelId::sphere_in_range:
      return objects.push_back(object_of(SphereShape{vec(0), s[3][0]}, {}));
    case KernelId::plane:
      return objects.push_back(object_of(PlaneShape{vec(0), s[3][0]}, {}));
    case KernelId::disk:
      return objects.push_back(object_of(DiskShape{vec(0), vec(3), s[6][0], s[7][0]}, {}));
    case KernelId::box: {
      double rows[12];
      for (int k = 0; k < 12; ++k) rows[k] = s[k][0];
      return objects.push_back(object_of(BoxShape{}, Affine::from_rows(rows).inverse()));
    }
    case KernelId::slab:
      return;
    default: {
      const auto mesh = std::make_shared<TriangleMesh>();
      for (std::uint32_t k = 0; k < 3; ++k)
        mesh->positions.push_back(Vec3f(corner(static_cast<int>(k)))), mesh->indices.push_back(k);
      MeshShape shape;
      shape.mesh = mesh, shape.test = static_cast<TriangleTest>(id);
      return objects.push_back(object_of(shape, {}));
    }
  }
}

/// check_scene with each instruction set asked in all ways.
SceneTally check_all(const Scene& scene, const RayBatch& rays, const std::vector<Isa>& isas) {
  SceneTally sum;
  for (std::size_t turn = 0; turn < isas.size() && sum.failure.empty(); ++turn)
    sum.add(check_scene(scene, rays, isas, turn));
  return sum;
}

RayBatch rays_without(const RayBatch& rays, std::size_t begin, std::size_t end) {
  RayBatch rest;
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (i < begin || i >= end) rest.push_back(rays[i]);
  return rest;
}

/// Makes a finding smaller.
class Minimizer {
 public:
  Minimizer(Finding& finding, const std::vector<Isa>& isas, double seconds)
      : finding_(finding),
        isas_(isas),
        end_(std::chrono::steady_clock::now() +
             std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                 std::chrono::duration<double>(seconds))) {}

  bool run() {
    if (!fails(finding_.scene, finding_.rays)) return false;
    if (const std::optional<Ray> ray = ray_in_text(finding_.what)) {
      RayBatch one;
      one.push_back(*ray);
      if (fails(finding_.scene, one)) finding_.rays = std::move(one);
    }
    reduce_objects(finding_.scene.objects);
    for (std::size_t k = 0; k < finding_.scene.prototypes.size(); ++k)
      reduce_objects(finding_.scene.prototypes[k].objects);
    reduce_rays();
    drop_unused_prototypes();
    return true;
  }

 private:
  bool fails(const Scene& scene, const RayBatch& rays) {
    const SceneTally tally = check_all(scene, rays, isas_);
    if (tally.wrong() > 0) finding_.what = tally.failure;
    return tally.wrong() > 0;
  }
  bool in_time() const { return std::chrono::steady_clock::now() < end_; }

  /// `objects` belongs to the finding's scene.
  void reduce_objects(std::vector<Object>& objects) {
    for (std::size_t i = objects.size(); i-- > 0 && objects.size() > 1 && in_time();) {
      const Object removed = objects[i];
      objects.erase(objects.begin() + static_cast<std::ptrdiff_t>(i));
      if (!fails(finding_.scene, finding_.rays))
        objects.insert(objects.begin() + static_cast<std::ptrdiff_t>(i), removed);
    }
    for (Object& object : objects) reduce_operands(object);
  }

  void reduce_operands(Object& object) {
    const auto* csg = std::get_if<CsgShape>(&object.shape);
    if (csg == nullptr) return;
    for (std::size_t i = csg->operands->size(); i-- > 0 && csg->operands->size() > 1 && in_time();) {
      const CsgShape before = *csg;
      std::vector<Object> rest = *before.operands;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
      object.shape = CsgShape{before.op, std::make_shared<const std::vector<Object>>(std::move(rest))};
      if (!fails(finding_.scene, finding_.rays)) object.shape = before;
      csg = std::get_if<CsgShape>(&object.shape);
    }
  }

  /// By halves, quarters and so on.
  void reduce_rays() {
    for (std::size_t size = finding_.rays.size() / 2; size > 0 && in_time(); size /= 2)
      for (std::size_t begin = 0; begin < finding_.rays.size() && finding_.rays.size() > 1 && in_time();) {
        RayBatch rest = rays_without(finding_.rays, begin, begin + size);
        if (rest.size() > 0 && fails(finding_.scene, rest))
          finding_.rays = std::move(rest);
        else
          begin += size;
      }
  }

  static void visit_instances(std::vector<Object>& objects,
                              const std::function<void(InstanceShape&)>& visit) {
    for (Object& object : objects)
      if (auto* instance = std::get_if<InstanceShape>(&object.shape)) visit(*instance);
  }

  void drop_unused_prototypes() {
    std::vector<Prototype>& prototypes = finding_.scene.prototypes;
    for (std::size_t k = prototypes.size(); k-- > 0;) {
      bool used = false;
      const auto each = [&](const std::function<void(InstanceShape&)>& visit) {
        visit_instances(finding_.scene.objects, visit);
        for (Prototype& p : prototypes) visit_instances(p.objects, visit);
      };
      each([&](InstanceShape& instance) { used |= instance.prototype == k; });
      if (used) continue;
      prototypes.erase(prototypes.begin() + static_cast<std::ptrdiff_t>(k));
      each([&](InstanceShape& instance) { instance.prototype -= instance.prototype > k; });
    }
  }

  Finding& finding_;
  const std::vector<Isa>& isas_;
  std::chrono::steady_clock::time_point end_;
};

/// A camera at the ray's origin that looks along it.
Camera camera_along(const Ray& ray) {
  Camera camera;
  const Vec3d d(ray.direction);
  camera.from = Vec3d(ray.origin), camera.at = camera.from + d;
  if (std::abs(d.y) > std::abs(d.x) + std::abs(d.z)) camera.up = {1, 0, 0};
  return camera;
}

/// Runs the check that a finding names once more.
std::string repeated(const std::string& repeat, const std::vector<Isa>& isas) {
  std::istringstream words(repeat);
  std::string check, name, kind;
  std::uint64_t first = 0, count = 0, placement = 0;
  int degree = 0;
  words >> check;
  if (check == "kernel" && words >> name >> kind >> first) {
    for (int k = 0; k < kKernels; ++k)
      for (int c = 0; c < kCaseClasses; ++c)
        if (name == to_string(static_cast<KernelId>(k)) && kind == to_string(static_cast<CaseClass>(c)))
          return verify_kernel(static_cast<KernelId>(k), static_cast<CaseClass>(c), 1, isas, first).failure;
  } else if (check == "surface" && words >> name >> first) {
    const std::vector<std::string> names = exact_oracle_names();
    const auto form = std::ranges::find(names, name);
    if (form != names.end())
      return verify_exact(static_cast<std::size_t>(form - names.begin()), kOneTrial, isas, first).failure;
  } else if (check == "combination" && words >> first) {
    return verify_csg(kOneTrial, isas, first).failure;
  } else if (check == "changes" && words >> first) {
    return verify_changes(1, isas, first).failure;
  } else if (check == "trace_scene" && words >> first) {
    return verify_trace_scenes(1, isas, first).failure;
  } else if (check == "scene" && words >> first) {
    return verify_scenes(1, isas, first).failure;
  } else if (check == "roots" && words >> degree >> first && degree >= 1 && degree <= kKnownRootsDegree) {
    return verify_roots(degree, 1, first).failure;
  } else if (check == "mesh" && words >> name >> placement >> first >> count) {
    const auto placements = mesh_placements();
    for (const OracleMesh& mesh : make_closed_meshes())
      if (mesh.name == name && placement < placements.size())
        return verify_mesh(mesh, placements[placement], count, isas, {}, first).failure;
  }
  throw Error(fmt::format("unknown check '{}'", repeat));
}

}  // namespace

Finding finding_of(KernelId id, CaseClass c, const KernelTally& tally) {
  Finding finding = with_ray(
      tally.failure, fmt::format("kernel {} {} {}", to_string(id), to_string(c), tally.first_failure));
  KernelCases cases;
  cases.fill(id, c, tally.first_failure, 1);
  add_shape(id, cases, finding.scene.objects);
  return finding;
}

Finding finding_of(std::size_t form, const ExactTally& tally) {
  Finding finding =
      with_ray(tally.failure, fmt::format("surface {} {}", exact_oracle_names()[form], tally.trial));
  const ExactTrial trial = exact_trial(form, tally.trial);
  finding.scene.objects.push_back(
      object_of(trial.oracle.shape, trial.to_world, known_name(form, tally.trial)));
  return finding;
}

Finding finding_of(const CsgTally& tally) {
  return with_ray(tally.failure, fmt::format("combination {}", tally.tree));
}

Finding finding_of(const ChangesTally& tally) {
  return with_ray(tally.failure, fmt::format("changes {}", tally.sequence));
}

Finding finding_of(const TraceScenesTally& tally) {
  return with_ray(tally.failure, fmt::format("trace_scene {}", tally.scene));
}

Finding finding_of(const OracleMesh& mesh, std::size_t placement, std::uint64_t first, std::uint64_t count,
                   const MeshTally& tally) {
  Finding finding =
      with_ray(tally.failure, fmt::format("mesh {} {} {} {}", mesh.name, placement, first, count));
  MeshShape shape;
  shape.mesh = std::make_shared<TriangleMesh>(placed_as(mesh.mesh, mesh_placements()[placement]));
  finding.scene.objects.push_back(object_of(shape, {}));
  return finding;
}

Finding finding_of(int degree, const RootsTally& tally) {
  return {tally.failure, fmt::format("roots {} {}", degree, tally.first_failure), {}, {}};
}

Finding finding_of(const SceneTally& tally) {
  Finding finding{tally.failure, fmt::format("scene {}", tally.scene), draw_scene(tally.scene), {}};
  finding.rays = draw_rays(finding.scene, tally.scene);
  return finding;
}

bool minimize(Finding& finding, const std::vector<Isa>& isas, double seconds) {
  return finding.rays.size() > 0 && !finding.scene.objects.empty() && Minimizer(finding, isas, seconds).run();
}

void save_finding(const std::string& path, const Finding& finding) {
  Scene scene = finding.scene;
  std::string comment = "wrong: " + finding.what + "\nrepeat: " + finding.repeat + "\n";
  for (std::size_t i = 0; i < finding.rays.size(); ++i)
    comment += "ray: " + exact_text(finding.rays[i]) + "\n";
  if (finding.rays.size() > 0) scene.camera = camera_along(finding.rays[0]), scene.camera_given = true;
  write_scene_file(path, scene, comment);
}

Finding load_finding(const std::string& path) {
  Finding finding;
  finding.scene = load_scene_file(path);
  std::ifstream lines(path);
  for (std::string line; std::getline(lines, line) && line.starts_with("# ");) {
    const std::size_t colon = line.find(": ");
    const std::string key = line.substr(2, colon - 2),
                      value = line.substr(std::min(colon, line.size() - 2) + 2);
    if (key == "wrong") finding.what = value;
    if (key == "repeat") finding.repeat = value;
    if (key != "ray") continue;
    const std::optional<Ray> ray = ray_in_text(value);
    if (!ray) throw Error(Location{path, 0, 0}, "expected a ray, found '" + value + "'");
    finding.rays.push_back(*ray);
  }
  if (finding.repeat.empty())
    throw Error(Location{path, 0, 0}, "expected a finding of oktett verify, which begins with '# wrong:'");
  return finding;
}

std::vector<std::string> replay(const Finding& finding, const std::vector<Isa>& isas) {
  std::vector<std::string> wrong;
  if (finding.rays.size() > 0 && !finding.scene.objects.empty()) {
    const SceneTally tally = check_all(finding.scene, finding.rays, isas);
    if (!tally.failure.empty()) wrong.push_back("this scene: " + tally.failure);
  }
  if (const std::string failure = repeated(finding.repeat, isas); !failure.empty())
    wrong.push_back(finding.repeat + ": " + failure);
  return wrong;
}

}  // namespace oktett
