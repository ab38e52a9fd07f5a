#pragma once
// The only threads in hourglass. A stage is `parallel(threads, [&](Team& team) {...})`: every member runs the
// body; rows are shared out by `team.rows(n)`, and `team.sync()` waits for the others. Row shares depend on
// the number of rows and members only, and sums are taken row by row in a fixed order, so a result does not
// depend on the number of threads.
//
// Why not OpenMP's own barrier: on a shared machine it spins for milliseconds while a neighbour holds the
// core that the last thread needs. This one spins for some ten microseconds and then sleeps in the kernel.
#include <omp.h>
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#include <atomic>
#include <cstddef>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

namespace hourglass {

class Barrier {
 public:
  explicit Barrier(int members) : members_(members) {}
  void wait() {
    const int phase = phase_.load(std::memory_order_relaxed);
    if (arrived_.fetch_add(1, std::memory_order_acq_rel) == members_ - 1) {
      arrived_.store(0, std::memory_order_relaxed);
      // Sequentially consistent: notify_all() asks whether anybody sleeps, and must not ask before the store
      // is seen.
      phase_.store(phase + 1, std::memory_order_seq_cst);
      phase_.notify_all();
      return;
    }
    for (int spin = 0; spin < 1000; ++spin) {
      if (phase_.load(std::memory_order_acquire) != phase) return;
#if defined(__x86_64__)
      __builtin_ia32_pause();
#endif
    }
    phase_.wait(phase, std::memory_order_acquire);
  }

 private:
  alignas(64) std::atomic<int> arrived_{0};
  alignas(64) std::atomic<int> phase_{0};
  const int members_;
};

/// Rows [begin, end).
struct Rows {
  int begin, end;
};

class Team {
 public:
  Team() = default;  ///< one member, nothing to wait for
  Team(int rank, int size, Barrier* barrier) : rank_(rank), size_(size), barrier_(barrier) {}

  int rank() const { return rank_; }
  int size() const { return size_; }
  bool leads() const { return rank_ == 0; }
  void sync() {
    if (size_ > 1) barrier_->wait();
  }
  /// This member's share of rows 0 .. n-1.
  Rows rows(int n) const {
    return {static_cast<int>(static_cast<long>(n) * rank_ / size_),
            static_cast<int>(static_cast<long>(n) * (rank_ + 1) / size_)};
  }

 private:
  int rank_ = 0, size_ = 1;
  Barrier* barrier_ = nullptr;
};

/// Flushes denormal numbers to zero while it lives: far from where anything happens a float V-cycle is full of them,
/// and each would cost a hundred cycles.
class FlushDenormals {
 public:
#if defined(__x86_64__)
  FlushDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040u); }  // FTZ and DAZ
  ~FlushDenormals() { _mm_setcsr(before_); }

 private:
  unsigned before_;
#endif
};

/// One machine code of a body for any number of threads: inlined in two places it may round differently, where the
/// compiler makes one product and sum a fused one and not the other.
template <class Body>
[[gnu::noinline, gnu::noclone]] void run_member(Body& body, Team& team) {
  body(team);
}

/// Runs body(Team&) on `threads` threads and returns when all are done. The body must not throw.
template <class Body>
void parallel(int threads, Body&& body) {
  if (threads <= 1) {
    const FlushDenormals flush;
    Team alone;
    run_member(body, alone);
    return;
  }
#if defined(__SANITIZE_THREAD__)  // which sees the fork and join of std::thread, but not those of libgomp
  Barrier barrier(threads);
  const auto member = [&](int rank) {
    const FlushDenormals flush;
    Team team(rank, threads, &barrier);
    run_member(body, team);
  };
  std::vector<std::jthread> others;
  for (int rank = 1; rank < threads; ++rank) others.emplace_back(member, rank);
  member(0);
#else
  std::optional<Barrier> barrier;
#pragma omp parallel num_threads(threads)
  {
    const int size = omp_get_num_threads();  // may be fewer than asked for, by a limit of the environment
#pragma omp single
    barrier.emplace(size);
    const FlushDenormals flush;
    Team team(omp_get_thread_num(), size, &*barrier);
    run_member(body, team);
  }
#endif
}

/// Runs operations 0 .. ops-1 on rows 0 .. n-1 as if each were a pass over all rows, in one sweep through
/// memory: operation s trails operation s - 1 by a row, so a row is worked on while it is in cache (wavefront
/// or temporal blocking; Douglas, Hu, Kowarschik, Ruede & Weiss 2000). op(s, j) may read rows j-1 .. j+1 of
/// what earlier operations wrote, and nothing that operation s itself writes in other rows. Members work on
/// slabs that shrink by a row an operation, then on the triangles left between slabs: two barriers in all.
/// Synced on return.
template <class Op>
void wavefront(Team& team, int n, int ops, Op&& op) {
  if (team.size() > 1 && n / team.size() < 2 * ops + 2) {  // slabs too thin to shrink: pass by pass
    const Rows rows = team.rows(n);
    for (int s = 0; s < ops; ++s) {
      for (int j = rows.begin; j < rows.end; ++j) op(s, j);
      team.sync();
    }
    return;
  }
  const Rows slab = team.rows(n);
  const bool shared_below = slab.begin > 0, shared_above = slab.end < n;
  for (int front = slab.begin; front < slab.end + ops - 1; ++front)
    for (int s = 0; s < ops; ++s) {
      const int j = front - s;
      const int first = slab.begin + (shared_below ? s : 0), last = slab.end - (shared_above ? s : 0);
      if (j >= first && j < last) op(s, j);
    }
  if (team.size() == 1) return;
  team.sync();
  if (shared_above)
    for (int s = 1; s < ops; ++s)
      for (int j = slab.end - s; j < slab.end + s; ++j) op(s, j);
  team.sync();
}

/// A row of n values that belongs to this thread, with 16 more on either side; what is in it is lost at the
/// next call.
template <class T>
T* row_scratch(int n) {
  thread_local std::vector<T> scratch;
  if (static_cast<int>(scratch.size()) < n + 32) scratch.resize(n + 32);
  return scratch.data() + 16;
}

/// Partial results, one slot a row; reduced by every member alike, in row order.
class RowSums {
 public:
  explicit RowSums(int rows = 0) : slots_(rows) {}
  double& operator[](int row) { return slots_[row]; }
  double sum() const {
    double s = 0;
    for (double x : slots_) s += x;
    return s;
  }
  double max() const {
    double m = 0;
    for (double x : slots_) m = x > m || x != x ? x : m;  // a NaN stays visible
    return m;
  }
  std::size_t bytes() const { return slots_.size() * sizeof(double); }

 private:
  std::vector<double> slots_;
};

}  // namespace hourglass
