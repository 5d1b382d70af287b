// Trains one survey in several ways to compare them. Each variant is a separate project, from blocks to report. Its result is saved, so that an
// interrupted bench continues with the next variant; large files of finished variants are removed.
//   FOLDER/source/                   the survey that all variants use (unless it is given as a project)
//   FOLDER/runs/<variant>/           project: blocks.geojson, train.json, report/ and the rest
//   FOLDER/runs/<variant>/covered/   which pixels of held-out photos were scored, and their errors (evaluate/photos/scored_pixels.h)
//   FOLDER/runs/<variant>.json       result
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/study/edited_survey.h"
#include "bench/study/light_scores.h"
#include "bench/study/scale_scores.h"
#include "coordinator/project/settings.h"
#include "coordinator/stages/pipeline.h"
#include "core/comm/communicator.h"
#include "core/scene/train_report.h"
#include "core/survey/survey.h"
#include "evaluate/metrics/metrics.h"

namespace skyquilt::bench {

// Where the photos come from: exactly one of `folder` and `place` is given.
struct StudySurvey {
  std::filesystem::path folder;  // photos, a simulated survey, or a prepared project
  std::string place;             // a place to simulate
  std::filesystem::path model;   // COLMAP model of the photos; may be empty
};

struct Variant {
  std::string name = {};                         // of its folder: lower-case letters, digits, '-' and '_'
  std::string label = {};                        // as shown in tables and plots
  std::vector<config::Override> overrides = {};  // changes to the study's settings
  int every_nth_photo = 1;                       // train with every n-th training photo in name order; 1: all
  // Train only with photos whose names begin with one of these; empty: with all. Applied before every_nth_photo. Held-out photos always stay.
  std::vector<std::string> photo_prefixes = {};
  // Train only with photos that look straight down to within this angle. Applied before every_nth_photo; held-out photos always stay.
  double max_tilt_deg = 180.0;
  SurveyEdit edit = SurveyEdit::kNone;  // made to the survey first

  bool AllPhotos() const { return every_nth_photo == 1 && photo_prefixes.empty() && max_tilt_deg >= 180.0 && edit == SurveyEdit::kNone; }
};

struct VariantField {
  std::string name;  // "context" or a block's
  int64_t parameters = 0, samples = 0;
  int64_t scene_parameters = 0;  // stored in the scene
  int log2_table_size = 0;       // 0: the context
  int64_t steps = 0, rays = 0;   // rays: 0 in results of older programs
  double seconds = 0.0;
  double psnr_db = std::numeric_limits<double>::quiet_NaN();  // held-out; NaN for the context
  // Of the training: how often it was taken back after a fall, how far its PSNR fell from its best so far, and how far below its best it ended.
  int falls = 0;
  double worst_fall_db = std::numeric_limits<double>::quiet_NaN(), end_below_best_db = std::numeric_limits<double>::quiet_NaN();
  bool shows_context = false;  // the scene shows the context in its place
};

// Scores and costs of one variant. NaN: not measured.
struct VariantResult {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  std::string name, label;
  std::string failure;            // empty when it has results
  double psnr_db = kNone;         // over its own covered pixels
  double psnr_common_db = kNone;  // over those that all variants cover that it is compared with (common_pixels.h); never in its saved result
  double ssim = kNone, flip = kNone, lpips = kNone, psnr_full_db = kNone, ssim_full = kNone, coverage = kNone, seam_gap_db = kNone;
  double depth_rmse_m = kNone, depth_median_abs_m = kNone, floater_opacity = kNone;  // simulated surveys
  double kept_median_gsd = kNone, kept_nmad_gsd = kNone;  // against sparse points kept from training, evaluate::photos::KeptPointErrors
  double train_seconds = kNone, samples_per_second = kNone, samples = kNone, peak_rss_bytes = kNone;
  std::vector<std::pair<double, double>> floater_profile;  // simulated surveys: (metres in front of the true surface, opacity up to there)
  double parameters = kNone;                               // trained, of all fields
  double scene_parameters = kNone, scene_bytes = kNone, evaluate_seconds = kNone;
  int blocks = 0, training_photos = 0;
  std::string layout;                                            // of the blocks, rows x columns: "3x3"
  std::vector<VariantField> fields;                              // context first
  std::vector<std::pair<double, double>> curve;                  // (training seconds of all fields together, mean PSNR of their batches)
  std::string photo, render, error;                              // image files of one held-out photo, relative to FOLDER; may be empty
  std::string report;                                            // its report, relative to FOLDER
  std::vector<ScaleScore> scales;                                // when the study measures them
  std::string scale_pictures;                                    // folder of their pictures, relative to FOLDER; may be empty
  std::vector<LightScore> lights;                                // when the study measures them
  std::string light_pictures;                                    // folder of their pictures, relative to FOLDER; may be empty
  std::vector<evaluate::metrics::ClassScore> classes;            // simulated surveys with true classes
  double flat_roof_rms_m = kNone, flat_roof_nmad_m = kNone;      // the same; evaluate::photos::FlatRoofScore
  std::string views;                                             // folder of the pictures that WriteViews makes, relative to FOLDER; may be empty
  std::optional<evaluate::buildings::BuildingScores> buildings;  // when the study measures them
  // Of runs within a total time, from photos to report: what it took, each stage of it, what was given up, and scores of the products.
  double wall_seconds = kNone, ortho_psnr_db = kNone, ortho_ssim = kNone, f_score = kNone;
  std::vector<std::pair<std::string, double>> stage_seconds;
  std::vector<std::string> given_up;
  // The trainings of which the single numbers are medians; all else is of the first that succeeded. Empty: this is one training.
  std::vector<VariantResult> seeds;
};

class Study {
 public:
  struct Options {
    std::filesystem::path folder;
    StudySurvey survey;
    coordinator::Settings settings;  // of every variant
    bool restart = false;
    bool keep = false;  // keep checkpoints and scenes of finished variants
    bool quiet = false, verbose = false;
  };
  // Prepares the survey. Throws as the stages of coordinator/stages/pipeline.h do.
  Study(comm::Communicator& comm, Options options);

