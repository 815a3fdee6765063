#include "io/display/display.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "core/error.h"
#include "core/phase.h"

namespace oktett::display_test {
namespace {

using Clock = std::chrono::steady_clock;

/// A TCP server on a free port of the loopback device that collects what one client sends.
class Server {
 public:
  Server() : listener_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(listener_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(listener_, 1), 0);
    getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  ~Server() {
    if (thread_.joinable()) thread_.join();
    if (client_ >= 0) close(client_);
    close(listener_);
  }

  std::string name() const { return "127.0.0.1:" + std::to_string(port_); }
  int port() const { return port_; }

  /// Accepts one client and reads until it leaves, or until `most` bytes came; then it hangs up.
  void read_in_background(std::size_t most = ~std::size_t{0}) {
    thread_ = std::thread([this, most] {
      client_ = accept(listener_, nullptr, nullptr);
      char buffer[4096];
      ssize_t count;
      while (bytes_.size() < most && (count = recv(client_, buffer, sizeof buffer, 0)) > 0)
        bytes_.insert(bytes_.end(), buffer, buffer + count);
      close(client_);
      client_ = -1;
    });
  }
  const std::vector<char>& received() {
    thread_.join();
    return bytes_;
  }

 private:
  int listener_, client_ = -1, port_ = 0;
  std::thread thread_;
  std::vector<char> bytes_;
};

/// Reads the fields of packets one after the other.
class Reader {
 public:
  explicit Reader(const std::vector<char>& bytes) : bytes_(bytes) {}
  template <class T>
  T number() {
    T v{};
    EXPECT_LE(at_ + sizeof v, bytes_.size());
    if (at_ + sizeof v <= bytes_.size()) std::memcpy(&v, bytes_.data() + at_, sizeof v);
    at_ += sizeof v;
    return v;
  }
  std::string text() {
    std::string s;
    while (at_ < bytes_.size() && bytes_[at_] != 0) s += bytes_[at_++];
    ++at_;
    return s;
  }
  std::size_t position() const { return at_; }
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  const std::vector<char>& bytes_;
  std::size_t at_ = 0;
};

Picture picture_with_planes(std::uint32_t width, std::uint32_t height) {
  Picture picture;
  picture.width = width, picture.height = height;
  picture.x = 5, picture.y = 7, picture.full_width = width + 10, picture.full_height = height + 20;
  const char* names[] = {"R", "G", "B", "A"};
  for (int c = 0; c < 4; ++c) {
    PicturePlane plane{names[c], PlaneType::half_float, Column<float>(std::size_t{width} * height), {}};
    for (std::size_t i = 0; i < plane.values.size(); ++i)
      plane.values[i] = static_cast<float>(1000 * c) + static_cast<float>(i);
    picture.planes.push_back(plane);
  }
  picture.planes.push_back(
      {"Z", PlaneType::single_float, Column<float>(std::size_t{width} * height, 1.0f), {}});
  return picture;
}

TEST(Display, SendsTheImageAndItsTiles) {
  Server server;
  server.read_in_background();
  const Picture picture = picture_with_planes(8, 6);
  {
    Display display(server.name(), "a picture");
    display.update(picture, {2, 1, 3, 2});
    display.update(picture, {0, 0, 8, 6});
    display.finish();
    EXPECT_EQ(display.take_warning(), "");
  }
  const std::vector<char>& bytes = server.received();
  Reader in(bytes);
  const auto size = in.number<std::uint32_t>();
  EXPECT_EQ(in.number<std::uint8_t>(), 4);  // create image
  EXPECT_EQ(in.number<std::uint8_t>(), 1);  // to the front
  EXPECT_EQ(in.text(), "a picture");
  EXPECT_EQ(in.number<std::uint32_t>(), 18u);
  EXPECT_EQ(in.number<std::uint32_t>(), 26u);
  EXPECT_EQ(in.number<std::uint32_t>(), 4u);
  for (const char* name : {"R", "G", "B", "A"}) EXPECT_EQ(in.text(), name);
  EXPECT_EQ(in.position(), size);

  for (const FinishedTile& tile : {FinishedTile{2, 1, 3, 2}, FinishedTile{0, 0, 8, 6}}) {
    const std::size_t start = in.position();
    const auto update_size = in.number<std::uint32_t>();
    EXPECT_EQ(in.number<std::uint8_t>(), 5);  // update image, several channels
    EXPECT_EQ(in.number<std::uint8_t>(), 0);
    EXPECT_EQ(in.text(), "a picture");
    EXPECT_EQ(in.number<std::uint32_t>(), 4u);
    for (const char* name : {"R", "G", "B", "A"}) EXPECT_EQ(in.text(), name);
    EXPECT_EQ(in.number<std::uint32_t>(), 5 + tile.x);
    EXPECT_EQ(in.number<std::uint32_t>(), 7 + tile.y);
    EXPECT_EQ(in.number<std::uint32_t>(), tile.width);
    EXPECT_EQ(in.number<std::uint32_t>(), tile.height);
    for (std::uint32_t c = 0; c < 4; ++c)
      for (std::uint32_t y = 0; y < tile.height; ++y)
        for (std::uint32_t x = 0; x < tile.width; ++x)
          EXPECT_EQ(in.number<float>(), static_cast<float>(1000 * c + (tile.y + y) * 8 + tile.x + x));
    EXPECT_EQ(in.position() - start, update_size);
  }
  EXPECT_TRUE(in.at_end());
}

TEST(Display, AbsentServerCostsOneWarningAndNoTime) {
  int free_port = 0;
  {
    const Server server;
    free_port = server.port();
  }
  const auto start = Clock::now();
  Display display("127.0.0.1:" + std::to_string(free_port), "a");
  const Picture picture = picture_with_planes(64, 64);
  for (int i = 0; i < 100; ++i) display.update(picture, {0, 0, 64, 64});
  display.finish();
  EXPECT_LT(seconds_since(start), 3);
  const std::string warning = display.take_warning();
  EXPECT_NE(warning.find(std::to_string(free_port)), std::string::npos) << warning;
  EXPECT_EQ(display.take_warning(), "");
}

// The listener exists but nobody accepts or reads: buffers fill up, the render goes on.
TEST(Display, SilentServerIsGivenUp) {
  const Server server;
  const auto start = Clock::now();
  Display display(server.name(), "a", {500, 300, 500});
  const Picture picture = picture_with_planes(512, 512);
  for (int i = 0; i < 8; ++i) display.update(picture, {0, 0, 512, 512});
  EXPECT_LT(seconds_since(start), 5);
  const auto finishing = Clock::now();
  display.finish();
  EXPECT_LT(seconds_since(finishing), 1);
  EXPECT_NE(display.take_warning(), "");
}

TEST(Display, ServerThatHangsUpIsGivenUp) {
  Server server;
  server.read_in_background(1000);
  Display display(server.name(), "a");
  const Picture picture = picture_with_planes(256, 256);
  for (int i = 0; i < 30; ++i) {
    display.update(picture, {0, 0, 256, 256});
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  display.finish();
  EXPECT_NE(display.take_warning(), "");
}

TEST(Display, DestructionDoesNotWait) {
  const Server server;
  const auto start = Clock::now();
  {
    Display display(server.name(), "a");
    display.update(picture_with_planes(1024, 1024), {0, 0, 1024, 1024});
  }
  EXPECT_LT(seconds_since(start), 2);
}

TEST(Display, RefusesWhatIsNoAddress) {
  for (const char* server : {"", "host:", "host:x", "host:0", "host:70000", "host:14158x", "a:b:c"})
    EXPECT_THROW(Display(server, "a"), Error) << server;
}

}  // namespace
}  // namespace oktett::display_test
