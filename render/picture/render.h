#pragma once
/// \file From a scene to a picture in one call.

#include <memory>

#include "render/picture.h"
#include "render/render_options.h"
#include "render/scene.h"

namespace oktett {

struct RenderResult {
  Picture picture;
  RenderReport report;
  Scene scene;  ///< the scene given, with camera and lights filled in if it had none
  std::shared_ptr<const PhotonMap> photons;  ///< those used; null if the picture has no caustics
};

/// Builds the acceleration structures and renders. The picture's bits do not depend on the number of threads,
/// the instruction set or timing. Throws std::bad_alloc if memory runs out, and Error if this build has no
/// code for `options.isa` or if `options.photons` are not for this scene.
RenderResult render(Scene scene, const RenderOptions& options = {});

}  // namespace oktett
