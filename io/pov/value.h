#pragma once
/// \file What names of a scene stand for while its directives are followed.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "io/pov/document.h"

namespace oktett::pov {

using BlockPtr = std::shared_ptr<const Block>;
using FunctionPtr = std::shared_ptr<const Function>;
using SplinePtr = std::shared_ptr<const Spline>;

struct Array;
struct Macro;
class TextFile;

/// A value of any type; std::monostate: none yet.
struct Datum {
  std::variant<std::monostate, Numbers, std::string, BlockPtr, FunctionPtr, SplinePtr, std::shared_ptr<Array>,
               std::shared_ptr<const Macro>, std::shared_ptr<TextFile>>
      value;
  std::uint32_t depth = 0;  ///< how deep values nest in it, so that nothing nests without a bound

  bool empty() const { return value.index() == 0; }
  template <class T>
  const T* get() const {
    return std::get_if<T>(&value);
  }
  const Array* array() const {
    const auto* held = std::get_if<std::shared_ptr<Array>>(&value);
    return held ? held->get() : nullptr;
  }
  const Macro* macro() const {
    const auto* held = std::get_if<std::shared_ptr<const Macro>>(&value);
    return held ? held->get() : nullptr;
  }
};

/// Counts the elements of all arrays.
struct ArrayCount {
  std::size_t living = 0;
  std::size_t copied = 0;  ///< since somebody looked
};

/// `array[2][3]`; the last index runs fastest. Shared by all copies until one of them is written to.
struct Array {
  std::vector<std::size_t> sizes;
  std::vector<Datum> elements;
  std::shared_ptr<ArrayCount> count;

  Array(std::vector<std::size_t> of_sizes, std::size_t size, std::shared_ptr<ArrayCount> counter)
      : sizes(std::move(of_sizes)), elements(size), count(std::move(counter)) {
    count->living += elements.size();
  }
  Array(const Array& other) : sizes(other.sizes), elements(other.elements), count(other.count) {
    count->living += elements.size();
    count->copied += elements.size();
  }
  Array& operator=(const Array&) = delete;
  ~Array() { count->living -= elements.size(); }

  void append(Datum datum) {
    elements.push_back(std::move(datum));
    ++count->living;
  }
};

/// A variable, or an element of an array in it: what a parameter of a macro stands for.
struct Reference {
  std::shared_ptr<Datum> slot;
  std::vector<std::size_t> path;  ///< indices into Array::elements, the outermost first

  /// Null if the arrays on the way have changed since.
  const Datum* find() const {
    const Datum* datum = slot.get();
    for (const std::size_t index : path) {
      const Array* const array = datum->array();
      if (array == nullptr || index >= array->elements.size()) return nullptr;
      datum = &array->elements[index];
    }
    return datum;
  }

  /// The same to write to: arrays that others share are copied before.
  Datum* find_to_write() const {
    Datum* datum = slot.get();
    for (const std::size_t index : path) {
      auto* const array = std::get_if<std::shared_ptr<Array>>(&datum->value);
      if (array == nullptr || index >= (*array)->elements.size()) return nullptr;
      if (array->use_count() > 1) *array = std::make_shared<Array>(**array);
      datum = &(*array)->elements[index];
    }
    return datum;
  }
};

}  // namespace oktett::pov
