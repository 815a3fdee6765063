#pragma once
/// \file A server of HTTP for one page, behind an interface: what implements it is a shared library that
/// `oktett view` loads, so that other verbs start without it.

#include <functional>
#include <map>
#include <memory>
#include <string>

namespace oktett {

/// What is asked. All of it is untrusted.
struct HttpRequest {
  std::string method, path, body;
  std::string host, origin, content_type;      ///< empty: not sent
  std::map<std::string, std::string> queries;  ///< behind the path; one of each name
  /// Whether whoever asks has closed the connection meanwhile, or the half of it that it writes to.
  std::function<bool()> is_gone = [] { return false; };
};

struct HttpResponse {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
  std::string file_name;  ///< if not empty, browsers save the body under this name
};

/// Bounds of what strangers may take.
struct HttpLimits {
  static constexpr std::size_t kConnections = 24, kHeaderBytes = 16384, kBodyBytes = 4096;
  static constexpr int kRequestSeconds = 10;  ///< from the first byte of a request to its last
  static constexpr int kAnswerSeconds = 60;   ///< from the first byte of an answer to its last
};

/// Listens on 127.0.0.1 alone.
class HttpServer {
 public:
  /// Called by several threads at the same time.
  using Handler = std::function<HttpResponse(const HttpRequest&)>;
  /// Whether a request is answered at all; asked before its body is read. Otherwise it gets that status.
  using Gate = std::function<int(const HttpRequest&)>;

  virtual ~HttpServer() = default;
  /// Binds a port, 0 for any that is free. Returns its number, or -1 if that cannot be had.
  virtual int bind(int port) = 0;
  /// Serves in threads of its own until `stop`. `gate` returns 0 for requests that may pass.
  virtual void start(Gate gate, Handler handler) = 0;
  virtual void stop() = 0;
};

/// The symbol that the shared library has.
inline constexpr const char* kHttpServerSymbol = "oktett_http_server";
using MakeHttpServer = HttpServer* (*)();

/// Loads the library. Throws Error if this build has none.
std::unique_ptr<HttpServer> load_http_server();

}  // namespace oktett
