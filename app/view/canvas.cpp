#include "app/view/canvas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/math.h"
#include "core/random.h"
#include "io/image/color.h"
#include "io/image/encode.h"
#include "render/light_groups.h"

namespace oktett {

// ---- The layers of a picture that a page can show, as eight-bit pixels.

namespace {

constexpr const char* kBeautyPlanes[] = {"R", "G", "B", "A"};

/// The part of some planes that a tile covers, under the names R, G, B and A.
Picture cut(const Picture& picture, const FinishedTile& tile, const std::string (&names)[4],
            const Tone& tone) {
  Picture part;
  part.width = tile.width, part.height = tile.height, part.tone = tone;
  for (int k = 0; k < 4; ++k) {
    const PicturePlane* plane = picture.find(names[k]);
    PicturePlane& to = part.planes.emplace_back();
    to.name = kBeautyPlanes[k];
    to.values = Column<float>(std::size_t{tile.width} * tile.height, 1.0f);
    if (plane == nullptr) continue;
    for (std::uint32_t y = 0; y < tile.height; ++y)
      std::copy_n(plane->values.data() + std::size_t{tile.y + y} * picture.width + tile.x, tile.width,
                  to.values.data() + std::size_t{y} * tile.width);
  }
  return part;
}

std::string bytes_of(const FlatImage& image) {
  return {reinterpret_cast<const char*>(image.bytes.data()), image.bytes.size()};
}

/// Calls `color(at)` for each pixel, which gives what the screen shows, in [0, 1]. Pixels that no surface
/// covers stay transparent.
template <class Color_>
std::string data_pixels(const Picture& picture, const FinishedTile& tile, const Color_& color) {
  std::string out;
  out.reserve(std::size_t{4} * tile.width * tile.height);
  const PicturePlane* ids = picture.find("geomID.I");
  for (std::uint32_t y = 0; y < tile.height; ++y)
    for (std::uint32_t x = 0; x < tile.width; ++x) {
      const std::size_t at = std::size_t{tile.y + y} * picture.width + tile.x + x;
      const bool covered = ids != nullptr && ids->ids[at] != kNoId;
      const Vec3f c = covered ? color(at) : Vec3f{0, 0, 0};
      for (int k = 0; k < 3; ++k)
        out += static_cast<char>(std::lround(255 * (c[k] > 0 ? std::min(c[k], 1.0f) : 0.0f)));
      out += static_cast<char>(covered ? 255 : 0);
    }
  return out;
}

Vec3f color_of(std::uint64_t number) {
  const std::uint64_t bits = mix_bits(number + kGoldenBits);
  const auto part = [&](int shift) { return 0.25f + 0.75f * static_cast<float>(bits >> shift & 0xff) / 255; };
  return {part(0), part(8), part(16)};
}

}  // namespace

std::vector<std::string> layer_names(const Scene& scene) {
  std::vector<std::string> names{"beauty",   "depth",  "normal",    "albedo", "uv",
                                 "position", "object", "primitive", "noise"};
  if (scene.integrator.error > 0) names.emplace_back("samples");
  const LightGroups groups = light_groups(scene);
  if (groups.any() && traits(scene.integrator.kind).traces_paths)
    for (const std::string& group : groups.names) names.push_back("light_" + group);
  return names;
}

std::string layer_pixels(const Picture& picture, const FinishedTile& tile, const Layer& layer) {
  const std::string& n = layer.name;
  if (n == "beauty")
    return bytes_of(flatten(cut(picture, tile, {"R", "G", "B", "A"}, layer.tone), PixelLayout::srgb8_alpha));
  if (n == "albedo")
    return bytes_of(
        flatten(cut(picture, tile, {"Albedo.R", "Albedo.G", "Albedo.B", ""}, {}), PixelLayout::srgb8_alpha));
  if (n.starts_with("light_"))
    return bytes_of(flatten(cut(picture, tile, {n + ".R", n + ".G", n + ".B", ""}, layer.tone),
                            PixelLayout::srgb8_alpha));
  const auto plane = [&](const char* name) -> const PicturePlane* { return picture.find(name); };
  const auto values = [&](std::size_t at, const char* a, const char* b, const char* c) -> Vec3f {
    const PicturePlane *x = plane(a), *y = plane(b), *z = plane(c);
    return {x ? x->values[at] : 0, y ? y->values[at] : 0, z ? z->values[at] : 0};
  };
  return data_pixels(picture, tile, [&](std::size_t at) -> Vec3f {
    if (n == "normal") return values(at, "N.X", "N.Y", "N.Z") * 0.5f + Vec3f{0.5f, 0.5f, 0.5f};
    if (n == "uv") {
      const Vec3f uv = values(at, "u", "v", "");
      return {uv.x - std::floor(uv.x), uv.y - std::floor(uv.y), 0};
    }
    if (n == "depth") {
      const double z = values(at, "Z", "", "").x;
      const auto grey = static_cast<float>((layer.far - z) / (layer.far - layer.near));
      return {grey, grey, grey};
    }
    if (n == "position") {
      const Vec3f p = values(at, "P.X", "P.Y", "P.Z") - layer.bounds.lo, e = layer.bounds.extent();
      return {p.x / e.x, p.y / e.y, p.z / e.z};
    }
    if (n == "object") return color_of(plane("geomID.I")->ids[at]);
    if (n == "primitive")
      return color_of(std::uint64_t{plane("geomID.I")->ids[at]} << 32 | plane("primID.I")->ids[at]);
    if (n == "samples") {
      const PicturePlane* counts = plane("sampleCount.I");
      const float grey = counts ? static_cast<float>(portable::log2(1.0 + counts->ids[at])) / 12 : 0;
      return {grey, grey, grey};
    }
    const Vec3f v = values(at, "Variance.R", "Variance.G", "Variance.B");
    return {4 * std::sqrt(v.x), 4 * std::sqrt(v.y), 4 * std::sqrt(v.z)};
  });
}

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
