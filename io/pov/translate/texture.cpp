#include "io/pov/translate/texture.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace oktett::pov {

/// Calls f for each pattern that what is said behind a look moves.
template <class F>
static void for_each_moved(Look& look, const F& f) {
  if (!look.layers.empty()) {
    for (Look& layer : look.layers) for_each_moved(layer, f);
  } else if (!look.entries.empty()) {
    f(look.pattern);
  } else {
    f(look.pigment.pattern), f(look.normal.pattern);
  }
}

bool is_look(std::string_view keyword) {
  return keyword == "texture" || keyword == "pigment" || keyword == "finish" || keyword == "normal";
}

void Look::move(const Moves& moves) {
  if (!moves.empty()) for_each_moved(*this, [&](PovPattern& p) { p.move(moves); });
}

void Look::move_in_space(const Moves& moves) {
  for_each_moved(*this, [&](PovPattern& p) {
    if (!p.uses_uv) p.move(moves);
  });
}

void Look::lay(const UvLayout& uv) {
  pigment.pattern.uv = normal.pattern.uv = pattern.uv = uv;
  for (Look& layer : layers) layer.lay(uv);
  for (TextureEntry& entry : entries) entry.look.lay(uv);
}

static void use_uv(Look& look) {
  look.pigment.pattern.uses_uv = look.normal.pattern.uses_uv = look.pattern.uses_uv = true;
  for (Look& layer : look.layers) use_uv(layer);
  for (TextureEntry& entry : look.entries) use_uv(entry.look);
}

namespace {

/// Reads textures.
class TextureReader {
 public:
  explicit TextureReader(Context& context)
      : context_(context),
        patterns_(context, [this](const Block& block) { return pigment_texture(context_, block); }) {}

  void read(const Block& block, Look& look) {
    if (block.keyword == "pigment") return read_part(block, look);
    if (block.keyword == "finish" || block.keyword == "normal") return read_part(block, look);
    if (block.keyword == "texture") {
      const std::string name = std::move(look.name);
      look = Look{};
      if (block.default_texture != nullptr) read(*block.default_texture, look);
      look.name = name;
    }
    if (!block.name.empty() && look.name.empty()) look.name = block.name;
    const Look base = look;
    const std::size_t textures = count_textures(block);
    if (textures > 1 && !has_pattern(block)) return read_layers(block, base, look);
    Arguments a(context_, block);
    // Patterns stand before what they show, and moves behind it.
    PovPattern pattern;
    std::vector<TextureEntry> entries;
    while (!a.at_end()) {
      if (const Block* const inner = a.peek_block(); inner != nullptr && is_part(*inner)) {
        a.take();
        if (inner->keyword == "texture" && pattern.is_list)
          entries.push_back({0, nested(*inner, base)});
        else if (inner->keyword == "texture_map")
          read_map(*inner, base, entries);
        else
          read_part(*inner, look);
        continue;
      }
      Moves moves;
      const Block* const object = a.peek_block();
      if (pattern.is_none() && take_moves(context_, a, moves)) {
        look.move(moves);
      } else if (!patterns_.take(a, pattern)) {
        a.take();
      } else if (object != nullptr && object->keyword == "object") {
        read_sides(*object, base, entries);
      }
    }
    if (pattern.uses_uv && pattern.is_none()) use_uv(look);
    if (pattern.is_none() || entries.empty()) return;
    while (pattern.is_list && entries.size() < default_colors(pattern).size()) entries.push_back({});
    if (!pattern.is_list && pattern.word != "average")
      entries = in_order(entries, [](double at, TextureEntry before, const TextureEntry&) {
        before.at = at;
        return before;
      });
    look.pattern = std::move(pattern), look.entries = std::move(entries), look.layers.clear();
  }

 private:
  static bool is_part(const Block& block) {
    constexpr std::string_view kParts[] = {"texture", "material",    "pigment",     "finish",
                                           "normal",  "texture_map", "material_map"};
    return std::ranges::find(kParts, block.keyword) != std::end(kParts);
  }

  void read_part(const Block& block, Look& look) {
    if (block.keyword == "texture" || block.keyword == "material") return read(block, look);
    if (block.keyword == "material_map")
      return context_.tell("material_map", block.where, "'material_map' has no meaning here");
    // Of layers the uppermost is changed, of textures in a pattern all.
    if (!look.layers.empty()) read_part(block, look.layers.back());
    for (TextureEntry& entry : look.entries) read_part(block, entry.look);
    if (!look.is_plain()) return;
    if (block.keyword == "pigment") {
      Pigment stated;
      read_pigment(context_, block, stated);
      // What has no name changes the one that is there, which keeps its transforms and turbulence.
      if (stated.is_stated && !stated.name.empty())
        look.pigment = std::move(stated);
      else
        read_pigment(context_, block, look.pigment);
    } else if (block.keyword == "normal") {
      look.normal = Normal{};
      read_normal(context_, block, look.normal);
    } else {
      read_finish(context_, block, look.finish);
    }
  }

