/// \file `oktett view`.

#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/random.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <csignal>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "app/command_line.h"
#include "app/json.h"
#include "app/process.h"
#include "app/text.h"
#include "app/view/http.h"
#include "app/view/page_files.h"
#include "app/view/session.h"
#include "io/text/files.h"

namespace oktett {

// ---- What requests are answered, and how.

/// Answers pages. All addresses begin with the token, so programs and other pages that do not know it see
/// nothing.
class Routes {
 public:
  Routes(Session& session, std::string token, int port)
      : session_(session), token_(std::move(token)), port_(port) {}

  /// 0 if the request may pass, else the status of its refusal: the address must begin with the token, Host
  /// must be this server, as must the page that a request comes from.
  int gate(const HttpRequest& request) const;
  /// Answers a request that has passed.
  HttpResponse answer(const HttpRequest& request);

 private:
  HttpResponse get(const std::string& name, const HttpRequest& request);
  std::string status_json() const;

  Session& session_;
  std::string token_;
  int port_;
};

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

/// A word that nobody can guess: 128 random bits as hexadecimal digits. Throws Error.
static std::string random_token() {
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

namespace {

struct ViewArguments {
  RenderArguments picture;
  std::string port;
  bool no_open = false;
};

int port_of(const std::string& text) {
  return text.empty() ? 0 : static_cast<int>(parse_amount("--port", text, "", 0, 65535));
}

/// Asks the desktop to show the page. Without a desktop the address on the terminal has to do. Every user of
/// the machine can read the arguments of programs, so the browser finds the secret address in a file.
std::unique_ptr<PrivateFolder> open_page(const std::string& address) {
  auto folder = std::make_unique<PrivateFolder>();
  const std::string page = fmt::format(
      "<!doctype html><meta charset=\"utf-8\"><meta name=\"referrer\" content=\"no-referrer\">"
      "<meta http-equiv=\"refresh\" content=\"0; url={0}\"><title>Oktett</title><a "
      "href=\"{0}\">Oktett</a>\n",
      address);
  std::string program = "xdg-open", word = folder->write("open.html", page).string();
  char* const words[] = {program.data(), word.data(), nullptr};
  pid_t process = 0;
  if (posix_spawnp(&process, "xdg-open", nullptr, nullptr, words, environ) == 0)
    std::signal(SIGCHLD, SIG_IGN);
  return folder;
}

int run_view(const CommandLine& line, const ViewArguments& arguments) {
  apply_limits(arguments.picture.limits);
  const int wanted = port_of(arguments.port);
  check_threads(arguments.picture.threads);
  std::optional<tbb::global_control> threads;
  if (arguments.picture.threads > 0)
    threads.emplace(tbb::global_control::max_allowed_parallelism, arguments.picture.threads);
  const std::unique_ptr<HttpServer> server = load_http_server();
  const StopOnSignal interrupt;
  Session session(arguments.picture, line.text());
  const int port = server->bind(wanted);
  if (port < 0) throw Error(fmt::format("--port: port {} cannot be had on 127.0.0.1", wanted), ErrorKind::io);
  const std::string token = random_token();
  Routes routes(session, token, port);
  server->start([&](const HttpRequest& r) { return routes.gate(r); },
                [&](const HttpRequest& r) { return routes.answer(r); });
  const std::string address = fmt::format("http://127.0.0.1:{}/{}/", port, token);
  say("{}\nCtrl-C ends the viewer\n", address);
  std::unique_ptr<PrivateFolder> page;
  try {
    if (!arguments.no_open) page = open_page(address);
  } catch (const Error& error) {
    say("the page is not opened: {}\n", error.what());
  }
  while (!interrupt.flag()->load()) poll(nullptr, 0, 100);
  session.stop();
  server->stop();
  return interrupt.signal() == SIGALRM ? kExitTimeout : 0;
}

}  // namespace

void add_view_command(CommandLine& line) {
  const auto arguments = std::make_shared<ViewArguments>();
  Verb verb = line.add_verb("view", "Show a scene file or a mesh in the browser",
                            [&line, arguments] { return run_view(line, *arguments); });
  verb.positional("scene", arguments->picture.scene, "SCENE|MESH", "Scene file (.yaml) or mesh");
  verb.option("--port", &arguments->port, "N", "Port on 127.0.0.1; default: any that is free");
  verb.flag("--no-open", arguments->no_open, "Print the address, and leave opening it to you");
  add_picture_options(verb, arguments->picture);
}

}  // namespace oktett
