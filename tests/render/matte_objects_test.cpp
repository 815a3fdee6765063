/// \file Which object a matte of Cryptomatte names: pictures of nested instances, lists of instances,
/// combinations and moving objects against a search through the scene's lists of objects.

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "render/film/cryptomatte.h"
#include "tests/render/test_scenes.h"

namespace oktett::matte_objects_test {
namespace {

using namespace test;

/// A name that covers all of a cell.
bool covers(const Picture& p, const std::string& name, std::uint32_t x, std::uint32_t y) {
  return value(p, "CryptoObject00.R", x, y) == matte_id(name) && value(p, "CryptoObject00.G", x, y) == 1;
}

/// Cells of unit size, numbered from (0, 0); a box covers the middle of one.
constexpr std::uint32_t kColumns = 72, kRows = 6;
constexpr double kHalf = 0.3;

/// Each cell is two pixels wide and high; its box covers the left lower one, see pixel_x and pixel_y.
Scene cells(std::uint32_t columns, std::uint32_t rows) {
  Scene scene = bare_scene();
  scene.film.width = 2 * columns, scene.film.height = 2 * rows;
  scene.film.cryptomatte = true;
  scene.integrator.samples = 4;
  scene.camera.projection = Projection::orthographic;
  scene.camera.height = rows;
  scene.camera.at = {0.5 * columns - 0.25, 0.5 * rows - 0.25, 0};
  scene.camera.from = scene.camera.at + Vec3d{0, 0, 9};
  return scene;
}
std::uint32_t pixel_x(std::uint32_t column) { return 2 * column; }
std::uint32_t pixel_y(std::uint32_t row, std::uint32_t rows) { return 2 * (rows - 1 - row) + 1; }

Object make(Shape shape, const std::string& name, const Vec3d& place) {
  Object object;
  object.shape = std::move(shape);
  object.name = name;
  object.transform = Affine::translation(place);
  return object;
}

Shape box() { return BoxShape{{-kHalf, -kHalf, -kHalf}, {kHalf, kHalf, kHalf}}; }

Shape unite(std::vector<Object> operands) {
  return CsgShape{CsgOp::unite, std::make_shared<const std::vector<Object>>(std::move(operands))};
}

/// Finds the name of what contains a point, object by object, as the rules say.
class NameSearch {
 public:
  explicit NameSearch(const Scene& scene) : scene_(scene) {
    for (const Prototype& prototype : scene.prototypes) number(prototype.objects);
    number(scene.objects);
  }

  /// Empty if nothing contains it.
  std::string at(const Vec3d& point) const { return find(scene_.objects, point, ""); }

 private:
  void number(const std::vector<Object>& objects) {
    for (const Object& object : objects) {
      numbers_[&object] = count_++;
      if (const auto* csg = std::get_if<CsgShape>(&object.shape)) number_operands(*csg);
    }
  }

  // A combination inside a combination has no number.
  void number_operands(const CsgShape& csg) {
    for (const Object& operand : *csg.operands)
      if (const auto* inner = std::get_if<CsgShape>(&operand.shape))
        number_operands(*inner);
      else
        numbers_[&operand] = count_++;
  }

  std::string find(const std::vector<Object>& objects, const Vec3d& point, const std::string& around) const {
    for (const Object& object : objects) {
      const Vec3d p = object.transform.inverse().point(point);
      const std::string name = object.name.empty() ? around : object.name;
      const auto own = [&] { return name.empty() ? "object" + std::to_string(numbers_.at(&object)) : name; };
      if (const auto* csg = std::get_if<CsgShape>(&object.shape)) {
        const std::string found = find(*csg->operands, p, name);
        if (!found.empty()) return found;
      } else if (const auto* instance = std::get_if<InstanceShape>(&object.shape)) {
        const std::string found = find(scene_.prototypes[instance->prototype].objects, p, "");
        if (!found.empty()) return name.empty() && object.material == kNoId ? found : own();
      } else if (max_component(abs(p)) < kHalf) {
        return own();
      }
    }
    return "";
  }

