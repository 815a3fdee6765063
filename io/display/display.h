#pragma once
/// \file Live preview: sends finished tiles to an image viewer that speaks the protocol of tev.

#include <memory>
#include <string>

#include "render/picture.h"
#include "render/render_options.h"

namespace oktett {

/// How long a viewer may take before it is given up; milliseconds.
struct DisplayTimeouts {
  int connect = 2000;  ///< to accept the connection
  int stall = 3000;    ///< without taking any data
  int finish = 3000;   ///< for what is still queued when the render is done
};

/// A picture in a viewer. All talking is done by a thread of its own: no call but `finish` ever waits for the
/// viewer. One that is absent, slow or goes away costs a warning and the preview, never the render.
class Display {
 public:
  /// `server` is host:port, host or :port; 127.0.0.1 and 14158 are the defaults. Throws Error if it is none
  /// of these. `title` names the picture in the viewer.
  Display(const std::string& server, const std::string& title, const DisplayTimeouts& timeouts = {});
  /// Drops what is still queued.
  ~Display();
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

  /// Queues the planes R, G, B and A (those that exist) of `tile`; the first call announces the picture in
  /// its full frame.
  void update(const Picture& picture, const FinishedTile& tile);
  /// Waits until everything is sent, at most for the time allowed, and ends the connection.
  void finish();
  /// What went wrong, once: empty if nothing did or it was already reported.
  std::string take_warning();

 private:
  struct Link;
  std::shared_ptr<Link> link_;
  std::string title_;
  bool announced_ = false;
};

}  // namespace oktett
