#pragma once
/// \file The light of a photographer's studio as a picture of all directions.

#include "core/vec3.h"
#include "render/light/environment_picture.h"

namespace oktett {

/// Where a studio stands: unit vectors, perpendicular to each other.
struct StudioFrame {
  Vec3d right{1, 0, 0};  ///< to the right of who looks in
  Vec3d up{0, 1, 0};
  Vec3d back{0, 0, 1};  ///< towards who looks in
};

/// Soft boxes over a ground: a warm one from the upper left, a weak cool one from the right, one above and
/// one behind, before a backdrop that darkens upwards.
///
/// The horizon and all below it have the radiance `horizon`. It is what an unshadowed diffuse ground of the
/// albedo `ground` shows under these lights, so that such a ground and the backdrop merge.
EnvironmentPicture studio_picture(const StudioFrame& frame, double ground, double horizon);

/// A bright sky, bluer and darker towards the zenith, over a ground of its horizon's colour.
EnvironmentPicture overcast_picture(const StudioFrame& frame);

}  // namespace oktett
