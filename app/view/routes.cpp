#include "app/view/routes.h"

#include <fmt/format.h>
#include <sys/random.h>

#include "app/choice.h"
#include "app/json.h"
#include "app/number_text.h"
#include "app/text.h"
#include "app/view/page_files.h"

namespace oktett {
namespace {

/// Takes the same time wherever texts of equal length differ.
bool same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned differs = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    differs |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return differs == 0;
}

/// A whole number of the address. Throws Error if it is none.
std::uint64_t whole(const HttpRequest& request, const char* name) {
  const auto found = request.queries.find(name);
  const std::string text = found == request.queries.end() ? "" : found->second;
  std::uint64_t value = 0;
  if (!parse_number(text, value)) throw Error(fmt::format("{}: expected a whole number", name));
  return value;
}

std::uint32_t pixel(const HttpRequest& request, const char* name) {
  const std::uint64_t value = whole(request, name);
  if (value > 0xffffffffu) throw Error(fmt::format("{}: out of range", name));
  return static_cast<std::uint32_t>(value);
}

const char* type_of(std::string_view name) {
  return name.ends_with(".html")  ? "text/html; charset=utf-8"
         : name.ends_with(".css") ? "text/css; charset=utf-8"
                                  : "text/javascript; charset=utf-8";
}

std::string view_json(const ViewState& state) {
  const Camera& c = state.camera;
  return fmt::format(
      "{{\"from\": {}, \"at\": {}, \"up\": {}, \"fov\": {}, \"height\": {}, \"lens\": {}, \"orthographic\": "
      "{}, "
      "\"tone\": \"{}\", \"exposure\": {}, \"layer\": {}}}",
      list_text(c.from), list_text(c.at), list_text(c.up), c.fov, c.height, c.aperture > 0 || c.f_number > 0,
      c.projection == Projection::orthographic, kToneKinds[static_cast<int>(state.tone.kind)].name,
      state.tone.exposure, JsonValue(state.layer).text);
}

}  // namespace

std::string random_token() {
  unsigned char bytes[16];
  if (getrandom(bytes, sizeof bytes, 0) != sizeof bytes)
    throw Error("the system gives no random numbers", ErrorKind::io);
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

int Routes::gate(const HttpRequest& request) const {
  const std::string local = fmt::format("127.0.0.1:{}", port_), named = fmt::format("localhost:{}", port_);
  if (request.host != local && request.host != named) return 403;
  if (!request.origin.empty() && request.origin != "http://" + request.host) return 403;
  const std::string_view path = request.path;
  if (path.size() < token_.size() + 2 || path[0] != '/' || path[token_.size() + 1] != '/') return 404;
  if (!same_secret(path.substr(1, token_.size()), token_)) return 404;
  // Forms of other pages cannot send this type without asking first.
  if (request.method == "POST" && request.content_type != "application/x-oktett-view") return 415;
  return path.size() > token_.size() + 40 ? 404 : 0;
}

HttpResponse Routes::answer(const HttpRequest& request) {
  const std::string name = request.path.substr(token_.size() + 2);
  try {
    if (request.method == "GET") return get(name, request);
    if (name == "view")
      return {200, "application/json", fmt::format("{{\"view\": {}}}", session_.change(request.body)), ""};
    return {404, "text/plain; charset=utf-8", "no such address\n", ""};
  } catch (const Error& error) {
    return {400, "text/plain; charset=utf-8", std::string(error.what()) + "\n", ""};
  } catch (const std::exception& error) {
    return {500, "text/plain; charset=utf-8", std::string(error.what()) + "\n", ""};
  }
}

HttpResponse Routes::get(const std::string& name, const HttpRequest& request) {
  if (name == "frame")
    return {200, "application/octet-stream",
            session_.frame(whole(request, "since"), 5000, [this] { return status_json(); }), ""};
  if (name == "pick")
    return {200, "application/json", session_.pick(pixel(request, "x"), pixel(request, "y")), ""};
  if (name == "camera") return {200, "text/plain; charset=utf-8", session_.camera(), ""};
  if (name == "picture.png") return {200, "image/png", session_.save(".png", request.is_gone), name};
  if (name == "picture.exr") return {200, "image/x-exr", session_.save(".exr", request.is_gone), name};
  const std::string file = name.empty() ? "page.html" : name;
  if (const auto bytes = page_file(file)) return {200, type_of(file), std::string(*bytes), ""};
  return {404, "text/plain; charset=utf-8", "no such address\n", ""};
}

std::string Routes::status_json() const {
  const SessionStatus s = session_.status();
  const auto list = [](const std::vector<std::string>& names) {
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "" : ", ") + JsonValue(name).text;
    return "[" + all + "]";
  };
  std::string json = fmt::format(
      "{{\"view\": {}, \"width\": {}, \"height\": {}, \"samples\": {}, \"wanted\": {}, \"settled\": {}, "
      "\"center\": "
      "{}, \"radius\": {}, \"state\": {}, \"home\": {}, \"layers\": {}, \"tones\": {}, "
      "\"edits\": {}",
      s.view, s.width, s.height, s.samples, s.wanted_samples, s.settled, list_text(s.center), s.radius,
      view_json(s.state), view_json(s.home), list(s.layers), list(names_of<ToneKind>(kToneKinds)), s.edits);
  if (s.error)
    json += fmt::format(", \"error\": {}, \"file\": {}, \"line\": {}, \"column\": {}, \"text\": {}",
                        JsonValue(s.error->what()).text, JsonValue(s.error->where().file).text,
                        s.error->where().line, s.error->where().column, JsonValue(s.error_line).text);
  return json;
}

}  // namespace oktett
