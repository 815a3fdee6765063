#include "io/pov/translate/view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "io/pov/translate/extent.h"
#include "io/pov/translate/look.h"
#include "io/pov/translate/mesh_camera.h"

namespace oktett::pov {
namespace {

constexpr double kRadians = std::numbers::pi / 180;

/// A projection of scene files, and the angle that it has in POV-Ray if none is given.
struct CameraKind {
  std::string_view name, projection;
  bool has_angle = false;
  double usual_angle = 90;
};
constexpr CameraKind kCameraKinds[] = {{"perspective", "perspective", true},
                                       {"orthographic", "orthographic"},
                                       {"fisheye", "fisheye", true},
                                       {"ultra_wide_angle", "ultra_wide_angle", true},
                                       {"omnimax", "omnimax"},
                                       {"panoramic", "panoramic"},
                                       {"cylinder", "cylindrical", true},
                                       {"spherical", "spherical", true, 360}};

/// A camera as POV-Ray has it, which is 1.33 wide, not 4/3.
struct PovCamera {
  std::string_view kind = "perspective";
  Vec3d location{0, 0, 0}, direction{0, 0, 1}, right{1.33, 0, 0}, up{0, 1, 0}, sky{0, 1, 0};
  std::optional<Vec3d> look_at, focal_point;
  std::optional<double> angle, vertical_angle;
  int cylinder = 1;  ///< 1 to 4
  bool has_angle = false, has_size = false;
  double aperture = 0, blur_samples = 0;
  std::shared_ptr<const Block> mesh;  ///< mesh_camera, which stands instead of a kind
  Moves moves;

