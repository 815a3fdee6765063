#pragma once
/// \file Where an instance stands at a time, and the boxes that hold it between keys.

#include "accel/time/time_tree.h"
#include "accel/trace_scene.h"

namespace oktett {

/// At how many keys the places of instances are given.
std::uint32_t key_count(const SceneInstance& instance);
std::uint32_t key_count(const SceneInstances& instances);

/// The map from the space of the child to that of the scene; of an array, of instance `index`.
Affine map_at(const SceneInstance& instance, const KeyTime& time);
Affine map_at(const SceneInstances& instances, std::uint32_t index, const KeyTime& time);

/// The same for a geometry that is either, at a time of which its keys are from 0 to 1.
Affine map_at(const SceneGeometry& geometry, std::uint32_t index, float own_time);

/// The image of a box at a key, grown so that between keys what is in the box is in the interpolated bounds,
/// and by what rounding the transformed ray to float may displace.
Box moved_bounds(const SceneInstance& instance, const Box& box, std::uint32_t key);
Box moved_bounds(const SceneInstances& instances, std::uint32_t index, const Box& box, std::uint32_t key);

}  // namespace oktett
