// How many rays to render at a time: as many as take about 8 ms, so that newer requests are noticed soon and the overhead stays small.
#pragma once

#include <cstddef>

namespace skyquilt::viewer {

class BatchSize {
 public:
  // remote_ranks: other ranks that render; 0: the threads of this process do.
  BatchSize(int threads, int remote_ranks);

  size_t rays() const;
  // How long a batch took, and whether fields had to be loaded from disk for it.
  void Add(size_t rays, double seconds, bool loaded_fields);

 private:
  int threads_;
  size_t remote_ranks_;
  double speed_ = 0.0;  // rays per second: of one thread, or of all ranks together; 0: unknown
  bool loading_ = false;
};

}  // namespace skyquilt::viewer
