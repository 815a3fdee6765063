#pragma once
/// \file The cache of texture images. Not for other folders.

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/texture.h>

#include <memory>
#include <string>

namespace oktett::oiio {

constexpr int kStoredChannel = 3;        ///< in the cache: the first of those as stored
constexpr int kMostTextureChannels = 7;  ///< of an image in the cache

/// An image file, as the textures that show it ask for it.
struct ImageSource {
  std::string path;
  std::shared_ptr<const std::string> content{};  ///< if not null, the bytes of the file
  bool alpha = false;                            ///< some texture needs the alpha channel

  /// In the cache: linear R, G, B, then the first three as stored, and alpha if it is needed.
  int channels() const { return alpha ? kMostTextureChannels : kMostTextureChannels - 1; }
};

/// An image that has been opened, and what it is read from.
struct OpenedImage {
  explicit OpenedImage(const ImageSource& source);

  std::shared_ptr<const std::string> content;
  std::unique_ptr<OIIO::Filesystem::IOMemReader> memory;
  OIIO::ImageInput::unique_ptr input;
};

/// The one texture system of the process, with a cache of its own. It lives until the process ends:
/// version 2.4 of the library frees it in a way that memory checkers refuse.
OIIO::TextureSystem& texture_system();

/// Lets the cache grow by `bytes`, which may be negative. The cache must hold everything at once: an image
/// that is dropped costs a whole decoding to bring back.
void reserve_memory(double bytes);

/// Makes an entry of the cache for an image file. The cache keeps about a kilobyte for each entry until the
/// process ends, so entries that were removed are used again.
int add_to_cache(const ImageSource& source);

/// Drops the image of an entry, whose handles are not to be used from then on.
void remove_from_cache(int entry);

/// What texture_system() calls the entry.
OIIO::ustring entry_name(int entry);

/// Whether memory ran out in a thread of the library since forget_refused_memory(): such exceptions become
/// messages about a file.
bool memory_was_refused();
void forget_refused_memory();

}  // namespace oktett::oiio
