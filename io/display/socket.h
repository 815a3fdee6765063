#pragma once
/// \file A TCP connection to a server that cannot be relied upon.

#include <atomic>
#include <cstddef>
#include <span>
#include <string>

namespace oktett {

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

}  // namespace oktett
