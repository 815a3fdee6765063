/// \file Root finders against the exact oracle, on as many random polynomials as there is time for. Not a
/// test of its own: prints a table by method, class and degree (docs/roots.md).
///
///     roots_verify [--count N] [--degrees FIRST-LAST] [--method NAME]... [--threads N] [--seed N] [--class
///     N]

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "kernels/roots/roots.h"
#include "tests/support/exact_roots.h"
#include "tests/support/random_polynomials.h"

namespace oktett::test {
namespace {

using namespace roots;

struct Options {
  std::uint64_t count = 20000, seed = 0;
  int first = 2, last = 16, threads = 1, only_class = -1, show = 3;
  std::vector<Method> methods;
};

/// What is counted for one method, class and degree.
struct Tally {
  std::uint64_t problems = 0, missed = 0, invented = 0, uncertified = 0, wrong_certified = 0, clusters = 0;
  double worst_error = 0, worst_bound = 0, seconds = 0;

  void add(const Tally& t) {
    problems += t.problems, missed += t.missed, invented += t.invented, uncertified += t.uncertified;
    wrong_certified += t.wrong_certified, clusters += t.clusters, seconds += t.seconds;
    worst_error = std::max(worst_error, t.worst_error), worst_bound = std::max(worst_bound, t.worst_bound);
  }
};

void report_failure(const RootProblem& q, Method method, RootClass c, const Judgement& j) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  fmt::print(stderr, "{} {} [{:a}, {:a}]: {}\n   ", to_string(method), to_string(c), q.a, q.b, j.what);
  for (int i = 0; i <= q.p.degree; ++i) fmt::print(stderr, " {:a}", q.p.c[i]);
  fmt::print(stderr, "\n");
}

Tally verify(const Options& o, Method method, RootClass c, int degree) {
  std::vector<Tally> parts(o.threads);
  std::atomic<std::uint64_t> next{0};
  std::atomic<int> shown{0};
  const std::uint64_t count = o.count / (o.only_class < 0 ? kRootClasses : 1);
  const auto work = [&](Tally& t) {
    constexpr std::uint64_t kBlock = 256;
    std::vector<RootProblem> problems(kBlock);
    std::vector<Roots> answers(kBlock);
    for (;;) {
      const std::uint64_t begin = next.fetch_add(kBlock), end = std::min(begin + kBlock, count);
      if (begin >= end) return;
      for (std::uint64_t i = begin; i < end; ++i) problems[i - begin] = random_problem(c, degree, o.seed + i);
      const auto start = std::chrono::steady_clock::now();
      for (std::uint64_t i = 0; i < end - begin; ++i) {
        answers[i] = solve(problems[i].p, problems[i].a, problems[i].b, method);
      }
      t.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      for (std::uint64_t i = 0; i < end - begin; ++i) {
        const RootProblem& q = problems[i];
        const Judgement j = judge(q.p, q.a, q.b, answers[i], answers[i].certified ? 0 : 0x1p-40);
        ++t.problems;
        t.missed += j.missed, t.invented += j.invented, t.clusters += j.clusters;
        t.uncertified += !answers[i].certified;
        t.worst_error = std::max(t.worst_error, j.worst_error);
        for (int k = 0; k < answers[i].count; ++k) {
          if (answers[i].root[k].multiplicity > 1) continue;
          t.worst_bound =
              std::max(t.worst_bound, answers[i].root[k].error / std::max(std::abs(q.a), std::abs(q.b)));
        }
        if (answers[i].certified && j.missed + j.invented) {
          ++t.wrong_certified;
          if (shown++ < o.show) report_failure(q, method, c, j);
        }
      }
    }
  };
  std::vector<std::thread> threads;
  for (Tally& t : parts) threads.emplace_back(work, std::ref(t));
  for (std::thread& t : threads) t.join();
  Tally sum;
  for (const Tally& t : parts) sum.add(t);
  return sum;
}

void print_row(const std::string& name, const std::string& degree, const Tally& t) {
  fmt::print("| {} | {} | {} | {:.0f} | {} | {} | {} | {} | {} | {:.1e} | {:.1e} |\n", name, degree,
             t.problems, 1e9 * t.seconds / t.problems, t.missed, t.invented, t.wrong_certified, t.uncertified,
             t.clusters, t.worst_error, t.worst_bound);
  std::fflush(stdout);
}

int run(const Options& o) {
  std::uint64_t wrong = 0;
  fmt::print(
      "| method, class | degree | problems | ns | missed | invented | wrong though certified | not certified "
      "| "
      "clusters | worst error | worst bound |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Method method : o.methods) {
    Tally by_class[kRootClasses];
    const auto start = std::chrono::steady_clock::now();
    std::uint64_t problems = 0;
    for (int degree = o.first; degree <= o.last; ++degree) {
      Tally all;
      for (int c = 0; c < kRootClasses; ++c) {
        if (o.only_class >= 0 && c != o.only_class) continue;
        const Tally t = verify(o, method, static_cast<RootClass>(c), degree);
        all.add(t);
        by_class[c].add(t);
      }
      print_row(to_string(method), std::to_string(degree), all);
      wrong += all.wrong_certified;
      problems += all.problems;
    }
    for (int c = 0; c < kRootClasses; ++c) {
      if (o.only_class >= 0 && c != o.only_class) continue;
      print_row(fmt::format("{}, {}", to_string(method), to_string(static_cast<RootClass>(c))),
                fmt::format("{}-{}", o.first, o.last), by_class[c]);
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    fmt::print(stderr, "{}: {} problems in {:.1f} s, {:.0f} per second\n", to_string(method), problems,
               seconds, problems / seconds);
  }
  return wrong ? 3 : 0;
}

}  // namespace
}  // namespace oktett::test

int main(int argc, char** argv) {
  using namespace oktett;
  test::Options o;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string key = argv[i], value = argv[i + 1];
    if (key == "--count") o.count = std::strtoull(value.c_str(), nullptr, 10);
    if (key == "--seed") o.seed = std::strtoull(value.c_str(), nullptr, 10);
    if (key == "--threads") o.threads = std::atoi(value.c_str());
    if (key == "--class") o.only_class = std::atoi(value.c_str());
    if (key == "--show") o.show = std::atoi(value.c_str());
    if (key == "--degrees") {
      o.first = o.last = std::atoi(value.c_str());
      if (const auto dash = value.find('-'); dash != value.npos) o.last = std::atoi(value.c_str() + dash + 1);
    }
    if (key == "--method") {
      for (int m = 0; m < 7; ++m) {
        const auto method = static_cast<roots::Method>(m);
        if (value == "all" || value == to_string(method)) o.methods.push_back(method);
      }
    }
  }
  if (o.methods.empty()) o.methods.push_back(roots::Method::automatic);
  return test::run(o);
}
