#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "python/src/arrays.h"
#include "python/src/bind.h"
#include "python/src/unlocked.h"
#include "render/camera.h"
#include "render/recentre.h"

namespace oktett::python {
namespace {

Vec3d parse_vector(const py::handle& value, const std::string& name) {
  const DoubleArray numbers = dense<double>(number_rows(value, name.c_str(), 3));
  if (numbers.ndim() != 1) throw py::value_error(name + ": expected three numbers");
  return {numbers.at(0), numbers.at(1), numbers.at(2)};
}

double parse_number(const py::handle& value, const std::string& name, const Range& range) {
  const auto number = value.cast<double>();
  if (!range.contains(number))
    throw py::value_error(name + ": " + std::to_string(number) + " is out of range");
  return number;
}

/// Changes what `camera` names of a scene's camera.
void override_camera(const py::dict& camera, Scene& scene) {
  // The default of a scene without a camera counts from (0, 0, 0).
  if (!scene.camera_given)
    scene.camera.from = scene.camera.from - scene.origin, scene.camera.at = scene.camera.at - scene.origin;
  const Camera before = scene.camera;
  for (const auto& [key, value] : camera) {
    const auto name = key.cast<std::string>();
    const std::string what = "camera['" + name + "']";
    if (name == "from")
      scene.camera.from = parse_vector(value, what) - scene.origin;
    else if (name == "at")
      scene.camera.at = parse_vector(value, what) - scene.origin;
    else if (name == "up")
      scene.camera.up = parse_vector(value, what);
    else if (name == "fov")
      scene.camera.fov = parse_number(value, what, Camera::kFieldsOfView);
    else
      throw py::value_error("camera: there is no key '" + name + "'" +
                            did_you_mean(name, std::vector<std::string>{"from", "at", "up", "fov"},
                                         "expected from, at, up, fov"));
  }
  if (camera.size() > 0) carry_frame(before, scene.camera);
  // Without a place the scene is framed.
  if (camera.contains("from")) scene.camera_given = true;
}

IntegratorKind parse_integrator(const std::string& name) {
  std::string list;
  std::vector<std::string> known;
  for (const auto& choice : kIntegratorKinds) {
    if (name == choice.name) return choice.value;
    known.emplace_back(choice.name);
    list += (list.empty() ? "" : ", ") + std::string(choice.name);
  }
  throw py::value_error("integrator: there is no '" + name + "'" +
                        did_you_mean(name, known, "expected " + list));
}

using Whole = std::optional<std::int64_t>;

void override_whole(const Whole& given, const char* name, const Range& range, std::uint32_t& out) {
  if (!given) return;
  const auto lo = static_cast<std::int64_t>(range.lo), hi = static_cast<std::int64_t>(range.hi);
  if (*given < lo || *given > hi)
    throw py::value_error(std::string(name) + ": expected " + std::to_string(lo) + " to " +
                          std::to_string(hi) + ", found " + std::to_string(*given));
  out = static_cast<std::uint32_t>(*given);
}

/// One coordinate of positions in float64, from (0, 0, 0); 0 where the picture shows no surface.
py::array far_plane(const Picture& picture, const PicturePlane& plane, double origin) {
  DoubleArray array(ArrayShape{picture.height, picture.width});
  double* const out = array.mutable_data();
  const PicturePlane* const depths = picture.find("Z");
  for (std::size_t i = 0; i < plane.values.size(); ++i)
    out[i] = std::isfinite(depths->values[i]) ? origin + static_cast<double>(plane.values[i]) : 0;
  return array;
}

/// A plane as an array that shares its memory with the picture, unless it holds positions that count from
/// `origin`.
py::array plane_array(const std::shared_ptr<const Picture>& picture, const PicturePlane& plane,
                      const Vec3d& origin) {
  if (plane.name.starts_with("P.") && !(origin == Vec3d{}))
    return far_plane(*picture, plane, origin[plane.name[2] - 'X']);
  const py::capsule owner(new std::shared_ptr<const Picture>(picture),
                          [](void* p) { delete static_cast<std::shared_ptr<const Picture>*>(p); });
  const ArrayShape shape{picture->height, picture->width};
  if (plane.type == PlaneType::unsigned_int)
    return py::array_t<std::uint32_t>(shape, plane.ids.data(), owner);
  return py::array_t<float>(shape, plane.values.data(), owner);
}

py::dict planes_of(const std::shared_ptr<const Picture>& picture, const Vec3d& origin,
                   const std::optional<std::vector<std::string>>& wanted) {
  py::dict planes;
  std::string known;
  for (const PicturePlane& plane : picture->planes) {
    known += (known.empty() ? "" : ", ") + plane.name;
    if (!wanted) planes[py::str(plane.name)] = plane_array(picture, plane, origin);
  }
  if (!wanted) return planes;
  for (const std::string& name : *wanted) {
    const PicturePlane* plane = picture->find(name);
    if (plane == nullptr) throw py::value_error("planes: the picture has no '" + name + "'; it has " + known);
    planes[py::str(name)] = plane_array(picture, *plane, origin);
  }
  return planes;
}

/// Renders `scene`, which was made of that of `store`. `progress` as in render_scene.
std::shared_ptr<Picture> render_picture(SceneStore& store, Scene scene, bool data_layers,
                                        const py::object& progress) {
  RenderOptions options;
  std::atomic<bool> stop = false;
  std::atomic<double> done = 0;
  options.stop = &stop;
  options.data_layers = data_layers;
  options.progress = [&done](const RenderProgress& p) {
    if (p.pixels_total > 0) done = static_cast<double>(p.pixels_done) / static_cast<double>(p.pixels_total);
  };
  std::shared_ptr<Picture> picture;
  run_watched(
      [&] {
        const std::shared_ptr<const TextureSampler> textures = store.textures();
        options.textures = textures.get();
        picture = std::make_shared<Picture>(render(std::move(scene), options).picture);
      },
      [&] { stop = true; }, progress.is_none() ? std::function<void()>() : [&] { progress(done.load()); });
  return picture;
}

bool is_colour(const std::string& name) { return name == "R" || name == "G" || name == "B" || name == "A"; }

py::dict render_scene(SceneStore& store, const Whole& width, const Whole& height, const Whole& samples,
                      const Whole& depth, const Whole& seed, const std::optional<std::string>& integrator,
                      const std::optional<py::dict>& camera,
                      const std::optional<std::vector<std::string>>& wanted, const py::object& progress) {
  Scene scene = store.scene();
  override_whole(width, "width", kFilmSides, scene.film.width);
  override_whole(height, "height", kFilmSides, scene.film.height);
  override_whole(samples, "samples", kPixelSamples, scene.integrator.samples);
  override_whole(depth, "depth", kDepths, scene.integrator.depth);
  override_whole(seed, "seed", kAnySeed, scene.integrator.seed);
  if (integrator) scene.integrator.kind = parse_integrator(*integrator);
  if (camera) override_camera(*camera, scene);
  say_lost_digits(store, find_lost_digits(scene));

  const bool data_layers = !wanted || !std::all_of(wanted->begin(), wanted->end(), is_colour);
  const Vec3d origin = scene.origin;
  return planes_of(render_picture(store, std::move(scene), data_layers, progress), origin, wanted);
}

/// What a notebook shows of a scene: its picture, with few pixels and samples. None if it cannot be rendered.
py::object preview(SceneStore& store) {
  constexpr std::uint32_t kLongSide = 480, kSamples = 4;
  Scene scene = store.scene();
  Film& film = scene.film;
  const std::uint32_t longest = std::max(film.width, film.height);
  const auto shrink = [&](std::uint32_t& side) {
    side = std::max<std::uint32_t>(1, static_cast<std::uint32_t>(std::uint64_t{side} * kLongSide / longest));
  };
  if (longest > kLongSide) shrink(film.width), shrink(film.height);
  scene.integrator.samples = std::min(scene.integrator.samples, kSamples);
  try {
    return py::bytes(files().png(*render_picture(store, std::move(scene), false, py::none())));
  } catch (const Error&) {
    return py::none();
  }
}

constexpr const char* kRenderDoc = R"(Renders the scene.

width, height, samples (per pixel), depth (bounces), seed, integrator ("whitted", "path", "ao", "normal", ...):
    instead of what the scene says.
camera: a dict with some of "from", "at", "up" (three numbers each) and "fov" (degrees), instead of the
    scene's. A scene without camera is framed, one without lights gets some.
planes: the names of the planes that are wanted; all if left out. A picture of colours alone renders faster.
progress: called with the finished part, 0 to 1, about twenty times a second.

Returns a dict of arrays (height, width), row 0 on top: "R", "G", "B" (float32, linear, premultiplied by "A"),
"A", "Z" (depth), "N.X" (normals), "P.X" (positions), "Albedo.R", "u", "v", "primID.I", "geomID.I" (uint32) and
others, named as in EXR files. The numbers are those that `oktett render` writes to an EXR file, which rounds
R, G, B and A to 16 bits. But positions of scenes that have an origin are float64 and count from (0, 0, 0),
those in files from the origin, which is their attribute "origin".

Ctrl-C stops it. Raises ValueError for arguments out of range.)";

}  // namespace

void bind_render(SceneClass& scene) {
  using namespace pybind11::literals;
  const py::none none;
  scene.def("render", render_scene, "width"_a = none, "height"_a = none, py::kw_only(), "samples"_a = none,
            "depth"_a = none, "seed"_a = none, "integrator"_a = none, "camera"_a = none, "planes"_a = none,
            "progress"_a = none, kRenderDoc);
  scene.def(
      "_repr_png_", preview,
      "The bytes of a PNG file that Jupyter shows for a scene: at most 480 pixels wide and high, 4 samples a "
      "pixel. None if the scene cannot be rendered.");
}

}  // namespace oktett::python
