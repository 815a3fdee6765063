#pragma once
/// \file Interiors: indices of refraction, and what fills solids and the space around. Within io/ only.

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "io/pov/translate/pigment.h"

namespace oktett::pov {

/// What a block `media` says.
struct PovMedia {
  Place where;
  Vec3d absorption{0, 0, 0}, emission{0, 0, 0}, scattering{0, 0, 0};
  int type = 1;  ///< of the scattering
  double eccentricity = 0, extinction = 1;
  std::vector<Pigment> densities;
};

/// What blocks `interior` say.
struct Interior {
  Place where;
  double ior = 1;
  double fade_distance = 0, fade_power = 0;
  Vec3d fade_color{0, 0, 0};
  std::vector<PovMedia> media;

  bool fills() const { return !media.empty() || (fade_distance > 0 && fade_power > 0); }
};

void read_interior(Context& context, const Block& block, Interior& interior);
void read_media(Context& context, const Block& block, PovMedia& media);

/// Names media, each once.
class MediaWriter {
 public:
  explicit MediaWriter(Context& context) : context_(context) {}

  /// The name of what fills a solid, whose space `to_world` leads out of; empty if nothing does. Without
  /// `shows_media` only what light loses counts.
  std::string name(const Interior& interior, const Affine& to_world, bool shows_media);

 private:
  Context& context_;
  std::map<std::string, std::string> names_;  ///< by what they say
  std::set<std::string> taken_;
};

}  // namespace oktett::pov
