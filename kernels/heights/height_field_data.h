#pragma once
/// \file What describes a height field.

#include <cstdint>
#include <memory>

#include "core/description.h"
#include "core/vec3.h"

namespace oktett {

/// The samples of a height field; make_height_grid makes one.
class HeightGrid;

/// The surface between four neighbouring samples.
enum class HeightInterpolation : std::uint8_t {
  nearest,    ///< a level square at their mean height, with upright walls to its neighbours (Zachmann 2010)
  triangles,  ///< two, which meet on the line from the corner (column + 1, row) to (column, row + 1)
  bilinear,   ///< a patch of a hyperbolic paraboloid (Zachmann 2010)
};

/// How a ray passes over the cells between samples. The hits are the same for each.
enum class HeightWalk : std::uint8_t {
  pyramid,  ///< in blocks of cells, skipping those whose least and greatest height the ray does not come
            ///< between
  cells,    ///< one cell after the other, by a digital differential analyser
  spans,    ///< runs of cells of one row (C. Henning, P. Stephenson 2004)
};

/// Heights over a rectangle about the y axis: sample (column, row) stands at x = (column / (columns - 1) -
/// 1/2) size.x, z = (row / (rows - 1) - 1/2) size.z, and y is size.y times its value.
struct HeightFieldShape {
  std::shared_ptr<const HeightGrid> grid;
  Vec3d size{2, 1, 2};  ///< > 0
  bool open = true;     ///< without the sides and the bottom at y = base, which make it a solid
  double base = 0;      ///< below all heights, unless open
  HeightWalk walk = HeightWalk::pyramid;
  /// The interpolation of the scene file, for which `grid` was made.
  HeightInterpolation interpolation = HeightInterpolation::bilinear;
  /// Shades with normals of the samples, by the heights of their neighbours; not `nearest`.
  bool smooth = false;
  /// In scene files, whether `grid` is made from the numbers of the colours of a palette.
  bool palette = false;

  static constexpr ShapeInfo kShapeInfo{"height_field",
                                        "heights over a rectangle, from one of `file` and `function`"};
  void describe(auto& p) {
    p.optional("file", ByHand{"file", "file"},
               "a grey image. 8 and 16 bits have values from 0 to 1, all others (EXR, TIFF) those that are "
               "stored; the top row lies at the least z");
    p.field(
        "palette", palette,
        "whether the heights are the numbers of the colours in the palette of a PNG image, counted from 0 "
        "and divided by 256");
    p.optional("function", ByHand{"[expression](#values) in x and z", "text"},
               "the heights where there is no file");
    p.field("samples", ByHand{"whole number or `[columns, rows]`, at least 2", "samples", "512"},
            "at how many places along each side the function is taken");
    p.field("size", size, kLength,
            "the rectangle lies about the y axis, x from -size.x / 2 to size.x / 2 and z likewise; the value "
            "of a sample times size.y is y");
    p.choice("interpolation", interpolation,
             {{"nearest", HeightInterpolation::nearest},
              {"triangles", HeightInterpolation::triangles},
              {"bilinear", HeightInterpolation::bilinear}},
             "what is between four samples; `nearest` makes level steps");
    p.field("smooth", smooth,
            "whether light falls as if it were curved, by normals at the samples and between them; not with "
            "`nearest`");
    p.check(!smooth || interpolation != HeightInterpolation::nearest, "smooth",
            "steps cannot be smooth: `nearest` has no 'smooth'");
    open &=
        !p.optional("base", base, kCoordinate,
                    "a y below all heights, which makes it a solid with upright sides and a bottom there");
    p.choice("walk", walk,
             {{"pyramid", HeightWalk::pyramid}, {"cells", HeightWalk::cells}, {"spans", HeightWalk::spans}},
             "[which find the same](surfaces.md#height-fields)");
    p.normals();
    p.one_of({"file", "function"});
    p.not_both("file", "samples", "a height field from a file has no 'samples'", "samples");
  }
};

}  // namespace oktett
