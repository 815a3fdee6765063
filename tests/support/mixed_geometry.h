#pragma once
/// \file A structure with leaves of many kinds, for tests of trees that come from a store.

#include <vector>

#include "accel/accel.h"
#include "verify/cases/kernel_cases.h"

namespace oktett::test {

/// Meshes with two ways to test triangles, closed forms, exact surfaces, a combination, and instances alone
/// and in a list. The meshes live as long as the object.
struct MixedGeometry {
  TriangleMesh first, second;
  std::vector<Geometry> geometries;

  MixedGeometry(int triangles, std::uint64_t seed) {
    CaseRandom r(seed);
    fill(first, triangles, r), fill(second, triangles / 4 + 1, r);
    const auto at = [&] { return Affine::translation(r.vector()); };
    const auto add = [&](auto shape, const Affine& transform) {
      geometries.push_back({std::move(shape), transform, kNoId});
    };
    add(SpheresShape{{SphereShape{{0, 0, 0}, 0.2}, SphereShape{{0.5, 0, 0}, 0.1}}}, at());
    add(MeshGeometry{&first}, Affine{});
    add(BoxShape{{-0.1, -0.1, -0.1}, {0.1, 0.2, 0.1}}, at());
    add(PlaneShape{{0, 0, 1}, -1.5}, Affine{});
    const ExactShape torus{TorusShape{0.2, 0.05}};
    add(torus, at());
    add(MeshGeometry{&second, true, TriangleTest::moller_trumbore}, at());
    add(torus, at() * Affine::scaling({0.5, 0.5, 0.5}));
    auto combined = std::make_shared<CsgExpression>();
    combined->op = CsgOp::subtract;
    for (const double radius : {0.3, 0.2}) {
      CsgExpression& operand = combined->children.emplace_back();
      operand.solids.push_back({SpheresShape{{SphereShape{{0, 0, 0.3 - radius}, radius}}}, {}, kNoId});
    }
    add(CsgGeometry{combined}, at());
    const auto child = build_accel({{SpheresShape{{SphereShape{{0, 0, 0}, 0.1}}}, {}, kNoId}});
    add(InstanceGeometry{child}, at());
    InstanceList list{{child}, {}};
    for (int k = 0; k < 10; ++k) {
      InstancePlace place{{}, 0, kNoId};
      at().to_rows(place.to_list);
      list.places.push_back(place);
    }
    add(list, Affine{});
  }
  MixedGeometry(const MixedGeometry&) = delete;
  MixedGeometry& operator=(const MixedGeometry&) = delete;

 private:
  static void fill(TriangleMesh& mesh, int triangles, CaseRandom& r) {
    for (int i = 0; i < triangles; ++i) {
      const Vec3d centre = r.vector();
      for (std::uint32_t k = 0; k < 3; ++k) {
        mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
        mesh.positions.push_back(Vec3f(centre + r.vector() * (i % 9 == 0 ? 0.8 : 0.1)));
      }
    }
  }
};

}  // namespace oktett::test
