#pragma once
/// \file Clocks, medians and threads for programs that compare with peers in turn.

#include <cstddef>
#include <functional>
#include <vector>

namespace oktett::bench {

/// Wall time that `f` takes.
double seconds(const std::function<void()>& f);
/// Processor time that `f` takes in the calling thread: what other programs take at the same time is left
/// out.
double thread_seconds(const std::function<void()>& f);

/// The median and the quartiles.
struct Quartiles {
  double low = 0, median = 0, high = 0;
  /// Half of all values lie within this much of each other.
  double range() const { return high - low; }
};

/// Quarter points by linear interpolation; zeros for no values.
Quartiles quartiles(std::vector<double> values);

/// Runs `f` where TBB may use `threads` threads, the caller's among them. While a device of Embree's lives,
/// TBB may not give out all of them: make it inside.
void on_threads(int threads, const std::function<void()>& f);

/// Makes the processor treat denormal floats of this thread as zero, as Embree recommends.
void flush_denormals();

/// Splits a batch into pieces of 4096 for `threads` threads, the same for every program, with denormals
/// flushed. The threads are not TBB's, because each program configures TBB differently.
void in_pieces(int threads, std::size_t size,
               const std::function<void(std::size_t begin, std::size_t count)>& f);

/// Tells when enough has been measured: at least `least` rounds, at most `most`, and in between no round
/// begins after `budget` seconds.
class Rounds {
 public:
  Rounds(double budget, int least, int most);
  bool next();

 private:
  double budget_, start_;
  int least_, most_, done_ = 0;
};

}  // namespace oktett::bench
