#include "app/view/canvas.h"

#include <fmt/format.h>

#include <algorithm>

namespace oktett {

void Canvas::begin(std::uint64_t view, std::uint32_t width, std::uint32_t height, bool coarse) {
  const std::lock_guard lock(mutex_);
  // The page keeps what it has drawn of the last view until tiles of the new one replace it.
  if (view != view_) tiles_.clear(), coarse_ = {};
  view_ = view;
  coarse_pass_ = coarse;
  if (!coarse && (width_ != width || height_ != height)) width_ = width, height_ = height, tiles_.clear();
}

void Canvas::show(const Picture& picture, const FinishedTile& tile, const Layer& layer) {
  std::string bytes = layer_pixels(picture, tile, layer);
  const std::lock_guard lock(mutex_);
  const auto same = [&](const Tile& t) {
    return t.place.x == tile.x && t.place.y == tile.y && t.place.width == tile.width &&
           t.place.height == tile.height;
  };
  const auto found = std::find_if(tiles_.begin(), tiles_.end(), same);
  Tile& to = coarse_pass_ ? coarse_ : found != tiles_.end() ? *found : tiles_.emplace_back();
  to = {++version_, tile, std::move(bytes)};
  grown_.notify_all();
}

void Canvas::wake() {
  const std::lock_guard lock(mutex_);
  ++version_;
  grown_.notify_all();
}

void Canvas::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  grown_.notify_all();
}

std::string Canvas::describe(std::uint64_t version, std::string header) const {
  header += fmt::format(", \"version\": {}, \"shown\": {}, \"tiles\": [", version_, view_);
  std::string pixels;
  const auto add = [&](const Tile& tile, bool coarse) {
    if (tile.version <= version || tile.bytes.empty()) return;
    const FinishedTile& p = tile.place;
    header += fmt::format("{}[{}, {}, {}, {}, {}]", header.back() == '[' ? "" : ", ", p.x, p.y, p.width,
                          p.height, coarse ? 1 : 0);
    pixels += tile.bytes;
  };
  add(coarse_, true);
  for (const Tile& tile : tiles_) add(tile, false);
  header += "]}";
  std::string out;
  for (int k = 0; k < 4; ++k) out += static_cast<char>(header.size() >> (8 * k) & 0xff);
  return out + header + pixels;
}

}  // namespace oktett
