#pragma once
/// \file What the user asks of `oktett render`, and how it changes a scene.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "app/checkpoint.h"
#include "app/command_line.h"
#include "app/gltf_words.h"
#include "app/limits.h"
#include "app/setting_options.h"
#include "io/cache/scene_cache.h"
#include "io/scene/scene_file.h"
#include "render/look/default_look.h"
#include "render/scene.h"

namespace oktett {

// ---- Options of `oktett render` for a folder that keeps meshes and trees.

/// The words of the command line, not checked yet. Empty: not given.
struct CacheArguments {
  std::string folder, size;
};

void add_cache_options(Verb& verb, CacheArguments& arguments);

/// Null if no cache is asked for. If the folder cannot be used, says so and returns null. Throws Error for a
/// size that cannot be read.
std::unique_ptr<SceneCache> open_cache(const CacheArguments& arguments);

/// The words of the command line. Numbers are read, words are not checked yet.
struct RenderArguments {
  std::string scene;
  LimitArguments limits;
  std::string outfile;
  bool no_output = false;
  std::string bits;        ///< of PNG: 8 or 16; empty: 8
  std::string depth_unit;  ///< of depths with 16 bits; empty: as it fits
  unsigned threads = 0;
  SettingWords settings;
  bool denoise = false;
  /// Of a mesh given alone; empty: the default.
  std::string look, up, viewpoint;
  std::string isa;
  std::string bvh;  ///< quality of the trees; empty: the default
  std::vector<std::string> definitions;
  std::string pov_files;  ///< PovOptions::files
  std::string stats;      ///< "", "text" or "json"
  std::string display_server;
  std::string show;  ///< how to print the picture on the terminal; empty: not at all
  bool caustics = false;
  std::string photon_map;  ///< file; empty: photons are not kept
  CheckpointArguments checkpoints;
  CacheArguments cache;
  GltfWords gltf;
  FrameWords frames;
  bool quiet = false;
  bool verbose = false;
  bool progress = false;
};

/// The options that say what a picture shows and with what means: those that all verbs with pictures have.
void add_picture_options(Verb& verb, RenderArguments& arguments);
void add_render_options(Verb& verb, RenderArguments& arguments);
/// Reads the words of a command line of `oktett render`. Those that are not given leave `arguments` as it is.
/// Throws Error.
void read_render_words(const std::vector<std::string>& words, RenderArguments& arguments);

/// Throws Error if --nthreads is out of range.
void check_threads(unsigned threads);

/// Overrides settings of the scene by the arguments. Throws Error for unknown words.
void override_scene(const RenderArguments& arguments, Scene& scene);
/// The look of a mesh given alone; nothing for a scene file, or if an integrator is asked for: then the mesh
/// stands before the background, lit from the camera. Throws Error for an unknown word or a look that does
/// not belong here.
std::optional<Look> look_of(const RenderArguments& arguments);
/// The up direction that --up names; nothing if it is not given. Throws Error for an unknown word, or if it
/// does not belong here.
std::optional<Vec3d> up_of(const RenderArguments& arguments);
/// Where a mesh given alone is seen from. Throws Error for an unknown word, or if it does not belong here.
Viewpoint viewpoint_of(const RenderArguments& arguments);
/// The option --files.
void add_pov_files_option(Verb& verb, std::string& folder);
/// Splits `name=value` words; of several with one name the last counts.
Definitions parse_definitions(const std::vector<std::string>& words);
void add_bvh_option(Verb& verb, std::string& quality);
/// Build options of the quality that --bvh names; empty: the default. Throws Error for an unknown word.
BuildOptions parse_bvh_option(const std::string& quality);
/// `outfile`, or the scene's name with .png in the current directory; empty if no picture shall be written.
/// Throws Error if both are asked for.
std::string output_path(const RenderArguments& arguments);

/// --bits, of verbs that write pictures.
void add_bits_option(Verb& verb, std::string& bits);
/// Throws Error if 16 bits are asked for and `picture`, which is written unless it is empty, is none of PNG.
void check_bits(const std::string& bits, const std::string& picture);
/// Whether the picture shows depths in steps of a unit.
bool shows_depth_units(const RenderArguments& arguments, const Scene& scene);
/// That of --depth-unit, if it is given. Throws Error if it is no length.
std::optional<double> depth_unit_of(const RenderArguments& arguments);

const char* to_string(IntegratorKind kind);

}  // namespace oktett
