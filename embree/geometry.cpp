#include "embree/geometry.h"

#include <algorithm>
#include <span>
#include <string>

#include "accel/time/instance_motion.h"
#include "embree/scene.h"

namespace oktett::embree {

namespace {

const char* name_of(RTCGeometryType type) {
  switch (type) {
    case RTC_GEOMETRY_TYPE_SUBDIVISION:
      return "subdivision surfaces";
    case RTC_GEOMETRY_TYPE_FLAT_LINEAR_CURVE:
    case RTC_GEOMETRY_TYPE_CONE_LINEAR_CURVE:
      return "linear curves other than round ones";
    default:
      return "curves other than round linear ones";
  }
}

bool is_known(RTCGeometryType type) {
  switch (type) {
    case RTC_GEOMETRY_TYPE_TRIANGLE:
    case RTC_GEOMETRY_TYPE_QUAD:
    case RTC_GEOMETRY_TYPE_GRID:
    case RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE:
    case RTC_GEOMETRY_TYPE_SPHERE_POINT:
    case RTC_GEOMETRY_TYPE_DISC_POINT:
    case RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT:
    case RTC_GEOMETRY_TYPE_USER:
    case RTC_GEOMETRY_TYPE_INSTANCE:
#if defined(RTC_GEOMETRY_INSTANCE_ARRAY)
    case RTC_GEOMETRY_TYPE_INSTANCE_ARRAY:
#endif
      return true;
    default:
      return false;
  }
}

}  // namespace

Geometry::Geometry(Ref<RTCDeviceTy> owner, RTCGeometryType kind) : device(std::move(owner)), type(kind) {}

bool Geometry::is_refused() const { return !is_known(type); }

bool Geometry::is_instance() const {
#if defined(RTC_GEOMETRY_INSTANCE_ARRAY)
  if (type == RTC_GEOMETRY_TYPE_INSTANCE_ARRAY) return true;
#endif
  return type == RTC_GEOMETRY_TYPE_INSTANCE;
}

// ---- Buffers.

namespace {

/// The format that a buffer of this kind has in a geometry; undefined: none has it, or several are possible.
RTCFormat format_of(const Geometry& g, RTCBufferType buffer) {
  switch (buffer) {
    case RTC_BUFFER_TYPE_VERTEX:
      return g.is_mesh() ? RTC_FORMAT_FLOAT3 : RTC_FORMAT_FLOAT4;
    case RTC_BUFFER_TYPE_INDEX:
      if (g.type == RTC_GEOMETRY_TYPE_TRIANGLE) return RTC_FORMAT_UINT3;
      return g.type == RTC_GEOMETRY_TYPE_QUAD ? RTC_FORMAT_UINT4 : RTC_FORMAT_UINT;
    case RTC_BUFFER_TYPE_GRID:
      return RTC_FORMAT_GRID;
    case RTC_BUFFER_TYPE_NORMAL:
      return RTC_FORMAT_FLOAT3;
    case RTC_BUFFER_TYPE_FLAGS:
      return RTC_FORMAT_UCHAR;
    default:
      return RTC_FORMAT_UNDEFINED;
  }
}

/// How many slots of this kind a geometry has.
unsigned slot_count(const Geometry& g, RTCBufferType buffer) {
  const bool lines = g.type == RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE;
  const bool points = g.type == RTC_GEOMETRY_TYPE_SPHERE_POINT || g.type == RTC_GEOMETRY_TYPE_DISC_POINT ||
                      g.type == RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT;
  switch (buffer) {
    case RTC_BUFFER_TYPE_VERTEX:
      return g.is_mesh() || lines || points ? g.time_steps : 0;
    case RTC_BUFFER_TYPE_NORMAL:
      return g.type == RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT ? g.time_steps : 0;
    case RTC_BUFFER_TYPE_INDEX:
      return g.type == RTC_GEOMETRY_TYPE_TRIANGLE || g.type == RTC_GEOMETRY_TYPE_QUAD || lines;
    case RTC_BUFFER_TYPE_FLAGS:
      return lines;
    case RTC_BUFFER_TYPE_GRID:
      return g.type == RTC_GEOMETRY_TYPE_GRID;
    case RTC_BUFFER_TYPE_VERTEX_ATTRIBUTE:
      return g.is_mesh() || lines || points ? g.attributes : 0;
#if defined(RTC_GEOMETRY_INSTANCE_ARRAY)
    case RTC_BUFFER_TYPE_TRANSFORM:
      return g.type == RTC_GEOMETRY_TYPE_INSTANCE_ARRAY ? g.time_steps : 0;
#endif
    default:
      return 0;
  }
}

bool is_any_slot(RTCBufferType buffer) { return buffer == RTC_BUFFER_TYPE_VERTEX_ATTRIBUTE; }

void check_slot(const Geometry& g, const Geometry::Slot& slot) {
  const unsigned count = slot_count(g, slot.first);
  if (slot.second < count || g.is_refused()) return;
#if defined(RTC_GEOMETRY_INSTANCE_ARRAY)
  // Which scene each instance of an array shows.
  if (g.type == RTC_GEOMETRY_TYPE_INSTANCE_ARRAY && slot == Geometry::Slot{RTC_BUFFER_TYPE_INDEX, 0}) return;
#endif
  fail(is_any_slot(slot.first) ? RTC_ERROR_INVALID_OPERATION : RTC_ERROR_INVALID_ARGUMENT,
       count == 0 ? "the geometry has no buffers of type " + std::to_string(static_cast<int>(slot.first))
                  : "slot " + std::to_string(slot.second) + " of a buffer, expected less than " +
                        std::to_string(count));
}

}  // namespace

void Geometry::set_view(const Slot& slot, View view) {
  if ((reinterpret_cast<std::uintptr_t>(view.data) & 3) != 0 || (view.stride & 3) != 0)
    if (slot.first != RTC_BUFFER_TYPE_FLAGS)
      fail(RTC_ERROR_INVALID_OPERATION, "buffers and strides must be multiples of 4 bytes");
  const RTCFormat format = format_of(*this, slot.first);
  if (format != RTC_FORMAT_UNDEFINED && view.format != format && !is_refused())
    fail(RTC_ERROR_INVALID_OPERATION, "the buffer has format " +
                                          std::to_string(static_cast<int>(view.format)) + ", expected " +
                                          std::to_string(static_cast<int>(format)));
  if (slot.first == RTC_BUFFER_TYPE_VERTEX_ATTRIBUTE && float_count(view.format) == 0)
    fail(RTC_ERROR_INVALID_OPERATION, "vertex attributes are one to sixteen floats");
  check_slot(*this, slot);
  if (view.data == nullptr && view.count > 0) fail(RTC_ERROR_INVALID_ARGUMENT, "the buffer has no memory");
  if (view.count > UINT32_MAX) fail(RTC_ERROR_INVALID_ARGUMENT, "more than 2^32 - 1 items in one buffer");
  views_[slot] = std::move(view);
  change_shape();
}

const View& Geometry::view(const Slot& slot) const {
  check_slot(*this, slot);
  const auto found = views_.find(slot);
  if (found == views_.end()) fail(RTC_ERROR_INVALID_OPERATION, "no buffer was set");
  return found->second;
}

const View* Geometry::find(RTCBufferType buffer, unsigned slot) const {
  const auto found = views_.find({buffer, slot});
  return found != views_.end() ? &found->second : nullptr;
}

// ---- Shapes.

std::uint32_t Geometry::primitive_count() const {
  if (is_refused()) return 0;
  const auto count = [&](RTCBufferType buffer) {
    const View* const view = find(buffer);
    return view != nullptr ? static_cast<std::uint32_t>(view->count) : 0u;
  };
  if (type == RTC_GEOMETRY_TYPE_USER) return user_primitives;
  if (type == RTC_GEOMETRY_TYPE_GRID) return count(RTC_BUFFER_TYPE_GRID);
  if (type == RTC_GEOMETRY_TYPE_INSTANCE) return 1;
#if defined(RTC_GEOMETRY_INSTANCE_ARRAY)
  if (type == RTC_GEOMETRY_TYPE_INSTANCE_ARRAY) return count(RTC_BUFFER_TYPE_TRANSFORM);
#endif
  if (type == RTC_GEOMETRY_TYPE_SPHERE_POINT || type == RTC_GEOMETRY_TYPE_DISC_POINT ||
      type == RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT)
    return count(RTC_BUFFER_TYPE_VERTEX);
  return count(RTC_BUFFER_TYPE_INDEX);
}

const Made& Geometry::made(bool keep) {
  // What a program's function or another scene tells may have changed unnoticed.
  if (made_version_ != shape_version_ || !keep || is_instance() || type == RTC_GEOMETRY_TYPE_USER) {
    made_ = make();
    made_version_ = shape_version_;
  }
  if (keep && made_.tree == nullptr && made_.mesh != nullptr && time_steps == 1) grow_tree();
  return made_;
}

void Geometry::grow_tree() {
  const TriangleMesh& mesh = *made_.mesh;
  const std::shared_ptr<const TriangleMesh> before = tree_ != nullptr ? tree_->mesh(tree_number_) : nullptr;
  const auto same = [](const auto& a, const auto& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
  };
  if (before != nullptr && quality == RTC_BUILD_QUALITY_REFIT && same(before->indices, mesh.indices) &&
      before->positions.size() == mesh.positions.size()) {
    tree_->set_vertices(tree_number_, std::span(mesh.positions.data(), mesh.positions.size()));
  } else {
    tree_ = std::make_unique<DynamicAccel>(BuildOptions{BuildQuality::fast, true, ~0u});
    oktett::Geometry geometry;
    geometry.shape = MeshGeometry{made_.mesh.get(), false};
    tree_number_ = tree_->add(made_.mesh, std::move(geometry));
  }
  made_.tree = tree_->accel();
}

Made Geometry::make() const {
  switch (type) {
    case RTC_GEOMETRY_TYPE_TRIANGLE:
      return make_triangles(*this);
    case RTC_GEOMETRY_TYPE_QUAD:
      return make_quads(*this);
    case RTC_GEOMETRY_TYPE_GRID:
      return make_grids(*this);
    case RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE:
      return make_lines(*this);
    case RTC_GEOMETRY_TYPE_USER:
      return make_user(*this);
    case RTC_GEOMETRY_TYPE_SPHERE_POINT:
    case RTC_GEOMETRY_TYPE_DISC_POINT:
    case RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT:
      return make_points(*this);
    default:
      break;
  }
  if (!is_refused()) return make_instance(*this);
  oktett::Geometry nothing;
  nothing.shape = SpheresShape{};
  Made made;
  made.shape = std::move(nothing);
  return made;
}

}  // namespace oktett::embree

