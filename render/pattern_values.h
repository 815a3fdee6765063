#pragma once
/// \file The values of patterns of pattern_kinds.h at places, before a wave brings them into one period.

#include <optional>

#include "render/pattern.h"

namespace oktett {

/// What the value of a pattern depends on beside its own numbers.
struct PatternFrame {
  const PatternTurbulence& turbulence;
  const Wave& wave;
  const PatternTextures* others = nullptr;  ///< null: other textures are black
};

// Of figures: pattern_figures.cpp.
double raw_value(const AngularPattern&, const Vec3d& p, const PatternFrame&);
double raw_value(const BoxedPattern&, const Vec3d& p, const PatternFrame&);
double raw_value(const CylindricalPattern&, const Vec3d& p, const PatternFrame&);
double raw_value(const FunctionPattern& f, const Vec3d& p, const PatternFrame&);
double raw_value(const IncidencePattern&, const Vec3d& p, const PatternFrame&);
double raw_value(const LayersPattern&, const Vec3d& p, const PatternFrame&);
double raw_value(const LeopardPattern&, const Vec3d& p, const PatternFrame&);
double raw_value(const LinearPattern& l, const Vec3d& p, const PatternFrame&);
double raw_value(const OnionPattern&, const Vec3d& p, const PatternFrame&);
double raw_value(const PlanarPattern&, const Vec3d& p, const PatternFrame&);
double raw_value(const QuiltedPattern& q, const Vec3d& p, const PatternFrame&);
double raw_value(const RingsPattern&, const Vec3d& p, const PatternFrame&);
double raw_value(const RipplesPattern& r, const Vec3d& p, const PatternFrame&);
double raw_value(const SlopePattern& s, const Vec3d& p, const PatternFrame&);
double raw_value(const SphericalPattern&, const Vec3d& p, const PatternFrame&);
double raw_value(const SpiralPattern& s, const Vec3d& p, const PatternFrame&);
double raw_value(const DoubleSpiralPattern& s, const Vec3d& p, const PatternFrame&);
double raw_value(const TexturePattern& t, const Vec3d& p, const PatternFrame&);
double raw_value(const VoxelPattern& v, const Vec3d& p, const PatternFrame&);
double raw_value(const WavesPattern& w, const Vec3d& p, const PatternFrame&);

/// The way from the middle of a cushion of `quilted`.
Vec3d from_cushion_middle(const Vec3d& p);
/// A Bezier curve of the distance from the middle of a cushion, which runs to 1 at 1.
double cushion_curve(const QuiltedPattern& q, double distance);

// Of cells and of noise: pattern_cells.cpp. Of patterns with kValues the number of the value.
double raw_value(const AgatePattern& a, const Vec3d& p, const PatternFrame&);
double raw_value(const BumpsPattern&, const Vec3d& p, const PatternFrame&);
double raw_value(const BrickPattern& b, const Vec3d& p, const PatternFrame&);
double raw_value(const CellsPattern&, const Vec3d& p, const PatternFrame&);
double raw_value(const CracklePattern& c, const Vec3d& p, const PatternFrame&);
double raw_value(const CubicPattern&, const Vec3d& p, const PatternFrame&);
double raw_value(const DentsPattern&, const Vec3d& p, const PatternFrame&);
double raw_value(const GranitePattern&, const Vec3d& p, const PatternFrame&);
double raw_value(const HexagonPattern&, const Vec3d& p, const PatternFrame&);
double raw_value(const WrinklesPattern&, const Vec3d& p, const PatternFrame&);

// pattern_fractal.cpp.
double raw_value(const FractalPattern& f, const Vec3d& p, const PatternFrame&);

// pattern_bends.cpp.
/// What POV-Ray adds to the normals of surfaces for these patterns in place of their slope; nothing for all
/// others.
std::optional<Vec3d> povray_bend(const Pattern& pattern, const Vec3d& p, const PatternFrame& frame);

}  // namespace oktett
