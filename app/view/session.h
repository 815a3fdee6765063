#pragma once
/// \file What `oktett view` holds: the view that a page asks for, and the session.
///
/// A session is a scene that is being looked at: it is read, rendered in finer and finer passes as the view
/// changes, and read again when one of its files changes.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "app/render_options.h"
#include "app/view/canvas.h"
#include "core/error.h"
#include "io/image/metadata.h"
#include "io/image/texture.h"
#include "render/picture/prepared_scene.h"

namespace oktett {

// ---- What a page may change about the picture: as text from the page, and back.

/// The view that a page asks for.
struct ViewState {
  Camera camera;
  Tone tone;
  std::string layer = "beauty";
};

/// Changes `state` by lines of the form key=value, e.g. "from=1 2 3". Keys: from, at, up, fov, height, focus,
/// tone, exposure, layer. Throws Error for anything else, for numbers that are not finite, and for cameras
/// that no scene file could have.
ViewState parse_view(std::string_view text, ViewState state);

/// The camera of a scene that counts from `origin` as the part of a scene file that gives the same camera,
/// number by number where the origin is zero. What moves it is left out.
std::string camera_yaml(Camera camera, const Vec3d& origin);

// ---- Whether files have changed, by asking for their times and sizes.

class WatchedFiles {
 public:
  /// Watches these from now on.
  void watch(const std::vector<std::string>& paths);
  /// Whether any has changed since `watch` or the last call that said so.
  bool have_changed();

 private:
  std::map<std::string, std::string> seen_;  ///< what was found, by path
};

// ---- The session.

/// What a page is told, apart from pixels.
struct SessionStatus {
  std::uint64_t view = 0;  ///< grows with each change of the view or the scene
  std::uint32_t width = 0, height = 0, samples = 0, wanted_samples = 0;
  bool settled = false;  ///< the picture is the one that `oktett render` gives
  ViewState state;
  std::uint64_t edits = 0;  ///< of the scene, read without an error
  std::vector<std::string> layers;
  ViewState home;  ///< the view of the scene file
  Vec3d origin;    ///< Scene::origin, from which all places count
  Vec3d center;    ///< of the scene's bounds
  double radius = 1;
  std::optional<Error> error;  ///< why the scene could not be read again, and the last good one is still
                               ///< shown; or why it cannot be rendered
  std::string error_line;      ///< the text of its line
};

/// What went wrong, in words for people.
std::string reason_of(const std::exception& error);

/// All functions may be called by any thread.
class Session {
 public:
  /// Reads the scene and begins to render. Throws Error.
  Session(const RenderArguments& arguments, std::string command_line);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Applies lines of parse_view; returns the number of the view. Throws Error.
  std::uint64_t change(const std::string& lines);
  SessionStatus status() const;
  /// The pixels that changed since `version`; waits up to `wait` for some. See Canvas::news.
  template <class Status>
  std::string frame(std::uint64_t version, int wait, const Status& status) {
    return canvas_.news(version, wait, status);
  }
  /// See pick_json.
  std::string pick(std::uint32_t x, std::uint32_t y);
  std::string camera() const;
  /// The bytes of the finished picture in a file of this extension, ".png" or ".exr". Waits until it is
  /// finished. Throws Error if the view changes before, the session ends or `is_gone`, which is asked now and
  /// then, returns true; std::runtime_error if the picture cannot be rendered.
  std::string save(const std::string& extension, const std::function<bool()>& is_gone);
  void stop();

 private:
  /// A scene and what belongs to it.
  struct Loaded {
    std::shared_ptr<PreparedScene> prepared;
    std::unique_ptr<ImageTextures> textures;
    std::vector<std::string> files;
    std::shared_ptr<const PhotonMap> photons;
  };

  Loaded load(std::vector<std::string>& files) const;
  void adopt(Loaded loaded);
  /// Reads the scene again; false if it cannot be read.
  bool reload();
  void work();
  void watch();
  /// Renders all passes of the present view; returns early if it changes.
  /// `only_last`: the last pass alone.
  void render_view(bool only_last);
  bool render_pass(const ViewState& state, std::uint64_t view, std::uint32_t scale, std::uint32_t samples,
                   bool last);
  bool has_changed(std::uint64_t view) const;
  /// There is a finished picture of the present view, with all planes if `layers`. Needs the lock.
  bool is_finished(bool layers) const;

  const RenderArguments arguments_;
  const std::string command_line_;
  Isa isa_;
  std::unique_ptr<SceneCache> cache_;
  Canvas canvas_;
  std::mutex using_scene_;  ///< held by whoever uses `loaded_`
  Loaded loaded_;

  mutable std::mutex mutex_;  ///< for all below
  std::condition_variable changed_;
  SessionStatus status_;
  Film film_;                  ///< of the scene
  bool wants_layers_ = false;  ///< the finished picture shall have all planes
  bool reload_wanted_ = false, stopping_ = false;
  std::shared_ptr<const Picture> finished_;  ///< of the present view; null while there is none
  ImageMetadata metadata_;                   ///< of `finished_`
  std::optional<Error> failure_;             ///< why the present view cannot be rendered
  WatchedFiles files_;

  std::atomic<bool> cancel_{false};
  double seconds_per_pixel_ = 1e-6;  ///< of one sample, by the last coarse pass
  std::thread worker_, watcher_;
};

}  // namespace oktett
