#include "app/process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <string_view>
#include <system_error>

#include "app/command_line.h"
#include "app/text.h"
#include "core/error.h"
#include "core/pages.h"
#include "core/platform.h"
#include "io/image/output.h"

namespace oktett {

namespace {

/// For signal handlers, which may not use streams.
void write_line(const char* text) {
  char line[512];
  std::size_t size = 0;
  const auto append = [&](const char* part) {
    while (*part != '\0' && size + 1 < sizeof line) line[size++] = *part++;
  };
  append("oktett: "), append(text);
  line[size++] = '\n';
  if (write(STDERR_FILENO, line, size) < 0) return;
}

/// Ends the process where no destructor runs any more.
[[noreturn]] void leave(const char* text, int status) {
  // Several threads may end the process at the same time; one line is enough. The others wait until it is
  // written.
  static std::atomic_flag reported;
  if (!reported.test_and_set())
    write_line(text);
  else
    poll(nullptr, 0, 500);
  remove_unfinished_files();
  _exit(status);
}

struct Diagnosis {
  const char* text;
  int status;
};

/// What the system refused, or null in `text` if `error` is none of its refusals.
Diagnosis diagnose(const std::exception& error) {
  constexpr const char* kNoThread = "the system refuses to start a thread; -t N asks for fewer";
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) return {"out of memory", kExitIo};
  // oneTBB throws this without a code.
  if (std::string_view(error.what()).find("pthread_create") != std::string_view::npos)
    return {kNoThread, kExitIo};
  if (const auto* system = dynamic_cast<const std::system_error*>(&error)) {
    if (system->code() == std::errc::resource_unavailable_try_again) return {kNoThread, kExitIo};
    if (system->code() == std::errc::not_enough_memory) return {"out of memory", kExitIo};
  }
  return {nullptr, kExitInternal};
}

/// What a library with some threads may ask the system for.
constexpr std::size_t kSomeMemory = std::size_t{128} << 20;

[[noreturn]] void on_terminate() {
  const char* text = "internal error";
  try {
    if (std::current_exception()) throw;
  } catch (const std::exception& error) {
    const Diagnosis found = diagnose(error);
    if (found.text != nullptr) leave(found.text, found.status);
    char line[400];
    std::snprintf(line, sizeof line, "internal error: %s", error.what());
    leave(line, kExitInternal);
  } catch (...) {}
  // Libraries that are refused their second thread end the process while they clean up after the first.
  if (!can_reserve(kSomeMemory)) leave("out of memory", kExitIo);
  leave(text, kExitInternal);
}

std::uintptr_t stack_top = 0;
std::uintptr_t stack_bytes = 0;

/// The stack of the main thread grows page by page. If the system refuses a page, the access fails.
void on_bad_access(int number, siginfo_t* info, void*) {
  const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
  if (number == SIGBUS) leave("a file was cut short by another program while it was read", kExitIo);
  if (address < stack_top && address > stack_top - stack_bytes) leave("out of memory for the stack", kExitIo);
  // Libraries for images use memory that they were refused.
  if (!can_reserve(kSomeMemory)) leave("out of memory", kExitIo);
  std::signal(number, SIG_DFL);
}

#if defined(OKTETT_SANITIZED)
constexpr bool kWatchesAccess = false;  // the sanitizer does
#else
constexpr bool kWatchesAccess = true;
#endif

void watch_access() {
  if (!kWatchesAccess) return;
  static char own_stack[65536];
  stack_t stack{};
  stack.ss_sp = own_stack, stack.ss_size = sizeof own_stack;
  rlimit limit{};
  getrlimit(RLIMIT_STACK, &limit);
  stack_bytes = limit.rlim_cur == RLIM_INFINITY ? std::uintptr_t{1} << 30 : limit.rlim_cur + (1 << 16);
  stack_top = reinterpret_cast<std::uintptr_t>(__builtin_frame_address(0));
  if (sigaltstack(&stack, nullptr) != 0) return;
  struct sigaction action {};
  action.sa_sigaction = &on_bad_access;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigaction(SIGSEGV, &action, nullptr);
  sigaction(SIGBUS, &action, nullptr);
}

/// Otherwise the first files opened would become the standard streams, and messages would be written into
/// pictures. Writing to a closed stream stays an error.
void occupy_closed_streams() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream)
    if (fcntl(stream, F_GETFD) < 0 && errno == EBADF) open("/dev/null", stream == 0 ? O_WRONLY : O_RDONLY);
}

}  // namespace

void prepare_process() {
  occupy_closed_streams();
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  std::set_terminate(on_terminate);
  watch_access();
}

void start_tasks() {
  constexpr std::size_t kEnough = std::size_t{1} << 20;
  // Volatile, as the compiler may leave out memory that nobody uses.
  void* volatile room = std::malloc(kEnough);
  if (room == nullptr) throw std::bad_alloc();
  std::free(room);
  static tbb::task_arena first(1);
  first.initialize();
}

int report_current_exception() {
  try {
    throw;
  } catch (const Error& error) {
    // An error with a location begins with it, so that editors can jump there.
    say("{}{}\n", error.where().file.empty() ? "oktett: " : "", printable(error.what()));
    return error.kind() == ErrorKind::io ? kExitIo : kExitBadInput;
  } catch (const std::exception& error) {
    // The message about lost output follows at the end.
    if (std::ferror(stdout) != 0) return kExitIo;
    const Diagnosis found = diagnose(error);
    if (found.text != nullptr)
      write_line(found.text);
    else
      say("oktett: internal error: {}\n", error.what());
    return found.status;
  }
}

int finish_output(int status) {
  errno = 0;
  const bool before = std::ferror(stdout) != 0;
  if (std::fflush(stdout) == 0 && !before) return status;
  const char* why = errno != 0 ? std::strerror(errno) : "some of it was lost";
  say("oktett: cannot write to standard output: {}\n", why);
  return status != 0 ? status : kExitIo;
}

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
