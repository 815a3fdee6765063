#include "app/view/session.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string>

#include "app/command_line.h"
#include "app/json.h"
#include "app/scene_loading.h"
#include "app/text.h"
#include "core/error.h"
#include "core/isa.h"
#include "io/image/image.h"
#include "io/text/files.h"
#include "render/camera.h"
#include "render/hit_object.h"
#include "render/picture/prepared_scene.h"

namespace oktett {

// ---- What a page may change.

namespace {

/// Coordinates beyond this are no places that floats can tell apart.
constexpr double kFarthest = 1e15;

double number(std::string_view key, std::string_view text) {
  double value = 0;
  if (!parse_number(text, value) || !(std::abs(value) <= kFarthest))
    throw Error(fmt::format("{}: expected a number", key));
  return value;
}

double positive(std::string_view key, std::string_view text) {
  const double value = number(key, text);
  if (!(value > 0)) throw Error(fmt::format("{}: expected a number above 0", key));
  return value;
}

Vec3d vector(std::string_view key, std::string_view text) {
  const std::size_t first = text.find(' '), second = text.find(' ', first + 1);
  if (first == std::string_view::npos || second == std::string_view::npos)
    throw Error(fmt::format("{}: expected three numbers", key));
  return {number(key, text.substr(0, first)), number(key, text.substr(first + 1, second - first - 1)),
          number(key, text.substr(second + 1))};
}

/// The same conditions as in a scene file.
void check(const Camera& camera) {
  const Vec3d view = camera.at - camera.from;
  const double distance = max_component(abs(view)), up = max_component(abs(camera.up));
  if (!(distance > 0) || !(up > 0)) throw Error("the camera has no direction");
  if (length(cross(normalize(view / distance), normalize(camera.up / up))) < 1e-9)
    throw Error("the camera's 'up' is parallel to its view direction");
  if (!(camera.fov > 0 && camera.fov < 180)) throw Error("fov: expected more than 0 and less than 180");
}

void set(std::string_view key, std::string_view text, ViewState& state) {
  Camera& camera = state.camera;
  if (key == "from") {
    camera.from = vector(key, text);
  } else if (key == "at") {
    camera.at = vector(key, text);
  } else if (key == "up") {
    camera.up = vector(key, text);
  } else if (key == "fov") {
    camera.fov = positive(key, text);
  } else if (key == "height") {
    camera.height = positive(key, text);
  } else if (key == "focus") {
    camera.focus = positive(key, text);
    camera.focus_at.reset();
  } else if (key == "tone") {
    state.tone.kind = choice_of<ToneKind>("tone", std::string(text), kToneKinds);
  } else if (key == "exposure") {
    state.tone.exposure = number(key, text);
    if (!kExposures.contains(state.tone.exposure)) throw Error("exposure: out of range");
  } else if (key == "layer") {
    state.layer = text;
  } else {
    throw Error("unknown key");
  }
}

}  // namespace

ViewState parse_view(std::string_view text, ViewState state) {
  const Camera before = state.camera;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    const std::size_t sign = line.find('=');
    if (sign == std::string_view::npos) throw Error("expected lines of the form key=value");
    set(line.substr(0, sign), line.substr(sign + 1), state);
  }
  check(state.camera);
  const Camera& now = state.camera;
  const bool moved = !(now.from == before.from && now.at == before.at && now.up == before.up &&
                       now.fov == before.fov && now.height == before.height);
  if (moved) carry_frame(before, state.camera);
  return state;
}

