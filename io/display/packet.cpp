#include "io/display/packet.h"

#include <bit>

namespace oktett {

namespace {

enum class PacketType : std::uint8_t { create_image = 4, update_image_v2 = 5 };

class Writer {
 public:
  explicit Writer(PacketType type) {
    number(0u);
    byte(static_cast<std::uint8_t>(type));
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
  void reserve(std::size_t more) { packet_.reserve(packet_.size() + more); }

  Packet finished() {
    const auto size = static_cast<std::uint32_t>(packet_.size());
    for (std::size_t i = 0; i < 4; ++i) packet_[i] = static_cast<std::byte>(size >> (8 * i));
    return std::move(packet_);
  }

 private:
  Packet packet_;
};

void channel_names(Writer& writer, std::span<const PicturePlane* const> planes) {
  for (const PicturePlane* plane : planes) writer.text(plane->name);
}

}  // namespace

Packet create_image_packet(const std::string& title, std::uint32_t width, std::uint32_t height,
                           std::span<const PicturePlane* const> planes) {
  Writer writer(PacketType::create_image);
  writer.byte(1);
  writer.text(title);
  writer.number(width);
  writer.number(height);
  writer.number(static_cast<std::uint32_t>(planes.size()));
  channel_names(writer, planes);
  return writer.finished();
}

Packet update_image_packet(const std::string& title, const Picture& picture, const FinishedTile& tile,
                           std::span<const PicturePlane* const> planes) {
  Writer writer(PacketType::update_image_v2);
  writer.byte(0);
  writer.text(title);
  writer.number(static_cast<std::uint32_t>(planes.size()));
  channel_names(writer, planes);
  writer.number(picture.x + tile.x);
  writer.number(picture.y + tile.y);
  writer.number(tile.width);
  writer.number(tile.height);
  writer.reserve(sizeof(float) * planes.size() * tile.width * tile.height);
  for (const PicturePlane* plane : planes)
    for (std::size_t y = tile.y; y < std::size_t{tile.y} + tile.height; ++y)
      for (std::size_t x = tile.x; x < std::size_t{tile.x} + tile.width; ++x)
        writer.number(plane->values[y * picture.width + x]);
  return writer.finished();
}

}  // namespace oktett