using namespace oktett::embree;

// ---- The life of a geometry.

RTC_API RTCGeometry rtcNewGeometry(RTCDevice device, RTCGeometryType type) {
  return guarded(device_of(device), [&] {
    object_of(device);
    auto geometry = std::make_unique<Geometry>(Ref<RTCDeviceTy>(device), type);
    if (geometry->is_refused())
      Device::report(device_of(device), RTC_ERROR_INVALID_OPERATION,
                     std::string("Oktett has no ") + name_of(type) + " (geometry type " +
                         std::to_string(static_cast<int>(type)) + "); such geometries have no surface");
    return Shells<RTCGeometryTy>::make(std::move(geometry));
  });
}

RTC_API void rtcRetainGeometry(RTCGeometry geometry) {
  guarded(device_of(geometry), [&] { object_of(geometry), Shells<RTCGeometryTy>::retain(geometry); });
}

RTC_API void rtcReleaseGeometry(RTCGeometry geometry) {
  guarded(device_of(geometry), [&] { object_of(geometry), Shells<RTCGeometryTy>::release(geometry); });
}

/// Calls f(geometry) and reports its errors.
template <class Function>
static void with(RTCGeometry handle, Function&& f) {
  guarded(device_of(handle), [&] { f(object_of(handle)); });
}

