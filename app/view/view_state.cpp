#include "app/view/view_state.h"

#include <fmt/format.h>

#include <cmath>

#include "app/choice.h"
#include "app/number_text.h"
#include "app/text.h"
#include "core/error.h"

namespace oktett {
namespace {

/// Coordinates beyond this are no places that floats can tell apart.
constexpr double kFarthest = 1e15;

double number(std::string_view key, std::string_view text) {
  double value = 0;
  if (!parse_number(text, value) || !(std::abs(value) <= kFarthest))
    throw Error(fmt::format("{}: expected a number", key));
  return value;
}

double positive(std::string_view key, std::string_view text) {
  const double value = number(key, text);
  if (!(value > 0)) throw Error(fmt::format("{}: expected a number above 0", key));
  return value;
}

Vec3d vector(std::string_view key, std::string_view text) {
  const std::size_t first = text.find(' '), second = text.find(' ', first + 1);
  if (first == std::string_view::npos || second == std::string_view::npos)
    throw Error(fmt::format("{}: expected three numbers", key));
  return {number(key, text.substr(0, first)), number(key, text.substr(first + 1, second - first - 1)),
          number(key, text.substr(second + 1))};
}

/// The same conditions as in a scene file.
void check(const Camera& camera) {
  const Vec3d view = camera.at - camera.from;
  const double distance = max_component(abs(view)), up = max_component(abs(camera.up));
  if (!(distance > 0) || !(up > 0)) throw Error("the camera has no direction");
  if (length(cross(normalize(view / distance), normalize(camera.up / up))) < 1e-9)
    throw Error("the camera's 'up' is parallel to its view direction");
  if (!(camera.fov > 0 && camera.fov < 180)) throw Error("fov: expected more than 0 and less than 180");
}

void set(std::string_view key, std::string_view text, ViewState& state) {
  Camera& camera = state.camera;
  if (key == "from") {
    camera.from = vector(key, text);
  } else if (key == "at") {
    camera.at = vector(key, text);
  } else if (key == "up") {
    camera.up = vector(key, text);
  } else if (key == "fov") {
    camera.fov = positive(key, text);
  } else if (key == "height") {
    camera.height = positive(key, text);
  } else if (key == "focus") {
    camera.focus = positive(key, text);
    camera.focus_at.reset();
  } else if (key == "tone") {
    state.tone.kind = choice_of<ToneKind>("tone", std::string(text), kToneKinds);
  } else if (key == "exposure") {
    state.tone.exposure = number(key, text);
    if (!kExposures.contains(state.tone.exposure)) throw Error("exposure: out of range");
  } else if (key == "layer") {
    state.layer = text;
  } else {
    throw Error("unknown key");
  }
}

}  // namespace

ViewState parse_view(std::string_view text, ViewState state) {
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    const std::size_t sign = line.find('=');
    if (sign == std::string_view::npos) throw Error("expected lines of the form key=value");
    set(line.substr(0, sign), line.substr(sign + 1), state);
  }
  check(state.camera);
  return state;
}

std::string camera_yaml(const Camera& c) {
  std::string out = fmt::format("camera:\n  from: {}\n  at: {}\n  up: {}\n", list_text(c.from),
                                list_text(c.at), list_text(c.up));
  if (c.projection == Projection::orthographic)
    out += fmt::format("  projection: orthographic\n  height: {}\n", c.height);
  else
    out += fmt::format("  fov: {}\n", c.fov);
  if (c.f_number > 0)
    out += fmt::format("  f_number: {}\n", c.f_number);
  else if (c.aperture > 0)
    out += fmt::format("  aperture: {}\n", c.aperture);
  if (c.focus_at)
    out += fmt::format("  focus: {}\n", list_text(*c.focus_at));
  else if (c.focus > 0)
    out += fmt::format("  focus: {}\n", c.focus);
  if (c.shutter[0] != 0 || c.shutter[1] != 1)
    out += fmt::format("  shutter: [{}, {}]\n", c.shutter[0], c.shutter[1]);
  return out;
}

}  // namespace oktett
