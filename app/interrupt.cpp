#include "app/interrupt.h"

#include <csignal>

#include "io/image/output.h"

namespace oktett {
namespace {

std::atomic<bool> stop_flag{false};
std::atomic<int> stop_signal{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

// SIGALRM is that of --timeout.
constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP, SIGALRM};
constexpr int kCount = 4;
struct sigaction previous[kCount];

void on_signal(int number) {
  if (stop_flag.exchange(true)) {
    // The time may be up after a person has asked for the end already.
    if (number == SIGALRM) return;
    remove_unfinished_files();
    std::signal(number, SIG_DFL);
    std::raise(number);
    return;
  }
  stop_signal = number;
}

}  // namespace

StopOnSignal::StopOnSignal() {
  stop_flag = false;
  stop_signal = 0;
  struct sigaction action {};
  action.sa_handler = &on_signal;
  // Neither signal is blocked while the first is handled, because the second may be of the other kind.
  action.sa_flags = SA_RESTART | SA_NODEFER;
  for (int i = 0; i < kCount; ++i) {
    sigaction(kSignals[i], nullptr, &previous[i]);
    // A signal that the parent made us ignore (nohup, background jobs) stays ignored.
    if (previous[i].sa_handler != SIG_IGN) sigaction(kSignals[i], &action, nullptr);
  }
}

StopOnSignal::~StopOnSignal() {
  for (int i = 0; i < kCount; ++i) sigaction(kSignals[i], &previous[i], nullptr);
}

const std::atomic<bool>* StopOnSignal::flag() const { return &stop_flag; }
int StopOnSignal::signal() const { return stop_signal; }

}  // namespace oktett
