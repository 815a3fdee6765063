#include "render/dielectric_stack.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "render/hit_object.h"
#include "render/shading_point.h"

namespace oktett {

void DielectricStack::enter(const StackedDielectric& dielectric) {
  if (size_ == kMost) {
    std::copy(entries_ + 1, entries_ + kMost, entries_);
    --size_;
  }
  entries_[size_++] = dielectric;
}

void DielectricStack::leave(const StackedDielectric& dielectric) {
  std::uint32_t found = size_;
  for (std::uint32_t i = 0; i < size_; ++i)
    if (entries_[i].solid == dielectric.solid &&
        (found == size_ || entries_[i] == dielectric || !(entries_[found] == dielectric)))
      found = i;
  if (found == size_) return;
  std::copy(entries_ + found + 1, entries_ + size_, entries_ + found);
  --size_;
}

bool encloses(const Material& m) {
  if (!m.surface) return true;
  if (m.principled) return m.principled->parameters.transmission > 0 && !m.principled->parameters.thin;
  return m.transparency > 0;
}

static const Material& material_of(const World& world, const StackedDielectric& e) {
  return world.materials[e.material];
}

/// The entry that fills the space; null if there is none.
static const StackedDielectric* filling(const World& world, const DielectricStack& stack) {
  const StackedDielectric* best = nullptr;
  for (std::uint32_t i = 0; i < stack.size(); ++i)
    if (best == nullptr || material_of(world, stack[i]).priority >= material_of(world, *best).priority)
      best = &stack[i];
  return best;
}

/// The solid whose boundary a surface is; its `solid` is kNoId if there is none.
static StackedDielectric dielectric_of(const World& world, const SurfaceInteraction& surface) {
  StackedDielectric e;
  e.material = material_index(world, surface.user, surface.material_slot);
  if (surface.user < world.objects.size() && encloses(world.materials[e.material]))
    e.solid = world.objects[surface.user].solid;
  return e;
}

Boundary boundary_at(const World& world, const DielectricStack& before, const SurfaceInteraction& surface,
                     bool front, float ior) {
  Boundary b;
  b.behind = before;
  StackedDielectric e = dielectric_of(world, surface);
  if (e.solid == kNoId) return b;
  e.ior = ior;
  front ? b.behind.enter(e) : b.behind.leave(e);
  const std::int32_t priority = material_of(world, e).priority;
  if (priority == kNoPriority) return b;
  const StackedDielectric* around = filling(world, front ? before : b.behind);
  if (around == nullptr || material_of(world, *around).priority == kNoPriority) return b;
  const std::int32_t other = material_of(world, *around).priority;
  // On the way out a solid of the same priority hides the boundary, too, if it was entered later: it fills
  // both sides.
  const bool left = !front && b.behind.size() < before.size();
  b.hidden = other > priority || (left && other == priority && filling(world, before)->solid != e.solid);
  b.ior = ior / around->ior;
  return b;
}

Boundary boundary_at(const World& world, const DielectricStack& before, const SurfaceInteraction& surface,
                     bool front) {
  Boundary b = boundary_at(world, before, surface, front, 1);
  b.ior.reset();
  return b;
}

std::uint32_t medium_in(const World& world, const DielectricStack& dielectrics, std::uint32_t outside) {
  const StackedDielectric* e = filling(world, dielectrics);
  return e != nullptr ? material_of(world, *e).interior : outside;
}

std::uint16_t light_lists_in(const World& world, const DielectricStack& dielectrics) {
  if (!world.has_light_lists) return 0xffff;
  const StackedDielectric* e = filling(world, dielectrics);
  const unsigned listed =
      e != nullptr && e->solid < world.objects.size() ? world.objects[e->solid].listed : 0u;
  return static_cast<std::uint16_t>(listed ^ world.lists_of_others);
}

DielectricStack dielectrics_behind(const RenderContext& context, const DielectricStack& before,
                                   const Ray& ray, std::span<const Hit> hits) {
  const World& world = *context.world;
  DielectricStack stack = before;
  for (const Hit& hit : hits) {
    const SurfaceInteraction s = surface_interaction(*world.accel, ray, hit);
    const bool front = !(dot(ray.direction, s.geometric_normal) > 0);
    stack = boundary_at(world, stack, s, front, index_of_refraction(context, ray, hit, s)).behind;
  }
  return stack;
}

/// The solids that the ray leaves without having entered them, in order.
static std::vector<StackedDielectric> left_by(const RenderContext& context, const Ray& ray) {
  const World& world = *context.world;
  std::vector<Hit> hits;
  all_hits(*world.accel, ray, hits);
  std::vector<StackedDielectric> entered, left;
  for (const Hit& hit : hits) {
    const SurfaceInteraction s = surface_interaction(*world.accel, ray, hit);
    StackedDielectric e = dielectric_of(world, s);
    if (e.solid == kNoId) continue;
    e.ior = index_of_refraction(context, ray, hit, s);
    if (!(dot(ray.direction, s.geometric_normal) > 0)) {
      entered.push_back(e);
      continue;
    }
    const auto same_solid = [&](const StackedDielectric& other) { return other.solid == e.solid; };
    const auto found = std::find_if(entered.begin(), entered.end(), same_solid);
    if (found != entered.end())
      entered.erase(found);
    else
      left.push_back(e);
  }
  return left;
}

DielectricStack dielectrics_at(const RenderContext& context, const Vec3f& point) {
  DielectricStack stack;
  if (!context.world->has_enclosing_solids) return stack;
  // A direction along no axis or diagonal, where rays might run along edges. A solid without bounds, such as
  // a half-space, may be left in one of two opposite directions only.
  const Vec3f direction = normalize(Vec3f{0.5377f, 0.7221f, -0.4349f});
  std::vector<StackedDielectric> left = left_by(context, {point, 0, direction});
  std::vector<StackedDielectric> behind = left_by(context, {point, 0, -direction});
  if (behind.size() > left.size()) std::swap(left, behind);
  for (std::size_t i = left.size(); i-- > 0;) stack.enter(left[i]);
  return stack;
}

}  // namespace oktett
