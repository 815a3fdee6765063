#pragma once
/// \file The solids that a point of a path lies in, and what a path meets at their boundaries: nested
/// dielectrics with priorities (Schmidt and Budge 2002, "Simple nested dielectrics in ray traced images").
///
/// A path carries the solids that it has entered and not left. Of these the one of highest priority fills the
/// space; of several with the same priority, or without any, the one that was entered last.

#include <cstdint>
#include <optional>

#include "accel/accel.h"
#include "render/geometry.h"

namespace oktett {

struct RenderContext;

/// A solid that a path has entered, by the material that it met there. Both are indices into World.
struct StackedDielectric {
  std::uint32_t solid = kNoId, material = kNoId;
  float ior = 1;  ///< index of refraction of the material where it was entered
  bool operator==(const StackedDielectric& other) const {
    return solid == other.solid && material == other.material;
  }
};

/// Solids in the order in which they were entered. Of more than kMost the first one is forgotten.
class DielectricStack {
 public:
  static constexpr std::uint32_t kMost = 8;

  std::uint32_t size() const { return size_; }
  const StackedDielectric& operator[](std::uint32_t i) const { return entries_[i]; }

  void enter(const StackedDielectric& dielectric);
  /// Removes the solid. If it was not entered by this material, another entry of the solid is removed: the
  /// faces of a solid may have different materials. Nothing happens if there is none.
  void leave(const StackedDielectric& dielectric);

 private:
  std::uint32_t size_ = 0;
  StackedDielectric entries_[kMost];
};

/// A place where a path meets a surface.
struct Boundary {
  DielectricStack behind;  ///< the solids around the path if it goes on behind the surface
  bool hidden = false;     ///< a solid of higher priority fills both sides: the path goes straight on
  /// Index of refraction of the material relative to what surrounds it; nothing if that of the material
  /// holds.
  std::optional<float> ior;
};

/// Whether light goes into solids of this material.
bool encloses(const Material& material);

/// `before`: the solids around a path that meets a surface named by `surface`; `front`: it comes from where
/// the surface's normal points to; `ior`: that of the material there.
Boundary boundary_at(const World& world, const DielectricStack& before, const SurfaceInteraction& surface,
                     bool front, float ior);
/// The same for rays that are not bent: indices of refraction are left out.
Boundary boundary_at(const World& world, const DielectricStack& before, const SurfaceInteraction& surface,
                     bool front);

/// The medium in the solids given, an index into Scene::media; `outside` if there are none.
std::uint32_t medium_in(const World& world, const DielectricStack& dielectrics, std::uint32_t outside);

/// Which lists of lights light the medium there, as LightPoint::lists: that of the solid that it fills.
std::uint16_t light_lists_in(const World& world, const DielectricStack& dielectrics);

/// The solids that a point lies in, by the crossings of a ray from there with all surfaces. Those that it
/// leaves first come last.
DielectricStack dielectrics_at(const RenderContext& context, const Vec3f& point);

/// The solids around a ray that starts with those of `before` and goes straight through the surfaces that
/// `hits` lists in order.
DielectricStack dielectrics_behind(const RenderContext& context, const DielectricStack& before,
                                   const Ray& ray, std::span<const Hit> hits);

}  // namespace oktett
