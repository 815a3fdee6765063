#include "app/cache_options.h"

#include "app/limits.h"
#include "app/text.h"
#include "core/error.h"

namespace oktett {

void add_cache_options(Verb& verb, CacheArguments& a) {
  verb.option("--cache", &a.folder, "DIR", "Keep meshes and trees in DIR, for a fast start of the next run");
  verb.option("--cache-size", &a.size, "BYTES", "Most bytes in that folder; default: 16G");
}

std::unique_ptr<SceneCache> open_cache(const CacheArguments& arguments) {
  SceneCacheOptions options;
  if (!arguments.size.empty()) {
    if (arguments.folder.empty()) throw Error("--cache-size needs --cache");
    options.most_bytes = parse_bytes("--cache-size", arguments.size);
  }
  if (arguments.folder.empty()) return nullptr;
  options.tell = [](const std::string& problem) { say("warning: {}\n", problem); };
  try {
    return std::make_unique<SceneCache>(arguments.folder, options);
  } catch (const Error& error) {
    options.tell(error.what());
    return nullptr;
  }
}

}  // namespace oktett
