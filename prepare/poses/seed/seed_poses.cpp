#include "prepare/poses/seed/seed_poses.h"

#include <algorithm>
#include <cstdio>

#include "core/base/cancel.h"
#include "core/base/progress.h"
#include "prepare/bundle/adjust_bundle.h"
#include "prepare/bundle/feature_tracks.h"
#include "prepare/bundle/resect.h"
#include "prepare/bundle/triangulate.h"
#include "prepare/poses/seed/bundle_model.h"
#include "prepare/poses/seed/seed_survey.h"
#include "prepare/poses/seed/verdict.h"

namespace skyquilt::prepare::poses {
namespace {

// Observations of each photo in the adjustment: enough for poses and lens; all others only become points.
constexpr size_t kPerPhoto = 640;
constexpr double kAngleSigma_deg = 3.0;     // of gimbals
constexpr double kLookDownSigma_deg = 6.0;  // of a camera that is fixed to an aircraft

// One line of progress over all stages; a stage that ends early jumps to its end.
class StageProgress {
 public:
  StageProgress() : progress_("place photos by tags", kTotal, "iterations") {}
  void Begin(const std::string& text, int iterations) {
    end_ += iterations;
    progress_.Update(at_, text);
  }
  void Step() {
    at_ = std::min(at_ + 1.0, end_);
    progress_.Update(at_);
  }
  void End() {
    at_ = end_;
    progress_.Update(at_);
  }
  void Finish() { progress_.Finish(); }

 private:
  static constexpr double kTotal = 85.0;
  base::Progress progress_;
  double at_ = 0.0, end_ = 0.0;
};

class Seeding {
 public:
  Seeding(bundle::BundleProblem bundle, const SeedStart& start, base::ThreadPool& threads)
      : bundle_(std::move(bundle)), start_(start), threads_(threads) {}

  const bundle::BundleProblem& bundle() const { return bundle_; }

  // Empty reason: done.
  std::string Run() {
    const double angle_deg = start_.by_gimbal ? kAngleSigma_deg : kLookDownSigma_deg;
    std::vector<char> counts(bundle_.agrees.size(), 0);
    for (size_t e = 0; e < counts.size(); ++e) counts[e] = bundle_.photos[bundle_.tracks.entries[e].photo].placed ? 1 : 0;
    chosen_ = bundle::ChooseTracks(bundle_, std::vector<char>(bundle_.tracks.size(), 1), counts, kPerPhoto);
    bundle::PlaceOnGround(bundle_, chosen_, start_.height_m);
    // While everything is off by tens of pixels, no observation is given up.
    if (!Adjust("rough poses",
                {.loss = 16.0, .gentle = true, .free_lens = false, .angle_sigma_deg = angle_deg, .max_iterations = 15, .tolerance = 1e-3})) {
      return kNoSolution;
    }
    bundle::Triangulate(bundle_, chosen_, 50.0, threads_);
    if (!Adjust("lens", {.loss = 10.0, .gps_factor = 1.5, .angle_sigma_deg = angle_deg, .max_iterations = 15, .tolerance = 1e-3})) return kNoSolution;
    bundle::Triangulate(bundle_, chosen_, 16.0, threads_);
    if (!Adjust("poses", {.loss = 3.0, .gps_factor = 3.0, .angle_sigma_deg = 3.0 * angle_deg, .max_iterations = 15, .tolerance = 1e-4}))
      return kNoSolution;
    // From here the tags only hold the frame. All tracks become points: they show which photos fail, and place those without tags.
    Complete(10.0);
    if (!Adjust("all photos", Last(1e-4))) return kNoSolution;
    Complete(4.0);
    if (!Adjust("final poses", Last(1e-6))) return kNoSolution;
    bundle::TriangulateAll(bundle_, FinalThreshold(), threads_);
    if (RemoveContradicted(bundle_, start_.height_m) > 0) bundle::TriangulateAll(bundle_, FinalThreshold(), threads_);
    progress_.Finish();
    return "";
  }

