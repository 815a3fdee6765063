#pragma once
/// \file The primitives of a scene that may be near a point.

#include "accel/trace_scene.h"

namespace oktett {

/// What is told of primitives that may be near a point.
class NearVisitor {
 public:
  virtual ~NearVisitor() = default;
  /// How far from the point primitives count; it may shrink meanwhile.
  virtual float radius() const = 0;
  /// A primitive whose bounds may be that near. Those of exact surfaces may be told twice.
  virtual void visit(const SceneGeometry& geometry, std::uint32_t primitive) = 0;
  /// What follows until leave() is in the scene that instance `index` of a geometry shows. Returns whether it
  /// is of interest; if not, leave() is not called.
  virtual bool enter(const SceneGeometry& instance, std::uint32_t index, const Affine& to_scene) = 0;
  virtual void leave() = 0;
};

/// Tells `visitor` of the primitives of a scene that may be near a point at a time, the nearest boxes first
/// where that is known. Point and radius are those of another space, from which `to_scene` leads to the
/// scene.
void visit_near(const TraceScene& scene, const Vec3f& point, const Affine& to_scene, float time,
                NearVisitor& visitor);

}  // namespace oktett
