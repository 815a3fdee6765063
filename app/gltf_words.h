#pragma once
/// \file What the user asks of glTF files and meshes.

#include <string>

#include "app/command_line.h"
#include "io/gltf/gltf_options.h"

namespace oktett {

/// The words of the command line, not checked yet. Empty: not given.
struct GltfWords {
  std::string time, shutter, variant, stroke_width;
};

/// Pictures of an animation, one after the other.
struct FrameWords {
  std::string frames, rate;
};

/// The numbers of pictures and their times.
struct Frames {
  int first = 0, last = 0;
  double rate = 24;  ///< per second
};

void add_frame_options(Verb& verb, FrameWords& words);
/// Throws Error for other words than `A-B` and a rate.
Frames frames_of(const FrameWords& words);
/// "walk_0007.png" of "walk.png".
std::string frame_path(const std::string& path, int number);

/// `moves`: the verb shows things that move while the shutter is open.
void add_gltf_options(Verb& verb, GltfWords& words, bool moves);
/// Of verbs that show points and lines.
void add_stroke_option(Verb& verb, GltfWords& words);

/// Throws Error for words that are no numbers.
GltfOptions gltf_options(const GltfWords& words);

}  // namespace oktett
