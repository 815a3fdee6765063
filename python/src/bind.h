#pragma once
/// \file The parts of the Python module.

#include <pybind11/pybind11.h>

#include <memory>
#include <vector>

#include "python/src/scene_store.h"

namespace oktett::python {

using SceneClass = pybind11::class_<SceneStore, std::shared_ptr<SceneStore>>;

/// Making scenes, pickling, what they hold.
void bind_scene(SceneClass& scene);
/// Scene.render.
void bind_render(SceneClass& scene);
/// Queries with rays.
void bind_ray_queries(SceneClass& scene);
/// Queries with points.
void bind_point_queries(SceneClass& scene);

/// The structure of a scene for rays with a mask, built without the interpreter's lock if that is still to be
/// done.
std::shared_ptr<const PlacedWorld> world_of(SceneStore& scene, std::uint32_t mask = ~0u);
/// Those for rays with each of these masks, of one state of the scene.
std::vector<std::shared_ptr<const PlacedWorld>> worlds_of(SceneStore& scene,
                                                          const std::vector<std::uint32_t>& masks);
/// Warns, through Python, of objects so far away from others that rays lose their details (find_lost_digits);
/// each text once.
void say_lost_digits(SceneStore& scene, const std::vector<Warning>& lost);

}  // namespace oktett::python
