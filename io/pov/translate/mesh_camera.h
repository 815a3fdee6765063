#pragma once
/// \file mesh_camera: a camera whose rays start at the faces of meshes. Within io/ only.

#include "io/pov/translate/context.h"

namespace oktett::pov {

/// The camera of a block `mesh_camera`. Of the place and the direction of the camera around it only z counts:
/// how far along the normals rays start, and, where it is negative, that they leave on the other side. Asks
/// for samples if rays per pixel are more than usual. Throws Error where POV-Ray has no picture.
Node mesh_camera_node(Context& context, const Block& block, double location_z, double direction_z);

}  // namespace oktett::pov
