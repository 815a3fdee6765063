#include <limits>

#include "io/scene/readers.h"

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

}  // namespace

void read_camera(SceneLoad& load, const YamlNode& node) {
  const Fields fields(node, "camera", {"from", "at", "up", "fov", "projection", "height"});
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
}

void read_film(SceneLoad& load, const YamlNode& node) {
  const Fields fields(node, "film", {"width", "height", "crop"});
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
}

void read_integrator(SceneLoad& load, const YamlNode& node) {
  const Fields fields(node, "integrator", {"kind", "samples", "depth", "seed", "ao_radius"});
  SceneValues& values = load.values;
  IntegratorSettings& integrator = load.scene.integrator;
  if (const YamlNode* kind = fields["kind"])
    integrator.kind = values.choice<IntegratorKind>(*kind, {{"whitted", IntegratorKind::whitted},
                                                            {"path", IntegratorKind::path},
                                                            {"ao", IntegratorKind::ao},
                                                            {"normal", IntegratorKind::normal},
                                                            {"depth", IntegratorKind::depth}});
  if (const YamlNode* samples = fields["samples"]) integrator.samples = values.integer(*samples, 1, 65536);
  if (const YamlNode* depth = fields["depth"]) integrator.depth = values.integer(*depth, 0, 64);
  if (const YamlNode* seed = fields["seed"])
    integrator.seed = values.integer(*seed, 0, std::numeric_limits<std::uint32_t>::max());
  values.read(fields["ao_radius"], integrator.ao_radius, kNonNegative);
}

}  // namespace oktett
