/// \file The same program on Embree and on the library that this project builds in its place: what calls
/// cost, and how many rays slip through closed meshes at edges and corners.
///
///   embree_calls [OPTION...] MESH...

#if defined(OKTETT_EMBREE4)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "bench/peer_timing.h"
#include "bench/program.h"
#include "core/mesh_geometry.h"
#include "core/random.h"
#include "io/mesh/load/load_mesh.h"

namespace oktett::bench {
namespace {

struct CallsOptions {
  std::vector<std::string> meshes;
  std::string embree = OKTETT_REAL_EMBREE, oktett = OKTETT_OWN_EMBREE, isa, rows;
  int rays = 20000, runs = 15, leaks = 0;
};

#if defined(OKTETT_EMBREE4)
#define OKTETT_CONTEXT(scene, rays) scene, rays, nullptr
#else
#define OKTETT_CONTEXT(scene, rays) scene, &context_, rays
#endif

/// The functions of one library.
class Library {
 public:
  Library(const std::string& path, const std::string& isa) {
    handle_ = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle_ == nullptr) throw Error(std::string("cannot load ") + dlerror());
    load(new_device, "rtcNewDevice"), load(new_scene, "rtcNewScene"), load(set_flags, "rtcSetSceneFlags");
    load(new_geometry, "rtcNewGeometry"), load(share, "rtcSetSharedGeometryBuffer");
    load(commit_geometry, "rtcCommitGeometry"), load(attach, "rtcAttachGeometry");
    load(commit_scene, "rtcCommitScene"), load(release_scene, "rtcReleaseScene");
    load(release_geometry, "rtcReleaseGeometry"), load(set_mask, "rtcSetGeometryMask");
    load(set_filter, "rtcSetGeometryIntersectFilterFunction"), load(set_user, "rtcSetGeometryUserData");
    load(set_count, "rtcSetGeometryUserPrimitiveCount"), load(set_bounds, "rtcSetGeometryBoundsFunction");
    load(set_intersect, "rtcSetGeometryIntersectFunction");
    load(intersect1, "rtcIntersect1"), load(intersect8, "rtcIntersect8"), load(occluded1, "rtcOccluded1");
    const std::string config = isa.empty() ? "" : "isa=" + isa;
    device = new_device(config.c_str());
    if (device == nullptr) throw Error("cannot make a device of " + path);
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  decltype(&rtcNewDevice) new_device;
  decltype(&rtcNewScene) new_scene;
  decltype(&rtcSetSceneFlags) set_flags;
  decltype(&rtcNewGeometry) new_geometry;
  decltype(&rtcSetSharedGeometryBuffer) share;
  decltype(&rtcCommitGeometry) commit_geometry;
  decltype(&rtcAttachGeometry) attach;
  decltype(&rtcCommitScene) commit_scene;
  decltype(&rtcReleaseScene) release_scene;
  decltype(&rtcReleaseGeometry) release_geometry;
  decltype(&rtcSetGeometryMask) set_mask;
  decltype(&rtcSetGeometryIntersectFilterFunction) set_filter;
  decltype(&rtcSetGeometryUserData) set_user;
  decltype(&rtcSetGeometryUserPrimitiveCount) set_count;
  decltype(&rtcSetGeometryBoundsFunction) set_bounds;
  decltype(&rtcSetGeometryIntersectFunction) set_intersect;
  decltype(&rtcIntersect1) intersect1;
  decltype(&rtcIntersect8) intersect8;
  decltype(&rtcOccluded1) occluded1;
  RTCDevice device;