/// The same for functions of geometries of one type.
template <class Function>
static void with(RTCGeometry handle, RTCGeometryType type, Function&& f) {
  with(handle, [&](Geometry& g) {
    if (g.type != type)
      fail(RTC_ERROR_INVALID_OPERATION, "the geometry is of type " +
                                            std::to_string(static_cast<int>(g.type)) + ", expected " +
                                            std::to_string(static_cast<int>(type)));
    f(g);
  });
}

RTC_API void rtcCommitGeometry(RTCGeometry geometry) {
  with(geometry, [](Geometry& g) {
    std::size_t vertices = 0;
    for (unsigned step = 0; step < g.time_steps; ++step) {
      const View* const view = g.find(RTC_BUFFER_TYPE_VERTEX, step);
      if (view == nullptr) continue;
      if (step > 0 && view->count != vertices)
        fail(RTC_ERROR_INVALID_OPERATION, "time step 0 has " + std::to_string(vertices) + " vertices, step " +
                                              std::to_string(step) + " has " + std::to_string(view->count));
      vertices = view->count;
    }
    // The program may have changed memory that it shares.
    g.change_shape();
    g.is_committed = true;
  });
}

RTC_API void rtcEnableGeometry(RTCGeometry geometry) {
  with(geometry, [](Geometry& g) { g.is_enabled = true, g.change_at_once(); });
}

