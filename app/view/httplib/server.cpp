/// \file The server of http.h by cpp-httplib, a shared library of its own. The library reads headers and
/// chunked bodies of any length, so a stream that ends early bounds what one request may be.

// Debian's library is compiled with it, and the members of its classes depend on it.
#define CPPHTTPLIB_OPENSSL_SUPPORT
#include <httplib.h>
#include <poll.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <map>

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
    answered_ = false, is_late_ = false;
  }
  bool is_readable() const override { return wait(POLLIN, 0); }
  bool is_writable() const override { return wait(POLLOUT, milliseconds_left()); }
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
    if (!answered_) end_ = Clock::now() + std::chrono::seconds(HttpLimits::kAnswerSeconds);
    answered_ = true;
    if (!is_writable()) return -1;
    return send(socket_, from, size, MSG_NOSIGNAL);
  }
  /// Answers a request that was given up because it is too long or too slow, if nothing has answered it.
  void answer_rest() {
    if (answered_ || (!is_late_ && bytes_left_ > 0)) return;
    const std::string status = is_late_ ? "408 Request Timeout" : "431 Request Header Fields Too Large";
    const std::string text = "HTTP/1.1 " + status + "\r\nContent-Length: 0\r\nConnection: close\r\n\r\n";
    write(text.data(), text.size());
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
    is_late_ = !wait(POLLIN, milliseconds_left());
    if (is_late_) return 0;
    const ssize_t count = recv(socket_, buffer_, sizeof buffer_, 0);
    first_ = 0, last_ = count > 0 ? static_cast<std::size_t>(count) : 0;
    return last_;
  }

  int milliseconds_left() const {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end_ - Clock::now()).count();
    return static_cast<int>(std::max<std::int64_t>(0, left));
  }

  socket_t socket_;
  char buffer_[4096];
  std::size_t first_ = 0, last_ = 0;  ///< of the bytes in the buffer that are not read yet
  std::size_t bytes_left_ = 0;
  bool answered_ = false;  ///< some of the answer is written
  bool is_late_ = false;
  Clock::time_point end_;  ///< of reading the request, then of writing the answer
};

/// The connections that owe the server a request, with the time since when.
class WaitingConnections {
 public:
  void add(socket_t socket) {
    const std::lock_guard lock(mutex_);
    since_[socket] = Clock::now();
  }
  /// Must be called before the socket is closed, since its number may then be that of another connection.
  void remove(socket_t socket) {
    const std::lock_guard lock(mutex_);
    since_.erase(socket);
  }
  /// Ends the connection that has waited longest, if there is one.
  void end_oldest() {
    const std::lock_guard lock(mutex_);
    const auto oldest = std::min_element(since_.begin(), since_.end(),
                                         [](const auto& a, const auto& b) { return a.second < b.second; });
    if (oldest == since_.end()) return;
    ::shutdown(oldest->first, SHUT_RDWR);
    since_.erase(oldest);
  }

 private:
  std::mutex mutex_;
  std::map<socket_t, Clock::time_point> since_;
};

/// Hands sockets to threads. While all are busy, whoever brings a socket ends the connections that have
/// waited longest for a request: clients that send slowly or nothing cannot keep others out.
class BoundedPool : public httplib::TaskQueue {
 public:
  explicit BoundedPool(WaitingConnections& waiting) : waiting_(waiting), pool_(HttpLimits::kConnections) {}
  /// Nothing in older versions of cpp-httplib, in newer ones whether the task was accepted.
  using Enqueued = decltype(std::declval<httplib::TaskQueue&>().enqueue(nullptr));
  Enqueued enqueue(std::function<void()> task) override {
    std::unique_lock lock(mutex_);
    const auto has_room = [&] { return busy_ < HttpLimits::kConnections; };
    while (!has_room()) {
      waiting_.end_oldest();
      free_.wait_for(lock, std::chrono::milliseconds(100), has_room);
    }
    ++busy_;
    pool_.enqueue([this, task = std::move(task)] {
      task();
      const std::lock_guard done(mutex_);
      --busy_;
      free_.notify_one();
    });
    return Enqueued(true);
  }
  void shutdown() override { pool_.shutdown(); }

