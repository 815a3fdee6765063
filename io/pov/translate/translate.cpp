#include "io/pov/translate/translate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "io/pov/noise_functions.h"
#include "io/pov/translate/atmosphere.h"
#include "io/pov/translate/look.h"
#include "io/pov/translate/objects.h"
#include "io/pov/translate/view.h"

namespace oktett::pov {
namespace {

const Block* block_of(const Element& statement) {
  const auto* const block = std::get_if<std::shared_ptr<const Block>>(&statement.value);
  return block != nullptr ? block->get() : nullptr;
}

/// Calls f with what follows each of these words in the `global_settings` of the document.
template <class F>
void for_each_setting(const Document& document, std::string_view name, const F& f) {
  for (const Element& statement : document.statements) {
    const Block* const block = block_of(statement);
    if (block == nullptr || block->keyword != "global_settings") continue;
    for (std::size_t i = 0; i + 1 < block->elements.size(); ++i) {
      const auto* const word = std::get_if<Word>(&block->elements[i].value);
      if (word != nullptr && word->text == name) f(block->elements[i + 1].value);
    }
  }
}

SceneGamma gamma_of(const Document& document) {
  SceneGamma gamma{1, document.version < 3.7};
  for_each_setting(document, "assumed_gamma", [&](const auto& value) {
    if (const auto* const number = std::get_if<Numbers>(&value))
      gamma = {std::isfinite(number->v[0]) ? std::clamp(number->v[0], 0.1, 10.0) : 1, false};
    if (const auto* const word = std::get_if<Word>(&value); word && word->text == "srgb") gamma = {1, true};
  });
  return gamma;
}

/// What a translation takes from all of the document before it begins.
void take_settings(Context& context) {
  context.gamma = gamma_of(context.document);
  context.noise_generator = noise_generator_of(context.document);
}

/// Statements that stand for themselves.
void read_statement(Context& context, const std::shared_ptr<const Block>& block, ObjectWriter& objects,
                    Surroundings& s) {
  const std::string_view k = block->keyword;
  if (is_object(k)) return objects.add(block);
  if (k == "light_source") return objects.add_light(block, {});
  if (k == "global_settings") return read_global_settings(context, *block, s);
  if (k == "background") return read_background(context, *block, s);
  if (k == "sky_sphere") {
    s.sky = block;
    return;
  }
  if (k == "fog") {
    const Node fog = fog_node(context, *block);
    if (fog == nullptr) return;
    if (s.fogs == nullptr) s.fogs = context.tree.list(block->where);
    return Tree::push(s.fogs, fog);
  }
  if (k == "rainbow") {
    const Node bow = rainbow_node(context, *block);
    if (bow == nullptr) return;
    if (s.rainbows == nullptr) s.rainbows = context.tree.list(block->where);
    return Tree::push(s.rainbows, bow);
  }
  if (k == "media") return read_media(context, *block, s.interior.media.emplace_back());
  if (k == "camera") return;
  context.tell(std::string(k), block->where, fmt::format("'{}' has no meaning here, and is left out", k));
}

/// Lights outside of light groups do not light these, unless their `global_lights` are on.
void darken_light_groups(Context& context) {
  if (context.lit_alone.empty()) return;
  Tree& tree = context.tree;
  const Place top;
  for (const Node keys : context.light_keys) {
    if (has_key(*keys, "only")) continue;
    const Node list = tree.list(top);
    for (const std::string& name : context.lit_alone) Tree::push(list, tree.text(top, name));
    tree.put(keys, "except", list);
  }
}

/// A tree without settings: of what its sections hold.
void finish_parts(Context& context, TranslatedScene& out) {
  Tree& tree = context.tree;
  const Place top;
  const Node root = tree.map(top);
  tree.put(root, "oktett", tree.number(top, 1));
  if (!context.media->items.empty()) tree.put(root, "media", context.media);
  if (!context.materials->items.empty()) tree.put(root, "materials", context.materials);
  if (!context.define->items.empty()) tree.put(root, "define", context.define);
  tree.put(root, "objects", context.objects);
  out.root = root;
  out.files = tree.take();
  out.meshes = std::move(context.meshes), out.warnings = std::move(context.warnings);
}

void begin_sections(Context& context) {
  const Place top;
  context.materials = context.tree.map(top), context.define = context.tree.map(top);
  context.objects = context.tree.list(top), context.lights = context.tree.list(top);
  context.media = context.tree.map(top);
}

}  // namespace

NoiseGenerator noise_generator_of(const Document& document) {
  NoiseGenerator generator = document.version < 3.5 ? NoiseGenerator::povray_1 : NoiseGenerator::povray_2;
  for_each_setting(document, "noise_generator", [&](const auto& value) {
    if (const auto* const number = std::get_if<Numbers>(&value))
      generator = noise_generator_named(number->v[0]);
  });
  return generator;
}

TranslatedObject translate_object(const Document& document, const std::shared_ptr<const Block>& object,
                                  bool as_solid, ObjectQueries* queries) {
  Context context(document);
  context.queries = queries;
  take_settings(context);
  begin_sections(context);
  const Element shown{object->where, object};
  ObjectWriter objects(context, {&shown, 1});
  TranslatedObject out;
  const ObjectWriter::Asked asked = objects.add_asked(object, as_solid);
  out.is_there = asked.is_there, out.negative = asked.negative;
  out.extent = extent_of(context, *object);
  finish_parts(context, out.scene);
  return out;
}

TranslatedScene translate_look(const Document& document, const std::shared_ptr<const Block>& look) {
  Context context(document);
  begin_sections(context);
  take_settings(context);
  auto sphere = std::make_shared<Block>();
  sphere->keyword = "sphere", sphere->where = look->where;
  sphere->elements = {
      {look->where, Numbers{{}, 3, false}}, {look->where, Numbers{{1}, 1, false}}, {look->where, look}};
  const std::shared_ptr<const Block> shown = sphere;
  const Element statement{look->where, shown};
  ObjectWriter(context, {&statement, 1}).add(shown);
  TranslatedScene out;
  finish_parts(context, out);
  return out;
}

TranslatedScene translate(const Document& document, const TranslateOptions& options) {
  Context context(document);
  context.warnings = document.warnings;
  take_settings(context);
  context.mesh_prefix = options.mesh_prefix, context.queries = options.queries;
  Tree& tree = context.tree;
  const Place top;
  begin_sections(context);
  const Block* camera = nullptr;
  Surroundings s;
  context.has_fog = std::ranges::any_of(document.statements, [](const Element& statement) {
    const Block* const block = block_of(statement);
    return block != nullptr &&
           (block->keyword == "fog" || block->keyword == "rainbow" || block->keyword == "media");
  });
  ObjectWriter objects(context);
  for (const Element& statement : document.statements) {
    const auto* const block = std::get_if<std::shared_ptr<const Block>>(&statement.value);
    if (block == nullptr || *block == nullptr) continue;
    if ((*block)->keyword == "camera") camera = block->get();
    read_statement(context, *block, objects, s);
  }
  const Node root = tree.map(top);
  tree.put(root, "oktett", tree.number(top, 1));
  tree.put(root, "camera", camera_node(context, camera));
  const Node film = tree.map(top);
  tree.put(film, "width", tree.number(top, options.width)),
      tree.put(film, "height", tree.number(top, options.height));
  if (context.gamma.power != 1) tree.put(film, "gamma", tree.number(top, context.gamma.power));
  if (context.gamma.is_raw) tree.put(film, "tone", tree.word(top, "raw"));
  tree.put(root, "film", film);
  const Node integrator = tree.map(s.settings_place);
  tree.put(integrator, "kind", tree.word(s.settings_place, "whitted"));
  // The rays of the camera are the first level.
  tree.put(integrator, "depth",
           tree.number(s.settings_place, std::clamp(std::round(s.max_trace_level) - 1, 0.0, 64.0)));
  tree.put(integrator, "cutoff", tree.number(s.settings_place, std::clamp(s.adc_bailout, 0.0, 1.0)));
  if (context.samples > 0) tree.put(integrator, "samples", tree.number(top, context.samples));
  tree.put(root, "integrator", integrator);
  const Node sky = s.sky != nullptr ? sky_node(context, *s.sky, s.background) : nullptr;
  tree.put(root, "background", sky != nullptr ? sky : color_node(tree, s.background_place, s.background));
  if (!(s.ambient == Vec3d{1, 1, 1}))
    tree.put(root, "ambient_light", color_node(tree, s.settings_place, s.ambient));
  if (s.fogs != nullptr) tree.put(root, "fog", s.fogs);
  if (s.rainbows != nullptr) tree.put(root, "rainbow", s.rainbows);
  const std::string around = s.interior.fills() ? objects.surrounding(s.interior) : "";
  if (!context.media->items.empty()) tree.put(root, "media", context.media);
  if (!around.empty()) tree.put(root, "medium", tree.text(top, around));
  if (!context.materials->items.empty()) tree.put(root, "materials", context.materials);
  darken_light_groups(context);
  tree.put(root, "lights", context.lights);
  if (!context.define->items.empty()) tree.put(root, "define", context.define);
  tree.put(root, "objects", context.objects);
  TranslatedScene out;
  out.root = root;
  out.files = tree.take();
  out.meshes = std::move(context.meshes), out.warnings = std::move(context.warnings);
  return out;
}

}  // namespace oktett::pov
