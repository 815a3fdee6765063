/// \file The server of http.h by cpp-httplib, a shared library of its own. The library reads headers and
/// chunked bodies of any length, so a stream that ends early bounds what one request may be.

// Debian's library is compiled with it, and the members of its classes depend on it.
#define CPPHTTPLIB_OPENSSL_SUPPORT
#include <httplib.h>
#include <poll.h>

#include <algorithm>
#include <charconv>
#include <chrono>

#include "app/view/http.h"

namespace oktett {
namespace {

using Clock = std::chrono::steady_clock;

/// A connection of which a request may be so many bytes and take so long.
class BoundedStream : public httplib::Stream {
 public:
  explicit BoundedStream(socket_t socket) : socket_(socket) {}

  void begin_request() {
    bytes_left_ = HttpLimits::kHeaderBytes + HttpLimits::kBodyBytes;
    end_ = Clock::now() + std::chrono::seconds(HttpLimits::kRequestSeconds);
  }
  bool is_readable() const override { return wait(POLLIN, 0); }
  bool is_writable() const override { return wait(POLLOUT, HttpLimits::kRequestSeconds * 1000); }
  ssize_t read(char* to, std::size_t size) override {
    size = std::min({size, bytes_left_, fill()});
    if (size == 0) return -1;
    std::copy_n(buffer_ + first_, size, to);
    first_ += size, bytes_left_ -= size;
    return static_cast<ssize_t>(size);
  }
  /// Whether a request has begun to arrive, after at most so long.
  bool has_begun(int milliseconds) const { return first_ < last_ || wait(POLLIN, milliseconds); }
  ssize_t write(const char* from, std::size_t size) override {
    if (!is_writable()) return -1;
    return send(socket_, from, size, MSG_NOSIGNAL);
  }
  void get_remote_ip_and_port(std::string& ip, int& port) const override { ip = "127.0.0.1", port = 0; }
  void get_local_ip_and_port(std::string& ip, int& port) const override { ip = "127.0.0.1", port = 0; }
  socket_t socket() const override { return socket_; }

  bool wait(short events, int milliseconds) const {
    pollfd entry{socket_, events, 0};
    return ::poll(&entry, 1, milliseconds) > 0 && (entry.revents & (events | POLLHUP)) != 0;
  }

 private:
  /// The number of bytes in the buffer, which is filled if it is empty. 0 at the end or when time is up.
  std::size_t fill() {
    if (first_ < last_) return last_ - first_;
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end_ - Clock::now()).count();
    if (left <= 0 || !wait(POLLIN, static_cast<int>(left))) return 0;
    const ssize_t count = recv(socket_, buffer_, sizeof buffer_, 0);
    first_ = 0, last_ = count > 0 ? static_cast<std::size_t>(count) : 0;
    return last_;
  }

  socket_t socket_;
  char buffer_[4096];
  std::size_t first_ = 0, last_ = 0;  ///< of the bytes in the buffer that are not read yet
  std::size_t bytes_left_ = 0;
  Clock::time_point end_;
};

/// Hands sockets to threads; whoever brings one waits while all are busy, so connections queue in the kernel.
class BoundedPool : public httplib::TaskQueue {
 public:
  BoundedPool() : pool_(HttpLimits::kConnections) {}
  void enqueue(std::function<void()> task) override {
    std::unique_lock lock(mutex_);
    free_.wait(lock, [&] { return busy_ < HttpLimits::kConnections; });
    ++busy_;
    pool_.enqueue([this, task = std::move(task)] {
      task();
      const std::lock_guard done(mutex_);
      --busy_;
      free_.notify_one();
    });
  }
  void shutdown() override { pool_.shutdown(); }