 private:
  WaitingConnections& waiting_;
  std::mutex mutex_;
  std::condition_variable free_;
  std::size_t busy_ = 0;
  httplib::ThreadPool pool_;
};

bool is_closed(socket_t socket) {
  pollfd entry{socket, POLLRDHUP, 0};
  return ::poll(&entry, 1, 0) > 0 && (entry.revents & (POLLRDHUP | POLLHUP | POLLERR)) != 0;
}

HttpRequest plain(const httplib::Request& from) {
  HttpRequest request;
  request.method = from.method, request.path = from.path, request.body = from.body;
  request.host = from.get_header_value("Host");
  request.origin = from.get_header_value("Origin");
  request.content_type = from.get_header_value("Content-Type");
  for (const auto& [name, value] : from.params) request.queries.emplace(name, value);
  return request;
}

/// The status for a request whose form is refused; 0 if it is in order.
int check_form(const httplib::Request& r) {
  if (r.method != "GET" && r.method != "POST") return 405;
  for (const char* name : {"Transfer-Encoding", "Range", "Upgrade"})
    if (r.has_header(name)) return 400;
  if (r.get_header_value_count("Host") != 1) return 400;
  for (const char* name : {"Content-Length", "Content-Type", "Origin"})
    if (r.get_header_value_count(name) > 1) return 400;
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
    new_task_queue = [this] { return new BoundedPool(waiting_); };
    set_expect_100_continue_handler([](const httplib::Request&, httplib::Response& to) {
      refuse(400, to);
      return to.status;
    });
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
        refuse(status, to);
        return HandlerResponse::Handled;
      }
      if (from.method == "POST") return HandlerResponse::Unhandled;
      answer(ask(handler, from), to);
      return HandlerResponse::Handled;
    });
    Post(".*",
         [handler](const httplib::Request& from, httplib::Response& to) { answer(ask(handler, from), to); });
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
  /// What follows a refused request is its body, if not worse, so it is not read.
  static void refuse(int status, httplib::Response& to) {
    to.set_header("Connection", "close");
    to.status = status;
    to.set_content("refused\n", "text/plain; charset=utf-8");
    arriving.refused = true;
  }

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

  /// Newer versions of cpp-httplib are told the addresses of both ends, for logs, which this server does not
  /// write.
  template <class Self>
  static bool process(Self& self, BoundedStream& stream, bool& closed) {
    if constexpr (requires { self.process_request(stream, false, closed, nullptr); })
      return self.process_request(stream, false, closed, nullptr);
    else
      return self.process_request(stream, "", 0, "", 0, false, closed, nullptr);
  }

  bool process_and_close_socket(socket_t socket) override {
    const int yes = 1;
    setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    BoundedStream stream(socket);
    waiting_.add(socket);
    bool good = true, closed = false;
    arriving = {&waiting_, socket, false};
    for (int idle = 0; good && !closed && !arriving.refused && !stopping_ && idle < 50; ++idle) {
      if (!stream.has_begun(100)) continue;
      idle = 0;
      stream.begin_request();
      good = process(*this, stream, closed);
      if (good) waiting_.add(socket);
    }
    if (!good) stream.answer_rest();
    waiting_.remove(socket);
    ::shutdown(socket, SHUT_RDWR);
    ::close(socket);
    return good;
  }

  /// The answer to the request of this thread, which is complete: its connection now waits for the server.
  static HttpResponse ask(const HttpServer::Handler& handler, const httplib::Request& from) {
    arriving.connections->remove(arriving.socket);
    HttpRequest request = plain(from);
    request.is_gone = [socket = arriving.socket] { return is_closed(socket); };
    return handler(request);
  }

  /// What this thread serves.
  struct Arriving {
    WaitingConnections* connections = nullptr;
    socket_t socket = INVALID_SOCKET;
    bool refused = false;  ///< the last request was
  };
  static thread_local Arriving arriving;

  WaitingConnections waiting_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

thread_local OwnServer::Arriving OwnServer::arriving;

}  // namespace
}  // namespace oktett

extern "C" __attribute__((visibility("default"))) oktett::HttpServer* oktett_http_server();
oktett::HttpServer* oktett_http_server() { return new oktett::OwnServer; }
