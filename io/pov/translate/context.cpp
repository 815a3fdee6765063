#include "io/pov/translate/context.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "io/image/contents.h"
#include "io/pov/read_pov.h"
#include "io/yaml/utf8.h"

namespace oktett::pov {

bool Context::has_alpha(const std::string& file) {
  const auto [known, is_new] = alphas_.try_emplace(file, false);
  if (is_new) known->second = image_contents(file).alpha;
  return known->second;
}

std::string Context::unique(std::set<std::string>& taken, std::string_view wanted) const {
  std::string name(wanted);
  for (int i = 2; !taken.insert(name).second; ++i) name = fmt::format("{} {}", wanted, i);
  return name;
}

// ---- The elements of a block.

const Block* Arguments::peek_block() const { return peek_shared_block().get(); }

std::shared_ptr<const Block> Arguments::peek_shared_block() const {
  if (at_end()) return nullptr;
  const auto* const block = std::get_if<std::shared_ptr<const Block>>(&peek().value);
  return block != nullptr ? *block : nullptr;
}

std::string_view Arguments::peek_word() const {
  if (at_end()) return {};
  const auto* const word = std::get_if<Word>(&peek().value);
  return word != nullptr ? word->text : std::string_view();
}

bool Arguments::take_word(std::string_view word) {
  if (peek_word() != word || word.empty()) return false;
  ++next_;
  return true;
}

const Numbers& Arguments::numbers(std::string_view what) {
  if (!is_numbers()) {
    const std::string block = block_.keyword.empty() ? "the scene" : fmt::format("'{}'", block_.keyword);
    context_.fail(where(), fmt::format("expected {} in {}", what, block));
  }
  return std::get<Numbers>(take().value);
}

double Arguments::number(std::string_view what) { return numbers(what).v[0]; }

Vec3d Arguments::vector(std::string_view what) {
  const Numbers& n = numbers(what);
  if (n.size == 1) return {n.v[0], n.v[0], n.v[0]};
  return {n.v[0], n.v[1], n.size > 2 ? n.v[2] : 0};
}

std::array<double, 2> Arguments::pair(std::string_view what) {
  const Numbers& n = numbers(what);
  return {n.v[0], n.size == 1 ? n.v[0] : n.v[1]};
}

PovColor Arguments::color(std::string_view what) {
  const Numbers& n = numbers(what);
  if (n.size == 1) return {{n.v[0], n.v[0], n.v[0]}};
  PovColor c{{n.v[0], n.v[1], n.size > 2 ? n.v[2] : 0}};
  if (n.size > 3) c.filter = n.v[3];
  if (n.size > 4) c.transmit = n.v[4];
  return c;
}

std::string Arguments::text(std::string_view what) {
  const auto* const text = at_end() ? nullptr : std::get_if<std::string>(&peek().value);
  if (text == nullptr) context_.fail(where(), fmt::format("expected {} in '{}'", what, block_.keyword));
  ++next_;
  return *text;
}

std::vector<double> Arguments::all_numbers() {
  std::vector<double> all;
  while (true) {
    if (is_numbers()) {
      const auto& n = std::get<Numbers>(take().value);
      all.insert(all.end(), n.v.begin(), n.v.begin() + n.size);
    } else if (const Block* const long_vector = peek_block();
               long_vector != nullptr && long_vector->keyword == "<") {
      // More numbers than a vector has.
      Arguments inner(context_, *long_vector);
      const std::vector<double> more = inner.all_numbers();
      all.insert(all.end(), more.begin(), more.end());
      take();
    } else {
      break;
    }
  }
  return all;
}

bool Arguments::flag() {
  if (is_numbers() && std::get<Numbers>(peek().value).size == 1) return number("a flag") != 0;
  for (const std::string_view word : {"on", "yes", "true"})
    if (take_word(word)) return true;
  for (const std::string_view word : {"off", "no", "false"})
    if (take_word(word)) return false;
  return true;
}

// ---- Transforms.

void Moves::add(const Move& move) {
  list.push_back(move);
  switch (move.kind) {
    case Move::Kind::translate:
      all = Affine::translation(move.v) * all;
      break;
    case Move::Kind::rotate:
      all = Affine::rotation(move.v) * all;
      break;
    case Move::Kind::scale:
      all = Affine::scaling(move.v) * all;
      break;
    case Move::Kind::matrix:
      all = move.matrix * all;
      break;
  }
}

/// A matrix with the rows of POV-Ray's, whose points stand to the left.
static Affine matrix_of(const std::vector<double>& v) {
  Affine a;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 4; ++column) a.m[row][column] = v[3 * column + row];
  return a;
}