RTC_API void rtcDisableGeometry(RTCGeometry geometry) {
  with(geometry, [](Geometry& g) { g.is_enabled = false, g.change_at_once(); });
}

// ---- Settings.

RTC_API void rtcSetGeometryTimeStepCount(RTCGeometry geometry, unsigned count) {
  with(geometry, [&](Geometry& g) {
    if (count == 0 || count > RTC_MAX_TIME_STEP_COUNT)
      fail(RTC_ERROR_INVALID_ARGUMENT,
           std::to_string(count) + " time steps, expected 1 to " + std::to_string(RTC_MAX_TIME_STEP_COUNT));
    g.time_steps = count;
    g.transforms.resize(count);
    if (!g.turning.empty()) g.turning.resize(count);
    g.change_shape();
  });
}

RTC_API void rtcSetGeometryTimeRange(RTCGeometry geometry, float begin, float end) {
  with(geometry, [&](Geometry& g) {
    if (!(begin < end)) fail(RTC_ERROR_INVALID_ARGUMENT, "the time range ends before it begins");
    g.begin = begin, g.end = end;
    g.change_shape();
  });
}

RTC_API void rtcSetGeometryVertexAttributeCount(RTCGeometry geometry, unsigned count) {
  with(geometry, [&](Geometry& g) { g.attributes = count; });
}

RTC_API void rtcSetGeometryMask(RTCGeometry geometry, unsigned mask) {
  with(geometry, [&](Geometry& g) { g.mask = mask, g.change_setting(); });
}

RTC_API void rtcSetGeometryBuildQuality(RTCGeometry geometry, RTCBuildQuality quality) {
  with(geometry, [&](Geometry& g) {
    if (quality < RTC_BUILD_QUALITY_LOW || quality > RTC_BUILD_QUALITY_REFIT)
      fail(RTC_ERROR_INVALID_ARGUMENT, "unknown build quality");
    g.quality = quality, g.change_setting();
  });
}

RTC_API void rtcSetGeometryMaxRadiusScale(RTCGeometry geometry, float) {
  with(geometry, [](Geometry&) { fail(RTC_ERROR_INVALID_OPERATION, "radii do not grow with the distance"); });
}

RTC_API void rtcSetGeometryUserData(RTCGeometry geometry, void* user) {
  with(geometry, [&](Geometry& g) { g.user = user; });
}

RTC_API void* rtcGetGeometryUserData(RTCGeometry geometry) {
  return guarded(device_of(geometry), [&] { return object_of(geometry).user; });
}

RTC_API void rtcSetGeometryIntersectFilterFunction(RTCGeometry geometry, RTCFilterFunctionN filter) {
  with(geometry, [&](Geometry& g) { g.closest_filter = filter, g.change_at_once(); });
}

RTC_API void rtcSetGeometryOccludedFilterFunction(RTCGeometry geometry, RTCFilterFunctionN filter) {
  with(geometry, [&](Geometry& g) { g.any_filter = filter, g.change_at_once(); });
}

#if OKTETT_EMBREE == 4
RTC_API void rtcSetGeometryEnableFilterFunctionFromArguments(RTCGeometry geometry, bool enable) {
  with(geometry, [&](Geometry& g) { g.takes_filter_of_query = enable, g.change_setting(); });
}
#endif

