// Bounded queues, places of connections, rates and HTML.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "viewer/server/answer.h"
#include "viewer/server/connections.h"
#include "viewer/server/send_queue.h"
#include "viewer/server/token_bucket.h"

namespace skyquilt::viewer::server {
namespace {

OutMessage MessageOf(size_t bytes) {
  return {.binary = true, .bytes = std::make_shared<const std::string>(bytes, 'x')};
}

TEST(SendQueueTest, WakesOnceAndKeepsOrder) {
  int wakes = 0;
  SendQueue queue(100, [&wakes] { ++wakes; });
  queue.Push(MessageOf(1));
  queue.Push(MessageOf(2));
  queue.Push({});
  EXPECT_EQ(wakes, 1);
  EXPECT_EQ(queue.waiting_bytes(), 3U);
  queue.BeginLook();
  EXPECT_EQ(queue.Next()->bytes->size(), 1U);
  EXPECT_EQ(queue.waiting_bytes(), 2U);
  queue.Push(MessageOf(3));
  EXPECT_EQ(wakes, 2);
  EXPECT_EQ(queue.Next()->bytes->size(), 2U);
  EXPECT_EQ(queue.Next()->bytes->size(), 3U);
  EXPECT_FALSE(queue.Next());
}

TEST(SendQueueTest, OverflowsWithTheMessageUnderWayCounted) {
  SendQueue queue(100, [] {});
  queue.Push(MessageOf(60));
  queue.Next();
  queue.Push(MessageOf(40));
  EXPECT_FALSE(queue.overflowed());
  queue.Push(MessageOf(1));
  EXPECT_TRUE(queue.overflowed());
  EXPECT_EQ(queue.waiting_bytes(), 0U);
  queue.Push(MessageOf(1));
  EXPECT_FALSE(queue.Next());
}

TEST(SendQueueTest, ManyEmptyMessagesOverflow) {
  SendQueue queue(100, [] {});
  for (int i = 0; i < 100000; ++i) queue.Push(MessageOf(0));
  EXPECT_TRUE(queue.overflowed());
}

TEST(SendQueueTest, ClosedQueueKeepsNothing) {
  SendQueue queue(100, [] {});
  queue.Push(MessageOf(5));
  queue.Close();
  queue.Push(MessageOf(5));
  EXPECT_EQ(queue.waiting_bytes(), 0U);
  EXPECT_FALSE(queue.Next());
}

TEST(ConnectionsTest, StrangersGoFirstThenWaitingOnesNeverBusyOnes) {
  Connections connections(3);
  std::vector<int> closed;
  const auto admit = [&](int name, Standing standing) {
    auto slot = connections.Admit([&closed, name] { closed.push_back(name); });
    if (slot) slot->Set(standing);
    return slot;
  };
  const auto waiting = admit(1, Standing::kWaiting);
  const auto stranger = admit(2, Standing::kStranger);
  const auto busy = admit(3, Standing::kBusy);
  const auto fourth = admit(4, Standing::kBusy);
  EXPECT_EQ(closed, std::vector<int>({2}));
  const auto fifth = admit(5, Standing::kBusy);
  EXPECT_EQ(closed, std::vector<int>({2, 1}));
  EXPECT_FALSE(admit(6, Standing::kBusy));
  EXPECT_EQ(closed.size(), 2U);
  connections.CloseAll();
  EXPECT_EQ(closed, std::vector<int>({2, 1, 3, 4, 5}));
}

TEST(ConnectionsTest, PlaceIsGivenBack) {
  Connections connections(1);
  for (int i = 0; i < 3; ++i) {
    auto slot = connections.Admit([] { ADD_FAILURE(); });
    ASSERT_TRUE(slot);
    slot->Set(Standing::kBusy);
    const ConnectionSlot moved = std::move(*slot);
  }
}

TEST(TokenBucketTest, AllowsBurstsOfTwiceTheRate) {
  const TokenBucket::Clock::time_point start{};
  TokenBucket bucket(10.0, start);
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(bucket.Take(start));
  EXPECT_FALSE(bucket.Take(start));
  int taken = 0;
  for (int i = 0; i < 50; ++i) taken += bucket.Take(start + std::chrono::seconds(1)) ? 1 : 0;
  EXPECT_EQ(taken, 10);
}

TEST(AnswerTest, TextOfPagesIsEscaped) {
  EXPECT_EQ(EscapeHtml("<a href=\"x\">'&"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;");
  const Answer page = PageAnswer(403, "<script>", {"a<b"}, "c<d");
  EXPECT_EQ(page.body->find("<script>"), std::string::npos);
  EXPECT_NE(page.body->find("a&lt;b"), std::string::npos);
  EXPECT_NE(page.body->find("c&lt;d"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::viewer::server
