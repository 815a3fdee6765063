#include <gtest/gtest.h>

#include <string>

#include "tests/io/scene_test_support.h"

namespace oktett::scene_visibility_test {
namespace {

using namespace test;

constexpr std::uint8_t set_of(std::initializer_list<RayKind> kinds) {
  std::uint8_t set = 0;
  for (const RayKind kind : kinds) set |= bit_of(kind);
  return set;
}

TEST(SceneVisibility, GroupsAndTheirMembersHideTogether) {
  const Scene scene = SceneFiles().load_v1(
      "objects:\n"
      "  - {sphere: {}, visible_to: [shadow, camera]}\n"
      "  - {sphere: {}}\n"
      "  - group:\n"
      "      - {sphere: {}, visible_to: [camera, glossy]}\n"
      "      - {sphere: {}}\n"
      "    visible_to: [camera, diffuse, transmission, volume]\n"
      "  - {union: [{sphere: {}}], visible_to: []}\n"
      "lights:\n"
      "  - rectangle: {corner: [0, 5, 0], u: [1, 0, 0], v: [0, 0, 1], visible_to: [diffuse, glossy]}\n");
  ASSERT_EQ(scene.objects.size(), 6u);
  EXPECT_EQ(scene.objects[0].visible_to, set_of({RayKind::diffuse, RayKind::glossy}));
  EXPECT_EQ(scene.objects[1].visible_to, set_of({RayKind::camera, RayKind::shadow}));
  EXPECT_EQ(scene.objects[2].visible_to, kAllRays);
  EXPECT_EQ(scene.objects[3].visible_to, set_of({RayKind::camera}));
  EXPECT_EQ(scene.objects[4].visible_to,
            set_of({RayKind::camera, RayKind::diffuse, RayKind::transmission, RayKind::volume}));
  EXPECT_EQ(scene.objects[5].visible_to, 0);
}

TEST(SceneVisibility, ListsNameObjectsGroupsAndWhatPrototypesHold) {
  const Scene scene = SceneFiles().load_v1(
      "lights:\n"
      "  - point: {position: [0, 5, 0], only: [leaf, table]}\n"
      "  - point: {position: [0, 5, 0], except: [table]}\n"
      "  - sky: {only: [leaf, table]}\n"
      "  - disk: {center: [0, 5, 0], except: [table]}\n"
      "  - point: {position: [0, 5, 0]}\n"
      "define:\n"
      "  tree: {group: [{sphere: {}, name: leaf}, {sphere: {}}]}\n"
      "objects:\n"
      "  - {group: [{sphere: {}, name: top}, {sphere: {}}], name: table}\n"
      "  - {instance: tree}\n"
      "  - {sphere: {}, material: {emission: [1, 1, 1]}, lights_only: [top]}\n");
  ASSERT_EQ(scene.light_lists.size(), 3u);
  EXPECT_FALSE(scene.light_lists[0].lights_others);
  EXPECT_TRUE(scene.light_lists[1].lights_others);
  // A last light without traits has none.
  ASSERT_EQ(scene.light_traits.size(), 3u);
  EXPECT_EQ(scene.light_traits[0].list, 0u);
  EXPECT_EQ(scene.light_traits[1].list, 1u);
  EXPECT_EQ(scene.light_traits[2].list, 0u);
  EXPECT_EQ(scene.prototypes[0].objects[0].listed, 1);
  EXPECT_EQ(scene.prototypes[0].objects[1].listed, 0);
  ASSERT_EQ(scene.objects.size(), 5u);
  EXPECT_EQ(scene.objects[0].light_list, 1u);  // the disk
  EXPECT_EQ(scene.objects[1].listed, 0b111);
  EXPECT_EQ(scene.objects[2].listed, 0b011);
  EXPECT_EQ(scene.objects[3].listed, 0);
  EXPECT_EQ(scene.objects[4].light_list, 2u);
}

TEST(SceneVisibility, IncludedFilesNameObjects) {
  SceneFiles files;
  files.dir.write("things.yaml", "oktett: 1\nobjects: [{sphere: {}, name: ball}]\n");
  const Scene scene =
      files.load_v1("include: [things.yaml]\nlights: [{point: {position: [0, 1, 0], only: [ball]}}]\n");
  EXPECT_EQ(scene.objects.at(0).listed, 1);
}

TEST(SceneVisibility, WrongKeysAreErrors) {
  std::string many = "lights:\n";
  for (int i = 0; i <= 16; ++i)
    many += "  - point: {position: [0, 0, 0], only: [a" + std::to_string(i) + "]}\n";
  expect_errors({
      {"objects: [{sphere: {}, visible_to: [camera, shadows]}]\n",
       "scene.yaml:2:45: expected camera or diffuse"},
      {"objects: [{sphere: {}, visible_to: camera}]\n", "scene.yaml:2:36: expected a list"},
      {"objects: [{union: [{sphere: {}, visible_to: [camera]}]}]\n",
       "scene.yaml:2:45: what is in a combination is visible to all rays that meet the combination"},
      {"define: {p: {sphere: {}, visible_to: [camera]}}\nobjects: [{union: [{instance: p}]}]\n",
       "scene.yaml:3:20: what is in a combination must be visible to all rays"},
      {"lights: [{point: {position: [0, 0, 0], only: [bal]}}]\nobjects: [{sphere: {}, name: ball}]\n",
       "scene.yaml:2:47: unknown object 'bal'; did you mean 'ball'?"},
      {"lights: [{point: {position: [0, 0, 0], only: [], except: []}}]\n", "scene.yaml:2:"},
      {"lights: [{point: {position: [0, 0, 0], only: [a]}}]\n"
       "objects: [{union: [{sphere: {}, name: a}]}]\n",
       "scene.yaml:2:47: 'a' is in a combination, which is lit as a whole; name the combination"},
      {"define: {p: {sphere: {}}}\nobjects: [{instance: p, lights_only: []}]\n",
       "scene.yaml:3:22: without a material of its own an instance glows as its prototype does"},
      {"objects: [{sphere: {}, lights_only: [], lights_except: []}]\n",
       "scene.yaml:2:56: expected 'lights_only' or 'lights_except', not both"},
      {many, "scene.yaml:19:40: there are more than 16 different lists"},
  });
}

}  // namespace
}  // namespace oktett::scene_visibility_test
