#include "render/transport/medium_march.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/math.h"
#include "render/shading_point.h"

namespace oktett {
namespace {

/// What a medium has at a place, per length.
struct MediumAt {
  Vec3d extinction, scattering, emission;
};

/// Media as they are asked.
class MarchedMedium {
 public:
  MarchedMedium(const RenderContext& context, const Medium& medium)
      : context_(context), medium_(medium), to_own_(medium.grid_place.inverse()) {
    const auto coefficient = [](const Color& c) { return max(Vec3d(c), Vec3d{0, 0, 0}); };
    scattering_ = coefficient(medium.scattering), emission_ = coefficient(medium.emission);
    extinction_ = coefficient(medium.absorption) + scattering_ * medium.extinction;
  }

  MediumAt at(const Vec3d& place) const {
    Vec3d density{1, 1, 1};
    if (medium_.varies()) {
      const Vec3d own = to_own_.point(place);
      if (medium_.grid) density = density * grid_density(own);
      if (medium_.density_texture != kNoId) {
        TexturePlace at;
        at.position = own;
        density = density * Vec3d(texture_color(context_, medium_.density_texture, at));
      }
    }
    return {extinction_ * density, scattering_ * density, emission_ * density};
  }

  bool scatters() const { return max_component(scattering_) > 0; }
  /// Its light and what it takes are known without steps.
  bool is_even() const { return !medium_.varies() && !scatters(); }

  /// The part of an endless way in which there is anything to see, or of any in which there is a grid.
  MediumWay cut(MediumWay way) const {
    if (medium_.grid) {
      const Affine& to_own = to_own_;
      clip(to_own.point(way.origin), to_own.vector(way.direction), {0, 0, 0}, {1, 1, 1}, way);
    } else if (std::isinf(way.length)) {
      const Box& all = context_.world->bounds;
      if (all.empty())
        way.length = 0;
      else
        clip(way.origin, way.direction, Vec3d(all.lo), Vec3d(all.hi), way);
    }
    return way;
  }

  /// What of light is left by MediumFade.
  Color faded(double length) const {
    const MediumFade& fade = medium_.fade;
    if (fade.distance == 0) return {1, 1, 1};
    const auto left = static_cast<float>(1 / (1 + portable::pow(length / fade.distance, fade.power)));
    return fade.color + (Color{1, 1, 1} - fade.color) * left;
  }

 private:
  double grid_density(const Vec3d& own) const {
    const DensityGrid& grid = *medium_.grid;
    Vec3d cell = own;
    for (int k = 0; k < 3; ++k) cell[k] *= grid.size(k) - 1;
    return grid.at(cell);
  }

  /// Keeps of a way the part in a box, which the ray sees from `origin` in `direction`.
  static void clip(const Vec3d& origin, const Vec3d& direction, const Vec3d& lo, const Vec3d& hi,
                   MediumWay& way) {
    double begin = 0, end = way.length;
    for (int k = 0; k < 3; ++k) {
      if (direction[k] == 0) {
        if (origin[k] < lo[k] || origin[k] > hi[k]) end = begin;
        continue;
      }
      const double a = (lo[k] - origin[k]) / direction[k], b = (hi[k] - origin[k]) / direction[k];
      begin = std::max(begin, std::min(a, b)), end = std::min(end, std::max(a, b));
    }
    way.origin = way.origin + way.direction * begin;
    way.length = std::max(0.0, end - begin);
  }

  const RenderContext& context_;
  const Medium& medium_;
  Affine to_own_;
  Vec3d extinction_, scattering_, emission_;
};

Vec3d exponentials(const Vec3d& depth) {
  return {portable::exp(-depth.x), portable::exp(-depth.y), portable::exp(-depth.z)};
}

/// The integral of e^(-extinction s) over a length, of which `left` passes.
Vec3d seen_length(const Vec3d& extinction, double length, const Vec3d& left) {
  Vec3d seen;
  for (int k = 0; k < 3; ++k) seen[k] = extinction[k] > 0 ? (1 - left[k]) / extinction[k] : length;
  return seen;
}

/// 0 times infinity is 0: where nothing is taken all passes.
Vec3d depth_of(const Vec3d& extinction, double length) {
  Vec3d depth;
  for (int k = 0; k < 3; ++k) depth[k] = extinction[k] > 0 ? extinction[k] * length : 0;
  return depth;
}

Veil march(const MarchedMedium& medium, const MediumWay& given, std::uint32_t steps,
           const ScatterPlace* scatter) {
  const MediumWay way = medium.cut(given);
  const double step = way.length / steps;
  Vec3d left{1, 1, 1}, light{0, 0, 0};
  for (std::uint32_t i = 0; i < steps && way.length > 0; ++i) {
    const Vec3d place = way.origin + way.direction * (step * (i + 0.5));
    const MediumAt at = medium.at(place);
    const Vec3d passed = exponentials(at.extinction * step);
    const Vec3d seen = left * seen_length(at.extinction, step, passed);
    light = light + at.emission * seen;
    if (scatter != nullptr && max_component(at.scattering) > 0)
      (*scatter)(place, Color(at.scattering * seen));
    left = left * passed;
  }
  return {Color(left), Color(light)};
}

}  // namespace

double phase_of(const Medium& medium, const Vec3d& light, const Vec3d& viewer) {
  constexpr double kSphere = 4 * std::numbers::pi;
  // From the lamp straight to the eye: the viewer's ray runs against the light.
  const double c = -dot(light, viewer);
  switch (medium.phase) {
    case PhaseKind::rayleigh:
      return (1 + c * c) * 0.75 / kSphere;
    case PhaseKind::haze:
      return (1 + 9 * portable::pow((1 + c) / 2, 8)) / (2 * kSphere);
    case PhaseKind::murk:
      return (1 + 50 * portable::pow((1 + c) / 2, 32)) / ((1 + 50.0 / 33) * kSphere);
    case PhaseKind::henyey_greenstein:
      break;
  }
  const double g = medium.anisotropy, square = 1 + g * g - 2 * g * c;
  return (1 - g * g) / (square * std::sqrt(square)) / kSphere;
}

Veil march_medium(const RenderContext& context, const Medium& medium, const MediumWay& way,
                  const ScatterPlace& scatter) {
  const MarchedMedium marched(context, medium);
  Veil veil;
  if (marched.is_even()) {
    const MediumAt at = marched.at(way.origin);
    const Vec3d left = exponentials(depth_of(at.extinction, way.length));
    Vec3d seen = seen_length(at.extinction, way.length, left);
    for (int k = 0; k < 3; ++k)
      if (at.emission[k] == 0) seen[k] = 0;
    veil = {Color(left), Color(at.emission * seen)};
  } else {
    veil = march(marched, way, medium.steps, &scatter);
    // Steps end where nothing more can be seen.
    if (std::isinf(way.length) && !medium.varies())
      veil.left = Color(exponentials(depth_of(marched.at(way.origin).extinction, way.length)));
  }
  veil.left = veil.left * marched.faded(way.length);
  return veil;
}

Color passing_interior(const RenderContext& context, std::uint32_t material, const MediumWay& way) {
  const std::uint32_t number = context.world->materials[material].interior;
  if (number >= context.marched.size()) return {1, 1, 1};
  const Medium& medium = context.marched[number];
  const MarchedMedium marched(context, medium);
  const Color left = medium.varies()
                         ? march(marched, way, std::max(4u, medium.steps / 4), nullptr).left
                         : Color(exponentials(depth_of(marched.at(way.origin).extinction, way.length)));
  return left * marched.faded(way.length);
}

}  // namespace oktett
