#include "render/moments.h"

#include <algorithm>

#include "core/math.h"
#include "core/random.h"
#include "render/light/emitter.h"

namespace oktett {

// ---- Cameras and lights that have been moved.

/// Turns the profile of an emitter, aimed along `down`, as a transform turns what is seen of it: down and
/// where horizontal angles count from.
static void turn_profile(const Affine& motion, Vec3d& down, double& rotation) {
  const Vec3d zero = motion.vector(aim(nullptr, down, rotation).zero);
  down = motion.vector(down);
  const AimedProfile unturned = aim(nullptr, down, 0);
  rotation =
      portable::atan2(dot(zero, cross(unturned.zero, unturned.down)), dot(zero, unturned.zero)) / kDegree;
}

Camera camera_at(const Camera& camera, double time) {
  if (camera.motion == nullptr) return camera;
  const Affine motion = camera.motion->at(time);
  Camera moved = camera;
  moved.from = motion.point(camera.from), moved.at = motion.point(camera.at);
  moved.up = motion.vector(camera.up);
  if (camera.frame)
    moved.frame = ViewFrame{motion.vector(camera.frame->right), motion.vector(camera.frame->up),
                            motion.vector(camera.frame->direction)};
  if (camera.focus_at) moved.focus_at = motion.point(*camera.focus_at);
  return moved;
}

Light moved_light(const Affine& motion, const Light& light) {
  Light moved = light;
  if (auto* point = std::get_if<PointLight>(&moved)) {
    point->position = motion.point(point->position);
    if (point->profile != nullptr) turn_profile(motion, point->down, point->rotation);
  }
  if (auto* spot = std::get_if<SpotLight>(&moved)) {
    spot->position = motion.point(spot->position);
    if (spot->profile != nullptr)
      turn_profile(motion, spot->direction, spot->rotation);
    else
      spot->direction = motion.vector(spot->direction);
  }
  if (auto* far = std::get_if<DirectionalLight>(&moved)) {
    far->direction = motion.vector(far->direction);
    if (far->from) far->from = motion.point(*far->from);
  }
  return moved;
}

// ---- Moments of the shutter.

namespace {

bool any_light_moves(const Scene& scene) {
  const auto moves = [](const LightTraits& traits) { return traits.motion != nullptr; };
  return std::any_of(scene.light_traits.begin(), scene.light_traits.end(), moves);
}

/// Whether light samples are different at each moment.
bool lights_differ(const Scene& scene, const World& world) {
  if (any_light_moves(scene)) return true;
  return traits(scene.integrator.kind).traces_paths && !world.moving.empty() &&
         std::ranges::any_of(world.materials, glows);
}

std::vector<Light> lights_at(const Scene& scene, double time) {
  std::vector<Light> lights = scene.lights;
  for (std::size_t i = 0; i < std::min(lights.size(), scene.light_traits.size()); ++i)
    if (const MotionPointer& motion = scene.light_traits[i].motion)
      lights[i] = moved_light(motion->at(time), lights[i]);
  return lights;
}

}  // namespace

Moments::Moments(const Scene& scene, World& world, const BuildOptions& build) : world_(world) {
  things_move_ = !world.moving.empty() || any_light_moves(scene);
  if (scene.camera.motion == nullptr && !things_move_) return;
  const double open = scene.camera.shutter[0], close = scene.camera.shutter[1];
  const std::uint32_t samples = first_samples(scene.integrator);
  std::uint32_t count = open == close ? 1 : std::min(samples, kMostMoments);
  // Each moment needs photons of its own.
  if (things_move_ && wants_photons(scene.integrator))
    count = std::min(count, std::max(scene.integrator.caustics.passes, 1u));
  if (world.bent_triangles > 0)
    count = static_cast<std::uint32_t>(std::min<std::uint64_t>(
        count, std::max<std::uint64_t>(kLeastBentMoments, kMostBentTriangles / world.bent_triangles)));
  const std::uint64_t key = pixel_key(scene.integrator.seed, ~std::uint64_t{0} - 1);
  for (std::uint32_t m = 0; m < count; ++m) {
    const double begin = first_sample_of_moment(m, count, samples),
                 end = first_sample_of_moment(m + 1, count, samples);
    const double at = begin + (end - begin) * static_cast<double>(random_float(key, m, 0));
    times_.push_back(open + (close - open) * (at / samples));
  }
  if (world.moving.empty()) return;
  for (const double time : times_) {
    World& posed = worlds_.emplace_back(world);
    pose(posed, time, build);
    world.bounds.grow(posed.bounds);
  }
  for (World& posed : worlds_) posed.bounds = world.bounds;
}

void Moments::share(Scene& scene, RenderContext& context) {
  const bool differ = !times_.empty() && lights_differ(scene, world_);
  contexts_.reserve(times_.size());
  for (std::size_t m = 0; m < times_.size(); ++m) {
    RenderContext& c = contexts_.emplace_back(context);
    const Camera camera = camera_at(scene.camera, times_[m]);
    c.camera = camera_frame(camera, scene.film);
    if (!worlds_.empty()) c.world = &worlds_[m];
    enclose_camera(camera, c);
    if (!differ) continue;
    std::vector<Light> lights = lights_at(scene, times_[m]);
    std::swap(scene.lights, lights);
    c.lights = light_sources(scene);
    c.sampled = &lights_.emplace_back(scene, *c.world, context.sampled);
    std::swap(scene.lights, lights);
  }
  if (!contexts_.empty()) context.moments = &contexts_;
}

}  // namespace oktett
