#include "bench/peer_options.h"

#include <algorithm>
#include <sstream>

#include "bench/program.h"

namespace oktett::bench {

/// In the order of Work.
static const std::vector<std::string> kWorks = {"build",   "bytes",     "primary", "shadow", "diffuse",
                                                "ao",      "equal",     "picture", "calls",  "allhits",
                                                "bounces", "instances", "spheres"};

const std::string& to_string(Work work) { return kWorks[static_cast<std::size_t>(work)]; }

bool PeerOptions::wants(Work work) const { return std::ranges::find(works, work) != works.end(); }

bool PeerOptions::wants_tracing() const {
  return std::ranges::any_of(works, [](Work work) { return work != Work::build && work != Work::bytes; });
}

static std::vector<int> integers(const std::string& list, int least) {
  return each(list, [&](const std::string& word) { return number(word, least, 1'000'000); });
}

/// Which of `known` a word is.
static std::size_t index_of(const std::string& word, const std::vector<std::string>& known) {
  const auto at = std::ranges::find(known, word);
  if (at == known.end()) throw Error("there is no '" + word + "'");
  return static_cast<std::size_t>(at - known.begin());
}

PeerOptions parse_peer_options(int argc, char** argv) {
  PeerOptions o;
  const std::string head = "usage: peers [option]... [MESH.obj...]";
  using Text = const std::string&;
  const std::vector<Option> options = {
      {"--threads", "N,...", "1", [&](Text v) { o.threads = integers(v, 1); }},
      {"--resolution", "N,...", "edges of the pictures in pixels, multiples of 16; 1024",
       [&](Text v) {
         o.resolutions = integers(v, 16);
         for (int& n : o.resolutions) n = n / 16 * 16;
       }},
      {"--view", "outside,inside", "where the camera stands; outside",
       [&](Text v) {
         o.inside = each(v, [](Text word) { return index_of(word, {"outside", "inside"}) == 1; });
       }},
      {"--inside", "", "only inside", [&](Text) { o.inside = {true}; }},
      {"--works", "W,...",
       "rows: build, bytes, primary, shadow, diffuse, ao, equal, picture, calls, allhits, bounces; "
       "all. With instances or spheres, rows of scenes of these",
       [&](Text v) {
         o.works = each(v, [](Text word) { return static_cast<Work>(index_of(word, kWorks)); });
       }},
      {"--instances", "N", "how many of the mesh, or plants without a mesh; 4000",
       [&](Text v) { o.instances = number(v, 1, 10'000'000); }},
      {"--spheres", "N", "how many, beside the mesh if there is one; 1000000",
       [&](Text v) { o.spheres = number(v, 1, 100'000'000); }},
      {"--seconds", "S", "time for measuring a row; 3", [&](Text v) { o.seconds = number(v, 0.0, 1e6); }},
      {"--runs", "N", "most rounds per row; 15", [&](Text v) { o.runs = number(v, 1, 1'000'000); }},
      {"--build", "NAME", "how Oktett builds the tree that it traces; its default",
       [&](Text v) { o.build = v; }},
      {"--isa", "NAME", "instruction set", [&](Text v) { o.isa = v; }},
      {"--json", "FILE", "all figures with their spread", [&](Text v) { o.json = v; }}};
  o.meshes = parse_options(argc, argv, head, options);
  const auto scenes =
      std::stable_partition(o.works.begin(), o.works.end(), [](Work work) { return work < Work::instances; });
  o.scenes.assign(scenes, o.works.end());
  o.works.erase(scenes, o.works.end());
  if (o.meshes.empty() && o.scenes.empty()) throw Error(usage_text(head, options));
  if (o.works.empty() && o.scenes.empty())
    for (Work work = Work::build; work < Work::instances;
         work = static_cast<Work>(static_cast<int>(work) + 1))
      o.works.push_back(work);
  if (o.works.empty())
    o.works = {Work::bytes, Work::primary, Work::shadow, Work::diffuse, Work::ambient_occlusion};
  return o;
}

}  // namespace oktett::bench
