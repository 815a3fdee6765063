#!/usr/bin/env bash
# A vertical line through a box comes out whole when SFCGAL subtracts the box, at half of all places; a line inside a solid has a distance from it.
#
# One would guess: the difference of a line and a box is what is left of the line outside of the box, wherever the line goes through it: of a
# line from -3 to 5 through a box from 0 to 2 the parts from -3 to 0 and from 2 to 5. The distance of things that intersect is 0.
# What happens: sfcgal_geometry_difference_3d of SFCGAL 1.4.1 (Debian 12) and 2.0.0 (Debian 13) cuts all lines along x and along y right. Of 25
# lines along z it cuts the 10 with x > y right; the 15 with x < y come out with all of their length, in either direction, and with a point at
# the upper face, but none at the lower one. If such a line begins at -1, its part from -1 to 0 is lost instead. All 15 lines along z through a
# tetrahedron come out whole. A line with a point in the middle of the box is cut right.
# A point and a triangle inside the box have the distance 0, but a line has 0.5 and a smaller box 0.8, which is how far they are from the faces;
# for all four of them "intersects" is true. PostGIS offers both, as CG_3DDifference and CG_3DDistance.
# Why a user of a ray tracer meets it: a ray minus a solid is the way of light outside of it, and the rest is the thickness. Distances
# of parts tell whether they collide.
#
# Needs Debian 12, g++ and the network. Debian 12: libsfcgal-dev 1.4.1-5. Debian 13: libsfcgal-dev 2.0.0-1. About three minutes.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
cd "$work"

cat >cut.cpp <<'CPP'
#include "sfcgal_c.h"

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

static int print(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  const int count = std::vfprintf(stderr, format, arguments);
  va_end(arguments);
  return count;
}
static sfcgal_geometry_t* read(const char* wkt) { return sfcgal_io_read_wkt(wkt, std::strlen(wkt)); }

// The length of a line, or of the lines of a collection.
static double length(const sfcgal_geometry_t* g) {
  double sum = 0;
  if (sfcgal_geometry_type_id(g) != SFCGAL_TYPE_LINESTRING) {
    for (size_t i = 0; i < sfcgal_geometry_collection_num_geometries(g); ++i) sum += length(sfcgal_geometry_collection_geometry_n(g, i));
    return sum;
  }
  for (size_t i = 1; i < sfcgal_linestring_num_points(g); ++i) {
    const sfcgal_geometry_t *a = sfcgal_linestring_point_n(g, i - 1), *b = sfcgal_linestring_point_n(g, i);
    const double x = sfcgal_point_x(a) - sfcgal_point_x(b), y = sfcgal_point_y(a) - sfcgal_point_y(b), z = sfcgal_point_z(a) - sfcgal_point_z(b);
    sum += std::sqrt(x * x + y * y + z * z);
  }
  return sum;
}

// Lines at 25 places, none on the diagonal: how many of them are cut right, and how many keep all of their length, by the half they are in.
static void count(const char* name, const char* format, const sfcgal_geometry_t* solid, bool tetrahedron) {
  int right[2] = {}, whole[2] = {};
  for (int i = 1; i < 20; i += 4)
    for (int j = 2; j < (tetrahedron ? 20 - i : 20); j += 4) {
      char wkt[100];
      const double a = i / 10., b = j / 10., inside = tetrahedron ? 2 - a - b : 2;
      std::snprintf(wkt, sizeof wkt, format, a, b, a, b);
      const double left = length(sfcgal_geometry_difference_3d(read(wkt), solid));
      if (std::fabs(left - (8 - inside)) < 1e-6) ++right[a < b];
      if (std::fabs(left - 8) < 1e-6) ++whole[a < b];
    }
  std::printf("%s: %d right and %d whole, %d right and %d whole\n", name, right[0], whole[0], right[1], whole[1]);
}

static void cut(const char* line, const sfcgal_geometry_t* solid) {
  char* text;
  size_t size;
  sfcgal_geometry_as_text_decim(sfcgal_geometry_difference_3d(read(line), solid), 1, &text, &size);
  std::printf("%.*s\n", static_cast<int>(size), text);
}

static void apart(const char* name, const sfcgal_geometry_t* thing, const sfcgal_geometry_t* solid) {
  std::printf("%s: intersects %d, distance %.1f\n", name, sfcgal_geometry_intersects_3d(thing, solid), sfcgal_geometry_distance_3d(thing, solid));
}

