#include "render/insides.h"
#include "render/hit_object.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace oktett {

void Insides::leave(std::uint16_t entry) {
  int place = 0;
  for (int i = 3; i >= 0; --i)
    if (static_cast<std::uint16_t>(bits_ >> (16 * i)) == entry) place = i;
  const std::uint64_t below = bits_ & ((std::uint64_t{1} << (16 * place)) - 1);
  const std::uint64_t above = place == 3 ? 0 : bits_ >> (16 * (place + 1)) << (16 * place);
  bits_ = above | below;
}

bool Insides::is_open() const {
  for (std::uint64_t rest = bits_; rest != 0; rest >>= 16)
    if ((rest & kClosed) != 0) return false;
  return true;
}

std::uint16_t inside_of(const World& world, const Hit& hit, std::uint32_t user, std::uint32_t slot) {
  if (user >= world.objects.size() || !world.objects[user].has_inside) return 0;
  std::uint16_t entry = Insides::kEntered;
  if (!is_hollow(world, hit, user)) entry |= Insides::kClosed;
  const std::uint32_t medium = world.materials[material_index(world, user, slot)].interior;
  if (medium < Insides::kMostMedia) entry |= static_cast<std::uint16_t>(medium + 1);
  return entry;
}

/// The solids that the ray leaves without having entered them, in order.
static std::vector<std::uint16_t> left_solids(const World& world, const Ray& ray) {
  std::vector<Hit> hits;
  all_hits(*world.accel, ray, hits);
  std::vector<std::uint16_t> entered, left;
  for (const Hit& hit : hits) {
    const SurfaceInteraction s = surface_interaction(*world.accel, ray, hit);
    const std::uint16_t entry = inside_of(world, hit, s.user, s.material_slot);
    if (entry == 0) continue;
    if (!(dot(ray.direction, s.geometric_normal) > 0)) {
      entered.push_back(entry);
    } else if (const auto found = std::ranges::find(entered, entry); found != entered.end()) {
      entered.erase(found);
    } else {
      left.push_back(entry);
    }
  }
  return left;
}

Insides insides_at(const World& world, const Vec3f& point) {
  // Along no axis or diagonal, where rays might run along edges. A solid without bounds may be left in one
  // direction only.
  const Vec3f direction = normalize(Vec3f{0.5377f, 0.7221f, -0.4349f});
  std::vector<std::uint16_t> left = left_solids(world, {point, 0, direction});
  std::vector<std::uint16_t> behind = left_solids(world, {point, 0, -direction});
  if (behind.size() > left.size()) std::swap(left, behind);
  Insides insides;
  for (std::size_t i = left.size(); i-- > 0;) insides.enter(left[i]);
  return insides;
}

}  // namespace oktett
