#pragma once
/// \file The two packets of tev's protocol that a renderer needs, after the source of tev
/// (include/tev/Ipc.h). A packet is its own size in bytes as 32 bits, an 8-bit type, then fields: integers
/// and floats little-endian, flags as one byte, texts ended by a zero.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/picture.h"
#include "render/render.h"

namespace oktett {

using Packet = std::vector<std::byte>;

/// Announces an image of `width` x `height` pixels with these channels, all black; brings it to the front.
Packet create_image_packet(const std::string& title, std::uint32_t width, std::uint32_t height,
                           std::span<const PicturePlane* const> planes);

/// Fills a rectangle of several channels at once. `tile` is in the picture's own coordinates, the packet in
/// those of the full frame.
Packet update_image_packet(const std::string& title, const Picture& picture, const FinishedTile& tile,
                           std::span<const PicturePlane* const> planes);

}  // namespace oktett