  const std::filesystem::path& folder() const { return options_.folder; }  // absolute
  const survey::Survey& survey() const { return survey_; }
  const coordinator::Settings& settings() const { return options_.settings; }
  const std::string& place() const { return options_.survey.place; }  // that is simulated; empty: none
  // Every variant that is run from now on is also scored at several scales.
  void MeasureScales(ScaleOptions options) { scales_ = std::move(options); }
  // Every variant that is run from now on is also scored under each of several lights; its photo_prefixes say which of them it is trained with.
  void MeasureLights(LightOptions options) { lights_ = std::move(options); }
  // Every variant that is run from now on leaves pictures of so many held-out photos, as its scene may be removed (scene_views.h).
  void KeepViews(int photos) { views_ = photos; }
  // Every variant that is trained from now on also gets surface and buildings.
  void MeasureBuildings() { buildings_ = true; }
  // Every variant that is run from now on is trained once with each seed of run.seed; its result has the medians.
  void UseSeeds(std::vector<int> seeds) { seeds_ = std::move(seeds); }
  // The variant with another seed, and with name and label that say so, unless it is the seed of the settings.
  Variant WithSeed(Variant variant, int seed) const;
  // A study of another survey with the same settings and `overrides`, in FOLDER/name.
  Study Beside(const std::string& name, const StudySurvey& survey, const std::vector<config::Override>& overrides) const;
  // Trains and scores a variant, or reads its saved results. When it cannot be trained, `failure` of the result has the reason.
  // Throws base::Interrupted (the same call continues), base::UsageError when the saved result was made with other settings.
  VariantResult Run(const Variant& variant);
  // The same, and then merges and scores its checkpoints again with the settings of each variant in `merged`. Returns the variant's result first;
  // its failure is that of the others, too. Trains again when the checkpoints were removed before all results were saved.
  std::vector<VariantResult> RunMerged(const Variant& variant, const std::vector<Variant>& merged);
  // Makes all of the variant as `skyquilt run --within`, from the photos on, and scores it; or reads its saved result. Throws base::UsageError when
  // the survey was given as a project, which has its poses already, and what RunStages throws; then the same call goes on.
  VariantResult RunWithin(const Variant& variant, double within_s);
  // A variant that is not trained: `work` fills in its result, or a saved one is read. The project of the pipeline has survey and blocks. Throws what
  // `work` throws; then the same call does it again.
  using UntrainedWork = std::function<void(coordinator::Pipeline& pipeline, VariantResult* result)>;
  VariantResult RunUntrained(const Variant& variant, const UntrainedWork& work);

 private:
  coordinator::Settings SettingsOf(const Variant& variant) const;
  // RunMerged with the seed of the settings.
  std::vector<VariantResult> RunOnce(const Variant& variant, const std::vector<Variant>& merged);
  // merge_anew: merge and score again, because the existing scene was made with other settings.
  VariantResult Measure(const Variant& variant, const coordinator::Settings& settings, const std::string& identity, bool merge_anew,
                        scene::TrainReport* training);
  void RemoveLargeFiles(const Variant& variant) const;
  std::filesystem::path RunFolder(const Variant& variant) const { return options_.folder / "runs" / variant.name; }
  // Scores the scene of the pipeline's project as that of the variant.
  evaluate::metrics::Metrics Evaluate(const Variant& variant, coordinator::Pipeline& pipeline) const;
  std::string Identity(const Variant& variant, const coordinator::Settings& settings) const;
  // The variant's project with survey and blocks.
  coordinator::Pipeline BeginRun(const Variant& variant, const coordinator::Settings& settings, bool merge_anew) const;
  evaluate::metrics::Metrics Train(const Variant& variant, const coordinator::Settings& settings, bool merge_anew, scene::TrainReport* training);
  void LinkPixels(const std::filesystem::path& run_folder, int image_width, bool share) const;
  // Puts together the result of `scored` from the training of `trained` (the same variant or not), the metrics, and the files of both.
  VariantResult Collect(const Variant& trained, const Variant& scored, const scene::TrainReport& training,
                        const evaluate::metrics::Metrics& metrics) const;
  // What is asked for beside the report: scores at several scales, pictures.
  void AddFromScene(const Variant& variant, const coordinator::Settings& settings, VariantResult* result) const;
  // Merges once for every look that stands for a light.
  void AddLights(const Variant& variant, const coordinator::Settings& settings, VariantResult* result) const;
  std::optional<VariantResult> Load(const Variant& variant, const std::string& identity) const;

  comm::Communicator& comm_;
  Options options_;
  std::filesystem::path source_;  // project that holds the survey
  survey::Survey survey_;
  std::optional<ScaleOptions> scales_;
  std::optional<LightOptions> lights_;
  int views_ = 0;
  bool buildings_ = false;
  std::vector<int> seeds_;  // empty: that of the settings
};

// Writes and reads the text of FOLDER/runs/<variant>.json. identity: of settings and survey. ParseResult throws nlohmann::json::exception.
std::string ResultJson(const VariantResult& result, const std::string& identity);
VariantResult ParseResult(const std::string& text, std::string* identity);

// The result of a variant from one training or more, as VariantResult::seeds says; of a single one that one. Its label tells how many failed.
VariantResult MedianResult(const std::string& name, const std::string& label, std::vector<VariantResult> trainings);

}  // namespace skyquilt::bench