  const Scene& scene_;
  std::map<const Object*, int> numbers_;
  int count_ = 0;
};

TEST(MatteObjects, InstancesOfOnePrototypeHaveTheirNames) {
  Scene scene = cells(3, 1);
  scene.prototypes = {{"p", {make(box(), "", {})}}};
  scene.objects = {make(InstanceShape{0}, "left", {}), make(InstanceShape{0}, "", {1, 0, 0}),
                   make(InstanceShape{0}, "right", {2, 0, 0})};
  const Picture p = run(scene).picture;
  EXPECT_TRUE(covers(p, "left", pixel_x(0), 1));
  EXPECT_TRUE(covers(p, "object0", pixel_x(1), 1));
  EXPECT_TRUE(covers(p, "right", pixel_x(2), 1));
  // The layer of numbers shows the prototype's object.
  EXPECT_EQ(id(p, "geomID.I", pixel_x(0), 1), 0u);
}

// As a material does: the instance's own counts, also that of the outer one of two, and only then the
// prototype's.
TEST(MatteObjects, TheOutermostInstanceWithANameOrAMaterialCounts) {
  Scene scene = cells(6, 1);
  add_material(scene, diffuse({1, 0, 0}));
  const auto with_material = [](Object object) {
    object.material = 0;
    return object;
  };
  scene.prototypes = {{"box", {make(box(), "box", {})}},
                      {"pair", {make(InstanceShape{0}, "first", {}), make(InstanceShape{0}, "", {1, 0, 0})}}};
  scene.objects = {make(InstanceShape{1}, "", {}), make(InstanceShape{1}, "pair", {2, 0, 0}),
                   with_material(make(InstanceShape{1}, "", {4, 0, 0}))};
  const Picture p = run(scene).picture;
  const char* const expected[] = {"first", "box", "pair", "pair", "object5", "object5"};
  for (std::uint32_t x = 0; x < 6; ++x) EXPECT_TRUE(covers(p, expected[x], pixel_x(x), 1)) << x;
}

// The name of a combination is for operands without one, as its material is.
TEST(MatteObjects, OperandsHaveTheirNamesElseThatOfTheCombination) {
  Scene scene = cells(6, 1);
  scene.prototypes = {{"p", {make(box(), "", {})}}};
  scene.objects = {
      make(unite({make(InstanceShape{0}, "a", {}), make(InstanceShape{0}, "", {1, 0, 0}),
                  make(unite({make(box(), "", {2, 0, 0}), make(InstanceShape{0}, "b", {3, 0, 0})}), "", {})}),
           "whole", {}),
      make(unite({make(InstanceShape{0}, "", {}), make(InstanceShape{0}, "c", {1, 0, 0})}), "", {4, 0, 0})};
  const Picture p = run(scene).picture;
  const char* const expected[] = {"a", "whole", "whole", "b", "object0", "c"};
  for (std::uint32_t x = 0; x < 6; ++x) EXPECT_TRUE(covers(p, expected[x], pixel_x(x), 1)) << x;
}

/// Random names, materials and nesting. Rows: objects of all kinds; a list of instances; a list in a
/// prototype; objects of all kinds that move.
class RandomCells {
 public:
  explicit RandomCells(unsigned seed) : random_(seed) {}

  Scene make_scene() {
    Scene scene = cells(kColumns, kRows);
    add_material(scene, diffuse({1, 1, 1}));
    // Prototypes 2 l and 2 l + 1 are 2^l cells wide.
    for (std::uint32_t l = 0; l < 4; ++l)
      for (int k = 0; k < 2; ++k) {
        Prototype& p = scene.prototypes.emplace_back();
        if (l == 0)
          p.objects = {thing(0, 0)};
        else
          p.objects = {thing(l - 1, 0), thing(l - 1, std::uint32_t{1} << (l - 1))};
      }
    Prototype row;
    for (std::uint32_t x = 0; x < kColumns / 2; ++x) row.objects.push_back(instance(1, 2 * x, 0));
    for (std::uint32_t x = 0; x < kColumns; ++x) row.objects.push_back(instance(0, x, 1));
    scene.prototypes.push_back(row);

    for (std::uint32_t x = 0; x < kColumns; x += 8) scene.objects.push_back(thing(3, x));
    for (std::uint32_t x = 0; x < kColumns; ++x) scene.objects.push_back(instance(0, x, 1));
    Object rows = make(InstanceShape{8}, "", {0, 2, 0});
    scene.objects.push_back(rows);
    for (std::uint32_t x = 0; x < kColumns; x += 8) {
      Object object = thing(3, x);
      object.transform = Affine::translation({0, 4, 0}) * object.transform;
      // It moves, but to where it is.
      object.motion =
          std::make_shared<const Motion>(Motion{{{{0, object.transform}, {1, object.transform}}}});
      scene.objects.push_back(object);
    }
    return scene;
  }

