#pragma once
/// \file Handles: pointers to shells that count references. The memory of a shell is used for nothing but
/// shells of the same kind, and for a new one only after many others have died, so a handle that was released
/// is recognised.

#include <atomic>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "embree/version.h"

namespace oktett::embree {

/// What a function of the interface ends with: an error code, and what was wrong.
struct ApiError {
  RTCError code;
  std::string message;
};
[[noreturn]] inline void fail(RTCError code, std::string message) {
  throw ApiError{code, std::move(message)};
}

template <class T>
struct Shell {
  using Object = T;
  std::atomic<std::size_t> references{0};  ///< 0: dead
  T* object = nullptr;

  bool is_alive() const { return references.load(std::memory_order_acquire) > 0; }
};

/// The shells of one kind.
template <class S>
class Shells {
 public:
  static S* make(std::unique_ptr<typename S::Object> object) {
    Shells& all = instance();
    const std::lock_guard lock(all.mutex_);
    S* shell;
    if (all.dead_.size() > kRest) {
      shell = all.dead_.front();
      all.dead_.pop_front();
    } else {
      shell = &all.shells_.emplace_back();
    }
    shell->object = object.release();
    shell->references.store(1, std::memory_order_release);
    return shell;
  }

  static void retain(S* shell) { shell->references.fetch_add(1, std::memory_order_relaxed); }
  static void release(S* shell) {
    if (shell->references.fetch_sub(1, std::memory_order_acq_rel) > 1) return;
    delete std::exchange(shell->object, nullptr);
    Shells& all = instance();
    const std::lock_guard lock(all.mutex_);
    all.dead_.push_back(shell);
  }

 private:
  /// So many dead shells wait before one is used again.
  static constexpr std::size_t kRest = 4096;

  /// Never destroyed: programs release handles while they end.
  static Shells& instance() {
    static Shells* const all = new Shells;
    return *all;
  }

  std::mutex mutex_;
  std::deque<S> shells_;
  std::deque<S*> dead_;
};

/// Keeps what a handle points to alive.
template <class S>
class Ref {
 public:
  Ref() = default;
  explicit Ref(S* shell) : shell_(shell) {
    if (shell_ != nullptr) Shells<S>::retain(shell_);
  }
  Ref(const Ref& other) : Ref(other.shell_) {}
  Ref(Ref&& other) noexcept : shell_(std::exchange(other.shell_, nullptr)) {}
  Ref& operator=(Ref other) noexcept {
    std::swap(shell_, other.shell_);
    return *this;
  }
  ~Ref() {
    if (shell_ != nullptr) Shells<S>::release(shell_);
  }
  S* handle() const { return shell_; }
  typename S::Object* operator->() const { return shell_->object; }
  typename S::Object& operator*() const { return *shell_->object; }
  explicit operator bool() const { return shell_ != nullptr; }

 private:
  S* shell_ = nullptr;
};

/// The object of a handle that a program gave. Throws ApiError if there is none.
template <class S>
typename S::Object& object_of(S* handle) {
  if (handle == nullptr) fail(RTC_ERROR_INVALID_ARGUMENT, "the handle is null");
  if (!handle->is_alive()) fail(RTC_ERROR_INVALID_ARGUMENT, "the handle was released");
  return *handle->object;
}

}  // namespace oktett::embree