int main() {
  sfcgal_init();
  sfcgal_set_error_handlers(print, print);
  const sfcgal_geometry_t* box = read("SOLID((((0 0 0,0 2 0,2 2 0,2 0 0,0 0 0)),((0 0 2,2 0 2,2 2 2,0 2 2,0 0 2)),((0 0 0,2 0 0,2 0 2,0 0 2,0 0 0)),"
                                      "((2 0 0,2 2 0,2 2 2,2 0 2,2 0 0)),((2 2 0,0 2 0,0 2 2,2 2 2,2 2 0)),((0 2 0,0 0 0,0 0 2,0 2 2,0 2 0))))");
  const sfcgal_geometry_t* tetrahedron =
      read("SOLID((((0 0 0,0 2 0,2 0 0,0 0 0)),((0 0 0,2 0 0,0 0 2,0 0 0)),((0 0 0,0 0 2,0 2 0,0 0 0)),((2 0 0,0 2 0,0 0 2,2 0 0))))");
  std::printf("valid: %d %d\n", sfcgal_geometry_is_valid(box), sfcgal_geometry_is_valid(tetrahedron));
  count("along x", "LINESTRING(-3 %g %g,5 %g %g)", box, false);
  count("along y", "LINESTRING(%g -3 %g,%g 5 %g)", box, false);
  count("along z", "LINESTRING(%g %g -3,%g %g 5)", box, false);
  count("along -z", "LINESTRING(%g %g 5,%g %g -3)", box, false);
  count("tetrahedron, along z", "LINESTRING(%g %g -3,%g %g 5)", tetrahedron, true);
  cut("LINESTRING(.6 .3 -3,.6 .3 5)", box);
  cut("LINESTRING(.3 .6 -3,.3 .6 5)", box);
  cut("LINESTRING(.3 .6 -1,.3 .6 5)", box);
  cut("LINESTRING(.3 .6 -3,.3 .6 1,.3 .6 5)", box);
  apart("point", read("POINT(1 1 1)"), box);
  apart("triangle", read("TRIANGLE((1 1 1,1.2 1 1,1 1.2 1,1 1 1))"), box);
  apart("line", read("LINESTRING(1 1 .5,1 1 1)"), box);
  apart("smaller box", sfcgal_geometry_extrude(read("POLYGON((1 1 1,1.2 1 1,1.2 1.2 1,1 1.2 1,1 1 1))"), 0, 0, .2), box);
}
CPP

guess "25 of 25 lines are cut right, in any direction; the distances of all four things inside the box are 0"
for release in "bookworm 1.4.1-5" "trixie 2.0.0-1"; do
  read -r suite version <<<"$release"
  unpack "$suite" amd64 libsfcgal-dev="$version"
  mkdir -p "include-$suite"
  ln -s "$root/usr/include/SFCGAL" "include-$suite/SFCGAL"
  g++ -O1 -I"include-$suite/SFCGAL/capi" -I"include-$suite" cut.cpp -o cut -L"$libraries" -lSFCGAL -Wl,-rpath-link,"$libraries" \
    -Wl,--allow-shlib-undefined
  run "$work/cut" | sed 's/ Z (/(/; s/-0\.0/0.0/g' >out
  line=0
  expect() {
    line=$((line + 1))
    seen "$version, $1" "$2" "$(sed -n ${line}p out)"
  }
  expect "box and tetrahedron" "valid: 1 1"
  expect "lines by half" "along x: 10 right and 0 whole, 15 right and 0 whole"
  expect "lines by half" "along y: 10 right and 0 whole, 15 right and 0 whole"
  expect "lines by half" "along z: 10 right and 0 whole, 0 right and 15 whole"
  expect "lines by half" "along -z: 10 right and 0 whole, 0 right and 15 whole"
  expect "lines by half" "tetrahedron, along z: 0 right and 6 whole, 0 right and 9 whole"
  expect "0.6 0.3, from -3 to 5" "MULTILINESTRING((0.6 0.3 -3.0,0.6 0.3 0.0),(0.6 0.3 2.0,0.6 0.3 5.0))"
  expect "0.3 0.6, from -3 to 5" "LINESTRING(0.3 0.6 -3.0,0.3 0.6 2.0,0.3 0.6 5.0)"
  expect "0.3 0.6, from -1 to 5" "LINESTRING(0.3 0.6 2.0,0.3 0.6 5.0)"
  expect "0.3 0.6, from -3 to 5 with a point at 1" "MULTILINESTRING((0.3 0.6 -3.0,0.3 0.6 1.0),(0.3 0.6 2.0,0.3 0.6 5.0))"
  expect "inside the box" "point: intersects 1, distance 0.0"
  expect "inside the box" "triangle: intersects 1, distance 0.0"
  expect "inside the box" "line: intersects 1, distance 0.5"
  expect "inside the box" "smaller box: intersects 1, distance 0.8"
done
finish