RTC_API void rtcSetGeometryPointQueryFunction(RTCGeometry geometry, RTCPointQueryFunction function) {
  with(geometry, [&](Geometry& g) { g.point_query = function; });
}

// ---- User geometries.

RTC_API void rtcSetGeometryUserPrimitiveCount(RTCGeometry geometry, unsigned count) {
  with(geometry, RTC_GEOMETRY_TYPE_USER, [&](Geometry& g) { g.user_primitives = count, g.change_shape(); });
}

RTC_API void rtcSetGeometryBoundsFunction(RTCGeometry geometry, RTCBoundsFunction bounds, void* user) {
  with(geometry, RTC_GEOMETRY_TYPE_USER,
       [&](Geometry& g) { g.bounds = bounds, g.bounds_user = user, g.change_shape(); });
}

RTC_API void rtcSetGeometryIntersectFunction(RTCGeometry geometry, RTCIntersectFunctionN intersect) {
  with(geometry, RTC_GEOMETRY_TYPE_USER, [&](Geometry& g) { g.intersect = intersect; });
}

RTC_API void rtcSetGeometryOccludedFunction(RTCGeometry geometry, RTCOccludedFunctionN occluded) {
  with(geometry, RTC_GEOMETRY_TYPE_USER, [&](Geometry& g) { g.occluded = occluded; });
}

// ---- Buffers.

/// A view of a buffer. Throws ApiError if items do not fit into it.
static View view_of(RTCBuffer buffer, RTCFormat format, std::size_t offset, std::size_t stride,
                    std::size_t count) {
  View view;
  const Buffer& own = object_of(buffer);
  view.buffer = Ref<RTCBufferTy>(buffer);
  view.data = own.data() + offset, view.stride = stride, view.count = count, view.format = format;
  const std::size_t last = size_of(format);
  if (count > 0 && (offset > own.bytes() || own.bytes() - offset < last ||
                    (count > 1 && stride > 0 && (own.bytes() - offset - last) / stride < count - 1)))
    fail(RTC_ERROR_INVALID_ARGUMENT, std::to_string(count) + " items of " + std::to_string(last) +
                                         " bytes, one every " + std::to_string(stride) + " bytes from byte " +
                                         std::to_string(offset) + " on, do not fit into a buffer of " +
                                         std::to_string(own.bytes()));
  return view;
}

RTC_API void rtcSetGeometryBuffer(RTCGeometry geometry, RTCBufferType type, unsigned slot, RTCFormat format,
                                  RTCBuffer buffer, size_t offset, size_t stride, size_t count) {
  with(geometry, [&](Geometry& g) {
    g.set_view({type, slot}, view_of(buffer, format, offset, stride, count));
  });
}

RTC_API void rtcSetSharedGeometryBuffer(RTCGeometry geometry, RTCBufferType type, unsigned slot,
                                        RTCFormat format, const void* data, size_t offset, size_t stride,
                                        size_t count) {
  with(geometry, [&](Geometry& g) {
    View view;
    if (data != nullptr) view.data = const_cast<std::byte*>(static_cast<const std::byte*>(data)) + offset;
    view.stride = stride, view.count = count, view.format = format;
    g.set_view({type, slot}, std::move(view));
  });
}

RTC_API void* rtcSetNewGeometryBuffer(RTCGeometry geometry, RTCBufferType type, unsigned slot,
                                      RTCFormat format, size_t stride, size_t count) {
  return guarded(device_of(geometry), [&]() -> void* {
    Geometry& g = object_of(geometry);
    if (stride != 0 && count > SIZE_MAX / 2 / stride) throw std::bad_alloc();
    const RTCBuffer buffer = Shells<RTCBufferTy>::make(std::make_unique<Buffer>(g.device, stride * count));
    const Ref<RTCBufferTy> kept(buffer);
    Shells<RTCBufferTy>::release(buffer);
    View view = view_of(buffer, format, 0, stride, count);
    std::byte* const data = view.data;
    g.set_view({type, slot}, std::move(view));
    return data;
  });
}

RTC_API void* rtcGetGeometryBufferData(RTCGeometry geometry, RTCBufferType type, unsigned slot) {
  return guarded(device_of(geometry), [&]() -> void* {
    const Geometry& g = object_of(geometry);
    check_slot(g, {type, slot});
    const View* const view = g.find(type, slot);
    return view != nullptr ? view->data : nullptr;
  });
}

