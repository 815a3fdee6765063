#include "io/display/socket.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <memory>
#include <system_error>

namespace oktett {
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

}  // namespace oktett
