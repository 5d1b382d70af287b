#include <gtest/gtest.h>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "tests/support/connect_alone.h"

namespace skyquilt::comm {
namespace {

TEST(SingleRank, IsRankZeroOfOne) {
  const auto ranks = ConnectAlone();
  EXPECT_EQ(ranks->rank(), 0);
  EXPECT_EQ(ranks->size(), 1);
  EXPECT_EQ(ranks->local_size(), 1);
  EXPECT_EQ(ranks->Broadcast("all of it"), "all of it");
  ranks->Barrier();
}

TEST(SingleRank, ReceivesItsOwnMessagesInOrder) {
  const auto ranks = ConnectAlone();
  EXPECT_FALSE(ranks->TryReceive().has_value());
  ranks->Send(0, 5, "first");
  ranks->Send(0, 6, std::string("\0\xFF", 2));
  ranks->Send(0, 5, "");
  EXPECT_EQ(ranks->bytes_sent(), 7);
  const Message first = ranks->Receive();
  EXPECT_EQ(first.source, 0);
  EXPECT_EQ(first.tag, 5);
  EXPECT_EQ(first.bytes, "first");
  EXPECT_EQ(ranks->Receive().bytes, std::string("\0\xFF", 2));
  EXPECT_EQ(ranks->TryReceive()->bytes, "");
  EXPECT_FALSE(ranks->TryReceive().has_value());
}

TEST(SingleRank, RefusesToSendToOtherRanks) {
  EXPECT_THROW(ConnectAlone()->Send(1, 0, "nobody"), std::logic_error);
}

TEST(SingleRank, DeliversWaitingMessagesBeforeItStopsOnCancel) {
  const auto ranks = ConnectAlone();
  base::RequestCancel();
  ranks->Send(0, 1, "still delivered");
  EXPECT_EQ(ranks->Receive().bytes, "still delivered");
  EXPECT_THROW(ranks->Receive(), base::Interrupted);
  base::ClearCancel();
}

TEST(SingleRankDeathTest, AbortsWithItsStatus) {
  EXPECT_EXIT(ConnectAlone()->Abort(4), testing::ExitedWithCode(4), "");
}

}  // namespace
}  // namespace skyquilt::comm
