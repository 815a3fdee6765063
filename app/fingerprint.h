#pragma once
/// \file What the bits of a picture depend on.

#include <string>
#include <vector>

#include "app/render_options.h"
#include "io/film/film_file.h"

namespace oktett {

/// The settings of a scene that its sums depend on, and the files that were read for it. Tone curves are not
/// among them: they are applied to the finished picture.
FilmFingerprint fingerprint_of(const Scene& scene, const std::vector<std::string>& files,
                               const RenderArguments& arguments, bool data_layers);

}  // namespace oktett