std::string camera_yaml(Camera c, const Vec3d& origin) {
  c.from = origin + c.from, c.at = origin + c.at;
  if (c.focus_at) c.focus_at = origin + *c.focus_at;
  std::string out = fmt::format("camera:\n  from: {}\n", list_text(c.from));
  const bool parallel = c.along_axis == Projection::orthographic;
  if (!c.frame) out += fmt::format("  at: {}\n  up: {}\n", list_text(c.at), list_text(c.up));
  if (c.projection != Projection::perspective)
    out += fmt::format("  projection: {}\n", kProjections[static_cast<int>(c.projection)].name);
  if (c.frame)
    out += fmt::format("  frame: {{right: {}, up: {}, direction: {}}}\n", list_text(c.frame->right),
                       list_text(c.frame->up), list_text(c.frame->direction));
  else if (c.projection == Projection::perspective)
    out += fmt::format("  fov: {}\n", c.fov);
  else if (c.projection == Projection::orthographic || (c.projection == Projection::cylindrical && parallel))
    out += fmt::format("  height: {}\n", c.height);
  if (c.angle[1] > 0)
    out += fmt::format("  angle: [{}, {}]\n", c.angle[0], c.angle[1]);
  else if (c.angle[0] > 0)
    out += fmt::format("  angle: {}\n", c.angle[0]);
  if (c.projection == Projection::cylindrical)
    out += fmt::format("  axis: {}\n  along_axis: {}\n", kCylinderAxes[static_cast<int>(c.axis)].name,
                       kProjections[static_cast<int>(c.along_axis)].name);
  if (c.f_number > 0)
    out += fmt::format("  f_number: {}\n", c.f_number);
  else if (c.aperture > 0)
    out += fmt::format("  aperture: {}\n", c.aperture);
  if (c.focus_at)
    out += fmt::format("  focus: {}\n", list_text(*c.focus_at));
  else if (c.focus > 0)
    out += fmt::format("  focus: {}\n", c.focus);
  if (c.shutter[0] != 0 || c.shutter[1] != 1)
    out += fmt::format("  shutter: [{}, {}]\n", c.shutter[0], c.shutter[1]);
  return out;
}

// ---- Whether files have changed, by asking for their times and sizes.

/// What changes with each edit, whether a file is written in place or replaced; empty if there is none.
static std::string look_at(const std::string& path) {
  struct stat s {};
  if (stat(path.c_str(), &s) != 0) return "";
  return fmt::format("{} {} {} {}", s.st_mtim.tv_sec, s.st_mtim.tv_nsec, s.st_size, s.st_ino);
}

void WatchedFiles::watch(const std::vector<std::string>& paths) {
  seen_.clear();
  for (const std::string& path : paths) seen_[path] = look_at(path);
}

bool WatchedFiles::have_changed() {
  bool changed = false;
  for (auto& [path, seen] : seen_) {
    std::string now = look_at(path);
    changed |= now != seen;
    seen = std::move(now);
  }
  return changed;
}

// ---- What lies under a pixel.

namespace {

struct NameOfShape {
  std::string operator()(const MeshShape& s) const {
    return s.stroke_width > 0 ? "points and lines" : "mesh";
  }
  std::string operator()(const InstanceShape&) const { return "instance"; }
  std::string operator()(const CsgShape&) const { return "combination"; }
  std::string operator()(const SpheresShape&) const { return "spheres"; }
  std::string operator()(const ExactShape& s) const {
    return std::visit(
        [](const auto& form) -> std::string {
          if constexpr (requires { form.kShapeInfo.key; }) return form.kShapeInfo.key;
          return "exact surface";
        },
        s.form);
  }
  template <class S>
  std::string operator()(const S&) const {
    return S::kShapeInfo.key;
  }
};

/// An object, and its name; that of the combination around it if it has none.
struct FoundObject {
  const Object* object = nullptr;
  std::string name;
};

/// Object number `left` of those that World counts: combinations come before their operands, and those inside
/// of others do not count. If there are fewer, `left` becomes the rest.
FoundObject find_object(const std::vector<Object>& objects, const Object* whole, std::uint32_t& left) {
  for (const Object& object : objects) {
    const auto* combination = std::get_if<CsgShape>(&object.shape);
    if ((combination == nullptr || whole == nullptr) && left-- == 0)
      return {&object, object.name.empty() && whole != nullptr ? whole->name : object.name};
    if (combination == nullptr) continue;
    FoundObject inside = find_object(*combination->operands, whole != nullptr ? whole : &object, left);
    if (inside.object != nullptr) return inside;
  }
  return {};
}

/// The object that SurfaceInteraction::user numbers; see World.
FoundObject object_of(const Scene& scene, std::uint32_t user) {
  for (const Prototype& p : scene.prototypes)
    if (FoundObject found = find_object(p.objects, nullptr, user); found.object != nullptr) return found;
  return find_object(scene.objects, nullptr, user);
}

}  // namespace

