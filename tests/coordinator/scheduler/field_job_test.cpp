#include "coordinator/scheduler/field_job.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <new>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/base/errors.h"
#include "core/base/json_text.h"

namespace skyquilt::coordinator {
namespace {

const worker::Reporter kSilent = [](const worker::TrainStatus&) {};

TEST(FieldJob, ReadsBackUnchanged) {
  const FieldJob job{
      .block = 3, .name = "block_r1c0", .attempt = 2, .steps = 0, .seconds = 1.0 / 3.0, .rate_factor = 0.25, .seed = 0xFFFFFFFFFFFFFFF1ULL};
  const FieldJob back = JobFromText(ToText(job));
  EXPECT_EQ(back.block, job.block);
  EXPECT_EQ(back.name, job.name);
  EXPECT_EQ(back.attempt, job.attempt);
  EXPECT_EQ(back.seconds, job.seconds);
  EXPECT_EQ(back.rate_factor, job.rate_factor);
  EXPECT_EQ(back.seed, job.seed);
}

TEST(FieldJob, OutcomeReadsBackUnchangedEvenWithStrangeText) {
  FieldOutcome outcome;
  outcome.job.name = "block_r0c0";
  outcome.failure.kind = Failure::kInput;
  outcome.failure.reason = "photo \xff\xfe \"quoted\"\nsecond line";
  outcome.result.samples = (int64_t{1} << 60) + 1;
  outcome.result.final_psnr_db = std::numeric_limits<double>::quiet_NaN();
  outcome.peak_rss_bytes = 123456789012;
  outcome.saved_bytes = 5000000000;
  outcome.result.phase_seconds[3] = 1.5;
  outcome.result.falls = {{5223, 23.6, 15.9, 4992}, {6000, 23.5, std::numeric_limits<double>::quiet_NaN(), 5504}};
  outcome.result.comparison = worker::ContextComparison{15.5, 20.25, true};
  const FieldOutcome back = OutcomeFromText(ToText(outcome));
  EXPECT_EQ(back.failure.kind, Failure::kInput);
  EXPECT_NE(back.failure.reason.find("\"quoted\"\nsecond line"), std::string::npos);
  EXPECT_EQ(back.result.samples, outcome.result.samples);
  EXPECT_EQ(back.peak_rss_bytes, outcome.peak_rss_bytes);
  EXPECT_EQ(back.saved_bytes, outcome.saved_bytes);
  EXPECT_EQ(back.result.phase_seconds, outcome.result.phase_seconds);
  ASSERT_EQ(back.result.falls.size(), 2U);
  EXPECT_EQ(back.result.falls[0].restored_step, 4992);
  EXPECT_EQ(back.result.falls[0].psnr_db, 15.9);
  EXPECT_TRUE(std::isnan(back.result.falls[1].psnr_db));
  EXPECT_TRUE(back.result.ShowsContext());
  EXPECT_EQ(back.result.comparison->context_psnr_db, 20.25);
}

TEST(FieldJob, OutcomeOfAnEarlierVersionsLedgerIsRead) {
  nlohmann::json old = base::ParseJson(ToText(FieldOutcome{}));
  old["failure"] = 1;
  old["reason"] = "diverged";
  old["job"]["team"] = {0, 1};
  const FieldOutcome outcome = OutcomeFromText(base::JsonText(old));
  EXPECT_EQ(outcome.failure.kind, Failure::kBlock);
  EXPECT_EQ(outcome.failure.reason, "diverged");
}

TEST(FieldJob, StatusWithANonFiniteLossIsSent) {
  worker::TrainStatus status;
  status.step = 7;
  status.loss = std::numeric_limits<double>::infinity();
  EXPECT_EQ(StatusFromText(ToText(status)).step, 7);
}

// A time budget is for training: what comes before the first step and after the last one is not part of it.
TEST(RunField, TellsTrainingFromSetUp) {
  const FieldTrainer trainer = [](const FieldJob&, const worker::Reporter& report) {
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    // Resumed: ten seconds were trained in an earlier run, and twenty milliseconds now.
    for (const double run_s : {0.01, 0.02}) {
      worker::TrainStatus status;
      status.seconds = 10.0 + run_s;
      status.run_seconds = run_s;
      report(status);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    worker::TrainResult result;
    result.ok = true;
    return result;
  };
  const FieldOutcome outcome = RunField(trainer, {}, kSilent, 1, 2);
  EXPECT_NEAR(outcome.setup_s, outcome.wall_s - 0.02, 1e-9);
  EXPECT_GE(outcome.setup_s, 0.1);
  EXPECT_EQ(OutcomeFromText(ToText(outcome)).setup_s, outcome.setup_s);
  // Nothing was trained.
  const FieldOutcome finished = RunField([](const FieldJob&, const worker::Reporter&) { return worker::TrainResult(); }, {}, kSilent, 1, 2);
  EXPECT_EQ(finished.setup_s, finished.wall_s);
}

TEST(RunField, EveryExceptionBecomesAnOutcome) {
  const auto failure = [](const FieldTrainer& trainer) { return RunField(trainer, {}, kSilent, 1, 2).failure.kind; };
  using Result = worker::TrainResult;
  const auto result = [](bool ok, const std::string& reason) {
    Result made;
    made.ok = ok;
    made.reason = reason;
    return made;
  };
  EXPECT_EQ(failure([&](const FieldJob&, const worker::Reporter&) { return result(true, ""); }), Failure::kNone);
  EXPECT_EQ(failure([&](const FieldJob&, const worker::Reporter&) { return result(false, "x"); }), Failure::kBlock);
  EXPECT_EQ(failure([](const FieldJob&, const worker::Reporter&) -> Result { throw std::bad_alloc(); }), Failure::kBlock);
  EXPECT_EQ(failure([](const FieldJob&, const worker::Reporter&) -> Result { throw std::logic_error("x"); }), Failure::kBlock);
  EXPECT_EQ(failure([](const FieldJob&, const worker::Reporter&) -> Result { throw base::InputError("a", "b", "c"); }), Failure::kInput);
  EXPECT_EQ(failure([](const FieldJob&, const worker::Reporter&) -> Result { throw base::UsageError("a"); }), Failure::kUsage);
  EXPECT_EQ(failure([](const FieldJob&, const worker::Reporter&) -> Result { throw base::Interrupted(); }), Failure::kInterrupted);
}

}  // namespace
}  // namespace skyquilt::coordinator
