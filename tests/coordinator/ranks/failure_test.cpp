#include "coordinator/ranks/failure.h"

#include <gtest/gtest.h>

#include <new>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/base/errors.h"
#include "core/base/json_text.h"

namespace skyquilt::coordinator {
namespace {

template <typename Error>
Failure Caught(const Error& error) {
  try {
    throw error;
  } catch (...) {
    return FailureFromJson(base::ParseJson(base::JsonText(ToJson(CurrentFailure()))));
  }
}

TEST(Failure, AnInputErrorArrivesAsItWasThrown) {
  // A path that contains ": " must not be cut there.
  const base::InputError sent("/data/flight: morning/IMG_1.jpg", "is cut short: 3 of 7 bytes", "Copy it again");
  const Failure failure = Caught(sent);
  EXPECT_EQ(failure.kind, Failure::kInput);
  EXPECT_EQ(failure.Text(), sent.what());
  try {
    Throw(failure);
  } catch (const base::InputError& error) {
    EXPECT_EQ(error.file(), sent.file());
    EXPECT_STREQ(error.what(), sent.what());
  }
}

TEST(Failure, NamesItsRank) {
  const Failure failure = Caught(base::InputError("scene.h5", "no such file", "Make it"));
  try {
    Throw(failure, "rank 3 on alpha");
  } catch (const base::InputError& error) {
    EXPECT_STREQ(error.what(), "scene.h5: rank 3 on alpha: no such file. Make it. All ranks must see the same project folder");
  }
}

TEST(Failure, EveryErrorKeepsItsKind) {
  EXPECT_EQ(Caught(base::UsageError("x")).kind, Failure::kUsage);
  EXPECT_EQ(Caught(base::Interrupted()).kind, Failure::kInterrupted);
  EXPECT_EQ(Caught(std::bad_alloc()).kind, Failure::kBlock);
  EXPECT_EQ(Caught(std::runtime_error("x")).reason, "x");
  EXPECT_THROW(Throw(Caught(base::UsageError("x"))), base::UsageError);
  EXPECT_THROW(Throw(Caught(base::Interrupted())), base::Interrupted);
  EXPECT_THROW(Throw(Caught(std::runtime_error("x")), "rank 1"), base::InputError);
}

}  // namespace
}  // namespace skyquilt::coordinator