 private:
  bool chance(int of) { return random_() % static_cast<unsigned>(of) == 0; }
  std::string name() { return chance(4) ? "n" + std::to_string(random_() % 1000) : ""; }

  Object instance(std::uint32_t level, std::uint32_t x, std::uint32_t y) {
    const std::uint32_t prototype = 2 * level + (chance(2) ? 1 : 0);
    Object object = make(InstanceShape{prototype}, name(), {double(x), double(y), 0});
    if (chance(5)) object.material = 0;
    return object;
  }

  /// Something 2^level cells wide.
  Object thing(std::uint32_t level, std::uint32_t x) {
    // Prototypes of a level hold those below.
    if (level > 0 && chance(3)) {
      std::vector<Object> halves{thing(level - 1, 0), thing(level - 1, std::uint32_t{1} << (level - 1))};
      return make(unite(std::move(halves)), name(), {double(x), 0, 0});
    }
    if (level > 0) return instance(level, x, 0);
    return make(box(), name(), {double(x), 0, 0});
  }

  std::mt19937 random_;
};

TEST(MatteObjects, NestedAtRandomTheyAreThoseOfASearch) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Scene scene = RandomCells(seed).make_scene();
    const NameSearch search(scene);
    for (const Isa isa : available_isas()) {
      const Picture p = run(scene, [&](RenderOptions& o) { o.isa = isa, o.threads = 1 + seed % 3; }).picture;
      int named = 0, wrong = 0;
      for (std::uint32_t row = 0; row < kRows; ++row)
        for (std::uint32_t column = 0; column < kColumns; ++column) {
          const std::string name = search.at({double(column), double(row), 0});
          if (name.empty()) continue;
          ++named;
          if (!covers(p, name, pixel_x(column), pixel_y(row, kRows)) && ++wrong < 5)
            ADD_FAILURE() << name << " at " << column << ", " << row << ", seed " << seed << ", "
                          << to_string(isa);
        }
      EXPECT_EQ(wrong, 0);
      EXPECT_EQ(named, static_cast<int>(5 * kColumns)) << seed;
    }
  }
}

// All that computes pictures records first hits of its own.
TEST(MatteObjects, AreTheSameForAllIntegrators) {
  Scene scene = RandomCells(1).make_scene();
  const Picture first = run(scene).picture;
  for (const auto& kind : kIntegratorKinds) {
    scene.integrator.kind = kind.value;
    const Picture p = run(scene).picture;
    for (const char* plane : {"CryptoObject00.R", "CryptoObject00.G", "CryptoObject00.B"})
      EXPECT_TRUE(std::equal(p.find(plane)->values.begin(), p.find(plane)->values.end(),
                             first.find(plane)->values.begin()))
          << kind.name << ' ' << plane;
  }
}

// Objects that cannot be shown, here a mesh without triangles, do not shift the names of those behind them.
TEST(MatteObjects, OperandsThatLeadNowhereAreLeftOut) {
  Scene scene = cells(2, 1);
  scene.prototypes = {{"p", {make(box(), "", {})}}};
  scene.objects = {
      make(unite({make(MeshShape{}, "none", {}), make(InstanceShape{0}, "a", {}),
                  make(InstanceShape{7}, "nowhere", {}), make(InstanceShape{0}, "b", {1, 0, 0})}),
           "", {})};
  const Picture p = run(scene).picture;
  EXPECT_TRUE(covers(p, "a", pixel_x(0), 1));
  EXPECT_TRUE(covers(p, "b", pixel_x(1), 1));
}

}  // namespace
}  // namespace oktett::matte_objects_test
