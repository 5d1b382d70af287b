// Runs a test once per instruction set of this processor, including the portable one:
//   using Fixture = EachInstructionSet;
//   TEST_P(Fixture, Name) { ... }
//   SKYQUILT_EACH_INSTRUCTION_SET(Fixture);
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "core/kernel/kernels.h"

namespace skyquilt::testing {

class EachInstructionSet : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    before_ = kernel::ActiveInstructionSet();
    kernel::ForceInstructionSet(GetParam());
    ASSERT_EQ(kernel::ActiveInstructionSet(), GetParam());
  }
  void TearDown() override { kernel::ForceInstructionSet(before_); }

 private:
  std::string before_;
};

}  // namespace skyquilt::testing

#define SKYQUILT_EACH_INSTRUCTION_SET(fixture) \
  INSTANTIATE_TEST_SUITE_P(On, fixture, ::testing::ValuesIn(::skyquilt::kernel::InstructionSets()), [](const auto& of) { return of.param; })
