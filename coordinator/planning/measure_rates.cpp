#include "coordinator/planning/measure_rates.h"

#include <algorithm>
#include <chrono>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/child_process.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/random.h"
#include "core/field/optimizer.h"
#include "core/image/image.h"
#include "core/kernel/descriptors.h"
#include "core/render/trained_field.h"
#include "prepare/input/input_folder.h"
#include "prepare/input/list_files.h"
#include "prepare/input/photo_files.h"
#include "prepare/poses/extract_features.h"
#include "prepare/poses/feature_matcher.h"
#include "prepare/prepare_options.h"
#include "worker/step/field_step.h"
#include "worker/step/random_batch.h"

namespace skyquilt::coordinator {
namespace {

using RateClock = std::chrono::steady_clock;

constexpr double kTraining_s = 0.6, kDecoding_s = 0.3;
constexpr int kSamplesOfRay = 16;
constexpr int kTrialTableSize = 17;  // log2
// Of the speed of steps on random rays: real ones are chosen, have priors and skip empty cells.
constexpr double kRealTraining = 0.75;
// Photos are decoded and scaled in parallel; memory keeps threads from adding up fully.
constexpr double kParallelDecoding = 0.8;
constexpr size_t kFewestTrialPhotos = 3, kMostTrialPhotos = 4;
constexpr size_t kTrialFeatures = 4096;

double SecondsSince(RateClock::time_point start) {
  return std::max(1e-6, std::chrono::duration<double>(RateClock::now() - start).count());
}

render::TrainedField TrialField(const worker::TrainOptions& options) {
  render::TrainedField field;
  field.map = encoding::SpaceMap::Box(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones());
  field.step_m = 1.0 / kSamplesOfRay;
  field.config.grid.levels = options.levels;
  field.config.grid.features = options.features;
  field.config.grid.log2_table_size = kTrialTableSize;
  field.config.grid.base_resolution = options.base_resolution;
  field.config.grid.finest_resolution = std::max(2048, options.base_resolution);
  field.config.hidden = options.hidden;
  field.config.color_hidden_layers = options.color_hidden_layers;
  field.config.sh_degree = options.sh_degree;
  field.config.density_activation = field::DensityActivationNamed(options.density_activation);
  field.config.appearance = options.appearance_codes;
  return field;
}

double TrainingSamples(const worker::TrainOptions& options, base::ThreadPool& threads) {
  const render::TrainedField target = TrialField(options);
  const field::HashField field(target.config);
  field::Parameters parameters;
  parameters.Allocate(field);
  field::OptimizerState state;
  state.Allocate(field);
  base::Random random(11);
  field.Initialize(random, parameters.grid, parameters.networks);
  worker::PhaseTimes times(threads.size());
  worker::FieldStep step(target, field, nullptr, worker::LuminancePlan{}, threads, times);
  worker::RayBatch batch =
      worker::RandomBatch(options.batch_samples, kSamplesOfRay, field.FeatureRows(), 5, 1.0 / target.config.grid.finest_resolution);
  worker::StepOptions learning;
  learning.learning_rate = 1e-4;  // keeps densities low, so that no sample is hidden and skipped
  step.Train(batch, learning, parameters, state, nullptr);
  const RateClock::time_point start = RateClock::now();
  double samples = 0.0;
  do {
    base::ThrowIfCancelled();
    step.Train(batch, learning, parameters, state, nullptr);
    samples += static_cast<double>(batch.n_samples);
  } while (SecondsSince(start) < kTraining_s);
  return kRealTraining * samples / SecondsSince(start);
}

double DecodedPixels(const std::filesystem::path& root, const std::vector<std::string>& names, int threads) {
  double pixels = 0.0;
  const RateClock::time_point start = RateClock::now();
  for (const std::string& name : names) {
    base::ThrowIfCancelled();
    const image::Image8 photo = image::LoadRgb8(root / name);
    pixels += static_cast<double>(photo.width) * photo.height;
    if (SecondsSince(start) > kDecoding_s) break;
  }
  return kParallelDecoding * threads * pixels / SecondsSince(start);
}

// Pixels at the size of the search, per second; all threads.
double FeaturePixels(const std::filesystem::path& root, const std::vector<std::string>& names, const WorkSize& size, const Settings& settings,
                     const std::filesystem::path& folder, base::ThreadPool& threads) {
  namespace poses = prepare::poses;
  const poses::PoseOptions options = prepare::PoseOptionsOf(settings.prepare);
  const prepare::input::PhotoSet photos = prepare::input::ReadPhotos(root, names, threads);
  const poses::ColmapJob job{.photo_root = root, .masks = {}, .folder = folder};
  const poses::ColmapSettings colmap{.program = base::FindProgram(options.colmap), .n_threads = threads.size(), .fast = options.fast};
  std::filesystem::create_directories(folder);
  const RateClock::time_point start = RateClock::now();
  poses::ExtractFeatures(job, colmap, photos.usable, options, "trial", nullptr);
  const double searched = size.PixelsAt(std::min(options.max_image_size, std::max(1, size.photo_width)));
  // Threads work on a photo each: fewer photos than threads leave some idle.
  const auto n = static_cast<double>(photos.usable.size());
  const double busy = std::min(1.0, n / threads.size());
  return n * searched / SecondsSince(start) / busy;
}

double MatchedPairs(int threads) {
  base::Random random(3);
  const auto descriptors = [&random] {
    std::vector<uint8_t> rows(kTrialFeatures * kernel::kDescriptorBytes);
    for (uint8_t& byte : rows) byte = static_cast<uint8_t>(90.0F * random.Uniform());
    return kernel::PackDescriptors(rows);
  };
  const kernel::PackedDescriptors a = descriptors(), b = descriptors();
  const RateClock::time_point start = RateClock::now();
  prepare::poses::MatchDescriptors(a, b, {});
  return threads / SecondsSince(start);
}

class TrialFolder {
 public:
  explicit TrialFolder(std::filesystem::path path) : path_(std::move(path)) {}
  ~TrialFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TrialFolder(const TrialFolder&) = delete;
  TrialFolder& operator=(const TrialFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::vector<std::string> TrialPhotos(const std::filesystem::path& root, const Settings& settings, base::ThreadPool& threads) {
  const std::vector<std::string> all =
      prepare::input::TakenNames(prepare::input::ListInput(root, {.skip = {}, .masks = {}, .patterns = settings.prepare.photos}, threads));
  const size_t n = std::min(all.size(), std::clamp(static_cast<size_t>(threads.size()), kFewestTrialPhotos, kMostTrialPhotos));
  std::vector<std::string> chosen;
  for (size_t i = 0; i < n; ++i) chosen.push_back(all[i * all.size() / n]);
  return chosen;
}

}  // namespace

Rates MeasureRates(const WorkSize& size, const Settings& settings, const RateSource& source, base::ThreadPool& threads) {
  Rates rates = Rates::Usual(threads.size());
  if (settings.train.encoding == "hash") rates.TakeSamples(TrainingSamples(settings.train, threads));
  if (!source.photos_to_decode) return rates;
  const base::LogLevel level = base::GetLogLevel();
  base::SetLogLevel(base::LogLevel::kError);
  try {
    const prepare::input::InputFolder folders = prepare::input::FindInputs(source.photos, source.model, settings.prepare.masks);
    const std::vector<std::string> names = TrialPhotos(folders.photo_root, settings, threads);
    rates.decoded_pixels = DecodedPixels(folders.photo_root, names, threads.size());
    if (source.poses && !size.poses_given) {
      rates.matched_pairs = MatchedPairs(threads.size());
      const TrialFolder trial(source.work_folder);
      rates.feature_pixels = FeaturePixels(folders.photo_root, names, size, settings, trial.path(), threads);
    }
  } catch (const base::InputError&) {
    // A photo that cannot be read or a COLMAP that fails: "prepare" says so. What was not measured keeps its usual value.
  } catch (...) {
    base::SetLogLevel(level);
    throw;
  }
  base::SetLogLevel(level);
  return rates;
}

}  // namespace skyquilt::coordinator
