#include "bench/peer_scene.h"

#include <fmt/format.h>

#include <cmath>

#include "bench/meadow.h"
#include "core/random.h"
#include "io/mesh/load/load_mesh.h"

namespace oktett::bench {
namespace {

InstancePlace place(const Affine& to_list, std::size_t model) {
  InstancePlace p;
  to_list.to_rows(p.to_list);
  p.child = static_cast<std::uint32_t>(model);
  return p;
}

/// Random numbers from 0 to 1, the same in every run.
class Random {
 public:
  double operator()() { return static_cast<double>(random_float(key_, 0, count_++)); }
  Vec3d point() { return {(*this)(), (*this)(), (*this)()}; }

 private:
  std::uint64_t key_ = mix_bits(5);
  std::uint32_t count_ = 0;
};

/// Spheres of one radius, a part `relative` of the distance between neighbours, at random places of a box.
std::vector<SphereShape> scatter(const Box& box, std::size_t count, double relative) {
  Random random;
  const Vec3d lo(box.lo), extent(box.extent());
  const double radius = relative * std::cbrt(extent.x * extent.y * extent.z / static_cast<double>(count));
  std::vector<SphereShape> spheres(count);
  for (SphereShape& s : spheres) {
    const Vec3d p = random.point();
    // In floats, as Embree takes them.
    const Vec3f center(lo + Vec3d{p.x * extent.x, p.y * extent.y, p.z * extent.z});
    s = {Vec3d(center), static_cast<double>(static_cast<float>(radius))};
  }
  return spheres;
}

}  // namespace

std::size_t PeerScene::primitives() const {
  std::size_t count = spheres.size();
  for (const auto* list : {&meshes, &models})
    for (const Mesh& mesh : *list) count += mesh->triangle_count();
  return count;
}

Box PeerScene::bounds() const {
  Box box;
  for (const Vec3f& p : meshes.front()->positions) box.grow(p);
  return box;
}

PeerScene file_scene(const std::string& path) {
  PeerScene scene;
  scene.name = path.substr(path.rfind('/') + 1), scene.path = path;
  scene.meshes.push_back(std::make_shared<TriangleMesh>(load_mesh(path).mesh));
  return scene;
}

PeerScene room_scene(const PeerScene& mesh) {
  PeerScene scene;
  scene.name = mesh.name + " in a room", scene.meshes = mesh.meshes;
  scene.framed = mesh.bounds();
  const Vec3f center = scene.framed.center();
  // Twice the radius of the mesh. Cameras outside stand 2.2 radii from its centre, 1.8 along an axis.
  const float half = length(scene.framed.extent());
  auto room = std::make_shared<TriangleMesh>();
  for (int corner = 0; corner < 8; ++corner) {
    const auto side = [&](int bit) { return (corner >> bit & 1) != 0 ? half : -half; };
    room->positions.push_back(center + Vec3f{side(0), side(1), side(2)});
  }
  for (const std::uint32_t i : {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5})
    room->indices.push_back(i);
  scene.meshes.push_back(room);
  return scene;
}

PeerScene copies_scene(const PeerScene& mesh, std::size_t count) {
  PeerScene scene;
  scene.name = fmt::format("{} x {}", count, mesh.name), scene.models = mesh.meshes;
  const Box box = mesh.bounds();
  const double spacing = 0.8 * static_cast<double>(length(box.extent()));
  const auto side = static_cast<std::size_t>(std::ceil(std::cbrt(static_cast<double>(count))));
  Random random;
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = [&](std::size_t cell) { return static_cast<double>(cell % side) * spacing; };
    const Vec3d degrees = random.point() * 360.0;
    scene.places.push_back(place(Affine::translation({at(i), at(i / side), at(i / side / side)}) *
                                     Affine::rotation(degrees) * Affine::translation(-Vec3d(box.center())),
                                 0));
  }
  return scene;
}

PeerScene meadow_scene(std::size_t plants) {
  PeerScene scene;
  const Meadow meadow = make_meadow(plants);
  scene.name = fmt::format("{} plants", meadow.plants.size());
  for (const PlantModel& model : meadow.models) {
    auto mesh = std::make_shared<TriangleMesh>();
    for (const Vec3f& p : model.vertices) mesh->positions.push_back(p);
    for (const auto& part : model.faces)
      for (const auto& face : part)
        for (const std::uint32_t i : face) mesh->indices.push_back(i);
    scene.models.push_back(mesh);
  }
  for (const Meadow::Plant& p : meadow.plants)
    scene.places.push_back(place(
        Affine::translation(p.position) * Affine::rotation({0, p.degrees, 0}) * Affine::scaling(p.scale),
        p.model));
  return scene;
}

PeerScene spheres_scene(std::size_t count) {
  PeerScene scene;
  scene.name = fmt::format("{} spheres", count);
  scene.spheres = scatter({{0, 0, 0}, {1, 1, 1}}, count, 0.3);
  return scene;
}

PeerScene mixed_scene(const PeerScene& mesh, std::size_t count) {
  PeerScene scene;
  scene.name = mesh.name + " + spheres", scene.meshes = mesh.meshes;
  // So small that a quarter of the rays through a cube meet one of a million.
  scene.spheres = scatter(mesh.bounds(), count, 0.03);
  return scene;
}

OktettScene build(const PeerScene& scene, const BuildOptions& options) {
  OktettScene built;
  std::vector<Geometry> geometries;
  const auto refer_to = [&](const PeerScene::Mesh& mesh) {
    built.bytes +=
        mesh->positions.size() * sizeof(mesh->positions[0]) + mesh->indices.size() * sizeof(mesh->indices[0]);
    return Geometry{MeshGeometry{mesh.get()}, {}};
  };
  for (const PeerScene::Mesh& mesh : scene.meshes) geometries.push_back(refer_to(mesh));
  if (!scene.spheres.empty()) geometries.push_back({SpheresShape{scene.spheres}, {}});
  if (!scene.places.empty()) {
    InstanceList list;
    for (const PeerScene::Mesh& model : scene.models) {
      list.children.push_back(build_accel({refer_to(model)}, options));
      built.bytes += stats(*list.children.back()).bytes();
    }
    list.places = scene.places;
    geometries.push_back({std::move(list), {}});
  }
  built.accel = build_accel(std::move(geometries), options);
  built.bytes += stats(*built.accel).bytes();
  return built;
}

}  // namespace oktett::bench
