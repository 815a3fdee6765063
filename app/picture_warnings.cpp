#include "app/picture_warnings.h"

#include <fmt/format.h>

#include <algorithm>

namespace oktett {
namespace {

/// A place of the scene in the coordinates of its files.
std::string place_text(const Scene& scene, const Vec3d& place) {
  const Vec3d p = scene.origin + place;
  const int digits = scene.origin == Vec3d{} ? 6 : 10;
  return fmt::format("({:.{}g}, {:.{}g}, {:.{}g})", p.x, digits, p.y, digits, p.z, digits);
}

bool is_black_picture(const Picture& picture) {
  for (const char* name : {"R", "G", "B"})
    if (const PicturePlane* plane = picture.find(name); plane != nullptr)
      if (std::ranges::any_of(plane->values, [](float value) { return value != 0; })) return false;
  return true;
}

std::string why_black(const Scene& scene) {
  const bool glowing = std::ranges::any_of(scene.materials, [](const Material& m) { return glows(m); });
  if (!scene.lights.empty()) return "no light reaches what the camera sees";
  if (!glowing) return "the scene has no lights";
  if (traits(scene.integrator.kind).light_from_points && scene.integrator.light_samples == 0)
    return "its only lights are glowing surfaces, which light others with 'light_samples' or the integrator "
           "'path'";
  return "no light of its glowing surfaces reaches what the camera sees";
}

}  // namespace

std::string why_nothing_is_seen(const RenderResult& result) {
  const Scene& scene = result.scene;
  const RenderReport& report = result.report;
  if (report.stopped || report.camera_rays == 0 || scene.objects.empty()) return {};
  if (report.camera_hits == 0 && scene.medium == kNoId)
    return fmt::format("the camera at {}, which looks towards {}, sees none of the objects",
                       place_text(scene, scene.camera.from), place_text(scene, scene.camera.at));
  if (traits(scene.integrator.kind).bounces() && is_black_picture(result.picture))
    return "the picture is black: " + why_black(scene);
  return {};
}

}  // namespace oktett
