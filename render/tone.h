#pragma once
/// \file Tone curves: how linear light becomes what a screen can show.

#include "core/description.h"
#include "core/vec3.h"

namespace oktett {

/// What happens to light before the sRGB curve encodes it.
enum class ToneKind {
  srgb,     ///< nothing: light of 1 is white, more is cut off
  filmic,   ///< the curve of a film with a long shoulder (Hable 2010)
  aces,     ///< the reference rendering and sRGB output of the Academy, as fitted by Hill (2016)
  neutral,  ///< colours as they are up to 0.76, highlights compressed (Khronos 2024)
  raw,      ///< files hold the numbers as they are, without the curve of sRGB
};
/// Their names.
inline constexpr Choice<ToneKind> kToneKinds[] = {{"srgb", ToneKind::srgb},
                                                  {"filmic", ToneKind::filmic},
                                                  {"aces", ToneKind::aces},
                                                  {"neutral", ToneKind::neutral},
                                                  {"raw", ToneKind::raw}};

/// Exposures that make sense, in stops.
inline constexpr Range kExposures{-64, 64};

/// Powers of light that make sense.
inline constexpr Range kGammas{0.1, 10};

/// A tone curve, and the exposure before it.
struct Tone {
  ToneKind kind = ToneKind::srgb;
  double exposure = 0;  ///< in stops: light is multiplied by 2^exposure
  /// Light is raised to this power first: of scenes whose numbers are meant as a screen of that gamma shows
  /// them.
  double gamma = 1;
  bool operator==(const Tone&) const = default;
  /// True if light stays as it is.
  bool is_identity() const { return kind == ToneKind::srgb && exposure == 0 && gamma == 1; }
};

/// `c`, linear Rec.709, as `tone` shows it: still linear, in [0, 1] for all curves but ToneKind::srgb.
/// Negative light counts as none. Colours that are not finite stay so.
Color toned(const Tone& tone, const Color& c);

}  // namespace oktett
