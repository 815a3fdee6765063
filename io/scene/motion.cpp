/// \file Motions in scene files: transforms by time.

#include <fmt/format.h>

#include "io/scene/readers.h"

namespace oktett {

/// More keys than any curve needs.
static constexpr std::size_t kMostKeys = 4096;

std::vector<MotionKey> read_motion(SceneValues& values, const YamlNode& node) {
  std::vector<MotionKey> keys;
  const auto read_key = [&](const YamlNode* item) {
    const Fields fields(*item, "a key of a motion", {"time", "transform"});
    MotionKey key;
    const YamlNode& time = fields.require("time");
    key.time = values.number(time);
    if (!keys.empty() && !(key.time > keys.back().time))
      throw Error(time.where(),
                  fmt::format("the times of a motion must ascend: expected more than {}", keys.back().time));
    const YamlNode& transform = fields.require("transform");
    key.transform = read_transform(values, transform);
    if (const std::string reason = why_degenerate(key.transform); !reason.empty())
      throw Error(transform.where(), reason + ", which a motion cannot pass");
    if (!keys.empty() && (key.transform.determinant() < 0) != (keys.back().transform.determinant() < 0))
      throw Error(transform.where(), "a motion cannot turn a thing into its mirror image");
    keys.push_back(key);
    if (keys.size() > kMostKeys)
      throw Error(item->where(), fmt::format("a motion has more than {} keys", kMostKeys));
  };
  declare_count(node, kNotEmpty);
  for (const YamlNode* item : list_items(node, "motion")) attempt(*item, [&] { read_key(item); });
  if (keys.empty()) throw Error(node.where(), "a motion needs at least one key {time, transform}");
  return keys;
}

}  // namespace oktett
