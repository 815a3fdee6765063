/// \file Interpolation of vertex data over a primitive.

#include <cstring>

#include "embree/geometry.h"

namespace oktett::embree {
namespace {

/// Weights of up to four vertices, and their derivatives by u and v; the only second derivative that is not
/// zero is the mixed one.
struct Weights {
  std::uint32_t vertex[4] = {};
  float at[4] = {}, du[4] = {}, dv[4] = {}, dudv[4] = {};
  int count = 0;

  void add(std::uint32_t v, float w, float by_u, float by_v, float by_both) {
    vertex[count] = v, at[count] = w, du[count] = by_u, dv[count] = by_v, dudv[count] = by_both;
    ++count;
  }
  /// The bilinear weights of a quad, whose derivatives are `su` and `sv` times larger.
  void add_quad(const std::uint32_t (&v)[4], float s, float t, float su, float sv) {
    add(v[0], (1 - s) * (1 - t), -(1 - t) * su, -(1 - s) * sv, su * sv);
    add(v[1], s * (1 - t), (1 - t) * su, -s * sv, -su * sv);
    add(v[2], s * t, t * su, s * sv, su * sv);
    add(v[3], (1 - s) * t, -t * su, (1 - s) * sv, -su * sv);
  }
};

/// The item of a view; throws ApiError if there is none.
template <class T>
const T* item_of(const Geometry& g, RTCBufferType buffer, std::uint32_t primitive) {
  const View& view = g.view({buffer, 0});
  if (primitive >= view.count)
    fail(RTC_ERROR_INVALID_ARGUMENT,
         "primitive " + std::to_string(primitive) + ", expected less than " + std::to_string(view.count));
  return view.item<T>(primitive);
}

Weights weights_of(const Geometry& g, std::uint32_t primitive, float u, float v) {
  Weights w;
  switch (g.type) {
    case RTC_GEOMETRY_TYPE_TRIANGLE: {
      const auto* const i = item_of<std::uint32_t>(g, RTC_BUFFER_TYPE_INDEX, primitive);
      w.add(i[0], 1 - u - v, -1, -1, 0), w.add(i[1], u, 1, 0, 0), w.add(i[2], v, 0, 1, 0);
      break;
    }
    case RTC_GEOMETRY_TYPE_QUAD: {
      // Over the two triangles that a quad is: linear on each.
      const auto* const i = item_of<std::uint32_t>(g, RTC_BUFFER_TYPE_INDEX, primitive);
      if (u + v <= 1)
        w.add(i[0], 1 - u - v, -1, -1, 0), w.add(i[1], u, 1, 0, 0), w.add(i[3], v, 0, 1, 0);
      else
        w.add(i[2], u + v - 1, 1, 1, 0), w.add(i[3], 1 - u, -1, 0, 0), w.add(i[1], 1 - v, 0, -1, 0);
      break;
    }
    case RTC_GEOMETRY_TYPE_GRID: {
      const RTCGrid grid = *item_of<RTCGrid>(g, RTC_BUFFER_TYPE_GRID, primitive);
      if (grid.width < 2 || grid.height < 2) fail(RTC_ERROR_INVALID_ARGUMENT, "the grid has no quads");
      const auto su = static_cast<float>(grid.width - 1), sv = static_cast<float>(grid.height - 1);
      const auto cell = [](float at, float cells) { return std::min(std::max(0.0f, at), cells - 1); };
      const float x = std::floor(cell(u * su, su)), y = std::floor(cell(v * sv, sv));
      const std::uint32_t first =
          grid.startVertexID + static_cast<std::uint32_t>(y) * grid.stride + static_cast<std::uint32_t>(x);
      w.add_quad({first, first + 1, first + grid.stride + 1, first + grid.stride}, u * su - x, v * sv - y, su,
                 sv);
      break;
    }
    case RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE: {
      const std::uint32_t i = *item_of<std::uint32_t>(g, RTC_BUFFER_TYPE_INDEX, primitive);
      w.add(i, 1 - u, -1, 0, 0), w.add(i + 1, u, 1, 0, 0);
      break;
    }
    case RTC_GEOMETRY_TYPE_SPHERE_POINT:
    case RTC_GEOMETRY_TYPE_DISC_POINT:
    case RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT:
      w.add(primitive, 1, 0, 0, 0);
      break;
    default:
      fail(RTC_ERROR_INVALID_OPERATION,
           "geometries of type " + std::to_string(static_cast<int>(g.type)) + " have nothing to interpolate");
  }
  return w;
}

/// Where results go: value k of point i at first[k * stride].
struct Places {
  float *p, *du, *dv, *dudu, *dvdv, *dudv;
  std::size_t stride;
};

void interpolate(const Geometry& g, std::uint32_t primitive, float u, float v, RTCBufferType type,
                 unsigned slot, unsigned count, const Places& out) {
  const View& view = g.view({type, slot});
  const Weights w = weights_of(g, primitive, u, v);
  for (int i = 0; i < w.count; ++i)
    if (w.vertex[i] >= view.count)
      fail(RTC_ERROR_INVALID_ARGUMENT,
           "vertex " + std::to_string(w.vertex[i]) + " of a buffer of " + std::to_string(view.count));
  for (unsigned k = 0; k < count; ++k) {
    const auto sum = [&](const float(&weights)[4]) {
      float value = 0;
      for (int i = 0; i < w.count; ++i) value += weights[i] * view.item<float>(w.vertex[i])[k];
      return value;
    };
    const auto set = [&](float* to, float value) {
      if (to != nullptr) to[k * out.stride] = value;
    };
    if (out.p != nullptr) set(out.p, sum(w.at));
    if (out.du != nullptr) set(out.du, sum(w.du)), set(out.dv, sum(w.dv));
    set(out.dudu, 0), set(out.dvdv, 0);
    if (out.dudv != nullptr) set(out.dudv, sum(w.dudv));
  }
}

}  // namespace
}  // namespace oktett::embree

using namespace oktett::embree;

RTC_API void rtcInterpolate(const RTCInterpolateArguments* a) {
  guarded(device_of(a->geometry), [&] {
    interpolate(object_of(a->geometry), a->primID, a->u, a->v, a->bufferType, a->bufferSlot, a->valueCount,
                {a->P, a->dPdu, a->dPdv, a->ddPdudu, a->ddPdvdv, a->ddPdudv, 1});
  });
}

RTC_API void rtcInterpolateN(const RTCInterpolateNArguments* a) {
  guarded(device_of(a->geometry), [&] {
    const Geometry& g = object_of(a->geometry);
    const auto* const valid = static_cast<const int*>(a->valid);
    for (unsigned i = 0; i < a->N; ++i) {
      if (valid != nullptr && valid[i] != -1) continue;
      const auto of = [i](float* p) { return p != nullptr ? p + i : nullptr; };
      interpolate(g, a->primIDs[i], a->u[i], a->v[i], a->bufferType, a->bufferSlot, a->valueCount,
                  {of(a->P), of(a->dPdu), of(a->dPdv), of(a->ddPdudu), of(a->ddPdvdv), of(a->ddPdudv), a->N});
    }
  });
}
