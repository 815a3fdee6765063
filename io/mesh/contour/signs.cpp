#include "io/mesh/contour/signs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/parallel.h"

namespace oktett {
namespace {

using Words = std::vector<std::uint64_t>;

bool bit(const std::uint64_t* words, std::size_t i) { return (words[i / 64] >> (i % 64) & 1) != 0; }

/// Whether what surrounds the grid is inside: most lines leave before they enter.
bool is_inverted(const ContourCrossings& crossings) {
  std::int64_t leaving = 0;
  for (const std::vector<std::uint32_t>& begin : crossings.of_lines)
    for (std::size_t line = 0; line + 1 < begin.size(); ++line)
      if (begin[line] < begin[line + 1]) leaving += crossings.all[begin[line]].turn;
  return leaving > 0;
}

/// A line whose crossings are those that are kept.
using Line = std::vector<ContourCrossing>;

/// Leaves out what does not enter and leave in turn.
Line alternate(std::span<const ContourCrossing> found, bool inverted) {
  Line kept;
  const int outside = inverted ? 1 : -1;  // the turn that leads away from what surrounds the grid
  for (const ContourCrossing& crossing : found)
    if (crossing.turn == (kept.size() % 2 == 0 ? outside : -outside)) kept.push_back(crossing);
  if (kept.size() % 2 != 0) kept.pop_back();
  return kept;
}

/// Lines in place of those of one axis.
void replace(ContourCrossings& crossings, const std::array<std::vector<Line>, 3>& lines) {
  crossings.all.clear();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<std::uint32_t>& begin = crossings.of_lines[axis];
    for (std::size_t line = 0; line < lines[axis].size(); ++line) {
      begin[line] = static_cast<std::uint32_t>(crossings.all.size());
      crossings.all.insert(crossings.all.end(), lines[axis][line].begin(), lines[axis][line].end());
    }
    begin[lines[axis].size()] = static_cast<std::uint32_t>(crossings.all.size());
  }
}

/// Moves crossings of a line so that it changes sides where `wrong`, nodes in ascending order, say.
class Mending {
 public:
  Mending(const ContourGrid& grid, int axis, Line& line)
      : grid_(grid), axis_(axis), k_(static_cast<std::size_t>(axis)), line_(line) {}

  void run(const std::vector<std::int32_t>& wrong, const GridPlace& start) {
    if (line_.empty()) {
      // Nothing to move: a ray along x met something here, and this one nothing.
      ContourCrossing made;
      made.place = start, made.axis = static_cast<std::uint8_t>(axis_);
      made.normal[axis_] = 1;
      copy_ = made, has_copy_ = true;
    }
    const Line before = line_;
    for (std::size_t i = 0; i < wrong.size(); ++i) {
      if (i == 0 || wrong[i - 1] != wrong[i] - 1) flip(before, wrong[i] - 1, wrong[i]);
      if (i + 1 == wrong.size() || wrong[i + 1] != wrong[i] + 1) flip(before, wrong[i], wrong[i]);
    }
    std::ranges::stable_sort(line_,
                             [](const ContourCrossing& a, const ContourCrossing& b) { return a.at < b.at; });
    std::ranges::stable_sort(line_, {}, [this](const ContourCrossing& c) { return c.place[k_]; });
  }

 private:
  /// Changes the parity of an edge at one of its nodes.
  void flip(const Line& before, std::int32_t edge, std::int32_t node) {
    const double at = grid_.node(axis_, node);
    const ContourCrossing* nearest = has_copy_ ? &copy_ : nullptr;
    for (const ContourCrossing& crossing : before)
      if (nearest == nullptr || std::abs(crossing.at - at) < std::abs(nearest->at - at)) nearest = &crossing;
    if (nearest == nullptr) return;
    if (nearest->place[k_] == edge && !has_copy_) {
      const auto found = std::ranges::find_if(
          line_, [&](const ContourCrossing& c) { return c.place[k_] == edge && c.at == nearest->at; });
      if (found != line_.end()) {
        line_.erase(found);
        return;
      }
    }
    ContourCrossing moved = *nearest;
    moved.place[k_] = edge, moved.at = at;
    line_.push_back(moved);
  }

