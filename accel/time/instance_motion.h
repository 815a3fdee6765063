#pragma once
/// \file Where an instance stands at a time, and the boxes that hold it between keys.

#include "accel/time/time_tree.h"
#include "accel/trace_scene.h"

namespace oktett {

/// At how many keys the place of an instance is given.
std::uint32_t key_count(const SceneInstance& instance);

/// The map from the space of the child to that of the scene.
Affine map_at(const SceneInstance& instance, const KeyTime& time);

/// The image of a box at a key, grown so that between keys what is in the box is in the interpolated bounds,
/// and by what rounding the transformed ray to float may displace.
Box moved_bounds(const SceneInstance& instance, const Box& box, std::uint32_t key);
/// The same for a map that does not move.
Box moved_bounds(const Affine& map, const Box& box);

}  // namespace oktett