 private:
  template <class Function>
  void load(Function& function, const char* name) {
    function = reinterpret_cast<Function>(dlsym(handle_, name));
    if (function == nullptr) throw Error(std::string("the library has no ") + name);
  }
  void* handle_;
};

/// Spheres that a program tests itself, as Embree's own example does.
struct UserSphere {
  Vec3f center;
  float radius;
};

void sphere_bounds(const RTCBoundsFunctionArguments* a) {
  const UserSphere& s = static_cast<const UserSphere*>(a->geometryUserPtr)[a->primID];
  *a->bounds_o = {s.center.x - s.radius, s.center.y - s.radius, s.center.z - s.radius, 0,
                  s.center.x + s.radius, s.center.y + s.radius, s.center.z + s.radius, 0};
}

void sphere_intersect(const RTCIntersectFunctionNArguments* a) {
  if (a->N != 1 || a->valid[0] == 0) return;
  const UserSphere& s = static_cast<const UserSphere*>(a->geometryUserPtr)[a->primID];
  auto* const r = reinterpret_cast<RTCRayHit*>(a->rayhit);
  const Vec3f m = Vec3f{r->ray.org_x, r->ray.org_y, r->ray.org_z} - s.center;
  const Vec3f d{r->ray.dir_x, r->ray.dir_y, r->ray.dir_z};
  const float aa = dot(d, d), b = dot(m, d), c = dot(m, m) - s.radius * s.radius, square = b * b - aa * c;
  if (square < 0) return;
  const float root = std::sqrt(square);
  for (const float t : {(-b - root) / aa, (-b + root) / aa})
    if (t > r->ray.tnear && t < r->ray.tfar) {
      const Vec3f n = m + d * t;
      r->ray.tfar = t;
      r->hit.u = r->hit.v = 0, r->hit.Ng_x = n.x, r->hit.Ng_y = n.y, r->hit.Ng_z = n.z;
      r->hit.geomID = a->geomID, r->hit.primID = a->primID, r->hit.instID[0] = a->context->instID[0];
      return;
    }
}

void accept_all(const RTCFilterFunctionNArguments*) {}

/// Counts a hit and rejects it, so that every hit comes by once.
void count_and_reject(const RTCFilterFunctionNArguments* a) {
  ++*static_cast<std::size_t*>(a->geometryUserPtr);
  a->valid[0] = 0;
}

/// A scene of a library.
class CallScene {
 public:
  CallScene(const Library& library, bool robust)
      : library_(library), scene_(library.new_scene(library.device)) {
    if (robust) library.set_flags(scene_, RTC_SCENE_FLAG_ROBUST);
#if !defined(OKTETT_EMBREE4)
    rtcInitIntersectContext(&context_);
#endif
  }
  ~CallScene() { library_.release_scene(scene_); }
  CallScene(const CallScene&) = delete;
  CallScene& operator=(const CallScene&) = delete;

  void add(const TriangleMesh& mesh, RTCFilterFunctionN filter, unsigned mask, void* user = nullptr) {
    const RTCGeometry g = library_.new_geometry(library_.device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // The last vertex may be read as four floats.
    positions_.assign(3 * mesh.positions.size() + 1, 0);
    std::memcpy(positions_.data(), mesh.positions.data(), 12 * mesh.positions.size());
    library_.share(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, positions_.data(), 0, 12,
                   mesh.positions.size());
    library_.share(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.indices.data(), 0, 12,
                   mesh.triangle_count());
    if (filter != nullptr) library_.set_filter(g, filter);
    library_.set_user(g, user);
    library_.set_mask(g, mask);
    finish(g);
  }
  void add(const std::vector<UserSphere>& spheres) {
    const RTCGeometry g = library_.new_geometry(library_.device, RTC_GEOMETRY_TYPE_USER);
    library_.set_count(g, static_cast<unsigned>(spheres.size()));
    library_.set_user(g, const_cast<UserSphere*>(spheres.data()));
    library_.set_bounds(g, sphere_bounds, nullptr);
    library_.set_intersect(g, sphere_intersect);
    library_.set_mask(g, ~0u);
    finish(g);
  }
  void commit() { library_.commit_scene(scene_); }

  void closest(RTCRayHit& ray) { library_.intersect1(OKTETT_CONTEXT(scene_, &ray)); }
  void any(RTCRay& ray) { library_.occluded1(OKTETT_CONTEXT(scene_, &ray)); }
  void closest8(const int* valid, RTCRayHit8& rays) {
    library_.intersect8(valid, OKTETT_CONTEXT(scene_, &rays));
  }

 private:
  void finish(RTCGeometry g) {
    library_.commit_geometry(g);
    library_.attach(scene_, g);
    library_.release_geometry(g);
  }

  const Library& library_;
  RTCScene scene_;
  std::vector<float> positions_;
#if !defined(OKTETT_EMBREE4)
  RTCIntersectContext context_;
#endif
};

RTCRayHit ray_hit(const Vec3f& o, const Vec3f& d, float tfar) {
  RTCRayHit r{};
  r.ray.org_x = o.x, r.ray.org_y = o.y, r.ray.org_z = o.z;
  r.ray.dir_x = d.x, r.ray.dir_y = d.y, r.ray.dir_z = d.z;
  r.ray.tnear = 0, r.ray.tfar = tfar, r.ray.mask = ~0u;
  r.hit.geomID = r.hit.primID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return r;
}

/// A stream of random numbers from 0 to 1.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : key_(mix_bits(seed)) {}
  float operator()() { return random_float(key_, 0, drawn_++); }
  Vec3f in(const Box& box) {
    const Vec3f e = box.extent();
    return box.lo + Vec3f{(*this)() * e.x, (*this)() * e.y, (*this)() * e.z};
  }
  std::size_t index(std::size_t size) {
    return std::min(size - 1, static_cast<std::size_t>((*this)() * static_cast<float>(size)));
  }

