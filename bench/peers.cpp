/// \file Oktett against Embree: the same scene, the same rays in the same order, runs interleaved, medians of
/// the ratios. `peers` without arguments lists its options.
///
/// Embree runs in the best of its modes (1, 8 or 16 rays, coherent or not, medium or high build quality),
/// once as it is and once robust; denormals are flushed for both programs.

#include <string>

#include "bench/peer_options.h"
#include "bench/peer_rows.h"
#include "bench/peer_scene.h"
#include "bench/peer_table.h"
#include "bench/peer_timing.h"
#include "bench/program.h"

namespace oktett::bench {
namespace {

/// The scenes that the options ask for, of one mesh, or without one.
void compare_scenes(const PeerScene* mesh, const PeerOptions& options, Isa isa, PeerReport& report) {
  for (const Work scene : options.scenes) {
    const auto count =
        static_cast<std::size_t>(scene == Work::instances ? options.instances : options.spheres);
    if (scene == Work::instances)
      compare_scene(mesh != nullptr ? copies_scene(*mesh, count) : meadow_scene(count), options, isa, report);
    else
      compare_scene(mesh != nullptr ? mixed_scene(*mesh, count) : spheres_scene(count), options, isa, report);
  }
}

/// The mesh itself. Seen from outside, the bounces are those in a room.
void compare_mesh(const PeerScene& mesh, const PeerOptions& options, Isa isa, PeerReport& report) {
  PeerOptions others = options, inside = options, room = options;
  std::erase(others.works, Work::bounces);
  if (!others.works.empty()) compare_scene(mesh, others, isa, report);
  if (!options.wants(Work::bounces)) return;
  inside.works = room.works = {Work::bounces};
  std::erase(inside.inside, false);
  std::erase(room.inside, true);
  if (!inside.inside.empty()) compare_scene(mesh, inside, isa, report);
  if (!room.inside.empty()) compare_scene(room_scene(mesh), room, isa, report);
}

int run(int argc, char** argv) {
  const PeerOptions options = parse_peer_options(argc, argv);
  const Isa isa = choose_isa(options.isa);
  flush_denormals();
  print_header(options, to_string(isa));
  PeerReport report;
  if (options.meshes.empty()) compare_scenes(nullptr, options, isa, report);
  for (const std::string& path : options.meshes) {
    const PeerScene mesh = file_scene(path);
    if (options.scenes.empty())
      compare_mesh(mesh, options, isa, report);
    else
      compare_scenes(&mesh, options, isa, report);
  }
  if (!options.json.empty()) write_json(options.json, report, to_string(isa));
  return 0;
}

}  // namespace
}  // namespace oktett::bench

int main(int argc, char** argv) { return oktett::bench::run_program(oktett::bench::run, argc, argv); }