  bool orthographic() const { return kind == "orthographic"; }
  bool curved() const { return kind != "perspective" && kind != "orthographic"; }
};

void read_camera(Context& context, const Block& block, PovCamera& c) {
  Arguments a(context, block);
  while (!a.at_end()) {
    const Place where = a.where();
    if (take_moves(context, a, c.moves)) continue;
    if (const std::shared_ptr<const Block> inner = a.peek_shared_block()) {
      a.take();
      if (inner->keyword == "camera")
        read_camera(context, *inner, c);
      else if (inner->keyword == "mesh_camera")
        c.mesh = inner;
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
      if (a.is_numbers()) c.vertical_angle = a.number("an angle");
    } else if (const auto* const kind = std::ranges::find(kCameraKinds, a.peek_word(), &CameraKind::name);
               kind != std::end(kCameraKinds)) {
      a.take();
      c.kind = kind->name, c.mesh = nullptr;
      if (c.kind == "cylinder") {
        const double number = a.number("the number of a kind of cylinder");
        if (!(number == 1 || number == 2 || number == 3 || number == 4))
          context.fail(where, fmt::format("expected a cylinder from 1 to 4, found {}", number));
        c.cylinder = static_cast<int>(number);
      }
    } else if (a.take_word("aperture")) {
      c.aperture = a.number("a number");
    } else if (a.take_word("focal_point")) {
      c.focal_point = a.vector("a point");
    } else if (a.take_word("blur_samples")) {
      c.blur_samples = a.number("a number");
      if (a.is_numbers()) a.take();
    } else {
      a.take();
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

/// The keys of a curved projection; its vectors are those of the world.
void put_curved(Context& context, const Place& where, PovCamera& c, Node node) {
  Tree& tree = context.tree;
  const CameraKind& kind = *std::ranges::find(kCameraKinds, c.kind, &CameraKind::name);
  if (kind.has_angle) {
    // An angle of 0 is none.
    const double angle = c.angle.value_or(0) != 0 ? *c.angle : kind.usual_angle;
    const double vertical = c.vertical_angle.value_or(0) != 0 ? *c.vertical_angle : angle / 2;
    for (const double degrees : {angle, vertical})
      if (!(degrees > 0 && degrees <= 360))
        context.fail(where, fmt::format("a '{}' camera of {} degrees cannot be shown; expected more than 0, "
                                        "at most 360",
                                        c.kind, degrees));
    const double both[] = {angle, vertical};
    tree.put(node, "angle", c.kind == "spherical" ? tree.numbers(where, both) : tree.number(where, angle));
  }
  if (c.kind == "cylinder") {
    tree.put(node, "axis", tree.word(where, c.cylinder % 2 == 1 ? "up" : "right"));
    if (c.cylinder > 2) tree.put(node, "along_axis", tree.word(where, "orthographic"));
  }
  // There the picture is turned by `right` and `up` as axes, whichever their hand is.
  if (c.kind == "spherical" && dot(cross(c.up, c.direction), c.right) < 0)
    c.right = c.right * -1.0, c.up = c.up * -1.0;
  if (c.aperture > 0 && c.blur_samples > 0)
    context.tell("curved blur", where, fmt::format("all is sharp that a '{}' camera sees", c.kind));
}

}  // namespace

Node camera_node(Context& context, const Block* block) {
  PovCamera c;
  Place where;
  if (block != nullptr) read_camera(context, *block, c), where = block->where;
  if (c.angle && !c.curved()) {
    if (!(*c.angle >= 0 && *c.angle < 180))
      context.fail(where, fmt::format("a camera of {} degrees cannot be meant", *c.angle));
    // One of 0 is none.
    if (*c.angle == 0) c.angle.reset();
  }
  if (c.angle && c.kind == "perspective") {
    const double size = length(c.direction);
    if (size > 0)
      c.direction = c.direction / size * (length(c.right) / 2 / std::tan(*c.angle / 2 * kRadians));
  }
  const double before = length(c.direction);
  look(context, where, c);
  if (c.orthographic() && (c.has_angle || !c.has_size)) {
    // As wide as the view in perspective at what it looks at.
    const double distance = length(c.look_at.value_or(Vec3d{0, 0, 1}) - c.location);
    double scale = before > 0 ? distance / before : 1;
    if (c.angle) scale = 2 * distance * std::tan(*c.angle / 2 * kRadians) / length(c.right);
    c.right = c.right * scale, c.up = c.up * scale;
  }
  const Affine& m = c.moves.all;
  c.location = m.point(c.location), c.direction = m.vector(c.direction);
  c.right = m.vector(c.right), c.up = m.vector(c.up);
  if (c.mesh != nullptr) return mesh_camera_node(context, *c.mesh, c.location.z, c.direction.z);
  Tree& tree = context.tree;
  const Node node = tree.map(where), frame = tree.map(where);
  if (c.kind != "perspective")
    tree.put(node, "projection",
             tree.word(where, std::ranges::find(kCameraKinds, c.kind, &CameraKind::name)->projection));
  if (c.curved()) put_curved(context, where, c, node);
  tree.put(node, "from", tree.vector(where, c.location));
  tree.put(frame, "right", tree.vector(where, c.right)), tree.put(frame, "up", tree.vector(where, c.up));
  tree.put(frame, "direction", tree.vector(where, c.direction));
  tree.put(node, "frame", frame);
  if (c.aperture > 0 && c.blur_samples > 0 && !c.curved()) {
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

namespace {

/// The points that a light of some size stands for, along one of its sides.
struct LightPoints {
  Vec3d side{0, 0, 0};
  int count = 1;
};

/// A light as POV-Ray has it.
struct PovLight {
  Vec3d location{0, 0, 0}, point_at{0, 0, 1};
  PovColor color{{1, 1, 1}};
  bool spot = false, cylinder = false, parallel = false, shadowless = false, circular = false;
  bool media_attenuation = false, media_interaction = true;
  std::optional<double> radius, falloff;
  double tightness = 0, fade_distance = 0, fade_power = 0;
  std::array<LightPoints, 2> area;
  /// Of the place, the point, the sides and the body: only what is said behind each of them moves it.
  Moves moves, point_moves, area_moves, body_moves;

  void move(const Moves& more) {
    for (Moves* const all : {&moves, &point_moves, &area_moves, &body_moves}) all->add(more);
  }
};

/// The most points along a side: more make pictures slow and hardly other.
constexpr int kMostLightPoints = 17;

void read_area(Context& context, Arguments& l, PovLight& light) {
  for (LightPoints& points : light.area) points.side = l.vector("a side of the light");
  for (LightPoints& points : light.area) {
    const Place where = l.where();
    const double count = l.number("how many points there are");
    if (!(count >= 1))
      context.fail(where, fmt::format("expected at least 1 point along a side of a light, found {}", count));
    points.count = static_cast<int>(std::min(std::floor(count), 1e6));
    if (points.count > kMostLightPoints)
      context.tell("area_light", where,
                   fmt::format("lights have at most {} points along a side", kMostLightPoints));
    points.count = std::min(points.count, kMostLightPoints);
  }
}

void read_light(Context& context, Arguments& l, PovLight& light, LightBody& body) {
  while (!l.at_end()) {
    const Place at = l.where();
    if (Moves moves; take_moves(context, l, moves)) {
      light.move(moves);
      continue;
    }
    if (const std::shared_ptr<const Block> inner = l.peek_shared_block()) {
      l.take();
      if (inner->keyword == "light_source") {
        Arguments base(context, *inner);
        light.location = base.vector("a place"), light.color = base.color("a colour");
        read_light(context, base, light, body);
      } else if (inner->keyword == "looks_like" || inner->keyword == "projected_through") {
        for (const Element& e : inner->elements)
          if (const auto* const object = std::get_if<std::shared_ptr<const Block>>(&e.value);
              object != nullptr && inner->keyword == "looks_like") {
            body.object = *object;
            light.body_moves = {};
            light.body_moves.add({Move::Kind::translate, light.moves.all.point(light.location), {}, at});
          }
        if (inner->keyword != "looks_like")
          context.tell("projected_through", at, "'projected_through' has no meaning here");
      } else if (inner->keyword != "photons") {
        context.tell(fmt::format("light {}", inner->keyword), at,
                     fmt::format("'{}' of a light has no meaning here", inner->keyword));
      }
    } else if (l.take_word("spotlight")) {
      light.spot = true;
    } else if (l.take_word("cylinder")) {
      light.cylinder = true;
    } else if (l.take_word("parallel")) {
      light.parallel = true;
    } else if (l.take_word("point_at")) {
      light.point_at = l.vector("a point"), light.point_moves = {};
    } else if (l.take_word("radius")) {
      light.radius = l.number("an angle");
    } else if (l.take_word("falloff")) {
      light.falloff = l.number("an angle");
    } else if (l.take_word("tightness")) {
      light.tightness = l.number("a number");
    } else if (l.take_word("fade_distance")) {
      light.fade_distance = l.number("a number");
    } else if (l.take_word("fade_power")) {
      light.fade_power = l.number("a number");
    } else if (l.take_word("shadowless")) {
      light.shadowless = l.flag();
    } else if (l.take_word("area_light")) {
      read_area(context, l, light), light.area_moves = {};
    } else if (l.take_word("circular")) {
      light.circular = l.flag();
    } else if (l.is_numbers()) {
      light.color = l.color("a colour");
    } else {
      const std::string_view word = l.peek_word();
      l.take();
      if (word == "media_attenuation") {
        light.media_attenuation = l.flag();
      } else if (word == "media_interaction") {
        light.media_interaction = l.flag();
      } else if (word == "adaptive" || word == "jitter" || word == "orient" || word == "area_illumination") {
        if (l.is_numbers()) l.take();
      }
    }
  }
}

/// The keys of a light that are the same at each of its points.
void put_light(Tree& tree, const Place& where, const PovLight& light, Node keys) {
  if (light.shadowless)
    // Such a light shows no highlights, either.
    tree.put(keys, "shadows", tree.flag(where, false)), tree.put(keys, "highlights", tree.flag(where, false));
  if (light.media_attenuation && light.media_interaction)
    tree.put(keys, "dimmed_by_fog", tree.flag(where, true));
  if (!(light.fade_distance > 0 && light.fade_power > 0)) return;
  const Node fade = tree.map(where);
  tree.put(fade, "distance", tree.number(where, light.fade_distance));
  tree.put(fade, "power", tree.number(where, light.fade_power));
  tree.put(keys, "fade", fade);
}

/// Of a light that is a cylinder. A radius of 0 means that it ends sharply.
void put_beam(Tree& tree, const Place& where, const PovLight& light, Node keys) {
  const double outer = std::max(light.falloff.value_or(1), 1e-9), radius = light.radius.value_or(0.75);
  const Node beam = tree.map(where);
  tree.put(beam, "outer_radius", tree.number(where, outer));
  tree.put(beam, "inner_radius", tree.number(where, radius > 0 ? std::min(radius, outer) : outer));
  if (light.tightness > 0) tree.put(beam, "tightness", tree.number(where, light.tightness));
  tree.put(keys, "beam", beam);
}

/// Where point (i, k) of a light of some size is, as fractions of its sides from the middle.
std::array<double, 2> light_place(const PovLight& light, int i, int k) {
  const auto part = [](int number, int count) { return count > 1 ? number / (count - 1.0) - 0.5 : 0.0; };
  const double x = part(i, light.area[0].count), y = part(k, light.area[1].count);
  const double size = std::sqrt(x * x + y * y);
  // Squares about the middle become circles.
  const double scale = light.circular && size > 0 ? std::max(std::abs(x), std::abs(y)) / size : 1;
  return {x * scale, y * scale};
}

/// The part of the light of one of `count` points along a side: those at both ends count half.
double light_part(int number, int count) {
  if (count == 1) return 1;
  return (number == 0 || number == count - 1 ? 0.5 : 1) / (count - 1);
}

}  // namespace

LightBody add_light(Context& context, const Block& block, const Affine& to_world) {
  Arguments a(context, block);
  Tree& tree = context.tree;
  const Place& where = block.where;
  PovLight light;
  LightBody body;
  if (a.peek_block() == nullptr) light.location = a.vector("a place"), light.color = a.color("a colour");
  read_light(context, a, light, body);
  const Affine of_sides = to_world * light.area_moves.all;
  const Vec3d middle = to_world.point(light.moves.all.point(light.location)),
              target = to_world.point(light.point_moves.all.point(light.point_at));
  const Vec3d way = target - middle;
  const Vec3d rgb = light.color.rgb;
  if (std::min({rgb.x, rgb.y, rgb.z}) < 0)
    context.tell("negative light", where, "light that takes away light is left out");
  const bool points = length(way) > 0;
  for (int i = 0; i < light.area[0].count; ++i)
    for (int k = 0; k < light.area[1].count; ++k) {
      const std::array<double, 2> place = light_place(light, i, k);
      const Vec3d at = middle + of_sides.vector(light.area[0].side) * place[0] +
                       of_sides.vector(light.area[1].side) * place[1];
      const double part = light_part(i, light.area[0].count) * light_part(k, light.area[1].count);
      const Node keys = tree.map(where);
      const char* kind = "point";
      if ((light.parallel || light.cylinder) && points) {
        kind = "directional";
        // Of a light of some size the directions differ, but all meet where it points to.
        tree.put(keys, "direction", tree.vector(where, target - at));
        tree.put(keys, "from", tree.vector(where, at));
        if (light.cylinder) put_beam(tree, where, light, keys);
      } else if (light.spot && points) {
        kind = "spot";
        const double radius = light.radius.value_or(30),
                     falloff = std::max(light.falloff.value_or(45), radius);
        tree.put(keys, "position", tree.vector(where, at));
        // The cones of all points of a light of some size have the same middle there.
        tree.put(keys, "at", tree.vector(where, target));
        tree.put(keys, "outer_angle", tree.number(where, std::clamp(falloff, 1e-3, 180.0)));
        tree.put(keys, "inner_angle", tree.number(where, std::clamp(radius, 0.0, 180.0)));
        if (light.tightness > 0) tree.put(keys, "tightness", tree.number(where, light.tightness));
        if (!(light.fade_distance > 0 && light.fade_power > 0))
          tree.put(keys, "falloff", tree.flag(where, false));
      } else {
        tree.put(keys, "position", tree.vector(where, at));
      }
      tree.put(keys, "color", color_node(tree, where, rgb * part));
      put_light(tree, where, light, keys);
      Tree::push(context.lights, tree.map(where, kind, keys));
      context.light_keys.push_back(keys);
    }
  body.moves = light.body_moves;
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
    } else if (a.take_word("adc_bailout")) {
      s.adc_bailout = a.number("a number");
    } else if (a.take_word("ambient_light")) {
      s.ambient = a.vector("a colour");
    } else if (a.take_word("irid_wavelength")) {
      // Only what the thickness is to the wavelength matters.
      const Vec3d lengths = a.vector("wavelengths");
      if (lengths.y > 0) context.film_scale = 0.52 / lengths.y;
    } else if (const Block* const inner = a.peek_block()) {
      a.take();
      const std::string_view k = inner->keyword;
      const char* const why = k == "radiosity" ? "; 'path' shows the light that surfaces give each other"
                              : k == "photons"
                                  ? "; 'path' with 'caustics' shows light that mirrors and glass gather"
                                  : "";
      context.tell(fmt::format("setting {}", k), where,
                   fmt::format("'{}' has no meaning here, and is left out{}", k, why));
    } else {
      a.take();
    }
  }
}

void read_background(Context& context, const Block& block, Surroundings& s) {
  Arguments a(context, block);
  while (!a.at_end()) {
    if (a.is_numbers()) {
      const PovColor color = a.color("a colour");
      // Nothing lies behind what it lets pass, since 3.7.
      const double left = context.document.version < 3.7 ? 1 : 1 - std::clamp(color.transmit, 0.0, 1.0);
      s.background = color.rgb * left, s.background_place = block.where;
    } else if (const Block* const inner = a.peek_block(); inner != nullptr && inner->keyword == "background")
      read_background(context, *inner, s), a.take();
    else
      a.take();
  }
}

}  // namespace oktett::pov
