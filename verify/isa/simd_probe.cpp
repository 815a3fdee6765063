#include "verify/probes/simd_probe.h"

#include "core/simd_memory.h"
#include "core/simd_order.h"
#include "verify/isa/load_column.h"

namespace oktett {

template <class V>
static V lanes_of(const typename V::M& m) {
  using T = typename V::Element;
  T lanes[V::kWidth];
  for (int i = 0; i < V::kWidth; ++i) lanes[i] = static_cast<T>(bits(m) >> i & 1);
  return V::load(lanes);
}

template <class V>
static V apply(SimdOp op, const V& a, const V& b) {
  switch (op) {
    case SimdOp::add:
      return a + b;
    case SimdOp::subtract:
      return a - b;
    case SimdOp::multiply:
      return a * b;
    case SimdOp::negate:
      return -a;
    case SimdOp::less:
      return lanes_of<V>(a < b);
    case SimdOp::less_equal:
      return lanes_of<V>(a <= b);
    case SimdOp::equal:
      return lanes_of<V>(a == b);
    default:
      break;
  }
  if constexpr (std::is_floating_point_v<typename V::Element>) {
    if (op == SimdOp::divide) return a / b;
    if (op == SimdOp::min) return min(a, b);
    if (op == SimdOp::max) return max(a, b);
    if (op == SimdOp::abs) return abs(a);
    if (op == SimdOp::sqrt) return sqrt(a);
  }
  return a;
}

template <class V>
static void run(SimdOp op, const SimdColumns<typename V::Element>& columns) {
  using T = typename V::Element;
  constexpr std::size_t W = V::kWidth;
  for (std::size_t at = 0; at < columns.count; at += W) {
    T lanes[W];
    apply(op, load_column<V>(columns.a, at, columns.count), load_column<V>(columns.b, at, columns.count))
        .store(lanes);
    for (std::size_t i = 0; i < W && at + i < columns.count; ++i) columns.out[at + i] = lanes[i];
  }
}

template <class T, class A>
static void run_width(SimdOp op, int width, const SimdColumns<T>& columns) {
  if (width == 4) run<Simd<T, 4, A>>(op, columns);
  if (width == 8) run<Simd<T, 8, A>>(op, columns);
  if (width == 16) run<Simd<T, 16, A>>(op, columns);
}

template <class A>
const SimdProbeCode& simd_probe_code() {
  static constexpr SimdProbeCode code = {
      run_width<float, A>,
      run_width<double, A>,
      run_width<std::int32_t, A>,
      [](const float* keys, unsigned lanes, const std::uint32_t* values, std::uint32_t* out_values,
         float* out_keys) {
        return store_descending(Simd<float, 8, A>::load(keys), lanes, values, out_values, out_keys);
      },
      [](const float* keys, unsigned lanes, const std::uint32_t* values, std::uint32_t* out_values,
         std::uint32_t* out_keys) {
        LaneOrder<A> order(Simd<float, 8, A>::load(keys), Mask<float, 8, A>::from_bits(lanes));
        int size = 0;
        for (auto least = order.least(); least.key() != ~0u; least = order.least(), ++size) {
          out_values[size] = least.pick(values), out_keys[size] = least.key();
          order.take(least);
        }
        return size;
      },
      [](unsigned lanes, const std::uint32_t* values, std::uint32_t* out) {
        return store_compact<A>(lanes, values, out);
      },
      [](const std::uint16_t* words, int k, const float* row, float* out) {
        PackedIndices<8, A>(words).look_up(k, row).store(out);
      },
      [](const std::uint16_t* words, unsigned flip, float* out) { load_words<A>(words, flip).store(out); },
  };
  return code;
}

template const SimdProbeCode& simd_probe_code<OKTETT_ISA>();

}  // namespace oktett
