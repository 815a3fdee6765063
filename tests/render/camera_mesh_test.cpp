// Cameras whose rays start at the faces of meshes: which face a pixel has, and where its ray goes, against
// what POV-Ray 3.7.0.10 shows of walls that are coloured by place, and against a search of all faces.

#include "render/camera_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "render/camera.h"
#include "render/recentre.h"

namespace oktett::camera_mesh_test {
namespace {

struct Corner {
  Vec3f place, normal;
  Vec2f uv;
};

std::shared_ptr<const TriangleMesh> mesh_of(const std::vector<Corner>& corners, bool normals = false) {
  auto mesh = std::make_shared<TriangleMesh>();
  for (const Corner& c : corners) {
    const auto index = static_cast<std::uint32_t>(mesh->positions.size());
    mesh->positions.push_back(c.place), mesh->uvs.push_back(c.uv);
    mesh->indices.push_back(index), mesh->uv_indices.push_back(index);
    if (normals) mesh->normals.push_back(c.normal), mesh->normal_indices.push_back(index);
  }
  return mesh;
}

/// Six faces in two rows of three, whose fronts look to +z, each with its middle 0.1 from its lower left
/// corner.
std::shared_ptr<const TriangleMesh> six_faces(float right, float up) {
  std::vector<Corner> corners;
  for (const float y : {1.f, -1.f})
    for (const float x : {-3.f, -1.f, 1.f})
      for (const Vec2f d : {Vec2f{0, 0}, Vec2f{0.3f, 0}, Vec2f{0, 0.3f}})
        corners.push_back({{x + right + d.x, y + up + d.y, 0}, {}, {}});
  return mesh_of(corners);
}

/// A square from -2 to 2 in x and y, whose texture coordinates are 0 at the lower left.
std::shared_ptr<const TriangleMesh> square(bool normals = false) {
  std::vector<Corner> corners;
  for (const Vec2f at : {Vec2f{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}})
    corners.push_back({{2 * at.x, 2 * at.y, 0}, {at.x / 2, at.y / 2, 1}, {at.x / 2 + 0.5f, at.y / 2 + 0.5f}});
  return mesh_of(corners, normals);
}

using Settings = CameraMesh::Settings;

/// Where the ray of the middle of a pixel meets the plane z = `wall`; nothing if it has none, or does not
/// reach the plane.
std::optional<Vec3d> seen(const CameraMesh& mesh, std::uint32_t x, std::uint32_t y, std::uint32_t width,
                          std::uint32_t height, double wall, double along = 0.5) {
  const Ray ray = mesh.ray({x + along, y + 0.5, width, height}, {});
  const double t = (wall - ray.origin.z) / ray.direction.z;
  if (!(t > ray.tmin && t <= ray.tmax)) return std::nullopt;
  return Vec3d(ray.origin) + Vec3d(ray.direction) * t;
}

void expect_place(const std::optional<Vec3d>& found, double x, double y) {
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->x, x, 0.005);
  EXPECT_NEAR(found->y, y, 0.005);
}

/// POV-Ray shows -2.90, 1.10 and so on, its rows moved by one.
TEST(CameraMesh, PixelsCountFaces) {
  const CameraMesh mesh({{six_faces(0, 0), {}}}, Settings{});
  expect_place(seen(mesh, 0, 0, 3, 2, 5), -2.90, 1.10);
  expect_place(seen(mesh, 1, 0, 3, 2, 5), -0.90, 1.10);
  expect_place(seen(mesh, 0, 1, 3, 2, 5), -2.90, -0.90);
  expect_place(seen(mesh, 2, 1, 3, 2, 5), 1.10, -0.90);
  // In a wider picture rows begin elsewhere, and the last pixels have no face.
  expect_place(seen(mesh, 3, 0, 4, 2, 5), -2.90, -0.90);
  expect_place(seen(mesh, 1, 1, 4, 2, 5), 1.10, -0.90);
  EXPECT_FALSE(seen(mesh, 2, 1, 4, 2, 5));
  EXPECT_TRUE(leaves_out(mesh.ray({2.5, 1.5, 4, 2}, {})));
}

TEST(CameraMesh, SamplesTakeMeshesFromLeftToRight) {
  const CameraMesh mesh({{six_faces(0, 0), {}}, {six_faces(0.5f, 2), {}}}, Settings{});
  expect_place(seen(mesh, 0, 0, 3, 2, 5, 0.25), -2.90, 1.10);
  expect_place(seen(mesh, 0, 0, 3, 2, 5, 0.75), -2.40, 3.10);
  EXPECT_FALSE(seen(mesh, 0, 2, 3, 3, 5));
}

/// As POV-Ray shows 3 x 4 pixels of distribution 1, without its first row.
TEST(CameraMesh, MeshesFollowEachOther) {
  const CameraMesh mesh({{six_faces(0, 0), {}}, {six_faces(0.5f, 2), {}}},
                        Settings{.order = FaceOrder::sequence});
  expect_place(seen(mesh, 0, 1, 3, 4, 5), -2.90, -0.90);
  expect_place(seen(mesh, 0, 2, 3, 4, 5), -2.40, 3.10);
  expect_place(seen(mesh, 2, 2, 3, 4, 5), 1.60, 3.10);
  expect_place(seen(mesh, 2, 3, 3, 4, 5), 1.60, 1.10);
  EXPECT_EQ(mesh.faces(), 12u);
}

TEST(CameraMesh, MeshesStandSideBySide) {
  const CameraMesh mesh({{six_faces(0, 0), {}}, {six_faces(0.5f, 2), {}}},
                        Settings{.order = FaceOrder::columns});
  expect_place(seen(mesh, 2, 0, 6, 2, 5), 1.10, 1.10);
  expect_place(seen(mesh, 2, 1, 6, 2, 5), 1.10, -0.90);
  expect_place(seen(mesh, 3, 0, 6, 2, 5), -2.40, 3.10);
  expect_place(seen(mesh, 3, 1, 6, 2, 5), -2.40, 1.10);
  // What is left over of the width shows nothing.
  EXPECT_FALSE(seen(mesh, 6, 0, 7, 2, 5));
}

TEST(CameraMesh, TextureCoordinatesLieUpwards) {
  const CameraMesh mesh({{square(), {}}}, Settings{.order = FaceOrder::uv});
  for (std::uint32_t x = 0; x < 5; ++x)
    for (std::uint32_t y = 0; y < 7; ++y)
      expect_place(seen(mesh, x, y, 5, 7, 5), -2 + 4 * (x + 0.5) / 5, 2 - 4 * (y + 0.5) / 7);
}

/// At u of 0, 0.25, 0.5 POV-Ray shows -4.50, -2.25, 0.00, and at v of 5/6, 2/3, 1/3 3.00, 1.50, -1.50.
TEST(CameraMesh, SmoothFacesLookAlongTheirNormals) {
  const CameraMesh mesh({{square(true), {}}}, Settings{.order = FaceOrder::uv, .smooth = true});
  const auto at = [&](double u, double v) {
    const Ray ray = mesh.ray({u * 4, (1 - v) * 3, 4, 3}, {});
    return Vec3d(ray.origin) + Vec3d(ray.direction) * ((5 - ray.origin.z) / ray.direction.z);
  };
  expect_place(at(0, 5.0 / 6), -4.50, 3.00);
  expect_place(at(0.25, 2.0 / 3), -2.25, 1.50);
  expect_place(at(0.5, 1.0 / 3), 0.00, -1.50);
  const CameraMesh flat({{square(true), {}}}, Settings{.order = FaceOrder::uv});
  expect_place(seen(flat, 0, 0, 4, 4, 5), -1.5, 1.5);
}

/// POV-Ray shows a wall behind the back, offsets that directions do not turn, and nothing beyond the
/// distance.
TEST(CameraMesh, FacesLookBackAndNoFurther) {
  const CameraMesh back({{six_faces(0, 0), {}}}, Settings{.reverse = true});
  EXPECT_FALSE(seen(back, 0, 0, 3, 2, 5));
  expect_place(seen(back, 0, 0, 3, 2, -5), -2.90, 1.10);
  const CameraMesh far({{six_faces(0, 0), {}}}, Settings{.reverse = true, .offset = 7});
  expect_place(seen(far, 0, 0, 3, 2, 5), -2.90, 1.10);
  const CameraMesh near({{six_faces(0, 0), {}}}, Settings{.offset = 0.6, .max_distance = 2});
  EXPECT_TRUE(seen(near, 0, 0, 3, 2, 2.5));
  EXPECT_FALSE(seen(near, 0, 0, 3, 2, 2.7));
}

/// POV-Ray shows -4.04 and 0.67 at u = 0 and v = 5/6 of a square at half its size that is turned by 30
/// degrees; its turns are left-handed, and its fronts lie on the other side.
TEST(CameraMesh, TransformsMoveNormals) {
  const Affine turn = Affine::rotation({0, 1, 0}, 30) * Affine::scaling({0.5, 0.5, 1});
  const CameraMesh mesh({{square(), turn}}, Settings{.order = FaceOrder::uv, .reverse = true});
  const Ray ray = mesh.ray({0, 0.5, 4, 3}, {});
  const Vec3d place = Vec3d(ray.origin) + Vec3d(ray.direction) * ((-5 - ray.origin.z) / ray.direction.z);
  expect_place(place, -4.04, 0.67);
  // A mirror image still looks to its own front.
  const CameraMesh mirrored({{square(), Affine::scaling({-1, 1, 1})}}, Settings{.order = FaceOrder::uv});
  expect_place(seen(mirrored, 0, 0, 4, 4, 5), 1.5, 1.5);
}

/// Random faces whose texture coordinates overlap, and some of which leave the unit square.
TEST(CameraMesh, TheFirstFaceCounts) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> any(-0.3f, 1.3f), small(-0.1f, 0.1f);
  std::vector<Corner> corners;
  for (int i = 0; i < 400; ++i) {
    const Vec2f at{any(random), any(random)};
    for (int k = 0; k < 3; ++k)
      corners.push_back({{static_cast<float>(i), any(random), any(random)},
                         {},
                         {at.x + small(random), at.y + small(random)}});
  }
  const CameraMesh mesh({{mesh_of(corners), {}}}, Settings{.order = FaceOrder::uv});
  int found = 0;
  for (int i = 0; i < 3000; ++i) {
    const double u = std::abs(any(random)) / 1.3, v = std::abs(any(random)) / 1.3;
    double first = -1;
    for (std::size_t t = 0; t < corners.size() && first < 0; t += 3) {
      const auto side = [&](std::size_t a, std::size_t b) {
        const Vec2f p = corners[t + a].uv, q = corners[t + b].uv;
        return (double{q.x} - p.x) * (v - p.y) - (double{q.y} - p.y) * (u - p.x);
      };
      const double s[] = {side(0, 1), side(1, 2), side(2, 0)};
      if ((s[0] > 0 && s[1] > 0 && s[2] > 0) || (s[0] < 0 && s[1] < 0 && s[2] < 0))
        first = static_cast<double>(t / 3);
    }
    const Ray ray = mesh.ray({u, 1 - v, 1, 1}, {});
    ASSERT_EQ(leaves_out(ray), first < 0) << u << " " << v;
    if (first < 0) continue;
    ASSERT_NEAR(ray.origin.x, first, 1e-3) << u << " " << v;
    ++found;
  }
  EXPECT_GT(found, 1000);
}

/// Where scenes lie far from the origin, rays start where they did.
TEST(CameraMesh, FarScenesKeepTheirView) {
  Scene scene;
  Object far;
  far.shape = SphereShape{};
  far.transform = Affine::translation({3e6, 0, 0});
  scene.objects.push_back(far);
  scene.camera.projection = Projection::mesh;
  scene.camera.mesh = std::make_shared<const CameraMesh>(
      std::vector<SeeingMesh>{{square(), Affine::translation({3e6, 0, 0})}},
      Settings{.order = FaceOrder::uv});
  scene.camera.from = scene.camera.mesh->middle(), scene.camera.at = scene.camera.from - Vec3d{0, 0, 1};
  scene.camera_given = true;
  recentre(scene);
  EXPECT_GT(length(scene.origin), 1e6);
  const Ray ray =
      camera_ray(camera_frame(scene.camera, scene.film), scene.film.width / 2.0, scene.film.height / 2.0);
  EXPECT_LT(length(Vec3d(ray.origin) + scene.origin - Vec3d{3e6, 0, 0}), 1e-4);
}

}  // namespace
}  // namespace oktett::camera_mesh_test
