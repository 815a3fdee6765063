#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <memory>

#include "io/scene/readers.h"
#include "render/moments.h"

namespace oktett {
namespace {

constexpr std::uint32_t kMaxFilmSide = 65536;
constexpr std::uint64_t kMaxFilmPixels = std::uint64_t{1} << 30;

void check_view(const Camera& camera, const YamlNode& node) {
  const Vec3d view = camera.at - camera.from;
  const double distance = max_component(abs(view)), up_size = max_component(abs(camera.up));
  if (distance == 0)
    throw Error(node.where(), "the camera looks from where it looks at: 'from' and 'at' are equal");
  if (up_size == 0) throw Error(node.where(), "the camera's 'up' is zero");
  if (length(cross(normalize(view / distance), normalize(camera.up / up_size))) < 1e-9)
    throw Error(node.where(), "the camera's 'up' is parallel to its view direction");
}

void read_lens(SceneValues& values, const Fields& fields, const YamlNode& node, Camera& camera) {
  const YamlNode *aperture = fields["aperture"], *f_number = fields["f_number"], *focus = fields["focus"];
  if (aperture && f_number) throw Error(node.where(), "expected 'aperture' or 'f_number', not both");
  values.read(aperture, camera.aperture, kNonNegative);
  values.read(f_number, camera.f_number, kPositive);
  if (aperture) camera.f_number = 0;
  if (f_number) camera.aperture = 0;
  if (f_number && camera.projection == Projection::orthographic)
    throw Error(f_number->where(), "an orthographic view has no f-number; expected 'aperture'");
  if (focus && focus->kind == YamlKind::sequence) {
    camera.focus_at = values.vector(*focus);
  } else if (focus) {
    camera.focus_at.reset();
    values.read(focus, camera.focus, kPositive);
  }
  if (camera.focus_at && !(dot(*camera.focus_at - camera.from, camera.at - camera.from) > 0))
    throw Error(focus ? focus->where() : node.where(), "the point in focus does not lie before the camera");
}

/// Warns of settings that change nothing, given the others.
void warn_of_unused_settings(SceneLoad& load, const Fields& fields, const Camera& camera) {
  const bool perspective = camera.projection == Projection::perspective;
  load.warn_if_unused(fields, "fov", !perspective, "an orthographic view has a 'height'");
  load.warn_if_unused(fields, "height", perspective, "a perspective view has a 'fov'");
}

}  // namespace

void read_camera(SceneLoad& load, const YamlNode& node) {
  const Fields fields(node, "camera",
                      {"from", "at", "up", "fov", "projection", "height", "aperture", "f_number", "focus",
                       "shutter", "motion"});
  SceneValues& values = load.values;
  Camera& camera = load.scene.camera;
  load.scene.camera_given = true;
  values.read(fields["from"], camera.from);
  values.read(fields["at"], camera.at);
  values.read(fields["up"], camera.up);
  values.read(fields["fov"], camera.fov, {0, 180, true, true});
  values.read(fields["height"], camera.height, kPositive);
  if (const YamlNode* projection = fields["projection"])
    camera.projection = values.choice<Projection>(
        *projection, {{"perspective", Projection::perspective}, {"orthographic", Projection::orthographic}});
  check_view(camera, node);
  read_lens(values, fields, node, camera);
  warn_of_unused_settings(load, fields, camera);
  if (const YamlNode* shutter = fields["shutter"]) {
    values.numbers(*shutter, camera.shutter);
    if (camera.shutter[0] > camera.shutter[1])
      throw Error(shutter->where(), "the shutter closes before it opens");
  }
  if (const YamlNode* motion = fields["motion"]) {
    const auto moved = std::make_shared<Motion>();
    moved->factors.push_back(read_motion(values, *motion));
    camera.motion = moved;
    // One key says where the camera stands all the time.
    if (moved->moves()) return;
    camera = camera_at(camera, 0);
    camera.motion = nullptr;
  }
}

void read_film(SceneLoad& load, const YamlNode& node) {
  const Fields fields(
      node, "film",
      {"width", "height", "crop", "filter", "filter_radius", "tone", "exposure", "cryptomatte"});
  Film& film = load.scene.film;
  if (const YamlNode* width = fields["width"]) film.width = load.values.integer(*width, 1, kMaxFilmSide);
  if (const YamlNode* height = fields["height"]) film.height = load.values.integer(*height, 1, kMaxFilmSide);
  if (std::uint64_t{film.width} * film.height > kMaxFilmPixels)
    throw Error(node.where(), "the film has more than 2^30 pixels");
  if (const YamlNode* crop = fields["crop"]) {
    load.values.numbers(*crop, film.crop, kUnitInterval);
    if (film.crop[0] >= film.crop[1] || film.crop[2] >= film.crop[3])
      throw Error(crop->where(),
                  "the crop window is empty; expected [x0, x1, y0, y1] with x0 < x1 and y0 < y1");
  }
  if (const YamlNode* filter = fields["filter"]) {
    film.filter = load.values.choice<FilterKind>(*filter, kFilterKinds);
    film.filter_radius = 0;
  }
  load.values.read(fields["filter_radius"], film.filter_radius, kFilterRadii);
  if (const YamlNode* tone = fields["tone"]) film.tone.kind = load.values.choice<ToneKind>(*tone, kToneKinds);
  load.values.read(fields["exposure"], film.tone.exposure, kExposures);
  load.values.read(fields["cryptomatte"], film.cryptomatte);
}

/// `caustics`: a flag, or a map of settings, which switches them on.
static void read_caustics(SceneLoad& load, const YamlNode& node, CausticSettings& caustics) {
  SceneValues& values = load.values;
  if (node.kind == YamlKind::scalar) {
    caustics.photons = values.boolean(node) ? CausticSettings::kUsualPhotons : 0;
    return;
  }
  const Fields fields(node, "caustics", {"photons", "passes", "radius"});
  caustics.photons = CausticSettings::kUsualPhotons;
  if (const YamlNode* photons = fields["photons"])
    caustics.photons = values.integer(*photons, 1, CausticSettings::kMostPhotons);
  if (const YamlNode* passes = fields["passes"])
    caustics.passes = values.integer(*passes, 1, CausticSettings::kMostPasses);
  if (const YamlNode* radius = fields["radius"]) {
    caustics.radius = 0;
    if (values.text(*radius) != "auto") values.read(radius, caustics.radius, kPositive);
  }
}

/// Warns of settings that change nothing, given the others.
static void warn_of_unused_settings(SceneLoad& load, const Fields& fields) {
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

void read_integrator(SceneLoad& load, const YamlNode& node) {
  const Fields fields(node, "integrator",
                      {"kind", "samples", "depth", "seed", "ao_radius", "clamp", "error", "max_samples",
                       "caustics", "light_samples", "penumbra_factor"});
  SceneValues& values = load.values;
  IntegratorSettings& integrator = load.scene.integrator;
  if (const YamlNode* kind = fields["kind"])
    integrator.kind = values.choice<IntegratorKind>(*kind, kIntegratorKinds);
  if (const YamlNode* samples = fields["samples"]) integrator.samples = values.integer(*samples, 1, 65536);
  if (const YamlNode* depth = fields["depth"]) integrator.depth = values.integer(*depth, 0, 64);
  if (const YamlNode* seed = fields["seed"])
    integrator.seed = values.integer(*seed, 0, std::numeric_limits<std::uint32_t>::max());
  values.read(fields["ao_radius"], integrator.ao_radius, kNonNegative);
  values.read(fields["clamp"], integrator.clamp, kNonNegative);
  values.read(fields["error"], integrator.error, kErrors);
  if (const YamlNode* most = fields["max_samples"]) integrator.max_samples = values.integer(*most, 1, 65536);
  if (const YamlNode* lights = fields["light_samples"])
    integrator.light_samples = values.integer(*lights, 0, 1024);
  if (const YamlNode* factor = fields["penumbra_factor"]) {
    integrator.penumbra_factor = values.integer(*factor, 1, 16);
    if (!std::has_single_bit(integrator.penumbra_factor))
      throw Error(factor->where(),
                  fmt::format("expected 1, 2, 4, 8 or 16, found {}", integrator.penumbra_factor));
  }
  if (const YamlNode* caustics = fields["caustics"]) read_caustics(load, *caustics, integrator.caustics);
  warn_of_unused_settings(load, fields);
}

}  // namespace oktett
