// The 16-bit formats in which scenes can be stored: rounding, overflow, and the quality of a scene stored with them.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "bench/numerics/groups.h"
#include "bench/numerics/hamlet_flight.h"
#include "core/base/half.h"
#include "core/base/random.h"
#include "core/checkpoint/archive.h"

namespace skyquilt::bench {
namespace {

struct ShortFormat {
  std::string name;
  checkpoint::Precision precision;
  float (*to_float)(uint16_t);
  uint16_t (*from_float)(float);
  int precision_bits;  // bits of the significand with the implicit one; rounding to nearest has a relative error of at most 2^-bits
  int least_exponent;  // smallest exponent of normal numbers
  float largest;
};

const std::vector<ShortFormat>& ShortFormats() {
  static const std::vector<ShortFormat> formats = {
      {"bf16", checkpoint::Precision::kBfloat16, base::FloatFromBfloat16, base::Bfloat16FromFloat, 8, -126, base::kLargestBfloat16},
      {"fp16", checkpoint::Precision::kFloat16, base::FloatFromFloat16, base::Float16FromFloat, 11, -14, base::kLargestFloat16}};
  return formats;
}

double StoredError(const ShortFormat& format, float value) {
  return static_cast<double>(format.to_float(format.from_float(value))) - static_cast<double>(value);
}

// Numbers of every magnitude of the format, both signs, uniform in their logarithm.
CaseResult Rounding(const ShortFormat& format) {
  base::Random random(29);
  Worst worst;
  for (int i = 0; i < 1000000; ++i) {
    const double size = std::exp2(random.Uniform(format.least_exponent, std::log2(static_cast<double>(format.largest)) - 0.01));
    const auto value = static_cast<float>(random.Uniform() < 0.5F ? -size : size);
    worst.Take(std::abs(StoredError(format, value)) / std::abs(static_cast<double>(value)));
  }
  return {.seen = fmt::format("10^6 numbers from 2^{} to {:g}", format.least_exponent, format.largest), .worst = worst.value()};
}

// Below its normal numbers fp16 has steps of 2^-24. bf16 has the exponents of float, so its subnormal numbers are those of float.
CaseResult TinyNumbers(const ShortFormat& format) {
  base::Random random(31);
  const double normal = std::exp2(format.least_exponent);
  const double step = std::ldexp(normal, 1 - format.precision_bits);
  Worst worst;
  for (int i = 0; i < 1000000; ++i) {
    const auto value = static_cast<float>(random.Uniform(-1.0, 1.0) * normal);
    worst.Take(std::abs(StoredError(format, value)) / step);
  }
  return {.seen = fmt::format("10^6 numbers within +-{:.2g}, steps of {:.2g}", normal, step), .worst = worst.value()};
}

CaseResult Overflow(const ShortFormat& format) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  bool holds = std::isnan(format.to_float(format.from_float(std::numeric_limits<float>::quiet_NaN())));
  for (const float value : {std::nextafter(format.largest, kInfinity), std::numeric_limits<float>::max(), kInfinity}) {
    holds = holds && format.to_float(format.from_float(value)) == format.largest && format.to_float(format.from_float(-value)) == -format.largest;
  }
  return {.seen = holds ? fmt::format("{:g}; NaN stays NaN", format.largest) : "another number", .holds = holds};
}

// A parameter that is too large for a 16-bit format, written to a file and read back.
CaseResult ArchiveOverflow(const ShortFormat& format, const NumericsOptions& options) {
  const std::vector<float> values = {1e30F, -std::numeric_limits<float>::max(), 0.25F, 0.0F};
  checkpoint::ArchiveWriter first("bench", 1);
  first.Put("values", values);
  std::filesystem::create_directories(options.work_folder);
  const std::filesystem::path from = options.work_folder / "wide.h5", to = options.work_folder / "short.h5";
  first.Commit(from);
  checkpoint::ArchiveWriter second("bench", 1);
  second.PutCopy("values", from, "values", format.precision);
  second.Commit(to);
  const std::vector<float> back = checkpoint::ArchiveReader(to).Floats("values");
  const bool finite = std::all_of(back.begin(), back.end(), [](float value) { return std::isfinite(value); });
  return {.seen = fmt::format("1e30 became {:g}, 0.25 became {:g}", back.at(0), back.at(2)),
          .holds = finite && back.size() == values.size() && back[2] == 0.25F && back[3] == 0.0F};
}

// One training, merged and scored with three precisions.
struct StoredScene {
  double psnr_db = kNoNumber;
  double bytes = 0.0;
};

StoredScene MergeAndScore(coordinator::Pipeline& pipeline, const std::string& storage) {
  pipeline.settings.merge.storage = storage;
  pipeline.restart = true;
  coordinator::MergeStage(pipeline);
  const double psnr_db = coordinator::EvaluateStage(pipeline).psnr;
  return {.psnr_db = psnr_db, .bytes = static_cast<double>(std::filesystem::file_size(pipeline.project.SceneFile()))};
}

std::vector<StoredScene> StoreHamlet(const NumericsOptions& options) {
  const QuietStages quiet(options.silent);
  const std::filesystem::path folder = options.work_folder / "storage";
  std::filesystem::remove_all(folder);
  coordinator::Pipeline pipeline{
      .comm = *options.comm, .project = coordinator::Project::Create(folder), .settings = HamletSettings({}, options), .quiet = true};
  // Tables chosen for a hamlet are so small that networks and occupancy grid, which keep their precision, count more than in a real block.
  pipeline.settings.partition.voxels_per_entry = 1.0;
  const std::filesystem::path photos = pipeline.project.SimulatedFolder();
  coordinator::SimulateStage(pipeline, photos);
  coordinator::PrepareStage(pipeline, photos, {});
  coordinator::PartitionStage(pipeline);
  coordinator::ThrowIfBlocksFailed(coordinator::TrainStage(pipeline), pipeline.project);
  std::vector<StoredScene> scenes = {MergeAndScore(pipeline, "fp32")};
  for (const ShortFormat& format : ShortFormats()) scenes.push_back(MergeAndScore(pipeline, format.name));
  std::filesystem::remove_all(folder);
  return scenes;
}

NumericCase SceneCase(size_t format, const std::shared_ptr<std::vector<StoredScene>>& scenes, const NumericsOptions& options) {
  constexpr double kMostBytes = 0.55;  // tables are halved; networks, occupancy grid and file headers are not
  return {.name = "A scene stored as " + ShortFormats()[format].name,
          .expected = fmt::format("PSNR within 0.1 dB of fp32, at most {:.0f} % of its bytes", 100.0 * kMostBytes),
          .unit = "dB",
          .limit = 0.1,
          .run = [format, scenes, options] {
            if (scenes->empty()) *scenes = StoreHamlet(options);
            const StoredScene &wide = scenes->at(0), &stored = scenes->at(format + 1);
            const double share = stored.bytes / wide.bytes;
            return CaseResult{.seen = fmt::format("{:.4f} dB, fp32 {:.4f} dB; {:.1f} % of {:.1f} MB", stored.psnr_db, wide.psnr_db, 100.0 * share,
                                                  wide.bytes / 1e6),
                              .worst = std::abs(stored.psnr_db - wide.psnr_db),
                              .holds = share <= kMostBytes};
          }};
}

}  // namespace

