#include "core/base/thread_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

#include "core/base/system.h"

namespace skyquilt::base {
namespace {

class ThreadPoolSizes : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Sizes, ThreadPoolSizes, testing::Values(1, 2, 3, 8));

TEST_P(ThreadPoolSizes, RunsEveryTaskOnce) {
  ThreadPool pool(GetParam());
  ASSERT_EQ(pool.size(), GetParam());
  for (const int64_t n : {0, 1, 2, 3, 100, 10007}) {
    std::vector<std::atomic<int>> runs(static_cast<size_t>(n));
    pool.ParallelFor(n, [&](int64_t task, int) { ++runs[static_cast<size_t>(task)]; });
    for (int64_t i = 0; i < n; ++i) ASSERT_EQ(runs[static_cast<size_t>(i)], 1) << "task " << i << " of " << n;
  }
}

TEST_P(ThreadPoolSizes, OneTaskAtATimePerThreadNumber) {
  ThreadPool pool(GetParam());
  std::vector<std::atomic<bool>> busy(static_cast<size_t>(pool.size()));
  std::atomic<bool> shared{false};
  pool.ParallelFor(2000, [&](int64_t, int thread) {
    if (busy.at(static_cast<size_t>(thread)).exchange(true)) shared = true;
    std::this_thread::yield();
    busy[static_cast<size_t>(thread)] = false;
  });
  EXPECT_FALSE(shared);
}

// A late thread must neither miss a loop nor join a finished one, whose body no longer exists.
TEST_P(ThreadPoolSizes, ManyShortLoopsInARow) {
  ThreadPool pool(GetParam());
  std::vector<int64_t> out(5);
  for (int64_t loop = 0; loop < 20000; ++loop) {
    const auto body = [&out, loop](int64_t task, int) { out[static_cast<size_t>(task)] = loop + task; };
    pool.ParallelFor(5, body);
    for (int64_t task = 0; task < 5; ++task) ASSERT_EQ(out[static_cast<size_t>(task)], loop + task);
  }
}

TEST_P(ThreadPoolSizes, RethrowsAndStaysUsable) {
  ThreadPool pool(GetParam());
  for (int round = 0; round < 50; ++round) {
    EXPECT_THROW(pool.ParallelFor(100,
                                  [](int64_t task, int) {
                                    if (task % 10 == 7) throw std::runtime_error("task failed");
                                  }),
                 std::runtime_error);
    std::atomic<int64_t> sum{0};
    pool.ParallelFor(100, [&](int64_t task, int) { sum += task; });
    ASSERT_EQ(sum, 4950);
  }
}

TEST_P(ThreadPoolSizes, NestedLoopIsRefused) {
  ThreadPool pool(GetParam());
  EXPECT_THROW(pool.ParallelFor(4, [&](int64_t, int) { pool.ParallelFor(4, [](int64_t, int) {}); }), std::logic_error);
  EXPECT_NO_THROW(pool.ParallelFor(4, [](int64_t, int) {}));
}

TEST(ThreadPool, UsesEveryThreadWhenTasksWait) {
  ThreadPool pool(3);
  std::atomic<int> n_inside{0};
  // Each task waits for the two others, so this needs three threads.
  pool.ParallelFor(3, [&](int64_t, int) {
    ++n_inside;
    while (n_inside < 3) std::this_thread::yield();
  });
  EXPECT_EQ(n_inside, 3);
}

TEST(ThreadPool, DefaultIsOnePerUsableCore) {
  EXPECT_EQ(ThreadPool().size(), UsableCores());
}

}  // namespace
}  // namespace skyquilt::base
