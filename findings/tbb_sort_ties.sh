#!/usr/bin/env bash
# tbb::parallel_sort leaves equal keys in another order at each run of the same program on the same numbers.
#
# One would guess: it is not stable, as its documentation says, but it is a fixed algorithm: the same input with the same
# number of threads gives the same output.
# What happens: with oneTBB 2021.8 and four threads, 40 sorts of the same 200000 pairs give tens of different orders. How
# far a range is split depends on which thread was free, and parts are sorted by std::sort, which orders ties by length.
# One thread gives one order.
# Why a user of a ray tracer meets it: trees are built by sorting boxes by a Morton code, and boxes in one cell tie. The trees
# differ from run to run, and so do the triangle that wins at equal distance and the last bits of sums. The index has to be
# part of the key.
#
# Needs Debian 12, g++ and the network. Debian 12: libtbb-dev 2021.8.0-2+deb12u1. About 20 seconds.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 libtbb-dev=2021.8.0-2+deb12u1
cd "$work"

cat >sort.cpp <<'CPP'
#include <tbb/global_control.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>

#include <cstdio>
#include <set>
#include <utility>
#include <vector>
using Pair = std::pair<unsigned, unsigned>;  // key, place in the input

static unsigned long long sorted_order(tbb::task_arena& arena, bool with_place) {
  std::vector<Pair> pairs(200000);
  unsigned long long state = 1, hash = 14695981039346656037ull;
  for (unsigned i = 0; i < pairs.size(); ++i) {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    pairs[i] = {unsigned(state >> 54), i};  // 1024 keys
  }
  arena.execute([&] {
    if (with_place) tbb::parallel_sort(pairs.begin(), pairs.end());
    else tbb::parallel_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.first < b.first; });
  });
  for (const Pair& pair : pairs) hash = (hash ^ pair.second) * 1099511628211ull;
  return hash;
}

static const char* orders(int threads, bool with_place) {
  tbb::task_arena arena(threads);
  std::set<unsigned long long> seen;
  for (int run = 0; run < 40 || (run < 1000 && threads > 1 && !with_place && seen.size() == 1); ++run)  // a busy machine needs more
    seen.insert(sorted_order(arena, with_place));
  return seen.size() == 1 ? "one order" : "several orders";
}

int main() {
  tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 4);
  std::printf("%s\n%s\n%s\n", orders(1, false), orders(4, false), orders(4, true));
}
CPP
g++ -O2 -std=c++17 -I"$root/usr/include" sort.cpp -o sort -L"$libraries" -ltbb
run "$work/sort" >out

guess "one order, whatever the number of threads is"
seen "keys with ties, one thread" "one order" "$(sed -n 1p out)"
seen "keys with ties, four threads" "several orders" "$(sed -n 2p out)"
seen "keys with the place as second key, four threads" "one order" "$(sed -n 3p out)"
finish
