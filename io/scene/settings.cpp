/// \file The camera and the integrator of scene files, where their descriptions do not say all.

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>

#include "io/scene/readers.h"
#include "io/scene/schema.h"
#include "render/camera_mesh.h"
#include "render/moments.h"

namespace oktett {
namespace {

void check_view(const Camera& camera, const YamlNode& node) {
  const Vec3d view = camera.at - camera.from;
  const double distance = max_component(abs(view)), up_size = max_component(abs(camera.up));
  if (distance == 0)
    throw Error(node.where(), "the camera looks from where it looks at: 'from' and 'at' are equal");
  if (up_size == 0) throw Error(node.where(), "the camera's 'up' is zero");
  if (length(cross(normalize(view / distance), normalize(camera.up / up_size))) < 1e-9)
    throw Error(node.where(), "the camera's 'up' is parallel to its view direction");
}

/// What a projection is called in messages, such as "an orthographic view".
std::string view_name(Projection projection) {
  const std::string_view name = std::ranges::find(kProjections, projection, &Choice<Projection>::value)->name;
  return fmt::format("{} {} view",
                     std::string_view("aeiou").find(name[0]) == std::string_view::npos ? "a" : "an", name);
}

/// Of a camera of meshes, which stand where they are: `from` and `at` only say where it is thought to be.
void set_meshes(SceneLoad& load, const Fields& fields, const YamlNode& node, Camera& camera) {
  if (camera.mesh == nullptr) throw Error(node.where(), "a mesh view needs a 'mesh', whose faces see");
  for (const char* key : {"from", "at", "up", "frame", "motion"})
    load.warn_if_unused(fields, key, true, "the view of a mesh is that of its faces");
  camera.from = camera.mesh->middle(), camera.at = camera.from - Vec3d{0, 0, 1}, camera.up = {0, 1, 0};
  camera.frame.reset(), camera.motion = nullptr;
}

void check_lens(const Fields& fields, const YamlNode& node, const Camera& camera) {
  const YamlNode *f_number = fields["f_number"], *focus = fields["focus"];
  if (is_curved(camera.projection))
    for (const char* key : {"aperture", "f_number", "focus"})
      if (fields[key])
        throw Error(fields[key]->where(),
                    fmt::format("{} has no lens; '{}' is for perspective and orthographic views",
                                view_name(camera.projection), key));
  if (f_number && camera.projection == Projection::orthographic)
    throw Error(f_number->where(), "an orthographic view has no f-number; expected 'aperture'");
  if (camera.focus_at && !(dot(*camera.focus_at - camera.from, camera.at - camera.from) > 0))
    throw Error(focus ? focus->where() : node.where(), "the point in focus does not lie before the camera");
}

/// Warns of keys that another projection has.
void warn_of_unused_keys(SceneLoad& load, const Fields& fields, const Camera& camera) {
  const Projection projection = camera.projection;
  const bool cylindrical = projection == Projection::cylindrical;
  const bool by_height = projection == Projection::orthographic ||
                         (cylindrical && camera.along_axis == Projection::orthographic);
  const std::string view = view_name(projection);
  const auto has = [&](const char* what) { return fmt::format("{} has {}", view, what); };
  const std::string own = projection == Projection::perspective    ? has("a 'fov'")
                          : projection == Projection::orthographic ? has("a 'height'")
                          : has_angle(projection)                  ? has("an 'angle'")
                          : projection == Projection::mesh         ? has("no angle")
                                                                   : has("always the same angle");
  load.warn_if_unused(fields, "fov", projection != Projection::perspective, own);
  load.warn_if_unused(fields, "height", !by_height, own);
  load.warn_if_unused(fields, "angle", !has_angle(projection), own);
  for (const char* key : {"axis", "along_axis"})
    load.warn_if_unused(fields, key, !cylindrical, fmt::format("{} has no cylinder", view));
  load.warn_if_unused(fields, "mesh", projection != Projection::mesh, fmt::format("{} has no mesh", view));
}

/// Warns of settings that change nothing, given the others.
void warn_of_unused_settings(SceneLoad& load, const Fields& fields) {
  IntegratorSettings s = load.scene.integrator;
  if (load.integrator) s.kind = *load.integrator;
  const auto warn = [&](const char* key, bool is_unused, const std::string& why) {
    load.warn_if_unused(fields, key, is_unused, why);
  };
  const bool path = traits(s.kind).traces_paths, whitted = traits(s.kind).light_from_points;
  const auto only = [&](const char* kinds) {
    const auto* const kind = std::ranges::find(kIntegratorKinds, s.kind, &Choice<IntegratorKind>::value);
    return fmt::format("it is for {}, but the integrator is {}", kinds, quote(kind->name));
  };
  warn("depth", !traits(s.kind).bounces(), only("'whitted' and 'path'"));
  warn("cutoff", !whitted, only("'whitted'"));
  warn("ao_radius", !traits(s.kind).ao_radius && s.ao_radius > 0, only("'ao'"));
  warn("caustics", !path && s.caustics.photons > 0, only("'path'"));
  warn("light_samples", !whitted && s.light_samples > 0, only("'whitted'"));
  warn("penumbra_factor", !whitted, only("'whitted'"));
  warn("penumbra_factor", whitted && s.light_samples == 0, "there are no 'light_samples'");
  warn("max_samples", s.error == 0, "there is no 'error'");
  warn("error", s.error > 0 && s.max_samples / s.samples < 2,
       fmt::format("pixels get {} samples or at least twice as many, but 'max_samples' is {}", s.samples,
                   s.max_samples));
}

}  // namespace

// ---- A distance, or a point.

void read_value(SceneLoad& load, const YamlNode& node, const Range&, Camera::Focus& focus) {
  if (node.kind == YamlKind::sequence) {
    focus.point = load.values.vector(node);
    return;
  }
  focus.point.reset();
  focus.distance = load.values.number(node, kPositive);
}

std::string schema_of(Schema&, const Range&, const Camera::Focus&) {
  return Schema::any_of({Schema::number(kPositive), Schema::vector()});
}

// ---- An angle, or two.

static constexpr Range kCurvedAngles{0, 360, true};

void read_value(SceneLoad& load, const YamlNode& node, const Range&, Camera::Angles& angles) {
  angles.values[1] = 0;
  if (node.kind == YamlKind::sequence)
    load.values.numbers(node, angles.values, kCurvedAngles);
  else
    angles.values[0] = load.values.number(node, kCurvedAngles);
}

std::string schema_of(Schema&, const Range&, const Camera::Angles&) {
  return Schema::any_of({Schema::number(kCurvedAngles), Schema::numbers(2, kCurvedAngles)});
}

void read_value(SceneLoad& load, const YamlNode& node, const Range&, Camera& camera) {
  load.scene.camera_given = true;
  const Fields fields = read_described(load, node, "camera", camera);
  if (camera.projection == Projection::mesh)
    set_meshes(load, fields, node, camera);
  else if (camera.frame)
    camera.set_frame(*camera.frame);
  else
    check_view(camera, node);
  check_lens(fields, node, camera);
  if (const YamlNode* angle = fields["angle"];
      angle && angle->kind == YamlKind::sequence && camera.projection != Projection::spherical)
    throw Error(angle->where(),
                fmt::format("{} has one angle; two are for a spherical view", view_name(camera.projection)));
  warn_of_unused_keys(load, fields, camera);
  // One key says where the camera stands all the time.
  if (!camera.motion || camera.motion->moves()) return;
  camera = camera_at(camera, 0);
  camera.motion = nullptr;
}

// ---- `auto`, or a number.

void read_value(SceneLoad& load, const YamlNode& node, const Range&, CausticSettings::Radius& radius) {
  radius.value = 0;
  if (load.values.text(node) != "auto") radius.value = load.values.number(node, kPositive);
}

std::string schema_of(Schema&, const Range&, const CausticSettings::Radius&) {
  return Schema::any_of({Schema::words({"auto"}), Schema::number(kPositive)});
}

// ---- A flag, or a map of settings, which switches them on.

void read_value(SceneLoad& load, const YamlNode& node, const Range&, CausticSettings& caustics) {
  if (node.kind == YamlKind::scalar) {
    caustics.photons = load.values.boolean(node) ? CausticSettings::kUsualPhotons : 0;
    return;
  }
  caustics.photons = CausticSettings::kUsualPhotons;
  read_described(load, node, "caustics", caustics);
}

std::string schema_of(Schema& schema, const Range&, const CausticSettings&) {
  CausticSettings usual;
  usual.photons = CausticSettings::kUsualPhotons;
  return Schema::any_of({Schema::boolean(), schema.map("caustics", usual)});
}

void read_value(SceneLoad& load, const YamlNode& node, const Range&, IntegratorSettings& integrator) {
  warn_of_unused_settings(load, read_described(load, node, "integrator", integrator));
}

}  // namespace oktett
