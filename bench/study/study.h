// One survey trained in several ways, side by side: each variant is a project of its own, from blocks to report, in one folder. What a variant
// scored is kept beside it, so that a bench that was interrupted goes on with the next one, and its large files are removed then.
//   FOLDER/source/              the survey that all share (unless it is given as a project)
//   FOLDER/runs/<variant>/      project: blocks.geojson, train.json, report/ and the rest
//   FOLDER/runs/<variant>.json  result
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/project/settings.h"
#include "core/comm/communicator.h"
#include "core/scene/train_report.h"
#include "core/survey/survey.h"
#include "evaluate/metrics.h"

namespace skyquilt::bench {

// Where the photos come from: exactly one of the first two.
struct StudySurvey {
  std::filesystem::path folder;  // photos, a simulated survey, or a project that was prepared
  std::string place;             // to be simulated
  std::filesystem::path model;   // COLMAP model of the photos; may be empty
};

struct Variant {
  std::string name;                         // of its folder: lower-case letters, digits, '-' and '_'
  std::string label;                        // for people
  std::vector<config::Override> overrides;  // on top of the study's settings
  int keep_every = 1;                       // of the training photos in name order, 1: all
};

struct VariantField {
  std::string name;  // "context" or a block's
  int64_t parameters = 0, samples = 0;
  int64_t scene_parameters = 0;  // those that the scene keeps
  int log2_table_size = 0;       // 0: the context
  double seconds = 0.0;
  double psnr_db = std::numeric_limits<double>::quiet_NaN();  // held-out; NaN for the context
};

// NaN: not measured.
struct VariantResult {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  std::string name, label;
  std::string failure;  // empty when it has results
  double psnr_db = kNone, ssim = kNone, lpips = kNone, psnr_full_db = kNone, coverage = kNone, seam_gap_db = kNone;
  double depth_rmse_m = kNone, depth_median_abs_m = kNone, floater_opacity = kNone;  // simulated surveys
  double train_seconds = kNone, samples_per_second = kNone, samples = kNone, peak_rss_bytes = kNone;
  std::vector<std::pair<double, double>> floater_profile;  // simulated surveys: (metres in front of the true surface, opacity until there)
  double parameters = kNone;                               // trained, of all fields
  double scene_parameters = kNone, scene_bytes = kNone, evaluate_seconds = kNone;
  int blocks = 0, training_photos = 0;
  std::string layout;                            // of the blocks, as "3x3": rows x columns
  std::vector<VariantField> fields;              // context first
  std::vector<std::pair<double, double>> curve;  // training seconds of all fields together against PSNR of their batches
  std::string photo, render, error;              // pictures of one held-out photo, relative to FOLDER; may be empty
  std::string report;                            // its report, relative to FOLDER
};

class Study {
 public:
  struct Options {
    std::filesystem::path folder;
    StudySurvey survey;
    coordinator::Settings settings;  // of every variant
    bool restart = false;
    bool keep = false;  // checkpoints and scenes of finished variants
    bool quiet = false, verbose = false;
  };
  // Prepares the survey. Throws as the stages of coordinator/stages/pipeline.h do.
  Study(comm::Communicator& comm, Options options);

  const survey::Survey& survey() const { return survey_; }
  const coordinator::Settings& settings() const { return options_.settings; }
  // Trains and scores, unless that was done before. A variant that cannot be trained has its reason in `failure`.
  // Throws base::Interrupted (the same call continues), base::UsageError when the result that is there came from other settings.
  VariantResult Run(const Variant& variant);
  // The same, and then what its training gives when only merging and scoring are done in other ways: the variant's result first. Retrains when
  // the training's files were removed before all of them were scored.
  std::vector<VariantResult> RunMerged(const Variant& variant, const std::vector<Variant>& merged);

 private:
  coordinator::Settings SettingsOf(const Variant& variant) const;
  // merge_anew: what is merged and scored already came from other settings.
  VariantResult Measure(const Variant& variant, const coordinator::Settings& settings, const std::string& identity, bool merge_anew,
                        scene::TrainReport* training);
  void RemoveLargeFiles(const Variant& variant) const;
  std::filesystem::path RunFolder(const Variant& variant) const { return options_.folder / "runs" / variant.name; }
  std::string Identity(const Variant& variant, coordinator::Settings settings) const;
  evaluate::Metrics Train(const Variant& variant, const coordinator::Settings& settings, bool merge_anew, scene::TrainReport* training);
  void LinkPixels(const std::filesystem::path& run_folder, int image_width, bool share) const;
  // From what the training of one variant and the scoring of another (or the same) found, and from their files' sizes and pictures.
  VariantResult Collect(const Variant& trained, const Variant& scored, const scene::TrainReport& training, const evaluate::Metrics& metrics) const;
  std::optional<VariantResult> Load(const Variant& variant, const std::string& identity) const;

  comm::Communicator& comm_;
  Options options_;
  std::filesystem::path source_;  // project that holds the survey
  survey::Survey survey_;
};

// The text of FOLDER/runs/<variant>.json, and back. Throws nlohmann::json::exception for another text.
std::string ResultJson(const VariantResult& result, const std::string& identity);
VariantResult ParseResult(const std::string& text, std::string* identity);

}  // namespace skyquilt::bench
