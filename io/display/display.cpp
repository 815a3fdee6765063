#include "io/display/display.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "core/error.h"

namespace oktett {

// ---- A TCP connection to a server that cannot be relied upon.

/// A TCP client whose every wait is bounded and can be called off.
class ClientSocket {
 public:
  /// All waits end early once `*stop` is true; it must outlive the socket.
  explicit ClientSocket(const std::atomic<bool>* stop) : stop_(stop) {}
  ~ClientSocket();
  ClientSocket(const ClientSocket&) = delete;
  ClientSocket& operator=(const ClientSocket&) = delete;

  /// Tries the addresses of `host` in turn, each for at most `timeout` milliseconds. Resolving a name takes
  /// as long as the system allows. Returns what went wrong, or an empty text.
  std::string connect(const std::string& host, const std::string& port, int timeout);
  /// Sends all of `bytes`; gives up after `timeout` milliseconds in which the peer took nothing.
  std::string send(std::span<const std::byte> bytes, int timeout);

 private:
  bool wait_writable(int timeout) const;

  const std::atomic<bool>* stop_;
  int descriptor_ = -1;
};

namespace {

constexpr int kSliceMilliseconds = 50;

std::string reason(int error) { return std::error_code(error, std::generic_category()).message(); }

}  // namespace

ClientSocket::~ClientSocket() {
  if (descriptor_ >= 0) close(descriptor_);
}

/// Waits in slices, to notice a stop. False if the time is over or the wait was called off.
bool ClientSocket::wait_writable(int timeout) const {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::milliseconds(timeout);
  while (!*stop_ && Clock::now() < end) {
    pollfd waiting{descriptor_, POLLOUT, 0};
    if (poll(&waiting, 1, std::min(timeout, kSliceMilliseconds)) > 0) return true;
  }
  return false;
}

std::string ClientSocket::connect(const std::string& host, const std::string& port, int timeout) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(host.c_str(), port.c_str(), &hints, &found); error != 0)
    return gai_strerror(error);
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> addresses(found, &freeaddrinfo);

  std::string problem = "no address";
  for (const addrinfo* address = found; address != nullptr && !*stop_; address = address->ai_next) {
    descriptor_ =
        socket(address->ai_family, address->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, address->ai_protocol);
    if (descriptor_ < 0) {
      problem = reason(errno);
      continue;
    }
    int error = ::connect(descriptor_, address->ai_addr, address->ai_addrlen) == 0 ? 0 : errno;
    if (error == EINPROGRESS) {
      socklen_t size = sizeof error;
      if (!wait_writable(timeout))
        error = ETIMEDOUT;
      else if (getsockopt(descriptor_, SOL_SOCKET, SO_ERROR, &error, &size) != 0)
        error = errno;
    }
    if (error == 0) {
      const int on = 1;
      setsockopt(descriptor_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
      return {};
    }
    problem = reason(error);
    close(descriptor_);
    descriptor_ = -1;
  }
  return problem;
}

std::string ClientSocket::send(std::span<const std::byte> bytes, int timeout) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent >= 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      if (!wait_writable(timeout)) return *stop_ ? "stopped" : "it takes no data";
    } else if (errno != EINTR) {
      return reason(errno);
    }
  }
  return {};
}

struct DisplayAddress {
  std::string host = "127.0.0.1";
  std::string port = "14158";
};

namespace {

constexpr std::size_t kMostQueuedBytes = std::size_t{256} << 20;

DisplayAddress parse_address(const std::string& server) {
  DisplayAddress address;
  // An IPv6 address has colons of its own and stands in brackets: [::1]:14158.
  const std::size_t bracket = server.starts_with('[') ? server.find(']') : std::string::npos;
  const std::size_t colon = server.find(':', bracket == std::string::npos ? 0 : bracket);
  std::string host = server.substr(0, colon);
  if (bracket != std::string::npos) host = server.substr(1, bracket - 1);
  if (!host.empty()) address.host = host;
  if (colon != std::string::npos) address.port = server.substr(colon + 1);
  const bool digits =
      !address.port.empty() && address.port.size() <= 5 &&
      std::all_of(address.port.begin(), address.port.end(), [](unsigned char c) { return std::isdigit(c); });
  if (server.empty() || !digits || std::stoi(address.port) < 1 || std::stoi(address.port) > 65535)
    throw Error("the display server '" + server + "' is not of the form host:port");
  return address;
}

using Packet = std::vector<std::byte>;

enum class PacketType : std::uint8_t { create_image = 4, update_image_v2 = 5 };

/// Writes a packet of tev's protocol, after the source of tev (include/tev/Ipc.h): its own size in bytes as
/// 32 bits, an 8-bit type, then fields: integers and floats little-endian, flags as one byte, texts ended by
/// a zero.
class Writer {
 public:
  Writer(PacketType type, bool flag, const std::string& title) {
    number(0u);
    byte(static_cast<std::uint8_t>(type));
    byte(flag ? 1 : 0);
    text(title);
  }

  void byte(std::uint8_t v) { packet_.push_back(static_cast<std::byte>(v)); }
  void number(std::uint32_t v) {
    for (int shift = 0; shift < 32; shift += 8) byte(static_cast<std::uint8_t>(v >> shift));
  }
  void number(float v) { number(std::bit_cast<std::uint32_t>(v)); }
  void text(const std::string& s) {
    // A zero byte in a title would shift all that follows.
    for (const char c : s)
      if (c != '\0') byte(static_cast<std::uint8_t>(c));
    byte(0);
  }
  void channels(std::span<const PicturePlane* const> planes) {
    number(static_cast<std::uint32_t>(planes.size()));
    for (const PicturePlane* plane : planes) text(plane->name);
  }
  void reserve(std::size_t more) { packet_.reserve(packet_.size() + more); }

