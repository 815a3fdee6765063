#include "io/pov/translate/view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "io/pov/translate/extent.h"
#include "io/pov/translate/look.h"

namespace oktett::pov {
namespace {

constexpr double kRadians = std::numbers::pi / 180;

/// A camera as POV-Ray has it.
struct PovCamera {
  Vec3d location{0, 0, 0}, direction{0, 0, 1}, right{4.0 / 3, 0, 0}, up{0, 1, 0}, sky{0, 1, 0};
  std::optional<Vec3d> look_at, focal_point;
  std::optional<double> angle;
  bool orthographic = false, has_angle = false, has_size = false;
  double aperture = 0, blur_samples = 0;
  Moves moves;
};

constexpr std::array<std::string_view, 10> kOtherCameras{
    "fisheye", "ultra_wide_angle",        "omnimax",      "panoramic", "cylinder", "spherical", "mesh_camera",
    "stereo",  "omni_directional_stereo", "test_camera_1"};

void read_camera(Context& context, const Block& block, PovCamera& c) {
  Arguments a(context, block);
  while (!a.at_end()) {
    const Place where = a.where();
    if (take_moves(context, a, c.moves)) continue;
    if (const Block* const inner = a.peek_block()) {
      a.take();
      if (inner->keyword == "camera")
        read_camera(context, *inner, c);
      else
        context.tell(fmt::format("camera {}", inner->keyword), where,
                     fmt::format("'{}' of a camera has no meaning here", inner->keyword));
    } else if (a.take_word("location")) {
      c.location = a.vector("a point");
    } else if (a.take_word("direction")) {
      c.direction = a.vector("a vector");
    } else if (a.take_word("right")) {
      c.right = a.vector("a vector"), c.has_size = true;
    } else if (a.take_word("up")) {
      c.up = a.vector("a vector"), c.has_size = true;
    } else if (a.take_word("sky")) {
      c.sky = a.vector("a vector");
    } else if (a.take_word("look_at")) {
      c.look_at = a.vector("a point");
    } else if (a.take_word("angle")) {
      c.has_angle = true;
      if (a.is_numbers()) c.angle = a.vector("an angle").x;
    } else if (a.take_word("orthographic")) {
      c.orthographic = true;
    } else if (a.take_word("perspective")) {
      c.orthographic = false;
    } else if (a.take_word("aperture")) {
      c.aperture = a.number("a number");
    } else if (a.take_word("focal_point")) {
      c.focal_point = a.vector("a point");
    } else if (a.take_word("blur_samples")) {
      c.blur_samples = a.number("a number");
      if (a.is_numbers()) a.take();
    } else {
      const std::string_view word = a.peek_word();
      a.take();
      if (std::ranges::find(kOtherCameras, word) != kOtherCameras.end())
        context.tell("camera kind", where,
                     fmt::format("a camera that is '{}' is shown in perspective", word));
    }
  }
}

/// Turns the camera to what it looks at. The frame stays left- or right-handed as it was.
void look(Context& context, const Place& where, PovCamera& c) {
  if (!c.look_at) return;
  const Vec3d view = *c.look_at - c.location;
  if (!(length(view) > 0))
    return context.tell("look_at", where, "the camera looks at its own place; 'look_at' is left out");
  const bool left_handed = dot(cross(c.up, c.direction), c.right) > 0;
  const double along = length(c.direction), across = length(c.right), high = length(c.up);
  const Vec3d direction = view / length(view);
  Vec3d right = cross(c.sky, direction);
  if (!(length(right) > 1e-9 * length(c.sky))) {
    // The sky is where the camera looks to.
    right = std::abs(direction.y) < 0.9 ? cross(Vec3d{0, 1, 0}, direction) : cross(Vec3d{0, 0, 1}, direction);
  }
  right = right / length(right);
  const Vec3d up = cross(direction, right);
  c.direction = direction * along, c.up = up * high;
  c.right = right * (left_handed ? across : -across);
}

}  // namespace

Node camera_node(Context& context, const Block* block) {
  PovCamera c;
  Place where;
  if (block != nullptr) read_camera(context, *block, c), where = block->where;
  if (c.angle && !c.orthographic) {
    if (!(*c.angle > 0 && *c.angle < 180))
      context.fail(where, fmt::format("a camera of {} degrees cannot be meant", *c.angle));
    const double size = length(c.direction);
    if (size > 0)
      c.direction = c.direction / size * (length(c.right) / 2 / std::tan(*c.angle / 2 * kRadians));
  }
  const double before = length(c.direction);
  look(context, where, c);
  if (c.orthographic && (c.has_angle || !c.has_size)) {
    // As wide as the view in perspective at what it looks at.
    const double distance = c.look_at ? length(*c.look_at - c.location) : before;
    double scale = before > 0 ? distance / before : 1;
    if (c.angle) scale = 2 * distance * std::tan(*c.angle / 2 * kRadians) / length(c.right);
    c.right = c.right * scale, c.up = c.up * scale;
  }
  const Affine& m = c.moves.all;
  c.location = m.point(c.location), c.direction = m.vector(c.direction);
  c.right = m.vector(c.right), c.up = m.vector(c.up);
  Tree& tree = context.tree;
  const Node node = tree.map(where), frame = tree.map(where);
  if (c.orthographic) tree.put(node, "projection", tree.word(where, "orthographic"));
  tree.put(node, "from", tree.vector(where, c.location));
  tree.put(frame, "right", tree.vector(where, c.right)), tree.put(frame, "up", tree.vector(where, c.up));
  tree.put(frame, "direction", tree.vector(where, c.direction));
  tree.put(node, "frame", frame);
  if (c.aperture > 0 && c.blur_samples > 0) {
    const Vec3d at = m.point(c.focal_point.value_or(Vec3d{0, 0, 0}));
    if (dot(at - c.location, c.direction) > 0) {
      tree.put(node, "aperture", tree.number(where, c.aperture));
      tree.put(node, "focus", tree.vector(where, at));
    } else {
      context.tell("focal_point", where, "the focal point lies behind the camera; all is sharp");
    }
  }
  return node;
}

LightBody add_light(Context& context, const Block& block, const Affine& to_world) {
  Arguments a(context, block);
  Tree& tree = context.tree;
  const Place& where = block.where;
  Vec3d location{0, 0, 0}, point_at{0, 0, 0};
  PovColor color{{1, 1, 1}};
  bool spot = false, parallel = false, shadowless = false;
  double radius = 30, falloff = 45, fade_distance = 0, fade_power = 0;
  Moves moves;
  LightBody body;
  const auto read = [&](auto&& self, Arguments& l) -> void {
    while (!l.at_end()) {
      const Place at = l.where();
      if (take_moves(context, l, moves)) continue;
      if (const std::shared_ptr<const Block> inner = l.peek_shared_block()) {
        l.take();
        if (inner->keyword == "light_source") {
          Arguments base(context, *inner);
          location = base.vector("a place"), color = base.color("a colour");
          self(self, base);
        } else if (inner->keyword == "looks_like" || inner->keyword == "projected_through") {
          for (const Element& e : inner->elements)
            if (const auto* const object = std::get_if<std::shared_ptr<const Block>>(&e.value);
                object != nullptr && inner->keyword == "looks_like")
              body.object = *object;
          if (inner->keyword != "looks_like")
            context.tell("projected_through", at, "'projected_through' has no meaning here");
        } else if (inner->keyword != "photons") {
          context.tell(fmt::format("light {}", inner->keyword), at,
                       fmt::format("'{}' of a light has no meaning here", inner->keyword));
        }
      } else if (l.take_word("spotlight")) {
        spot = true;
      } else if (l.take_word("cylinder")) {
        spot = parallel = true;
        context.tell("cylinder light", at, "a light that is a cylinder shines everywhere in its direction");
      } else if (l.take_word("parallel")) {
        parallel = true;
      } else if (l.take_word("point_at")) {
        point_at = l.vector("a point");
      } else if (l.take_word("radius")) {
        radius = l.number("an angle");
      } else if (l.take_word("falloff")) {
        falloff = l.number("an angle");
      } else if (l.take_word("tightness")) {
        if (l.number("a number") != 0)
          context.tell("tightness", at, "'tightness' of a light has no meaning here");
      } else if (l.take_word("fade_distance")) {
        fade_distance = l.number("a number");
      } else if (l.take_word("fade_power")) {
        fade_power = l.number("a number");
      } else if (l.take_word("shadowless")) {
        shadowless = l.flag();
      } else if (l.take_word("area_light")) {
        context.tell("area_light", at, "area lights are points here, with sharp shadows");
        while (l.is_numbers()) l.take();
      } else if (l.is_numbers()) {
        color = l.color("a colour");
      } else {
        const std::string_view word = l.peek_word();
        l.take();
        if (word == "adaptive" || word == "jitter" || word == "circular" || word == "orient" ||
            word == "media_interaction" || word == "media_attenuation" || word == "area_illumination") {
          if (l.is_numbers()) l.take();
        }
      }
    }
  };
  if (a.peek_block() == nullptr) location = a.vector("a place"), color = a.color("a colour");
  read(read, a);
  const Affine all = to_world * moves.all;
  const Vec3d at = all.point(location), target = all.point(point_at);
  const Vec3d rgb = color.rgb;
  if (std::min({color.rgb.x, color.rgb.y, color.rgb.z}) < 0)
    context.tell("negative light", where, "light that takes away light is left out");
  if (shadowless)
    context.tell("shadowless", where, "'shadowless' has no meaning here: each light casts shadows");
  const Node keys = tree.map(where);
  const auto add = [&](std::string_view kind) { Tree::push(context.lights, tree.map(where, kind, keys)); };
  const Vec3d way = target - at;
  if (parallel && length(way) > 0) {
    tree.put(keys, "direction", tree.vector(where, way)),
        tree.put(keys, "color", color_node(tree, where, rgb));
    add("directional");
  } else if (spot && length(way) > 0) {
    tree.put(keys, "position", tree.vector(where, at)), tree.put(keys, "at", tree.vector(where, target));
    tree.put(keys, "outer_angle", tree.number(where, std::clamp(std::max(radius, falloff), 1e-3, 180.0)));
    tree.put(keys, "inner_angle", tree.number(where, std::clamp(std::min(radius, falloff), 0.0, 180.0)));
    tree.put(keys, "color", color_node(tree, where, rgb));
    tree.put(keys, "falloff", tree.flag(where, false));
    add("spot");
  } else {
    tree.put(keys, "position", tree.vector(where, at));
    tree.put(keys, "color", color_node(tree, where, rgb));
    add("point");
  }
  if (fade_distance > 0 && fade_power > 0)
    context.tell("fade", where,
                 "light does not fade with the distance: 'fade_distance' and 'fade_power' are left out");
  if (body.object) {
    body.moves.add({Move::Kind::translate, location, {}, where});
    body.moves.add(moves);
  }
  return body;
}

// ---- Settings of the whole scene.

void read_global_settings(Context& context, const Block& block, Surroundings& s) {
  Arguments a(context, block);
  s.settings_place = block.where;
  while (!a.at_end()) {
    const Place where = a.where();
    if (a.take_word("assumed_gamma")) {
      // Read beforehand, as colours need it.
      if (!a.at_end()) a.take();
    } else if (a.take_word("max_trace_level")) {
      s.max_trace_level = a.number("a number");
    } else if (a.take_word("ambient_light")) {
      s.ambient = a.vector("a colour");
    } else if (const Block* const inner = a.peek_block()) {
      a.take();
      context.tell(fmt::format("setting {}", inner->keyword), where,
                   fmt::format("'{}' has no meaning here, and is left out", inner->keyword));
    } else {
      a.take();
    }
  }
}

void read_background(Context& context, const Block& block, Surroundings& s) {
  Arguments a(context, block);
  while (!a.at_end()) {
    if (a.is_numbers())
      s.background = a.color("a colour").rgb, s.background_place = block.where;
    else if (const Block* const inner = a.peek_block(); inner != nullptr && inner->keyword == "background")
      read_background(context, *inner, s), a.take();
    else
      a.take();
  }
}

}  // namespace oktett::pov
