#include "io/display/display.h"

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/display/packet.h"
#include "io/display/socket.h"

namespace oktett {

namespace {

constexpr std::size_t kMostQueuedBytes = std::size_t{256} << 20;

struct Address {
  std::string host = "127.0.0.1";
  std::string port = "14158";
};

Address parse_address(const std::string& server) {
  Address address;
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
  Address address;
  DisplayTimeouts timeouts;
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Packet> queue;
  std::size_t queued_bytes = 0;
  bool closing = false;  ///< nothing more will be queued
  bool ended = false;    ///< the thread has left, for good or bad
  std::string problem;

  void run();
  bool next(Packet& packet);
  void end(const std::string& what);
  void push(Packet packet);
};

/// The thread: connect, then send packets as they come.
void Display::Link::run() {
  ClientSocket socket(&stop);
  std::string what = socket.connect(address.host, address.port, timeouts.connect);
  Packet packet;
  while (what.empty() && next(packet)) what = socket.send(packet, timeouts.stall);
  end(what);
}

bool Display::Link::next(Packet& packet) {
  std::unique_lock lock(mutex);
  changed.wait(lock, [this] { return !queue.empty() || closing || stop; });
  if (queue.empty() || stop) return false;
  packet = std::move(queue.front());
  queue.pop_front();
  queued_bytes -= packet.size();
  return true;
}

/// Ends the preview, with a reason or without; the first reason stays.
void Display::Link::end(const std::string& what) {
  const std::lock_guard lock(mutex);
  ended = true;
  queue.clear();
  queued_bytes = 0;
  if (!what.empty() && !stop)
    problem = "no live preview: display server " + address.host + ":" + address.port + ": " + what;
  stop = true;
  changed.notify_all();
}

void Display::Link::push(Packet packet) {
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
