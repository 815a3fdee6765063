#include "io/pov/winding_functions.h"

#include <algorithm>
#include <array>

#include "io/pov/formula_text.h"

namespace oktett::pov {
namespace {

using Operands = std::vector<std::string>;

/// (|u|^(2/n) + |v|^(2/n))^(n/2): the distance from a tube's middle whose section is a superellipse, a circle
/// for n of 1.
std::string section(const std::string& u, const std::string& v, const std::string& n) {
  return filled("pow(pow(abs($0), 2 / $2) + pow(abs($1), 2 / $2), $2 / 2)", {u, v, n});
}

/// f_helix1: tubes that wind about the y axis, each a turn of 2 pi / $4 up, from $3 places around it.
std::string helix1(const Operands& operands) {
  Operands o = operands;
  // Where a place is in the turn of the tube that is nearest, from -pi to pi.
  const std::string turn = filled("$3 * ($4 * $1 + atan2($2, $0))", o);
  const std::string part = filled("$0 - 2 * pi * floor($0 / (2 * pi)) - pi", {turn});
  const std::string up = filled("$0 / ($1 * $2 * $3)", {part, o[3], o[4], o[7]});
  const std::string out = filled("hypot($0, $2) - $6", o);
  const std::string angle = filled("$9 * pi / 180", o);
  const std::string u = filled("$0 * cos($2) - $1 * sin($2)", {out, up, angle}),
                    v = filled("$0 * sin($2) + $1 * cos($2)", {out, up, angle});
  return filled("$0 - $1", {section(u, v, o[8]), o[5]});
}

/// f_helix2: one tube whose section in each plane of equal height is a superellipse, turned with the tube.
std::string helix2(const Operands& o) {
  const std::string turn = filled("$4 * $1", o);
  const std::string x = filled("$0 - $1 * cos($2)", {o[0], o[6], turn}),
                    z = filled("$0 - $1 * sin($2)", {o[2], o[6], turn});
  const std::string u = filled("$0 * cos($2) + $1 * sin($2)", {x, z, turn}),
                    v = filled("$1 * cos($2) - $0 * sin($2)", {x, z, turn});
  return filled("$0 - $1", {section(u, v, o[8]), o[5]});
}

/// f_helical_torus: a strand at the distance $8 from a ring of radius $3, which goes $4 times around the axis
/// of the ring and $5 times around its tube. Along its turn a place is $9 times the square of its angle away.
/// It is $6 thick, with grooves of the period $10 and the amplitude $11 that turn by $12 around the axis.
std::string helical_torus(const Operands& o) {
  const std::string axis = filled("hypot($0, $2)", o);
  const std::string out = filled("hypot($0 - $1, $2) - $3", {axis, o[3], o[1], o[8]});
  const std::string around = filled("atan2(-$0, $1)", {o[0], o[2]});
  // Where a place is in the winding that is nearest, from -pi to pi.
  const std::string turn =
      filled("-$0 * $1 - $2 * atan2($3 - $4, $5)", {o[4], around, o[5], o[3], axis, o[1]});
  const std::string part = filled("pi - $0 + 2 * pi * floor($0 / (2 * pi))", {turn});
  const std::string away = filled("min(sqrt($0^2 + $1 * $2^2), $0 + 2 * $3)", {out, o[9], part, o[8]});
  const std::string groove =
      filled("cos($0 * atan2($1 * $2, $3) + $4 * $5)", {o[10], o[11], part, out, o[12], around});
  return filled("min($0 - $1 * $2, $3 + $4 - $5) - $6", {away, o[6], groove, axis, o[3], o[8], o[7]});
}

/// f_spiral: a tube that winds about the origin in the plane of x and z, each turn $3 farther out, in a ball
/// of radius $5.
std::string spiral(const Operands& o) {
  const std::string beyond = filled("hypot($0, $2) - $3 * (0.5 - atan2($2, $0) / (2 * pi))", o);
  // There is no winding before the first.
  const std::string out = filled("$0 - $1 * max(0, floor($0 / $1 + 0.5))", {beyond, o[3]});
  const std::string distance = filled("sqrt($0^2 + $1^2 + $2^2)", o);
  return filled("max(min($0, $1) - $2, $1 - $3)", {section(out, o[1], o[8]), distance, o[4], o[5]});
}

/// f_polytubes: the distance from the nearest of $3 lines around the y axis, whose distance from it is a
/// polynomial of the height.
std::string polytubes(const Operands& o) {
  const std::string out =
      filled("$0 + $1 * ($2 + $1 * ($3 + $1 * ($4 + $1 * $5)))", {o[4], o[1], o[5], o[6], o[7], o[8]});
  // A negative distance is one to the other side.
  const std::string turn = filled("atan2($0, $1) + pi * max(0, -sign($2))", {o[0], o[2], out});
  const std::string part = filled("$0 - 2 * pi / $1 * floor($0 * $1 / (2 * pi) + 0.5)", {turn, o[3]});
  const std::string axis = filled("hypot($0, $2)", o);
  return filled("hypot($0 * cos($1) - abs($2), $0 * sin($1))", {axis, part, out});
}

/// f_mesh1: threads along x and z that go over and under each other.
std::string mesh(const Operands& o) {
  // Those of even numbers, and of odd ones, which are as high to the other side.
  const auto family = [&](const std::string& across, const std::string& gap, const std::string& height) {
    const std::string even = filled("$0 - 2 * $1 * floor($0 / (2 * $1) + 0.5)", {across, gap});
    return filled("min(hypot($3 * $0, $4 * ($2 - $5)), hypot($3 * ($1 - abs($0)), $4 * ($2 + $5)))",
                  {even, gap, o[1], o[5], o[7], height});
  };
  const std::string along_x = family(o[2], o[4], filled("$0 * cos(pi * $1 / $2)", {o[6], o[0], o[3]})),
                    along_z = family(o[0], o[3], filled("-$0 * cos(pi * $1 / $2)", {o[6], o[2], o[4]}));
  return filled("min($0, $1)", {along_x, along_z});
}

/// How far a place of the plane is from the middle of a hexagon, relative to its middle's distance from its
/// edges.
std::string hexagon(const std::string& x, const std::string& y) {
  return filled("max($0, 0.5 * $0 + sqrt(0.75) * $1)", {x, y});
}

/// f_hex_x and f_hex_y: the distance from the nearest middle of a honeycomb, by hexagons, and from the three
/// lines through the corners of its cell. One of the two lattices of middles contains the origin.
std::string honeycomb(const Operands& o, bool lines) {
  const std::string x = filled("abs($0 - sqrt(3) * floor($0 / sqrt(3) + 0.5))", o),
                    y = filled("abs($1 - 3 * floor($1 / 3 + 0.5))", o);
  const std::string other_x = filled("sqrt(0.75) - $0", {x}), other_y = filled("abs(1.5 - $0)", {y});
  const std::string here = hexagon(x, y), there = hexagon(other_x, other_y);
  if (!lines) return filled("min($0, $1)", {here, there});
  const auto spokes = [](const std::string& a, const std::string& b) {
    return filled("min($1, abs(0.5 * $1 - sqrt(0.75) * $0))", {a, b});
  };
  return filled("$2 + max(0, sign($0 - $1)) * ($3 - $2)",
                {here, there, spokes(x, y), spokes(other_x, other_y)});
}

struct Winding {
  std::uint32_t number;
  std::size_t operands;
  std::string (*text)(const Operands&);
};
constexpr std::array<Winding, 8> kWindings{{
    {24, 13, helical_torus},
    {25, 10, helix1},
    {26, 10, helix2},
    {27, 3, [](const Operands& o) { return honeycomb(o, false); }},
    {28, 3, [](const Operands& o) { return honeycomb(o, true); }},
    {40, 8, mesh},
    {52, 9, polytubes},
    {64, 9, spiral},
}};

}  // namespace

std::optional<std::string> winding_text(std::uint32_t number, const std::vector<std::string>& operands) {
  const auto* const found = std::ranges::find(kWindings, number, &Winding::number);
  if (found == kWindings.end() || operands.size() < found->operands) return std::nullopt;
  return found->text(operands);
}

}  // namespace oktett::pov
