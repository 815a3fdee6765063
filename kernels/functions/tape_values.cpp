#include "kernels/functions/tape_values.h"

#include <map>
#include <string>
#include <utility>

#include "core/error.h"

namespace oktett {
namespace {

bool is_wave(TapeOp op) { return op == TapeOp::sin || op == TapeOp::cos; }

/// Writes the steps for the values that count, and gives registers back after their last use.
class Writer {
 public:
  Writer(std::span<const TapeValue> list, std::uint32_t root) : list_(list) {
    uses_.assign(list_.size(), 0);
    uses_[root] = 1;
    for (std::uint32_t v = static_cast<std::uint32_t>(list_.size()); v-- > 3;) {
      if (uses_[v] == 0) continue;
      if (list_[v].a != kNoId) ++uses_[list_[v].a];
      if (list_[v].b != kNoId) ++uses_[list_[v].b];
      if (is_wave(list_[v].op)) waves_[{list_[v].op, list_[v].a}] = v;
    }
    registers_.resize(list_.size());
    for (std::uint32_t k = 0; k < 3; ++k) registers_[k] = static_cast<std::uint8_t>(k);
    written_.assign(list_.size(), false);
    for (std::uint32_t v = 3; v < list_.size(); ++v)
      if (uses_[v] > 0 && !written_[v]) write(v);
    tape_.result = registers_[root];
    tape_.varies = root < 3 || list_[root].op != TapeOp::constant;
  }
  FunctionTape take() { return std::move(tape_); }

 private:
  [[noreturn]] static void fail(const std::string& what) { throw Error(Location{"", 0, 1}, what); }

  /// The cosine of what `v` is the sine of, or the other way round, if it counts; else kNoId.
  std::uint32_t partner(std::uint32_t v) const {
    const TapeValue& value = list_[v];
    if (!is_wave(value.op)) return kNoId;
    const auto found = waves_.find({value.op == TapeOp::sin ? TapeOp::cos : TapeOp::sin, value.a});
    return found == waves_.end() ? kNoId : found->second;
  }

  void write(std::uint32_t v) {
    const TapeValue& value = list_[v];
    if (tape_.steps.size() == kMaxTapeSteps)
      fail("the function takes more than " + std::to_string(kMaxTapeSteps) + " steps");
    TapeStep step{value.op, 0, 0, 0, value.n, value.c};
    if (value.a != kNoId) step.a = registers_[value.a];
    if (value.b != kNoId) step.b = registers_[value.b];
    const std::uint32_t other = partner(v);
    if (other != kNoId) {
      // The angle is used by both; neither result may overwrite it before the other is there.
      registers_[v] = acquire(), registers_[other] = acquire();
      written_[other] = true;
      release(value.a), release(value.a);
      step.op = TapeOp::sin_cos;
      step.out = registers_[value.op == TapeOp::sin ? v : other];
      step.b = registers_[value.op == TapeOp::sin ? other : v];
    } else {
      // What a result overwrites is read before.
      if (value.a != kNoId) release(value.a);
      if (value.b != kNoId) release(value.b);
      step.out = registers_[v] = acquire();
    }
    written_[v] = true;
    tape_.steps.push_back(step);
  }
  void release(std::uint32_t v) {
    if (--uses_[v] == 0 && v > 2) free_.push_back(registers_[v]);
  }
  std::uint8_t acquire() {
    if (free_.empty()) {
      if (tape_.registers == 3 + kMaxTapeRegisters)
        fail("the function needs more than " + std::to_string(kMaxTapeRegisters) + " values at a time");
      return static_cast<std::uint8_t>(tape_.registers++);
    }
    const std::uint8_t r = free_.back();
    free_.pop_back();
    return r;
  }

  std::span<const TapeValue> list_;
  std::map<std::pair<TapeOp, std::uint32_t>, std::uint32_t> waves_;  ///< the sines and cosines that count
  std::vector<std::uint32_t> uses_;
  std::vector<std::uint8_t> registers_, free_;
  std::vector<bool> written_;
  FunctionTape tape_;
};

bool has_second(TapeOp op) {
  switch (op) {
    case TapeOp::add:
    case TapeOp::subtract:
    case TapeOp::multiply:
    case TapeOp::divide:
    case TapeOp::atan2:
    case TapeOp::min:
    case TapeOp::max:
      return true;
    default:
      return false;
  }
}

}  // namespace

FunctionTape write_tape(std::span<const TapeValue> values, std::uint32_t root) {
  return Writer(values, root).take();
}

TapeValues values_of(const FunctionTape& tape) {
  TapeValues values;
  values.list.resize(3);
  std::vector<std::uint32_t> in(static_cast<std::size_t>(tape.registers));
  for (std::uint32_t k = 0; k < 3; ++k) in[k] = k;
  for (const TapeStep& s : tape.steps) {
    TapeValue value{s.op, kNoId, kNoId, s.n, s.c};
    if (s.op != TapeOp::constant) value.a = in[s.a];
    if (has_second(s.op)) value.b = in[s.b];
    const auto add = [&](TapeOp op, std::uint8_t out) {
      value.op = op, in[out] = static_cast<std::uint32_t>(values.list.size());
      values.list.push_back(value);
    };
    if (s.op == TapeOp::sin_cos) {
      add(TapeOp::sin, s.out), add(TapeOp::cos, s.b);
    } else {
      add(s.op, s.out);
    }
  }
  values.root = in[tape.result];
  return values;
}

}  // namespace oktett