static Moves moves_of(Context& context, const Block& block) {
  Arguments arguments(context, block);
  Moves moves;
  bool inverse = false;
  while (!arguments.at_end()) {
    if (arguments.take_word("inverse"))
      inverse = true;
    else if (!take_moves(context, arguments, moves))
      context.fail(arguments.where(), "expected a transform");
  }
  if (!inverse) return moves;
  if (!moves.all.is_invertible()) context.fail(block.where, "the transform has no inverse");
  Moves inverted;
  inverted.add({Move::Kind::matrix, {}, moves.all.inverse(), block.where});
  return inverted;
}

bool take_moves(Context& context, Arguments& arguments, Moves& moves) {
  const Place where = arguments.where();
  if (arguments.take_word("translate")) {
    moves.add({Move::Kind::translate, arguments.vector("a vector"), {}, where});
  } else if (arguments.take_word("rotate")) {
    moves.add({Move::Kind::rotate, arguments.vector("a vector"), {}, where});
  } else if (arguments.take_word("scale")) {
    Vec3d v = arguments.vector("a vector");
    for (int k = 0; k < 3; ++k) {
      if (v[k] != 0) continue;
      context.tell("scale 0", where, "a scale of 0 counts as 1");
      v[k] = 1;
    }
    moves.add({Move::Kind::scale, v, {}, where});
  } else if (arguments.take_word("matrix")) {
    const std::vector<double> v = arguments.all_numbers();
    if (v.size() != 12) context.fail(where, fmt::format("a matrix has 12 numbers, found {}", v.size()));
    moves.add({Move::Kind::matrix, {}, matrix_of(v), where});
  } else if (arguments.take_word("transform")) {
    const Block* const block = arguments.peek_block();
    if (block == nullptr) context.fail(where, "expected a transform");
    moves.add(moves_of(context, *block));
    arguments.take();
  } else if (const Block* const block = arguments.peek_block();
             block != nullptr && block->keyword == "transform") {
    moves.add(moves_of(context, *block));
    arguments.take();
  } else {
    return false;
  }
  return true;
}

static Node move_node(Tree& tree, const Move& move) {
  const Place& w = move.where;
  switch (move.kind) {
    case Move::Kind::translate:
      return tree.map(w, "translate", tree.vector(w, move.v));
    case Move::Kind::rotate:
      return tree.map(w, "rotate", tree.vector(w, move.v));
    case Move::Kind::scale: {
      const bool even = move.v.x == move.v.y && move.v.x == move.v.z;
      return tree.map(w, "scale", even ? tree.number(w, move.v.x) : tree.vector(w, move.v));
    }
    case Move::Kind::matrix:
      break;
  }
  double rows[12];
  move.matrix.to_rows(rows);
  return tree.map(w, "matrix", tree.numbers(w, rows));
}

Node moves_node(Tree& tree, const Place& where, const Moves& moves) {
  if (moves.empty()) return nullptr;
  if (moves.list.size() == 1) return move_node(tree, moves.list.front());
  const Node list = tree.list(where);
  for (const Move& move : moves.list) Tree::push(list, move_node(tree, move));
  return list;
}

// ---- Files.

std::string find_file(const Context& context, const Place& where, const std::string& name) {
  namespace fs = std::filesystem;
  const auto beside = [&](std::size_t file) {
    return (fs::path(context.document.files[file]).parent_path() / name).string();
  };
  std::vector<std::string> places{beside(0), beside(where.file)};
  for (const std::string& folder : ReadOptions::default_library_folders())
    places.push_back((fs::path(folder) / name).string());
  for (const std::string& path : places)
    if (why_unreadable(path).empty()) return fs::absolute(path).lexically_normal().string();
  context.fail(where, quote(name, 1000) + ": " + why_unreadable(beside(0)));
}

Moves moves_in(Context& context, const Block& block) {
  Moves moves;
  Arguments a(context, block);
  while (!a.at_end())
    if (!take_moves(context, a, moves)) a.take();
  return moves;
}

}  // namespace oktett::pov
