#include "render/bsdf/principled_lobes.h"

namespace oktett {

PrincipledSurface::PrincipledSurface(const PrincipledParameters& p, bool is_front)
    : SurfaceOf(p, PrincipledBase(p, is_front)), stretch(p.stretch) {}

/// Calls act(a type of a lobe, its surface) for the lobes of a list.
template <template <class> class... L, class Act>
static void each_lobe(LobeList<L...>, const PrincipledSurface& s, Act&& act) {
  using D = Simd<double, 1, ScalarIsa>;
  const PrincipledBase& base = s;
  (act(std::type_identity<L<D>>{}, static_cast<const typename L<D>::Surface&>(s), base), ...);
}

bool PrincipledSurface::only_delta() const {
  bool only = true;
  each_lobe(PrincipledList{}, *this,
            [&]<class Lobe>(std::type_identity<Lobe>, const auto& s, const auto& base) {
              only = only && (!Lobe::is_there(s, base) || Lobe::is_delta(s, base));
            });
  return only;
}

bool PrincipledSurface::transmits() const {
  bool some = false;
  each_lobe(PrincipledList{}, *this, [&]<class Lobe>(std::type_identity<Lobe>, const auto& s, const auto&) {
    if constexpr (requires { Lobe::transmits(s); }) some = some || Lobe::transmits(s);
  });
  return some;
}

}  // namespace oktett