/// What the ray through the centre of a pixel meets, as one JSON object; the pixel counts from the upper left
/// corner of the part of the frame that is rendered. Numbers have as many digits as give back the bits that
/// closest_hit and surface_interaction give; "place" is "point" in the coordinates of the files. Of a
/// combination the operand counts whose surface is hit. Motion is left out: things stand where they are at
/// time 0. Throws Error for a pixel outside. While another thread renders, `prepared` may be asked.
static std::string pick_json(const PreparedScene& prepared, const Camera& camera, const Film& film,
                             std::uint32_t x, std::uint32_t y, Isa isa) {
  const Scene& scene = prepared.scene();
  const World& world = prepared.world();
  const PixelWindow window = crop_window(film);
  if (x >= window.width() || y >= window.height()) throw Error("the pixel lies outside of the picture");
  const CameraFrame frame = camera_frame(camera, film);
  const Ray ray = camera_ray(frame, window.x0 + x + 0.5, window.y0 + y + 0.5);
  const Hit hit = closest_hit(seen_by(world, RayKind::camera), ray, isa);
  const std::string head =
      fmt::format("{{\"x\": {}, \"y\": {}, \"origin\": {}, \"direction\": {}, \"hit\": {}", x, y,
                  list_text(ray.origin), list_text(ray.direction), hit.valid());
  if (!hit.valid()) return head + "}";
  const SurfaceInteraction s = surface_interaction(*world.accel, ray, hit);
  const Material& material = material_at(world, s);
  const FoundObject object = object_of(scene, s.user);
  const std::string shape = object.object != nullptr ? std::visit(NameOfShape{}, object.object->shape) : "";
  return head + fmt::format(
                    ", \"t\": {}, \"u\": {}, \"v\": {}, \"item\": {}, \"instance\": {}, \"point\": {}, "
                    "\"place\": {}, \"normal\": {}, "
                    "\"shading_normal\": {}, \"object\": {}, \"object_name\": {}, \"primitive\": {}, "
                    "\"surface\": {}, "
                    "\"material\": {}, \"depth\": {}}}",
                    number_text(hit.t), number_text(hit.u), number_text(hit.v), hit.item, hit.instance,
                    list_text(s.position), list_text(scene.origin + Vec3d(s.position)),
                    list_text(s.geometric_normal), list_text(s.shading_normal), s.user,
                    JsonValue(object.name).text, s.primitive, JsonValue(shape).text,
                    JsonValue(material.name).text, camera_depth(frame, s.position));
}

namespace {

/// Line `where.line` of its file, without what would not fit on a page.
std::string line_of(const Location& where) {
  std::ifstream file(where.file);
  std::string line;
  for (int k = 0; k < where.line && std::getline(file, line); ++k) continue;
  return where.line > 0 ? line.substr(0, 200) : "";
}

std::string content(const std::filesystem::path& path) {
  std::ostringstream out;
  out << std::ifstream(path, std::ios::binary).rdbuf();
  return out.str();
}

}  // namespace

std::string reason_of(const std::exception& error) {
  return dynamic_cast<const std::bad_alloc*>(&error) != nullptr ? "out of memory" : error.what();
}

Session::Session(const RenderArguments& arguments, std::string command_line)
    : arguments_(arguments), command_line_(std::move(command_line)), isa_(choose_isa(arguments.isa)) {
  cache_ = open_cache(arguments_.cache);
  std::vector<std::string> files;
  adopt(load(files));
  files_.watch(files);
  loaded_.files = files;
  print_warnings(loaded_.prepared->scene().warnings);
  print_warnings(loaded_.textures->warnings());
  worker_ = std::thread([this] { work(); });
  watcher_ = std::thread([this] { watch(); });
}

Session::~Session() { stop(); }

void Session::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true, cancel_ = true;
  }
  changed_.notify_all();
  canvas_.close();
  for (std::thread* thread : {&worker_, &watcher_})
    if (thread->joinable()) thread->join();
}

Session::Loaded Session::load(std::vector<std::string>& files) const {
  const FilesRead read;
  struct Note {
    const FilesRead& read;
    std::vector<std::string>& files;
    ~Note() { files = read.paths(); }
  } const note{read, files};
  Loaded loaded;
  Scene scene = load_as_asked(arguments_);
  loaded.textures = std::make_unique<ImageTextures>(scene.textures, scene.texture_places);
  loaded.prepared = std::make_shared<PreparedScene>(std::move(scene), parse_bvh_option(arguments_.bvh));
  loaded.prepared->complete();
  return loaded;
}