 private:
  std::uint64_t key_;
  std::uint32_t drawn_ = 0;
};

Box bounds_of(const TriangleMesh& mesh) {
  Box box;
  for (const Vec3f& p : mesh.positions) box.grow(p);
  return box;
}

std::vector<RTCRayHit> random_rays(const Box& box, int count) {
  Draw draw(1);
  std::vector<RTCRayHit> rays;
  for (int i = 0; i < count; ++i) {
    const Vec3f a = draw.in(box), b = draw.in(box);
    rays.push_back(ray_hit(a, b - a, std::numeric_limits<float>::infinity()));
  }
  return rays;
}

std::vector<RTCRayHit> camera_rays(const Box& box, int count) {
  const Vec3f e = box.extent();
  const float size = std::max({e.x, e.y, e.z});
  const Vec3f eye = box.center() + Vec3f{0.3f * size, 0.4f * size, 1.6f * size};
  const int side = static_cast<int>(std::sqrt(static_cast<float>(count)));
  std::vector<RTCRayHit> rays;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const auto at = [&](int k) { return (static_cast<float>(k) + 0.5f) / static_cast<float>(side) - 0.5f; };
      rays.push_back(ray_hit(eye, box.center() + Vec3f{at(x) * size, at(y) * size, 0} - eye,
                             std::numeric_limits<float>::infinity()));
    }
  return rays;
}

/// One way to trace all rays; returns how many hit.
using Work = std::function<std::size_t(CallScene&, const std::vector<RTCRayHit>&)>;

std::size_t one_by_one(CallScene& scene, const std::vector<RTCRayHit>& rays) {
  std::size_t found = 0;
  for (const RTCRayHit& r : rays) {
    alignas(16) RTCRayHit ray = r;
    scene.closest(ray);
    found += ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  }
  return found;
}

std::size_t shadows(CallScene& scene, const std::vector<RTCRayHit>& rays) {
  std::size_t found = 0;
  for (const RTCRayHit& r : rays) {
    alignas(16) RTCRay ray = r.ray;
    scene.any(ray);
    found += ray.tfar < 0;
  }
  return found;
}

std::size_t by_eight(CallScene& scene, const std::vector<RTCRayHit>& rays) {
  std::size_t found = 0;
  alignas(32) const int valid[8] = {-1, -1, -1, -1, -1, -1, -1, -1};
  for (std::size_t i = 0; i + 8 <= rays.size(); i += 8) {
    RTCRayHit8 eight{};
    for (std::size_t k = 0; k < 8; ++k) {
      const RTCRay& r = rays[i + k].ray;
      eight.ray.org_x[k] = r.org_x, eight.ray.org_y[k] = r.org_y, eight.ray.org_z[k] = r.org_z;
      eight.ray.dir_x[k] = r.dir_x, eight.ray.dir_y[k] = r.dir_y, eight.ray.dir_z[k] = r.dir_z;
      eight.ray.tnear[k] = r.tnear, eight.ray.tfar[k] = r.tfar, eight.ray.mask[k] = ~0u;
      eight.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
    }
    scene.closest8(valid, eight);
    for (std::size_t k = 0; k < 8; ++k) found += eight.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
  }
  return found;
}

/// A row: contenders in turn, the first being Oktett's. Only rows whose names hold `options.rows` are
/// measured.
void row(const std::string& name, const std::vector<CallScene*>& scenes,
         const std::vector<const char*>& names, const std::vector<RTCRayHit>& rays, const Work& work,
         const CallsOptions& options) {
  if (name.find(options.rows) == std::string::npos) return;
  std::vector<std::vector<double>> times(scenes.size());
  std::vector<std::size_t> found(scenes.size());
  for (int run = -1; run < options.runs; ++run)
    for (std::size_t k = 0; k < scenes.size(); ++k) {
      const double s = thread_seconds([&] { found[k] = work(*scenes[k], rays); });
      if (run >= 0) times[k].push_back(s / static_cast<double>(rays.size()) * 1e9);
    }
  const double own = quartiles(times[0]).median;
  fmt::print("| {} | {:.0f} |", name, own);
  for (std::size_t k = 1; k < scenes.size(); ++k) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < times[k].size(); ++i) ratios.push_back(times[k][i] / times[0][i]);
    const Quartiles q = quartiles(ratios);
    fmt::print(" {} {:.2f} ({:.2f}-{:.2f}){} |", names[k], q.median, q.low, q.high,
               found[k] == found[0] ? "" : fmt::format(", {} hits of {}", found[k], found[0]));
  }
  fmt::print("\n");
}

