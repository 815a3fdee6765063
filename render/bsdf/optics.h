#pragma once
/// \file Mirrors and dielectrics: where light goes, and how much of it. All vectors have unit length.

#include <optional>

#include "core/vec3.h"

namespace oktett {

/// The direction in which a ray along `d` leaves a mirror of normal `n`.
Vec3f reflect(const Vec3f& d, const Vec3f& n);

/// The same, for a shading normal `n` that differs from the geometric normal `ng` (both on the side `d` comes
/// from): if the mirrored direction would go below the true surface it is folded back above it.
Vec3f reflect_above(const Vec3f& d, const Vec3f& n, const Vec3f& ng);

/// The direction in which a ray along `d` continues behind an interface of normal `n`, dot(d, n) <= 0, by
/// Snell's law; nothing if all light is reflected. `eta` is the index of refraction behind the interface
/// relative to that before it.
std::optional<Vec3f> refract(const Vec3f& d, const Vec3f& n, float eta);

/// The fraction of unpolarised light that an interface between dielectrics reflects, by Fresnel's equations:
/// 1 beyond the critical angle. `cosine` is that of the angle of incidence, [0, 1].
double fresnel(double cosine, double eta);

/// The same for a conductor of complex index of refraction eta + i k, relative to the medium before it, eta >
/// 0 (Born 1999, section 14.2).
double conductor_fresnel(double cosine, double eta, double k);

}  // namespace oktett
