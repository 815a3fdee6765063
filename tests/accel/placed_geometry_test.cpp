#include "accel/hit_place.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>

namespace oktett::placed_geometry_test {
namespace {

Geometry spheres(std::vector<SphereShape> list, std::uint32_t user, const Affine& transform = {}) {
  return {SpheresShape{std::move(list)}, transform, user};
}

Geometry instance(std::shared_ptr<const Accel> child, std::uint32_t user, const Affine& transform) {
  return {InstanceGeometry{std::move(child)}, transform, user};
}

/// Shoots at every sphere that the walk reports, from just outside of where it should stand. The hits are the
/// oracle: they must carry the instance, item and user that the walk announced.
void expect_hits_confirm(const Accel& accel, std::size_t geometries) {
  std::size_t count = 0;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> seen;
  visit_placed_geometries(accel, [&](const PlacedGeometry& placed) {
    ++count;
    const auto& list = std::get<SpheresShape>(placed.geometry->shape).spheres;
    for (std::uint32_t k = 0; k < list.size(); ++k) {
      EXPECT_EQ(++seen[std::make_pair(placed.instance, placed.first_item + k)], 1);
      const Vec3d center = placed.to_world.point(list[k].center);
      const Vec3d reach = placed.to_world.vector({0, 0, 1.5 * list[k].radius});
      const Ray ray{Vec3f(center + reach), 0, Vec3f(-reach)};
      const Hit hit = closest_hit(accel, ray);
      ASSERT_TRUE(hit.valid());
      EXPECT_EQ(hit.instance, placed.instance);
      EXPECT_EQ(hit.item, placed.first_item + k);
      EXPECT_EQ(identify(accel, hit).user, placed.user);
    }
  });
  EXPECT_EQ(count, geometries);
}

TEST(PlacedGeometries, AreThoseThatHitsName) {
  const auto leaf =
      build_accel({spheres({{{0, 0, 0}, 0.2}, {{1, 0, 0}, 0.2}}, 5), spheres({{{2, 0, 0}, 0.2}}, 6)});
  const auto branch =
      build_accel({spheres({{{0, 3, 0}, 0.2}}, 7), instance(leaf, kNoId, Affine::scaling({1, 2, 1})),
                   instance(leaf, 8, Affine::translation({0, 0, 4}))});
  InstanceList list{{branch, leaf}, {}};
  for (int k = 0; k < 10; ++k) {
    InstancePlace place{
        {}, static_cast<std::uint32_t>(k % 2), k % 3 == 0 ? 20u + static_cast<std::uint32_t>(k) : kNoId};
    Affine::translation({100.0 * k, 0, 50}).to_rows(place.to_list);
    list.places.push_back(place);
  }
  // A singular instance is in no tree.
  list.places.push_back({{}, 0, kNoId});
  std::vector<Geometry> all;
  all.push_back(spheres({{{0, -9, 0}, 1}}, 1, Affine::translation({0, -5, 0})));
  all.push_back(instance(branch, kNoId, Affine::translation({-50, 0, 0})));
  all.push_back({std::move(list), Affine::rotation({0, 30, 0}), 9});
  all.push_back(instance(branch, 11, Affine::translation({-90, 0, 0}) * Affine::scaling({-1, 1, 1})));
  all.push_back(spheres({{{0, 0, -9}, 1}}, 2, Affine::scaling({0, 1, 1})));
  const auto accel = build_accel(std::move(all));
  // 1 alone, 5 in each branch (one sphere list, twice two), 2 in each leaf.
  expect_hits_confirm(*accel, 1 + 2 * 5 + 5 * 5 + 5 * 2);
}

TEST(PlacedGeometries, LeaveCombinationsOut) {
  auto expression = std::make_shared<CsgExpression>();
  expression->op = CsgOp::unite;
  expression->children.resize(2);
  expression->children[0].solids.push_back(spheres({{{0, 0, 0}, 1}}, 1));
  expression->children[1].solids.push_back(spheres({{{1, 0, 0}, 1}}, 2));
  std::vector<Geometry> all;
  all.push_back({CsgGeometry{expression}, {}, kNoId});
  all.push_back(spheres({{{5, 0, 0}, 1}}, 3));
  expect_hits_confirm(*build_accel(std::move(all)), 1);
}

TEST(PlacedGeometries, OfNothingAreNone) { expect_hits_confirm(*build_accel({}), 0); }

}  // namespace
}  // namespace oktett::placed_geometry_test
