#include "core/base/cancel.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <cstdlib>

#include "core/base/errors.h"

namespace skyquilt::base {
namespace {

TEST(Cancel, FlagIsSetAndCleared) {
  ClearCancel();
  EXPECT_FALSE(CancelRequested());
  EXPECT_NO_THROW(ThrowIfCancelled());
  RequestCancel();
  EXPECT_TRUE(CancelRequested());
  EXPECT_THROW(ThrowIfCancelled(), Interrupted);
  ClearCancel();
  EXPECT_FALSE(CancelRequested());
}

TEST(Cancel, ARequestCanBeWithdrawnButNotASignal) {
  ClearCancel();
  RequestCancel();
  WithdrawRequest();
  EXPECT_FALSE(CancelRequested());
  InstallSignalHandlers();
  raise(SIGTERM);
  RequestCancel();
  WithdrawRequest();
  EXPECT_TRUE(CancelRequested());
  ClearCancel();
  EXPECT_FALSE(CancelRequested());
}

// Exits with status 0 if no signal ended the process and each one set the flag.
void SurviveEachSignalOnce() {
  InstallSignalHandlers();
  for (const int signal_number : {SIGTERM, SIGTERM, SIGUSR1, SIGINT}) {
    ClearCancel();
    raise(signal_number);
    if (!CancelRequested()) std::_Exit(1);
  }
  std::_Exit(0);
}

TEST(CancelDeathTest, OneSignalOnlySetsTheFlag) {
  EXPECT_EXIT(SurviveEachSignalOnce(), testing::ExitedWithCode(0), "");
}

TEST(CancelDeathTest, SecondInterruptEndsAtOnce) {
  const auto interrupt_twice = [] {
    InstallSignalHandlers();
    raise(SIGINT);
    raise(SIGINT);
    std::_Exit(0);
  };
  EXPECT_EXIT(interrupt_twice(), testing::ExitedWithCode(130), "");
}

}  // namespace
}  // namespace skyquilt::base