void measure(const TriangleMesh& mesh, const std::string& name, const Library& own, const Library& real,
             const CallsOptions& options) {
  const Box box = bounds_of(mesh);
  CallScene ours(own, true), ordinary(real, false), robust(real, true);
  for (CallScene* scene : {&ours, &ordinary, &robust}) scene->add(mesh, nullptr, ~0u), scene->commit();
  const std::vector<RTCRayHit> random = random_rays(box, options.rays),
                               camera = camera_rays(box, options.rays);
  const std::vector<CallScene*> all{&ours, &ordinary, &robust};
  const std::vector<const char*> names{"", "ordinary", "robust"};
  const auto both = [&](const std::string& what, const Work& work) {
    row(name + ", " + what + ", random", all, names, random, work, options);
    row(name + ", " + what + ", camera", all, names, camera, work, options);
  };
  both("rtcIntersect1", one_by_one), both("rtcOccluded1", shadows), both("rtcIntersect8", by_eight);

  CallScene filtered(own, true), masked(own, true), filtered_real(real, true);
  filtered.add(mesh, accept_all, ~0u), masked.add(mesh, nullptr, 1), filtered_real.add(mesh, accept_all, ~0u);
  for (CallScene* scene : {&filtered, &masked, &filtered_real}) scene->commit();
  row(name + ", Oktett without filter or mask", {&ours, &filtered, &masked},
      {"", "a filter that accepts all", "a mask"}, random, one_by_one, options);
  row(name + ", a filter that accepts all", {&filtered, &filtered_real}, {"", "robust"}, random, one_by_one,
      options);

  std::vector<UserSphere> spheres;
  Draw draw(3);
  const Vec3f e = box.extent();
  for (int i = 0; i < 2000; ++i) spheres.push_back({draw.in(box), 0.02f * std::max({e.x, e.y, e.z})});
  CallScene user(own, true), user_real(real, true);
  user.add(spheres), user_real.add(spheres);
  user.commit(), user_real.commit();
  row("2000 spheres of the program", {&user, &user_real}, {"", "robust"}, random, one_by_one, options);
}

// ---- Rays at edges and corners.

/// Rays from outside through places on edges, or corners, whose triangles all face them, and on past the
/// middle.
std::vector<RTCRayHit> rays_at(const TriangleMesh& mesh, bool corners, int count, std::vector<float>& reach) {
  const std::size_t vertices = mesh.positions.size();
  std::vector<std::vector<std::uint32_t>> around(vertices);
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t)
    for (std::size_t k = 0; k < 3; ++k) around[mesh.indices[3 * std::size_t{t} + k]].push_back(t);
  const auto corner = [&](std::uint32_t t, std::size_t k) {
    return Vec3d(mesh.positions[mesh.indices[3 * std::size_t{t} + k]]);
  };
  const Box box = bounds_of(mesh);
  const Vec3d middle(box.center());
  const double radius = length(Vec3d(box.extent())) / 2;
  Draw draw(corners ? 11 : 12);
  std::vector<RTCRayHit> rays;
  for (int tries = 0; rays.size() < static_cast<std::size_t>(count) && tries < 200 * count; ++tries) {
    const std::uint32_t t = static_cast<std::uint32_t>(draw.index(mesh.triangle_count()));
    const std::size_t k = draw.index(3);
    const std::uint32_t a = mesh.indices[3 * std::size_t{t} + k],
                        b = mesh.indices[3 * std::size_t{t} + (k + 1) % 3];
    const double part = corners ? 0 : static_cast<double>(draw());
    const Vec3d target = Vec3d(mesh.positions[a]) * (1 - part) + Vec3d(mesh.positions[b]) * part;
    const Vec3d to = middle + (Vec3d{draw(), draw(), draw()} * 2.0 - Vec3d{1, 1, 1}) * (0.35 * radius);
    Vec3d d = to - target;
    d = d * (1 / length(d));
    const Vec3d origin = target - d * (2.5 * radius);
    const Vec3f o(origin), f(d);
    bool faces = true;
    // Also around the ends of an edge, which rounding may bring a ray to.
    for (const std::uint32_t end : {a, corners ? a : b})
      for (const std::uint32_t near : around[end]) {
        const Vec3d n = cross(corner(near, 1) - corner(near, 0), corner(near, 2) - corner(near, 0));
        faces &= dot(n, d) < -0.05 * length(n);
      }
    if (!faces) continue;
    rays.push_back(ray_hit(o, f, std::numeric_limits<float>::infinity()));
    reach.push_back(static_cast<float>(2.5 * radius));
  }
  return rays;
}

