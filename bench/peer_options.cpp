#include "bench/peer_options.h"

#include <algorithm>
#include <charconv>

#include "core/error.h"

namespace oktett::bench {

const char* const kPeerUsage =
    "usage: peers [option]... MESH.obj...\n"
    "  --threads N,...          1\n"
    "  --resolution N,...       edges of the pictures in pixels, multiples of 16; 1024\n"
    "  --view outside,inside    where the camera stands; outside (--inside: only inside)\n"
    "  --works W,...            build, bytes, primary, shadow, diffuse, ao, equal, picture; all\n"
    "  --seconds S              time for measuring a row; 3\n"
    "  --runs N                 most rounds per row; 15\n"
    "  --build NAME             how Oktett builds the tree that it traces; its default\n"
    "  --isa NAME               instruction set\n"
    "  --json FILE              all figures with their spread";

static constexpr Work kWorks[] = {Work::build,  Work::bytes,   Work::primary,
                                  Work::shadow, Work::diffuse, Work::ambient_occlusion,
                                  Work::equal,  Work::picture};

const char* to_string(Work work) {
  static constexpr const char* kNames[] = {"build",   "bytes", "primary", "shadow",
                                           "diffuse", "ao",    "equal",   "picture"};
  return kNames[static_cast<int>(work)];
}

bool PeerOptions::wants(Work work) const {
  return works.empty() || std::find(works.begin(), works.end(), work) != works.end();
}

bool PeerOptions::wants_tracing() const {
  for (const Work work : kWorks)
    if (work != Work::build && work != Work::bytes && wants(work)) return true;
  return false;
}

static std::vector<std::string> words(const std::string& list) {
  std::vector<std::string> words(1);
  for (const char c : list) {
    if (c == ',')
      words.emplace_back();
    else
      words.back() += c;
  }
  return words;
}

static double number(const std::string& option, const std::string& word, double least) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !(value >= least) || value > 1e6)
    throw Error(option + ": '" + word + "' is not a number of at least " + std::to_string(least));
  return value;
}

static std::vector<int> integers(const std::string& option, const std::string& list, int least) {
  std::vector<int> values;
  for (const std::string& word : words(list)) values.push_back(static_cast<int>(number(option, word, least)));
  return values;
}

static std::vector<bool> views(const std::string& list) {
  std::vector<bool> inside;
  for (const std::string& word : words(list)) {
    if (word != "inside" && word != "outside") throw Error("--view: '" + word + "' is not inside or outside");
    inside.push_back(word == "inside");
  }
  return inside;
}

static std::vector<Work> parse_works(const std::string& list) {
  std::vector<Work> works;
  for (const std::string& word : words(list)) {
    const auto* at = std::find_if(std::begin(kWorks), std::end(kWorks),
                                  [&](Work work) { return word == to_string(work); });
    if (at == std::end(kWorks)) throw Error("--works: there is no '" + word + "'");
    works.push_back(*at);
  }
  return works;
}

PeerOptions parse_peer_options(int argc, char** argv) {
  PeerOptions o;
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    const auto value = [&]() -> std::string {
      if (++i >= argc) throw Error(a + " needs a value");
      return argv[i];
    };
    if (a == "--inside") {
      o.inside = {true};
    } else if (a == "--view") {
      o.inside = views(value());
    } else if (a == "--resolution") {
      o.resolutions = integers(a, value(), 16);
      for (int& n : o.resolutions) n = n / 16 * 16;
    } else if (a == "--threads") {
      o.threads = integers(a, value(), 1);
    } else if (a == "--works") {
      o.works = parse_works(value());
    } else if (a == "--seconds") {
      o.seconds = number(a, value(), 0);
    } else if (a == "--runs") {
      o.runs = static_cast<int>(number(a, value(), 1));
    } else if (a == "--build") {
      o.build = value();
    } else if (a == "--isa") {
      o.isa = value();
    } else if (a == "--json") {
      o.json = value();
    } else if (a.starts_with("--")) {
      throw Error("unknown option " + a + "\n" + kPeerUsage);
    } else {
      o.meshes.push_back(a);
    }
  }
  if (o.meshes.empty()) throw Error(kPeerUsage);
  return o;
}

}  // namespace oktett::bench