  Packet finished() {
    const auto size = static_cast<std::uint32_t>(packet_.size());
    for (std::size_t i = 0; i < 4; ++i) packet_[i] = static_cast<std::byte>(size >> (8 * i));
    return std::move(packet_);
  }

 private:
  Packet packet_;
};

/// Announces an image of `width` x `height` pixels with these channels, all black; brings it to the front.
Packet create_image_packet(const std::string& title, std::uint32_t width, std::uint32_t height,
                           std::span<const PicturePlane* const> planes) {
  Writer writer(PacketType::create_image, true, title);
  writer.number(width);
  writer.number(height);
  writer.channels(planes);
  return writer.finished();
}

/// Fills a rectangle of several channels at once. `tile` is in the picture's own coordinates, the packet in
/// those of the full frame.
Packet update_image_packet(const std::string& title, const Picture& picture, const FinishedTile& tile,
                           std::span<const PicturePlane* const> planes) {
  Writer writer(PacketType::update_image_v2, false, title);
  writer.channels(planes);
  for (const std::uint32_t v : {picture.x + tile.x, picture.y + tile.y, tile.width, tile.height})
    writer.number(v);
  writer.reserve(sizeof(float) * planes.size() * tile.width * tile.height);
  for (const PicturePlane* plane : planes)
    for (std::size_t y = tile.y; y < std::size_t{tile.y} + tile.height; ++y)
      for (std::size_t x = tile.x; x < std::size_t{tile.x} + tile.width; ++x)
        writer.number(plane->values[y * picture.width + x]);
  return writer.finished();
}

std::vector<const PicturePlane*> shown_planes(const Picture& picture) {
  std::vector<const PicturePlane*> planes;
  for (const char* name : {"R", "G", "B", "A"}) {
    const PicturePlane* plane = picture.find(name);
    if (plane != nullptr && plane->type != PlaneType::unsigned_int) planes.push_back(plane);
  }
  return planes;
}

}  // namespace

/// What the display and its thread share. The thread holds on to it: a name that takes minutes to resolve
/// must not keep the display from being destroyed.
struct Display::Link {
  DisplayAddress address;
  DisplayTimeouts timeouts;
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Packet> queue;
  std::size_t queued_bytes = 0;
  bool closing = false;  ///< nothing more will be queued
  bool ended = false;    ///< the thread has left, for good or bad
  std::string problem;

  /// The thread: connect, then send packets as they come.
  void run() {
    ClientSocket socket(&stop);
    std::string what = socket.connect(address.host, address.port, timeouts.connect);
    Packet packet;
    while (what.empty() && next(packet)) what = socket.send(packet, timeouts.stall);
    end(what);
  }

  bool next(Packet& packet) {
    std::unique_lock lock(mutex);
    changed.wait(lock, [this] { return !queue.empty() || closing || stop; });
    if (queue.empty() || stop) return false;
    packet = std::move(queue.front());
    queue.pop_front();
    queued_bytes -= packet.size();
    return true;
  }

  /// Ends the preview, with a reason or without; the first reason stays.
  void end(const std::string& what) {
    const std::lock_guard lock(mutex);
    ended = true;
    queue.clear();
    queued_bytes = 0;
    if (!what.empty() && !stop)
      problem = "no live preview: display server " + address.host + ":" + address.port + ": " + what;
    stop = true;
    changed.notify_all();
  }

  void push(Packet packet) {
    {
      const std::lock_guard lock(mutex);
      if (ended || stop) return;
      if (queued_bytes + packet.size() <= kMostQueuedBytes) {
        queued_bytes += packet.size();
        queue.push_back(std::move(packet));
        changed.notify_all();
        return;
      }
    }
    end("it is too slow");
  }
};

Display::Display(const std::string& server, const std::string& title, const DisplayTimeouts& timeouts)
    : link_(std::make_shared<Link>()), title_(title) {
  link_->address = parse_address(server);
  link_->timeouts = timeouts;
  std::thread([link = link_] { link->run(); }).detach();
}

Display::~Display() {
  const std::lock_guard lock(link_->mutex);
  link_->stop = true;
  link_->changed.notify_all();
}

void Display::update(const Picture& picture, const FinishedTile& tile) {
  if (link_->stop) return;
  const std::vector<const PicturePlane*> planes = shown_planes(picture);
  if (planes.empty() || tile.width == 0 || tile.height == 0) return;
  if (!announced_)
    link_->push(create_image_packet(title_, std::max(picture.full_width, picture.x + picture.width),
                                    std::max(picture.full_height, picture.y + picture.height), planes));
  announced_ = true;
  link_->push(update_image_packet(title_, picture, tile, planes));
}

void Display::finish() {
  std::unique_lock lock(link_->mutex);
  link_->closing = true;
  link_->changed.notify_all();
  const auto allowed = std::chrono::milliseconds(link_->timeouts.finish);
  if (link_->changed.wait_for(lock, allowed, [this] { return link_->ended; })) return;
  lock.unlock();
  link_->end("it is too slow");
}

std::string Display::take_warning() {
  const std::lock_guard lock(link_->mutex);
  return std::exchange(link_->problem, {});
}

}  // namespace oktett