NumericGroup StorageGroup(const NumericsOptions& options) {
  NumericGroup group{.id = "storage",
                     .title = "Storage with 16 bits",
                     .lead =
                         "Tables may be stored as bf16 (the exponents of float) or fp16 (three more bits of precision, at most 65504). Numbers that "
                         "are too large become the largest number, because one infinity would make a whole field NaN."};
  for (const ShortFormat& format : ShortFormats()) {
    group.cases.push_back({.name = format.name + ": rounding",
                           .expected = fmt::format("off by at most 2^-{} of the number", format.precision_bits),
                           .unit = "relative",
                           .limit = std::exp2(-format.precision_bits),
                           .run = [&format] { return Rounding(format); }});
    group.cases.push_back({.name = format.name + ": numbers too small to be normal",
                           .expected = "off by at most half a step",
                           .unit = "steps",
                           .limit = 0.5,
                           .run = [&format] { return TinyNumbers(format); }});
    group.cases.push_back({.name = format.name + ": numbers too large, infinity, NaN",
                           .expected = fmt::format("becomes {:g} with its sign", format.largest),
                           .run = [&format] { return Overflow(format); }});
    group.cases.push_back({.name = format.name + ": parameters too large, through a file",
                           .expected = "finite; the others unchanged",
                           .run = [&format, options] { return ArchiveOverflow(format, options); }});
  }
  if (options.comm == nullptr) return group;
  const auto scenes = std::make_shared<std::vector<StoredScene>>();
  for (size_t format = 0; format < ShortFormats().size(); ++format) group.cases.push_back(SceneCase(format, scenes, options));
  return group;
}

}  // namespace skyquilt::bench