 private:
  std::mutex mutex_;
  std::condition_variable free_;
  std::size_t busy_ = 0;
  httplib::ThreadPool pool_;
};

HttpRequest plain(const httplib::Request& from) {
  HttpRequest request{from.method, from.path, from.body, {}, {}, {}, {}};
  request.host = from.get_header_value("Host");
  request.origin = from.get_header_value("Origin");
  request.content_type = from.get_header_value("Content-Type");
  for (const auto& [name, value] : from.params) request.queries.emplace(name, value);
  return request;
}

/// The status for a request whose form is refused; 0 if it is in order.
int check_form(const httplib::Request& r) {
  if (r.method != "GET" && r.method != "POST") return 405;
  if (r.has_header("Transfer-Encoding") || r.has_header("Range") || r.has_header("Expect")) return 400;
  if (r.get_header_value_count("Host") != 1 || r.get_header_value_count("Content-Length") > 1) return 400;
  const std::string text = r.get_header_value("Content-Length");
  if (r.method == "GET") return text.empty() || text == "0" ? 0 : 400;
  std::size_t length = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), length);
  if (text.empty() || error == std::errc::invalid_argument || end != text.data() + text.size()) return 411;
  return error != std::errc{} || length > HttpLimits::kBodyBytes ? 413 : 0;
}

class OwnServer : public HttpServer, private httplib::Server {
 public:
  OwnServer() {
    new_task_queue = [] { return new BoundedPool; };
    // Other programs must not share the port, as the library's own choice would let them.
    set_socket_options([](socket_t socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    set_payload_max_length(HttpLimits::kBodyBytes);
  }
  ~OwnServer() override { stop(); }

  int bind(int port) override {
    if (port == 0) return bind_to_any_port("127.0.0.1");
    return bind_to_port("127.0.0.1", port) ? port : -1;
  }

  void start(Gate gate, HttpServer::Handler handler) override {
    set_default_headers(
        {{"Cache-Control", "no-store"},
         {"X-Content-Type-Options", "nosniff"},
         {"Referrer-Policy", "no-referrer"},
         {"Cross-Origin-Resource-Policy", "same-origin"},
         {"Cross-Origin-Opener-Policy", "same-origin"},
         {"Content-Security-Policy",
          "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' "
          "blob: data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"}});
    set_pre_routing_handler([gate, handler](const httplib::Request& from, httplib::Response& to) {
      int status = check_form(from);
      if (status == 0) status = gate(plain(from));
      if (status != 0) {
        to.set_header("Connection", "close");
        answer({status, "text/plain; charset=utf-8", "refused\n", ""}, to);
        return HandlerResponse::Handled;
      }
      if (from.method == "POST") return HandlerResponse::Unhandled;
      answer(handler(plain(from)), to);
      return HandlerResponse::Handled;
    });
    Post(".*", [handler](const httplib::Request& from, httplib::Response& to) {
      answer(handler(plain(from)), to);
    });
    thread_ = std::thread([this] { listen_after_bind(); });
    while (!is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  void stop() override {
    stopping_ = true;
    if (!thread_.joinable()) return;
    httplib::Server::stop();
    thread_.join();
  }

 private:
  static void answer(HttpResponse from, httplib::Response& to) {
    to.status = from.status;
    if (!from.file_name.empty())
      to.set_header("Content-Disposition", "attachment; filename=\"" + from.file_name + "\"");
    // A provider of known length is sent as it is: neither copied nor compressed.
    const auto body = std::make_shared<const std::string>(std::move(from.body));
    if (body->empty()) return;
    to.set_content_provider(body->size(), from.type,
                            [body](std::size_t at, std::size_t size, httplib::DataSink& sink) {
                              return sink.write(body->data() + at, size);
                            });
  }

  bool process_and_close_socket(socket_t socket) override {
    const int yes = 1;
    setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    BoundedStream stream(socket);
    bool good = true, closed = false;
    for (int idle = 0; good && !closed && !stopping_ && idle < 50; ++idle) {
      if (!stream.has_begun(100)) continue;
      idle = 0;
      stream.begin_request();
      good = process_request(stream, false, closed, nullptr);
    }
    ::shutdown(socket, SHUT_RDWR);
    ::close(socket);
    return good;
  }

  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace
}  // namespace oktett

extern "C" __attribute__((visibility("default"))) oktett::HttpServer* oktett_http_server();
oktett::HttpServer* oktett_http_server() { return new oktett::OwnServer; }
