// Batch size, cache of frames, encoder, watched files and places of two surveys.
#include <gtest/gtest.h>

#include <condition_variable>
#include <limits>
#include <mutex>

#include "core/base/file.h"
#include "core/geo/enu_frame.h"
#include "tests/support/temporary_folder.h"
#include "viewer/data/file_look.h"
#include "viewer/data/survey_place.h"
#include "viewer/engine/batch_size.h"
#include "viewer/engine/frame_cache.h"
#include "viewer/engine/frame_encoder.h"
#include "viewer/protocol/frame.h"

namespace skyquilt::viewer {
namespace {

// Batches of a machine with this speed per thread, after some measurements.
size_t Settled(int threads, int ranks, double rays_per_second) {
  BatchSize batch(threads, ranks);
  for (int i = 0; i < 30; ++i) {
    const size_t tasks = (batch.rays() + 127) / 128, busy = std::min<size_t>(static_cast<size_t>(threads), tasks);
    const double parallel = ranks > 0 ? 1.0 : static_cast<double>(busy);
    batch.Add(batch.rays(), static_cast<double>(batch.rays()) / (rays_per_second * parallel), false);
  }
  return batch.rays();
}

TEST(BatchSize, TakesAboutEightMilliseconds) {
  EXPECT_NEAR(static_cast<double>(Settled(2, 0, 120e3)), 1920.0, 1.0);
  EXPECT_NEAR(static_cast<double>(Settled(2, 0, 400e3)), 6400.0, 1.0);
  EXPECT_NEAR(static_cast<double>(Settled(2, 0, 50e3)), 800.0, 1.0);  // both threads work, however slow they are
  EXPECT_EQ(Settled(1, 0, 1e3), 256U);                                // a slow machine
  EXPECT_EQ(Settled(64, 0, 1e6), 16384U);                             // a fast one
  EXPECT_EQ(Settled(2, 3, 100e3), 6144U);                             // at least 2048 per rank
  EXPECT_EQ(Settled(2, 2, 1e6), 8000U);
}

TEST(BatchSize, SharesTheLoadingOfFieldsAmongManyRays) {
  BatchSize batch(2, 0);
  for (int i = 0; i < 10; ++i) batch.Add(2048, 0.010, false);
  const size_t usual = batch.rays();
  batch.Add(2048, 1.5, true);
  EXPECT_EQ(batch.rays(), 16384U);
  batch.Add(16384, 0.080, false);
  EXPECT_EQ(batch.rays(), usual);
}

TEST(BatchSize, IgnoresSenselessMeasurements) {
  BatchSize batch(2, 0);
  const size_t first = batch.rays();
  for (const double seconds : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    batch.Add(2048, seconds, false);
    EXPECT_EQ(batch.rays(), first);
  }
  batch.Add(1, 1.0, false);  // a pick
  EXPECT_EQ(batch.rays(), first);
}

FrameBytes Bytes(size_t n) {
  return std::make_shared<const std::string>(n, 'x');
}

TEST(FrameCache, DropsWhatWasUsedLongestAgo) {
  FrameCache cache(1000);
  cache.Put("a", Bytes(400));
  cache.Put("b", Bytes(400));
  EXPECT_NE(cache.Find("a"), nullptr);
  cache.Put("c", Bytes(400));
  EXPECT_EQ(cache.Find("b"), nullptr);
  EXPECT_NE(cache.Find("a"), nullptr);
  EXPECT_EQ(cache.bytes(), 800U);
  cache.Put("a", Bytes(500));  // replaced, not added
  EXPECT_EQ(cache.bytes(), 900U);
  cache.Put("d", Bytes(1001));
  EXPECT_EQ(cache.Find("d"), nullptr);
  EXPECT_EQ(cache.bytes(), 900U);
  cache.Clear();
  EXPECT_EQ(cache.Find("a"), nullptr);
  EXPECT_EQ(cache.bytes(), 0U);
}

TEST(FrameCache, FramesAreReaddressed) {
  FrameHeader header;
  header.seq = 0x01020304;
  header.revision = 9;
  header.passes = 1;
  header.format = ColorFormat::kPng;
  header.width = header.height = header.w = header.h = 2;
  const std::vector<uint8_t> rgb(12, 50);
  const std::vector<float> depth(4, 3.0F);
  const FrameBytes frame = std::make_shared<const std::string>(EncodeFrame(header, rgb, depth));
  EXPECT_EQ(Readdressed(frame, 0x01020304, 9), frame);  // no copy
  const DecodedFrame other = DecodeFrame(*Readdressed(frame, 0xFFEEDDCC, 0x10203));
  EXPECT_EQ(other.header.seq, 0xFFEEDDCCU);
  EXPECT_EQ(other.header.revision, 0x10203U);
  EXPECT_EQ(other.color, DecodeFrame(*frame).color);
}

TEST(FrameEncoder, ReturnsEverythingAndItsErrors) {
  std::mutex mutex;
  std::condition_variable changed;
  int done = 0;
  FrameEncoder encoder(
      [](const RenderedPass& pass) -> std::string {
        if (pass.header.seq == 2) throw std::runtime_error("broken");
        return std::to_string(pass.header.seq);
      },
      true,
      [&] {
        const std::lock_guard lock(mutex);
        ++done;
        changed.notify_all();
      });
  std::map<uint64_t, uint32_t> seq;
  for (uint32_t i = 1; i <= 3; ++i) {
    RenderedPass pass;
    pass.header.seq = i;
    seq[encoder.Add(std::move(pass))] = i;
  }
  std::unique_lock lock(mutex);
  changed.wait(lock, [&] { return done == 3; });
  const std::vector<EncodedPass> encoded = encoder.Take();
  ASSERT_EQ(encoded.size(), 3U);
  for (const EncodedPass& pass : encoded) {
    if (seq.at(pass.ticket) == 2) {
      EXPECT_EQ(pass.bytes, nullptr);
      EXPECT_EQ(pass.error, "broken");
    } else {
      EXPECT_EQ(*pass.bytes, std::to_string(seq.at(pass.ticket)));
    }
  }
  EXPECT_EQ(encoder.pending(), 0U);
}

TEST(FileLook, NoticesAReplacedFile) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "scene.h5";
  EXPECT_FALSE(LookAt(file).exists);
  base::WriteFileAtomically(file, "one");
  const FileLook first = LookAt(file);
  EXPECT_TRUE(first.exists);
  EXPECT_EQ(LookAt(file), first);
  base::WriteFileAtomically(file, "two");  // of the same length, perhaps within the clock's resolution
  EXPECT_NE(LookAt(file), first);
}

TEST(SurveyPlace, CarriesPointsThroughEcef) {
  const SurveyPlace main{{47.0, 8.0, 400.0}, true}, other{{47.002, 8.003, 420.0}, true};
  const std::optional<geo::Rigid3d> other_from_main = OtherFromMain(main, other);
  ASSERT_TRUE(other_from_main);
  const geo::EnuFrame in_main(main.origin), in_other(other.origin);
  for (const Eigen::Vector3d& x : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(120, -340, 55), Eigen::Vector3d(-2000, 1500, 10)}) {
    EXPECT_LT((*other_from_main * x - in_other.EnuFromGeodetic(in_main.GeodeticFromEnu(x))).norm(), 1e-6);
  }
}

TEST(SurveyPlace, LocalFramesAreTheSameAndMixedOnesAreNotComparable) {
  const SurveyPlace local, placed{{47.0, 8.0, 400.0}, true}, broken{{400.0, 8.0, 0.0}, true};
  EXPECT_TRUE(OtherFromMain(local, local));
  EXPECT_FALSE(OtherFromMain(local, placed));
  EXPECT_FALSE(OtherFromMain(placed, local));
  EXPECT_FALSE(OtherFromMain(placed, broken));
}

}  // namespace
}  // namespace skyquilt::viewer