/// How many rays are first hit beyond the place they are aimed at, and how many meet an odd number of
/// triangles.
void leaks(const TriangleMesh& mesh, const std::string& name, const Library& own, const Library& real,
           const CallsOptions& options) {
  const float tolerance = 1e-3f;
  for (const bool corners : {false, true}) {
    std::vector<float> reach;
    const std::vector<RTCRayHit> rays = rays_at(mesh, corners, options.leaks, reach);
    fmt::print("| {}, {} | {} |", name, corners ? "corners" : "edges", rays.size());
    const std::pair<const Library*, bool> contenders[] = {{&own, true}, {&real, true}, {&real, false}};
    for (const auto& [library, is_robust] : contenders) {
      std::size_t counted = 0, past = 0, none = 0, odd = 0;
      CallScene scene(*library, is_robust), counting(*library, is_robust);
      scene.add(mesh, nullptr, ~0u), counting.add(mesh, count_and_reject, ~0u, &counted);
      scene.commit(), counting.commit();
      for (std::size_t i = 0; i < rays.size(); ++i) {
        alignas(16) RTCRayHit ray = rays[i], all = rays[i];
        scene.closest(ray);
        if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID)
          ++none;
        else
          past += ray.ray.tfar > reach[i] * (1 + tolerance);
        counted = 0;
        counting.closest(all);
        odd += counted % 2;
      }
      fmt::print(" {} / {} / {} |", past, none, odd);
    }
    fmt::print("\n");
  }
}

int run(int argc, char** argv) {
  CallsOptions options;
  const auto set = [](auto& to, auto least, auto most) {
    return [&to, least, most](const std::string& word) { to = number(word, least, most); };
  };
  const auto word = [](std::string& to) { return [&to](const std::string& value) { to = value; }; };
  const std::vector<Option> list = {
      {"--rays", "N", "rays of each row (20000)", set(options.rays, 64, 100000000)},
      {"--runs", "N", "how often each row is measured (15)", set(options.runs, 1, 1000)},
      {"--rows", "TEXT", "only rows whose names hold this text", word(options.rows)},
      {"--leaks", "N", "aim N rays at edges and N at corners of closed meshes, in place of timing",
       set(options.leaks, 1, 100000000)},
      {"--isa", "NAME", "sse4.2, avx2 or avx512, of both libraries", word(options.isa)},
      {"--embree", "FILE", "Embree's library", word(options.embree)},
      {"--oktett", "FILE", "the one in its place", word(options.oktett)}};
  options.meshes =
      parse_options(argc, argv,
                    "embree_calls [OPTION...] MESH...\n\nCalls of Embree's functions, on Embree and on "
                    "Oktett in turn. Numbers are nanoseconds a ray of Oktett, then the times of Embree's "
                    "modes over Oktett's: above 1, Oktett is faster.\n\n",
                    list);
  if (options.meshes.empty()) throw Error("expected the file of a mesh");
  const Library own(options.oktett, options.isa), real(options.embree, options.isa);
  flush_denormals();
  if (options.leaks > 0)
    fmt::print(
        "| aimed at | rays | Oktett: past / none / odd | Embree robust | Embree ordinary "
        "|\n|---|---|---|---|---|\n");
  else
    fmt::print("| row | ns | | |\n|---|---|---|---|\n");
  for (const std::string& path : options.meshes) {
    const TriangleMesh mesh = load_mesh(path).mesh;
    const std::string name = std::filesystem::path(path).stem().string();
    if (options.leaks > 0)
      leaks(mesh, name, own, real, options);
    else
      measure(mesh, name, own, real, options);
  }
  return 0;
}

}  // namespace
}  // namespace oktett::bench

int main(int argc, char** argv) { return oktett::bench::run_program(oktett::bench::run, argc, argv); }
