/// \file Which meshes are seen from inside.

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "render/look/mesh_view.h"
#include "tests/render/look_meshes.h"

namespace oktett::interior_view_test {
namespace {

using look_meshes::add_box;
using look_meshes::ball;

Film small_film() {
  Film film;
  film.width = 160, film.height = 90;
  return film;
}

/// Walls that face inwards or outwards, and pieces of furniture on the floor.
TriangleMesh room(int pieces, bool inward = true) {
  TriangleMesh mesh;
  add_box(mesh, {-5, 0, -4}, {5, 3, 4}, inward);
  for (int i = 0; i < pieces; ++i) {
    const auto x = static_cast<float>(i % 4) * 2 - 3.5f, z = static_cast<float>(i / 4) * 1.8f - 2.2f;
    add_box(mesh, {x, 0, z}, {x + 0.8f, 1.2f, z + 0.5f});
  }
  return mesh;
}

/// Only the triangles for which `keep` is true.
template <class Keep>
TriangleMesh filtered(TriangleMesh mesh, const Keep& keep) {
  const auto all = mesh.indices;
  mesh.indices.clear();
  for (std::size_t i = 0; i < all.size(); i += 3)
    if (keep(i / 3))
      for (std::size_t k = 0; k < 3; ++k) mesh.indices.push_back(all[i + k]);
  return mesh;
}

TriangleMesh inside_out(TriangleMesh mesh) {
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
    std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
  return mesh;
}

TriangleMesh corridor() {
  TriangleMesh mesh;
  add_box(mesh, {0, 0, 0}, {2, 2.5f, 30}, true);
  // Cupboards, each with its back at the wall.
  for (int i = 0; i < 9; ++i) {
    const auto z = static_cast<float>(1 + 3 * i);
    add_box(mesh, {0, 0, z}, {0.3f, 1, z + 1});
  }
  return mesh;
}

/// A hall that is round, with a block in it.
TriangleMesh hall() {
  TriangleMesh mesh = inside_out(ball(24));
  add_box(mesh, {-0.3f, -0.7f, -0.3f}, {0.3f, -0.2f, 0.3f});
  return mesh;
}

/// A closed box that hides balls, of more area than its own.
TriangleMesh filled_box() {
  TriangleMesh mesh;
  add_box(mesh, {-1, -1, -1}, {1, 1, 1});
  for (int i = 0; i < 40; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const TriangleMesh one = ball(8);
    const Vec3f center(Vec3d{i % 4 * 0.45 - 0.7, i / 4 % 4 * 0.45 - 0.7, i / 16 * 0.6 - 0.6});
    for (const Vec3f& p : one.positions) mesh.positions.push_back(p * 0.2f + center);
    for (const std::uint32_t index : one.indices) mesh.indices.push_back(first + index);
  }
  return mesh;
}

/// A body, open at the sides, with seats in it: seen from outside it shows its front.
TriangleMesh car() {
  TriangleMesh mesh;
  add_box(mesh, {-2, 0.3f, -0.9f}, {2, 0.8f, 0.9f});
  add_box(mesh, {-1, 1.4f, -0.8f}, {1, 1.45f, 0.8f});
  for (const float x : {-0.6f, 0.4f})
    for (const float z : {-0.6f, 0.2f}) add_box(mesh, {x, 0.8f, z}, {x + 0.4f, 1.2f, z + 0.4f});
  return mesh;
}

TEST(InteriorView, ShowsRoomsFromInsideAndThingsFromOutside) {
  TriangleMesh block;
  add_box(block, {0, 0, 0}, {1, 2, 3});
  TriangleMesh door;
  add_box(door, {0, 0, 0}, {1, 2, 0.04f});
  struct Case {
    const char* name;
    TriangleMesh mesh;
    bool inside;
  };
  const std::vector<Case> cases = {
      {"a room with much in it", room(12), true},
      {"a room with little in it", room(3), true},
      {"a room with a single piece", room(1), true},
      {"an empty room", room(0), true},
      {"a room without one wall of glass", filtered(room(3), [](std::size_t i) { return i != 0; }), true},
      {"a corridor", corridor(), true},
      {"a round hall", hall(), true},
      {"a room without a ceiling", filtered(room(3), [](std::size_t i) { return i != 6 && i != 7; }), false},
      {"a box with things in it", room(5, false), false},
      {"a box full of balls", filled_box(), false},
      {"a car", car(), false},
      {"a box", block, false},
      {"a ball", ball(12), false},
      // What is turned inside out as a whole is what it was.
      {"a ball inside out", inside_out(ball(12)), false},
      {"a door inside out", inside_out(door), false},
      {"a box with things in it, inside out", inside_out(room(5, false)), false},
      {"a box full of balls, inside out", inside_out(filled_box()), false},
      {"a car inside out", inside_out(car()), false},
  };
  for (const Case& c : cases)
    EXPECT_EQ(interior_view(c.mesh, {0, 1, 0}, small_film()).has_value(), c.inside) << c.name;
}

TEST(InteriorView, StandsInTheRoom) {
  const std::optional<InteriorView> view = interior_view(room(12), {0, 1, 0}, small_film());
  ASSERT_TRUE(view);
  const Vec3d& p = view->camera.from;
  EXPECT_TRUE(std::abs(p.x) < 5 && p.y > 0 && p.y < 3 && std::abs(p.z) < 4);
  EXPECT_FALSE(view->sun) << "the room is closed";
}

TEST(InteriorView, LooksAlongACorridor) {
  const std::optional<InteriorView> view = interior_view(corridor(), {0, 1, 0}, small_film());
  ASSERT_TRUE(view);
  const Vec3d forward = normalize(view->camera.at - view->camera.from);
  EXPECT_GT(std::abs(forward.z), 0.9);
  EXPECT_GT(forward.z > 0 ? 30 - view->camera.from.z : view->camera.from.z, 15);
}

TEST(InsideView, StandsInWhateverHasAnInside) {
  const std::optional<InteriorView> view = inside_view(ball(12), {0, 1, 0}, small_film());
  ASSERT_TRUE(view);
  EXPECT_LT(length(view->camera.from), 1);
  TriangleMesh flat;  // nowhere in it is a place with walls around
  flat.positions.push_back({0, 0, 0}), flat.positions.push_back({4, 0, 0}),
      flat.positions.push_back({0, 0, 4});
  for (const std::uint32_t i : {0u, 2u, 1u}) flat.indices.push_back(i);
  const std::optional<InteriorView> middle = inside_view(flat, {0, 1, 0}, small_film());
  ASSERT_TRUE(middle);
  EXPECT_EQ(middle->camera.from, (Vec3d{2, 0, 2}));
  EXPECT_FALSE(inside_view(TriangleMesh{}, {0, 1, 0}, small_film()));
}

}  // namespace
}  // namespace oktett::interior_view_test
