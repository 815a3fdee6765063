#pragma once
/// \file Failures while a mesh file is read in parallel: the first one in the file counts, whichever task
/// finds it.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "io/text/scan.h"

namespace oktett {

/// What is wrong at a place in the text, thrown by the readers of a chunk. Lines are counted only when the
/// failure is reported.
struct MeshFailure {
  const char* where = nullptr;
  std::string message;
};

/// Keeps the failure that comes first in the text.
inline void keep_first(std::optional<MeshFailure>& first, const char* where, std::string message) {
  if (!first || where < first->where) first = MeshFailure{where, std::move(message)};
}
inline void keep_first(std::optional<MeshFailure>& first, const std::optional<MeshFailure>& other) {
  if (other) keep_first(first, other->where, other->message);
}

[[noreturn]] inline void stop_at(const char* where, std::string message) {
  throw MeshFailure{where, std::move(message)};
}
/// The passes read the same bytes unless someone writes to the file at the same time.
[[noreturn]] inline void stop_changed(const char* where) {
  stop_at(where, "the file changed while it was read");
}

/// Throws the Error of a failure: with its line in `text`, or with its byte.
[[noreturn]] void fail_at_line(const std::string& path, std::string_view text, const MeshFailure& failure);
[[noreturn]] void fail_at_byte(const std::string& path, std::string_view text, const MeshFailure& failure);

/// Throws Error if there are more than `most` of `what`.
void check_limit(const std::string& path, std::uint64_t count, const char* what, std::size_t most);

/// A name between quotes for a message, shortened, with a `?` for each control character.
std::string quote_name(std::string_view text);
/// The word at `p` in the same way, with a `?` for each byte that is not ASCII too.
std::string quote_word(const char* p);

}  // namespace oktett
