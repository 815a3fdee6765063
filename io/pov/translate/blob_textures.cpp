#include "io/pov/translate/blob_textures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <span>
#include <string_view>
#include <utility>

#include "io/pov/translate/texture.h"

namespace oktett::pov {
namespace {

/// Most looks of a blob: they are blended in halves, and textures may be nested six deep beside their own.
constexpr std::size_t kMostLooks = 64;

const Block* block_of(const Element& element) {
  const auto* const block = std::get_if<std::shared_ptr<const Block>>(&element.value);
  return block == nullptr ? nullptr : block->get();
}

bool has_texture(const Block& block) {
  return std::ranges::any_of(block.elements, [](const Element& e) {
    const Block* const inner = block_of(e);
    return inner != nullptr && (inner->keyword == "texture" || inner->keyword == "pigment");
  });
}

/// The steps of a function of x, y and z.
class FieldFunction {
 public:
  explicit FieldFunction(const Place& where) {
    function_.where = where, function_.parameters = {"x", "y", "z"};
    for (std::uint32_t k = 0; k < 3; ++k) {
      FunctionNode node;
      node.op = FunctionNode::Op::parameter, node.index = k;
      function_.nodes.push_back(node);
    }
  }

  using Step = std::uint32_t;
  Step number(double value) {
    FunctionNode node;
    node.number = value;
    return add(std::move(node));
  }
  Step call(std::string_view name, std::initializer_list<Step> operands) {
    FunctionNode node;
    node.op = FunctionNode::Op::call, node.name = name, node.operands = operands;
    return add(std::move(node));
  }
  Step sum(Step a, Step b) { return is(a, 0) ? b : is(b, 0) ? a : call("+", {a, b}); }
  Step product(Step a, Step b) { return is(a, 1) ? b : is(b, 1) ? a : call("*", {a, b}); }
  Step square(Step a) { return call("pow", {a, number(2)}); }

  /// The magnitude of the field at (x, y, z).
  Step field(const BlobField& f) {
    // The place from `from` on, in the space of the component.
    Step p[3];
    for (int i = 0; i < 3; ++i) {
      Step all = number(f.to_own.m[i][3] - f.from[i]);
      for (std::uint32_t k = 0; k < 3; ++k)
        if (const double factor = f.to_own.m[i][k]; factor != 0) all = sum(all, product(number(factor), k));
      p[i] = all;
    }
    const Vec3d axis = f.to - f.from;
    if (const double size = dot(axis, axis); size > 0) {
      Step along = number(0);
      for (int i = 0; i < 3; ++i) along = sum(along, product(p[i], number(axis[i] / size)));
      along = call("max", {number(0), call("min", {number(1), along})});
      for (int i = 0; i < 3; ++i) p[i] = call("-", {p[i], product(along, number(axis[i]))});
    }
    Step distance = number(0);
    for (const Step each : p) distance = sum(distance, square(each));
    const Step rest = call(
        "max", {number(0), call("-", {number(1), product(distance, number(1 / (f.radius * f.radius)))})});
    return product(number(std::abs(f.strength)), square(rest));
  }

  std::shared_ptr<const Function> finish() { return std::make_shared<const Function>(std::move(function_)); }

 private:
  bool is(Step a, double value) const {
    const FunctionNode& node = function_.nodes[a];
    return node.op == FunctionNode::Op::constant && node.number == value;
  }
  Step add(FunctionNode node) {
    function_.nodes.push_back(std::move(node));
    return static_cast<Step>(function_.nodes.size() - 1);
  }

