/// \file `oktett view`.

#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <tbb/global_control.h>

#include <csignal>
#include <memory>
#include <optional>

#include "app/command_line.h"
#include "app/interrupt.h"
#include "app/text.h"
#include "app/view/private_folder.h"
#include "app/view/routes.h"

extern char** environ;

namespace oktett {
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
      "<meta http-equiv=\"refresh\" content=\"0; url={0}\"><title>Oktett</title><a href=\"{0}\">Oktett</a>\n",
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