  static std::size_t count_textures(const Block& block) {
    return static_cast<std::size_t>(std::ranges::count_if(block.elements, [](const Element& e) {
      const auto* const inner = std::get_if<std::shared_ptr<const Block>>(&e.value);
      return inner != nullptr && *inner != nullptr && (*inner)->keyword == "texture";
    }));
  }

  bool has_pattern(const Block& block) {
    Arguments a(context_, block);
    PovPattern pattern;
    while (!a.at_end())
      if (const Block* const inner = a.peek_block(); inner != nullptr || !patterns_.take(a, pattern))
        a.take();
    return !pattern.is_none();
  }

  void read_layers(const Block& block, const Look& base, Look& look) {
    std::vector<Look> layers;
    Arguments a(context_, block);
    while (!a.at_end()) {
      Moves moves;
      if (const Block* const inner = a.peek_block(); inner != nullptr && inner->keyword == "texture") {
        a.take();
        layers.push_back(nested(*inner, base));
      } else if (take_moves(context_, a, moves)) {
        for (Look& layer : layers) layer.move(moves);
      } else if (inner != nullptr && is_part(*inner) && !layers.empty()) {
        read_part(*inner, layers.back());
        a.take();
      } else {
        a.take();
      }
    }
    look.layers = std::move(layers), look.entries.clear();
  }

  Look nested(const Block& block, const Look& base) {
    Look look = base;
    look.name.clear();
    read(block, look);
    return look;
  }

  /// The textures of a pattern `object`, outside and inside.
  void read_sides(const Block& block, const Look& base, std::vector<TextureEntry>& entries) {
    Arguments a(context_, block);
    while (!a.at_end()) {
      const Block* const inner = a.peek_block();
      a.take();
      if (inner != nullptr && inner->keyword == "texture") entries.push_back({0, nested(*inner, base)});
    }
  }

  void read_map(const Block& map, const Look& base, std::vector<TextureEntry>& entries) {
    Arguments a(context_, map);
    while (!a.at_end()) {
      const Block* const block = a.peek_block();
      a.take();
      if (block == nullptr) continue;
      if (block->keyword != "[") {
        read_map(*block, base, entries);  // one that was declared
        continue;
      }
      Arguments e(context_, *block);
      TextureEntry entry{e.number("a number"), base};
      // The rest of the entry stands as in a block `texture`.
      Block rest = *block;
      rest.keyword = "texture", rest.elements.erase(rest.elements.begin());
      read(rest, entry.look);
      entries.push_back(std::move(entry));
    }
  }

  Context& context_;
  PatternReader patterns_;
};

}  // namespace

void read_look(Context& context, const Block& block, Look& look) { TextureReader(context).read(block, look); }

static Look default_look(Context& context, const std::shared_ptr<const Block>& default_texture) {
  Look look;
  if (default_texture != nullptr) read_look(context, *default_texture, look);
  look.name.clear();
  return look;
}

static void put_over(Look& look, Look layer) {
  if (look.layers.empty()) {
    std::vector<Look> lowest{std::move(look)};
    look = Look{}, look.layers = std::move(lowest);
  }
  if (layer.layers.empty())
    look.layers.push_back(std::move(layer));
  else
    std::ranges::move(layer.layers, std::back_inserter(look.layers));
}

Look look_of(Context& context, const std::vector<LookItem>& items,
             const std::shared_ptr<const Block>& default_texture) {
  Look look = default_look(context, items.empty() ? default_texture : items[0].default_texture);
  bool is_first = true;
  for (const LookItem& item : items) {
    const std::string_view k = item.block->keyword;
    Look& top = look.layers.empty() ? look : look.layers.back();
    if (k != "texture" && (k == "finish" || !top.is_plain())) {
      // Of textures in a pattern all are changed.
      read_look(context, *item.block, top), is_first = false;
      continue;
    }
    Look own;
    read_look(context, *item.block, own);
    if (item.by_uv) use_uv(own);
    Moves moves;
    if (item.to_texture.is_invertible() && !(item.to_texture == Affine{}))
      moves.add({Move::Kind::matrix, {}, item.to_texture.inverse(), {}});
    if (k == "pigment" && (!own.pigment.is_stated || own.pigment.name.empty())) {
      // It changes the pigment that is there, where the block stands, and leaves it its transforms and
      // turbulence. The default one stands there unmoved.
      Moves there;
      if (!moves.empty() && !is_first) there.add({Move::Kind::matrix, {}, item.to_texture, {}});
      top.move_in_space(there);
      read_pigment(context, *item.block, top.pigment);
      if (item.by_uv) top.pigment.pattern.uses_uv = true;
      top.move_in_space(moves), is_first = false;
      continue;
    }
    own.move_in_space(moves);
    if (k == "pigment")
      top.pigment = std::move(own.pigment);
    else if (k == "normal")
      top.normal = std::move(own.normal);
    else if (is_first)
      look = std::move(own);
    else
      put_over(look, std::move(own));
    is_first = false;
  }
  return look;
}

}  // namespace oktett::pov