 private:
  static constexpr const char* kNoSolution = "the bundle adjustment found no solution";

  static bundle::BundleStage Last(double tolerance) {
    return {.loss = 1.0, .gps_factor = 10.0, .angle_sigma_deg = 30.0, .max_iterations = 20, .tolerance = tolerance};
  }

  bool Adjust(const std::string& text, const bundle::BundleStage& stage) {
    progress_.Begin(text, stage.max_iterations);
    const bool solved = bundle::AdjustBundle(bundle_, chosen_, stage, [this] { progress_.Step(); });
    progress_.End();
    return solved;
  }

  // Points of all tracks, photos that contradict them removed, those without pose placed by them, and tracks chosen anew among what agrees.
  void Complete(double threshold) {
    bundle::TriangulateAll(bundle_, threshold, threads_);
    const size_t removed = RemoveContradicted(bundle_, start_.height_m);
    if (removed > 0) bundle::TriangulateAll(bundle_, threshold, threads_);
    // Photos that see only others without a pose follow in a second round.
    for (int round = 0; round < 2 && bundle::ResectPhotos(bundle_, 2.0 * threshold) > 0; ++round)
      bundle::TriangulateAll(bundle_, threshold, threads_);
    chosen_ = bundle::ChooseTracks(bundle_, bundle_.has_point, bundle_.agrees, kPerPhoto);
  }

  // A few times the usual error, so that a sharp survey is not blurred by matches that are only nearly right.
  double FinalThreshold() const {
    constexpr double kLeast = 1.5, kMost = 4.0, kTimes = 5.0;
    return std::clamp(kTimes * Judge(bundle_, start_.height_m).median_error, kLeast, kMost);
  }

  bundle::BundleProblem bundle_;
  const SeedStart& start_;
  base::ThreadPool& threads_;
  std::vector<uint32_t> chosen_;
  StageProgress progress_;
};

}  // namespace

std::optional<SeededModel> SeedPoses(const SeedInput& input, base::ThreadPool& threads, std::string* reason) {
  SeedSurvey survey;
  if (!MakeSeedSurvey(input, &survey, reason)) return std::nullopt;
  for (const SeedStart& start : FindStarts(survey, reason)) {
    base::ThrowIfCancelled();
    Seeding seeding(MakeBundle(survey, start, threads), start, threads);
    const std::string failure = seeding.Run();
    const Verdict verdict = Judge(seeding.bundle(), start.height_m);
    if (!failure.empty() || !verdict.good) {
      *reason =
          std::string("seeded by ") + (start.by_gimbal ? "gimbal angles, " : "GPS and matches, ") + (failure.empty() ? verdict.reason : failure);
      continue;
    }
    SeededModel seeded;
    ModelOfBundle(input, seeding.bundle(), &seeded.model, &seeded.observations);
    seeded.median_error = verdict.median_error;
    seeded.median_gps_m = verdict.median_gps_m;
    seeded.by_gimbal = start.by_gimbal;
    char text[240];
    std::snprintf(text, sizeof(text),
                  "%zu of %zu photos placed by %s, %zu points, median reprojection error %.2f px at 1600 px, %.0f %% of matches agree, "
                  "median distance to tags %.1f m",
                  verdict.n_placed, input.photos.size(), start.by_gimbal ? "GPS and gimbal" : "GPS and matches", seeded.model.points.size(),
                  verdict.median_error, 100.0 * verdict.share_agreeing, verdict.median_gps_m);
    seeded.summary = text;
    reason->clear();
    return seeded;
  }
  return std::nullopt;
}

void WriteSeededModel(const SeededModel& seeded, const std::filesystem::path& folder) {
  survey::WriteColmapBinary(seeded.model, seeded.observations, folder);
}

}  // namespace skyquilt::prepare::poses