RTC_API void rtcUpdateGeometryBuffer(RTCGeometry geometry, RTCBufferType type, unsigned slot) {
  with(geometry, [&](Geometry& g) {
    check_slot(g, {type, slot});
    g.change_shape();
  });
}

// ---- Instances.

namespace oktett::embree {

namespace {

/// Rows, columns and whether rows come first, of a format of matrices.
struct MatrixFormat {
  int rows, columns;
  bool row_major;
};

MatrixFormat matrix_format(RTCFormat format) {
  switch (format) {
    case RTC_FORMAT_FLOAT3X4_ROW_MAJOR:
      return {3, 4, true};
    case RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR:
      return {3, 4, false};
    case RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR:
      return {4, 4, false};
#if OKTETT_EMBREE == 4
    case RTC_FORMAT_FLOAT4X4_ROW_MAJOR:
      return {4, 4, true};
#endif
    default:
      fail(RTC_ERROR_INVALID_OPERATION,
           "a transform has 3x4 numbers by rows or columns or 4x4 by columns, not format " +
               std::to_string(static_cast<int>(format)));
  }
}

}  // namespace

TurningMap to_turning_map(const RTCQuaternionDecomposition& q) {
  TurningMap map;
  const auto d = [](float f) { return static_cast<double>(f); };
  map.quaternion[0] = d(q.quaternion_r), map.quaternion[1] = d(q.quaternion_i);
  map.quaternion[2] = d(q.quaternion_j), map.quaternion[3] = d(q.quaternion_k);
  map.inner.m = {{{d(q.scale_x), d(q.skew_xy), d(q.skew_xz), d(q.shift_x)},
                  {0, d(q.scale_y), d(q.skew_yz), d(q.shift_y)},
                  {0, 0, d(q.scale_z), d(q.shift_z)}}};
  map.outer = {d(q.translation_x), d(q.translation_y), d(q.translation_z)};
  return map;
}

Affine read_transform(RTCFormat format, const void* data) {
  if (data == nullptr) fail(RTC_ERROR_INVALID_ARGUMENT, "there is no transform");
  const MatrixFormat m = matrix_format(format);
  const auto* const numbers = static_cast<const float*>(data);
  Affine map;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c)
      map.m[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] =
          static_cast<double>(numbers[m.row_major ? m.columns * r + c : m.rows * c + r]);
  return map;
}

void write_transform(const Affine& map, RTCFormat format, void* data) {
  if (data == nullptr) fail(RTC_ERROR_INVALID_ARGUMENT, "there is no place for the transform");
  const MatrixFormat m = matrix_format(format);
  auto* const numbers = static_cast<float*>(data);
  for (int r = 0; r < m.rows; ++r)
    for (int c = 0; c < m.columns; ++c)
      numbers[m.row_major ? m.columns * r + c : m.rows * c + r] =
          r < 3 ? static_cast<float>(map.m[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)])
                : static_cast<float>(c == 3);
}

Affine transform_at(const Geometry& geometry, std::uint32_t index, float time) {
  if (!geometry.is_instance()) fail(RTC_ERROR_INVALID_OPERATION, "the geometry is no instance");
  if (index >= geometry.primitive_count())
    fail(RTC_ERROR_INVALID_ARGUMENT, "there is no instance " + std::to_string(index));
  SceneGeometry shape;
  shape.shape = make_instance(geometry).shape;
  const float own_time = (time - geometry.begin) / (geometry.end - geometry.begin);
  return map_at(shape, index, own_time);
}

}  // namespace oktett::embree

RTC_API void rtcSetGeometryInstancedScene(RTCGeometry geometry, RTCScene scene) {
  with(geometry, [&](Geometry& g) {
    if (!g.is_instance()) fail(RTC_ERROR_INVALID_OPERATION, "the geometry is no instance");
    object_of(scene);
    g.scenes = {Ref<RTCSceneTy>(scene)};
    g.change_shape();
  });
}