void Session::adopt(Loaded loaded) {
  const Scene& scene = loaded.prepared->scene();
  const ViewState home{scene.camera, scene.film.tone, "beauty"};
  const Box& bounds = loaded.prepared->world().bounds;
  const std::scoped_lock lock(using_scene_, mutex_);
  const bool first = loaded_.prepared == nullptr;
  // Who has turned the view keeps it, unless the file's own view was edited.
  if (first || !(home.camera == status_.home.camera)) status_.state.camera = home.camera;
  if (first || !(home.tone == status_.home.tone)) status_.state.tone = home.tone;
  status_.home = home, status_.origin = scene.origin;
  const std::vector<std::string>& layers = status_.layers = layer_names(scene);
  ++status_.edits;
  if (std::ranges::find(layers, status_.state.layer) == layers.end()) status_.state.layer = "beauty";
  if (!bounds.empty()) {
    status_.center = (Vec3d(bounds.lo) + Vec3d(bounds.hi)) * 0.5;
    status_.radius = std::max(1e-30, length(Vec3d(bounds.hi) - Vec3d(bounds.lo)) / 2);
  }
  film_ = scene.film;
  const PixelWindow window = crop_window(scene.film);
  status_.width = window.width(), status_.height = window.height();
  status_.wanted_samples = scene.integrator.samples;
  status_.error.reset(), failure_.reset();
  status_.settled = false, finished_.reset(), wants_layers_ = false;
  ++status_.view;
  loaded_ = std::move(loaded);
}

bool Session::reload() {
  std::vector<std::string> files;
  std::optional<Error> failure;
  try {
    adopt(load(files));
  } catch (const Error& error) {
    failure = error;
  } catch (const std::exception& error) {
    failure = Error(reason_of(error), ErrorKind::io);
  }
  const std::lock_guard lock(mutex_);
  if (failure) {
    status_.error = failure;
    status_.error_line = line_of(failure->where());
    // Files that the broken scene no longer names may be named again.
    for (const std::string& path : loaded_.files) files.push_back(path);
  }
  loaded_.files = files;
  files_.watch(files);
  return !failure;
}

void Session::watch() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    changed_.wait_for(lock, std::chrono::milliseconds(100));
    if (stopping_ || !files_.have_changed()) continue;
    // Editors write in several steps.
    for (int quiet = 0; quiet < 1 && !stopping_; ++quiet) {
      lock.unlock();
      std::this_thread::sleep_for(std::chrono::milliseconds(60));
      lock.lock();
      if (files_.have_changed()) quiet = -1;
    }
    reload_wanted_ = true, cancel_ = true;
    changed_.notify_all();
  }
}

std::uint64_t Session::change(const std::string& lines) {
  std::uint64_t view = 0;
  {
    const std::lock_guard lock(mutex_);
    ViewState state = parse_view(lines, status_.state);
    if (state.layer != status_.state.layer) {
      if (std::ranges::find(status_.layers, state.layer) == status_.layers.end())
        throw Error("layer: unknown");
    }
    status_.state = std::move(state);
    status_.settled = false, finished_.reset(), failure_.reset(), wants_layers_ = false;
    view = ++status_.view;
    cancel_ = true;
  }
  changed_.notify_all();
  return view;
}

SessionStatus Session::status() const {
  const std::lock_guard lock(mutex_);
  SessionStatus status = status_;
  if (!status.error && failure_) status.error = failure_, status.error_line.clear();
  return status;
}

std::string Session::pick(std::uint32_t x, std::uint32_t y) {
  Camera camera;
  Film film;
  std::shared_ptr<const PreparedScene> prepared;
  {
    const std::lock_guard lock(mutex_);
    camera = status_.state.camera, film = film_, prepared = loaded_.prepared;
  }
  return pick_json(*prepared, camera, film, x, y, isa_);
}

std::string Session::camera() const {
  const std::lock_guard lock(mutex_);
  return camera_yaml(status_.state.camera, status_.origin);
}

std::string Session::save(const std::string& extension, const std::function<bool()>& is_gone) {
  std::shared_ptr<const Picture> picture;
  ImageMetadata metadata;
  {
    std::unique_lock lock(mutex_);
    const std::uint64_t view = status_.view;
    const bool layers = extension == ".exr";
    if (layers && !is_finished(true) && !failure_) wants_layers_ = true, changed_.notify_all();
    const auto is_decided = [&] {
      return stopping_ || status_.view != view || is_finished(layers) || failure_;
    };
    while (!changed_.wait_for(lock, std::chrono::milliseconds(200), is_decided))
      if (is_gone()) throw Error("nobody waits for the picture any more");
    if (stopping_ || status_.view != view)
      throw Error("the view has changed before the picture was finished");
    if (!is_finished(layers)) throw std::runtime_error(std::string("cannot render: ") + failure_->what());
    picture = finished_, metadata = metadata_;
  }
  const PrivateFolder folder;
  const std::filesystem::path path = folder.path() / ("picture" + extension);
  write_image(path.string(), *picture, metadata);
  return content(path);
}

}  // namespace oktett