  Function function_;
};

/// A look and the fields of all components that have it.
struct Group {
  std::shared_ptr<const Block> texture;
  std::vector<BlobField> fields;
};

/// One that begins with the default of a blob or a component.
std::shared_ptr<Block> texture_block(const Block& of) {
  auto block = std::make_shared<Block>();
  block->keyword = "texture", block->where = of.where, block->default_texture = of.default_texture;
  return block;
}

/// What part of the fields of all groups is that of those from `middle` on.
std::shared_ptr<const Function> share_of(const Place& where, std::span<const Group> groups,
                                         std::size_t middle) {
  FieldFunction f(where);
  const auto total = [&](std::span<const Group> some) {
    auto all = f.number(0);
    for (const Group& group : some)
      for (const BlobField& field : group.fields) all = f.sum(all, f.field(field));
    return all;
  };
  const auto first = total(groups.first(middle)), second = total(groups.subspan(middle));
  // Where no field of these is, the quotient must be some number; a share of 1 would be one of 0 again.
  f.product(f.number(1 - 1e-7),
            f.call("/", {second, f.call("max", {f.sum(first, second), f.number(1e-30)})}));
  return f.finish();
}

/// The looks of groups, weighted by their fields.
std::shared_ptr<const Block> blended(const Block& blob, std::span<const Group> groups) {
  if (groups.size() == 1) return groups[0].texture;
  const std::size_t middle = (groups.size() + 1) / 2;
  auto map = std::make_shared<Block>();
  map->keyword = "texture_map", map->where = blob.where;
  const auto entry = [&](double at, const std::shared_ptr<const Block>& texture) {
    auto block = std::make_shared<Block>();
    block->keyword = "[", block->where = blob.where;
    Numbers place{};
    place.v[0] = at;
    block->elements.push_back({blob.where, place});
    block->elements.push_back({blob.where, texture});
    map->elements.push_back({blob.where, std::shared_ptr<const Block>(block)});
  };
  entry(0, blended(blob, groups.first(middle))), entry(1, blended(blob, groups.subspan(middle)));
  auto texture = texture_block(blob);
  texture->elements.push_back({blob.where, share_of(blob.where, groups, middle)});
  texture->elements.push_back({blob.where, std::shared_ptr<const Block>(map)});
  return texture;
}

/// The look with its own elements that `blob` has, without its transforms.
std::shared_ptr<const Block> texture_of_blob(const Block& blob) {
  auto texture = texture_block(blob);
  for (const Element& e : blob.elements)
    if (const Block* const inner = block_of(e); inner != nullptr && is_look(inner->keyword))
      texture->elements.push_back(e);
  return texture;
}

}  // namespace

bool has_own_texture(const Block& component) { return has_texture(component); }

std::shared_ptr<const Block> texture_of_component(const Block& component) {
  // A declared texture that nothing changes is one for all that have it.
  const Block* only = &component;
  std::shared_ptr<const Block> named;
  while (only != nullptr) {
    const Block* next = nullptr;
    std::size_t parts = 0;
    for (const Element& e : only->elements) {
      const auto* const block = std::get_if<std::shared_ptr<const Block>>(&e.value);
      const bool is_number = std::holds_alternative<Numbers>(e.value);
      if (only == &component && is_number) continue;
      ++parts;
      if (block != nullptr && *block != nullptr && (*block)->keyword == "texture") {
        next = block->get();
        if (!next->name.empty()) named = *block;
      }
    }
    if (parts != 1 || next == nullptr) break;
    if (named.get() == next) return named;
    only = next;
  }
  auto texture = texture_block(component);
  // Numbers and words before the look are those of the shape.
  const auto first =
      std::ranges::find_if(component.elements, [](const Element& e) { return block_of(e) != nullptr; });
  for (auto e = first; e != component.elements.end(); ++e) texture->elements.push_back(*e);
  return texture;
}

std::shared_ptr<const Block> blended_texture(Context& context, const Block& blob,
                                             const std::vector<BlobPart>& parts) {
  if (std::ranges::all_of(parts, [](const BlobPart& part) { return part.texture == nullptr; }))
    return nullptr;
  std::vector<Group> groups;
  const auto add = [&](const std::shared_ptr<const Block>& texture, const BlobField& field) {
    const auto known = std::ranges::find(groups, texture, &Group::texture);
    if (known != groups.end()) return known->fields.push_back(field);
    groups.push_back({texture, {field}});
  };
  const bool many = [&] {
    for (const BlobPart& part : parts) add(part.texture, part.field);
    return groups.size() > kMostLooks;
  }();
  if (many) {
    context.tell("blob looks", blob.where,
                 fmt::format("of the {} textures of this blob's components {} are shown", groups.size(),
                             kMostLooks - 1));
    std::vector<Group> kept;
    std::swap(groups, kept);
    std::size_t own = 0;
    for (const Group& group : kept) {
      const bool stays = group.texture != nullptr && own++ < kMostLooks - 1;
      for (const BlobField& field : group.fields) add(stays ? group.texture : nullptr, field);
    }
  }
  for (Group& group : groups)
    if (group.texture == nullptr) group.texture = texture_of_blob(blob);
  return blended(blob, groups);
}

}  // namespace oktett::pov