  const ContourGrid& grid_;
  int axis_;
  std::size_t k_;
  Line& line_;
  ContourCrossing copy_;
  bool has_copy_ = false;
};

/// Bits of the nodes along x that are inside, for each line along x.
Words inside_bits(const ContourGrid& grid, const std::vector<Line>& lines, std::size_t words) {
  Words bits(lines.size() * words, 0);
  in_parts(lines.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t line = begin; line < end; ++line)
      for (std::size_t i = 0; i + 1 < lines[line].size(); i += 2)
        for (std::int32_t n = lines[line][i].place[0] + 1; n <= lines[line][i + 1].place[0]; ++n)
          bits[line * words + static_cast<std::size_t>(n) / 64] |= std::uint64_t{1} << (n % 64);
  });
  (void)grid;
  return bits;
}

/// Mends all lines along y or z that lie at one node of the third axis.
void mend_slab(const ContourGrid& grid, int axis, std::int32_t third, const Words& inside, std::size_t words,
               std::vector<Line>& lines) {
  const auto nodes_x = static_cast<std::int32_t>(grid.nodes[0].size());
  const auto k = static_cast<std::size_t>(axis);
  const int other = 3 - axis;  // y for z, z for y
  const auto place = [&](std::int32_t x, std::int32_t along) {
    GridPlace p{};
    p[0] = x, p[k] = along, p[static_cast<std::size_t>(other)] = third;
    return p;
  };
  std::vector<std::vector<std::int32_t>> toggles(grid.nodes[k].size());
  for (std::int32_t x = 0; x < nodes_x; ++x)
    for (const ContourCrossing& crossing : lines[grid.line(axis, place(x, 0))])
      toggles[static_cast<std::size_t>(crossing.place[k]) + 1].push_back(x);
  Words row(words, 0);
  std::vector<std::pair<std::int32_t, std::int32_t>> wrong;  // x, node
  for (std::size_t n = 0; n < grid.nodes[k].size(); ++n) {
    for (const std::int32_t x : toggles[n])
      row[static_cast<std::size_t>(x) / 64] ^= std::uint64_t{1} << (x % 64);
    const std::uint64_t* const right =
        inside.data() + words * grid.line(0, place(0, static_cast<std::int32_t>(n)));
    for (std::size_t w = 0; w < words; ++w)
      if (row[w] != right[w])
        for (std::int32_t x = static_cast<std::int32_t>(w) * 64;
             x < nodes_x && x / 64 == static_cast<std::int32_t>(w); ++x)
          if (bit(row.data(), static_cast<std::size_t>(x)) != bit(right, static_cast<std::size_t>(x)))
            wrong.emplace_back(x, static_cast<std::int32_t>(n));
  }
  std::ranges::sort(wrong);
  for (std::size_t i = 0; i < wrong.size();) {
    const std::int32_t x = wrong[i].first;
    std::vector<std::int32_t> of_line;
    for (; i < wrong.size() && wrong[i].first == x; ++i) of_line.push_back(wrong[i].second);
    Mending(grid, axis, lines[grid.line(axis, place(x, 0))]).run(of_line, place(x, 0));
  }
}

}  // namespace

void make_consistent(const ContourGrid& grid, ContourCrossings& crossings) {
  const bool inverted = is_inverted(crossings);
  std::array<std::vector<Line>, 3> lines;
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    lines[k].resize(grid.lines(axis));
    in_parts(lines[k].size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t line = begin; line < end; ++line) {
        const CrossingRange range = crossings.on_line(axis, line);
        lines[k][line] =
            alternate(std::span(crossings.all).subspan(range.first, range.last - range.first), inverted);
      }
    });
  }
  const std::size_t words = (grid.nodes[0].size() + 63) / 64;
  const Words inside = inside_bits(grid, lines[0], words);
  for (const int axis : {1, 2}) {
    const std::size_t slabs = grid.nodes[static_cast<std::size_t>(3 - axis)].size();
    in_parts(slabs, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t third = begin; third < end; ++third)
        mend_slab(grid, axis, static_cast<std::int32_t>(third), inside, words,
                  lines[static_cast<std::size_t>(axis)]);
    });
  }
  // What surrounds the grid is on one side, so turns follow from the order.
  for (std::vector<Line>& of_axis : lines)
    for (Line& line : of_axis)
      for (std::size_t i = 0; i < line.size(); ++i) {
        ContourCrossing& crossing = line[i];
        crossing.turn = static_cast<std::int8_t>((i % 2 == 0) != inverted ? -1 : 1);
        if (crossing.normal[crossing.axis] * static_cast<float>(crossing.turn) < 0)
          crossing.normal = -crossing.normal;
      }
  replace(crossings, lines);
}

}  // namespace oktett