#if defined(RTC_GEOMETRY_INSTANCE_ARRAY)
RTC_API void rtcSetGeometryInstancedScenes(RTCGeometry geometry, RTCScene* scenes, size_t count) {
  with(geometry, RTC_GEOMETRY_TYPE_INSTANCE_ARRAY, [&](Geometry& g) {
    std::vector<Ref<RTCSceneTy>> all;
    for (std::size_t i = 0; i < count; ++i) object_of(scenes[i]), all.emplace_back(scenes[i]);
    g.scenes = std::move(all);
    g.change_shape();
  });
}
#endif

RTC_API void rtcSetGeometryTransform(RTCGeometry geometry, unsigned step, RTCFormat format,
                                     const void* data) {
  with(geometry, RTC_GEOMETRY_TYPE_INSTANCE, [&](Geometry& g) {
    if (step >= g.time_steps)
      fail(RTC_ERROR_INVALID_ARGUMENT,
           "time step " + std::to_string(step) + ", expected less than " + std::to_string(g.time_steps));
    g.transforms[step] = read_transform(format, data);
    g.turning.clear();
    g.change_shape();
  });
}

RTC_API void rtcSetGeometryTransformQuaternion(RTCGeometry geometry, unsigned step,
                                               const RTCQuaternionDecomposition* map) {
  with(geometry, RTC_GEOMETRY_TYPE_INSTANCE, [&](Geometry& g) {
    if (step >= g.time_steps)
      fail(RTC_ERROR_INVALID_ARGUMENT,
           "time step " + std::to_string(step) + ", expected less than " + std::to_string(g.time_steps));
    if (map == nullptr) fail(RTC_ERROR_INVALID_ARGUMENT, "there is no transform");
    g.turning.resize(g.time_steps);
    g.turning[step] = to_turning_map(*map);
    g.change_shape();
  });
}

RTC_API void rtcGetGeometryTransform(RTCGeometry geometry, float time, RTCFormat format, void* data) {
  with(geometry, [&](Geometry& g) { write_transform(transform_at(g, 0, time), format, data); });
}

#if defined(RTC_GEOMETRY_INSTANCE_ARRAY)
RTC_API void rtcGetGeometryTransformEx(RTCGeometry geometry, unsigned index, float time, RTCFormat format,
                                       void* data) {
  with(geometry, [&](Geometry& g) { write_transform(transform_at(g, index, time), format, data); });
}
#endif

// ---- What subdivision surfaces have.

/// Reports that there are none, unless that was said when the geometry was made.
static unsigned no_subdivision(RTCGeometry geometry) {
  return guarded(device_of(geometry), [&]() -> unsigned {
    if (object_of(geometry).is_refused()) return 0;
    fail(RTC_ERROR_INVALID_OPERATION, "the geometry is no subdivision surface");
  });
}

RTC_API void rtcSetGeometryTessellationRate(RTCGeometry geometry, float) { no_subdivision(geometry); }
RTC_API void rtcSetGeometryTopologyCount(RTCGeometry geometry, unsigned) { no_subdivision(geometry); }
RTC_API void rtcSetGeometrySubdivisionMode(RTCGeometry geometry, unsigned, RTCSubdivisionMode) {
  no_subdivision(geometry);
}
RTC_API void rtcSetGeometryVertexAttributeTopology(RTCGeometry geometry, unsigned, unsigned) {
  no_subdivision(geometry);
}
RTC_API void rtcSetGeometryDisplacementFunction(RTCGeometry geometry, RTCDisplacementFunctionN) {
  no_subdivision(geometry);
}
RTC_API unsigned rtcGetGeometryFirstHalfEdge(RTCGeometry geometry, unsigned) {
  return no_subdivision(geometry);
}
RTC_API unsigned rtcGetGeometryFace(RTCGeometry geometry, unsigned) { return no_subdivision(geometry); }
RTC_API unsigned rtcGetGeometryNextHalfEdge(RTCGeometry geometry, unsigned) {
  return no_subdivision(geometry);
}
RTC_API unsigned rtcGetGeometryPreviousHalfEdge(RTCGeometry geometry, unsigned) {
  return no_subdivision(geometry);
}
RTC_API unsigned rtcGetGeometryOppositeHalfEdge(RTCGeometry geometry, unsigned, unsigned) {
  return no_subdivision(geometry);
}
