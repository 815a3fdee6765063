#pragma once
/// \file The pixels that pages show, and which of them are new.

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "core/box.h"
#include "render/picture.h"
#include "render/picture/render.h"
#include "render/scene.h"

namespace oktett {

// ---- The layers of a picture that a page can show, as eight-bit pixels.

/// What is shown of a picture.
struct Layer {
  std::string name = "beauty";
  Tone tone;
  double near = 0, far = 1;  ///< depths that show as white and black
  Box bounds;                ///< places in it show as colours
};

/// The names of all layers of pictures of `scene`.
std::vector<std::string> layer_names(const Scene& scene);
/// Whether a layer needs the planes of RenderOptions::data_layers.
inline bool needs_data(const std::string& layer) { return layer != "beauty"; }

/// RGBA bytes of a tile, row by row. For beauty the pixels of a PNG file of the same picture.
std::string layer_pixels(const Picture& picture, const FinishedTile& tile, const Layer& layer);

/// Eight-bit pixels in the tiles that were rendered. All functions may be called by several threads.
class Canvas {
 public:
  /// A new pass: pictures of the view with so many pixels. If `coarse`, its only tile is the whole picture,
  /// which pages stretch over the canvas.
  void begin(std::uint64_t view, std::uint32_t width, std::uint32_t height, bool coarse);
  /// Shows a tile of `picture`.
  void show(const Picture& picture, const FinishedTile& tile, const Layer& layer);
  /// Makes waiting calls of `news` return, as when the status has changed.
  void wake();
  /// From now on no call of `news` waits.
  void close();

  /// Waits until something is newer than `version`, at most `wait` ms. A little-endian u32 count of bytes of
  /// a JSON header, the header, then the RGBA bytes of all its tiles one after the other. `status`, a JSON
  /// object without its closing brace, begins the header.
  template <class Status>
  std::string news(std::uint64_t version, int wait, const Status& status);

 private:
  struct Tile {
    std::uint64_t version = 0;
    FinishedTile place;
    std::string bytes;
  };
  std::string describe(std::uint64_t version, std::string header) const;

  std::mutex mutex_;
  std::condition_variable grown_;
  std::uint64_t version_ = 1, view_ = 0;
  std::uint32_t width_ = 0, height_ = 0;
  Tile coarse_;
  bool coarse_pass_ = false, closed_ = false;
  std::vector<Tile> tiles_;  ///< of the passes of full size; a newer tile replaces the one of its place
};

template <class Status>
std::string Canvas::news(std::uint64_t version, int wait, const Status& status) {
  std::unique_lock lock(mutex_);
  grown_.wait_for(lock, std::chrono::milliseconds(wait), [&] { return closed_ || version_ > version; });
  lock.unlock();
  std::string header = status();
  lock.lock();
  return describe(version, std::move(header));
}

}  // namespace oktett
