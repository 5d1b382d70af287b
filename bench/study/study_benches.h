// The benches that train whole surveys. Each one runs a list of variants of one survey and makes a page with tables, plots and conclusions.
#pragma once

#include <string>
#include <vector>

#include "bench/bench_page.h"
#include "bench/study/study.h"

namespace skyquilt::bench {

struct StudyBench {
  BenchPage page;
  std::vector<VariantResult> results;
};

struct SingleVsMultiOptions {
  std::string blocks = "3x3";  // of the variants with several blocks
  double budget_s = 300.0;     // training time of every variant, context included
};
// Compares one model of the whole area with one model per block, at equal time and at equal parameters. Also compares blocks with and without the
// context, and block boxes as high as their content with boxes that all have the height of the survey.
// Source of the question: MatrixCity (Li et al. 2023), supplement, table 2.
StudyBench SingleVsMulti(Study& study, const SingleVsMultiOptions& options);

struct BlocksBenchOptions {
  std::vector<std::string> blocks = {"1x1", "2x2", "2x4", "4x4"};  // rows x columns
  std::vector<int> log2_table_sizes = {15, 17, 19};
  double budget_s = 180.0;
  int steps = 0;  // of all fields of a variant together, context included, in place of budget_s; 0: by time
};
// Compares numbers of blocks and table sizes. Source: MatrixCity, supplement, table 3.
StudyBench BlocksBench(Study& study, const BlocksBenchOptions& options);

struct CapacityOptions {
  std::string blocks;                                      // empty: as partition chooses
  std::vector<int> log2_table_sizes = {17, 18};            // the same for all blocks
  std::vector<double> voxels_per_entry = {1.0, 2.0, 8.0};  // of partition
  double budget_s = 300.0;
};
// Compares table sizes chosen from each block's ground sampling distance and surface with one size for all blocks, with more and fewer surface
// voxels per entry, and with smaller blocks. Reports quality, and how many entries the scene leaves out.
StudyBench CapacityBench(Study& study, const CapacityOptions& options);

struct EncodingsOptions {
  double budget_s = 180.0;
  int frequency_hidden = 128;  // networks of the encoding without tables
  int frequency_layers = 6;
  double frequency_learning_rate = 2e-3;
};
// Compares encodings of the same field: hash grid, dense voxels, planes and lines, sines and cosines.
StudyBench EncodingsBench(Study& study, const EncodingsOptions& options);

struct StudiedPreset {
  std::string name;
  std::vector<config::Override> overrides;  // options that differ from the defaults
  std::vector<double> budgets;              // training times to try, as multiples of middle_budget_s
};

struct TradeoffOptions {
  double middle_budget_s = 60.0;       // training time of the variants that change one setting
  std::vector<StudiedPreset> presets;  // from the fastest to the best
  std::vector<int> log2_table_sizes = {14, 15, 16, 17, 18, 19};
  std::vector<double> step_voxels = {1.0, 2.0, 4.0};  // step along the ray in finest voxels: decides the number of samples
  std::vector<int> every_nth_photo = {1, 2, 4};       // train with every n-th training photo
};
// Measures presets at several time budgets. Then changes one setting at a time: storage precision, table size, samples per ray, their placement,
// number of photos.
StudyBench Tradeoff(Study& study, const TradeoffOptions& options);

// Presets train on photos of different widths, and small images score higher. So all are scored at the width of the settings.
config::Override ScoringWidth(const Study& study);

struct WithinOptions {
  std::vector<double> totals_s;        // of the whole run, each
  std::vector<StudiedPreset> presets;  // without their budgets
};
// Measures quality against the time on the clock, from photos to report: every preset within every total, stage by stage.
StudyBench TradeoffWithin(Study& study, const WithinOptions& options);

struct ScalesOptions {
  std::vector<int> positions = {0, 1, 4, 6};  // per sample, as train.multisample: 0 are points, the others cones
  double budget_s = 60.0;                     // training time of every variant of equal time
  std::vector<int> seeds;                     // of training, each once; empty: that of the settings
  bool equal_time = true, equal_steps = true;
  bool heights = false;        // train with photos from several heights; the photos are simulated
  std::string place = "town";  // simulated for `heights`
  int height_views = 10;       // held-out photos of each height without training photos
};
// Compares samples that are points with samples that are cones, taught from photos or from a pyramid of photos, rendered at several widths with one
// ray per pixel: at equal time, at equal steps, and trained and rendered from several heights. Writes scales.png into the study's folder.
StudyBench ScalesBench(Study& study, const ScalesOptions& options);

struct MethodsOptions {
  std::vector<StudiedPreset> methods;  // without their budgets, at least one
  std::string blocks = "1x5";          // of the variants with several blocks
  double budget_s = 300.0;             // training time of every variant, context included
  std::vector<int> seeds;              // of training, each once; empty: that of the settings
  // Simulated places: share of a photo that the next one sees too, along and across the lines, and flying heights, each with each. The study has the
  // first of both already, every other pair a survey of its own in FOLDER/o60_a120. Empty: the settings' own.
  std::vector<double> overlaps, altitudes_m;
};
// The changes to the settings for the first overlap and altitude.
std::vector<config::Override> FirstSurvey(const std::vector<double>& overlaps, const std::vector<double>& altitudes_m);
// Compares published methods, each as one field of the whole area and as blocks, at equal time and, where they have tables, at equal parameters; and
// its orders with those of MatrixCity (Li et al. 2023), supplement, table 2. Writes methods.png into the study's folder.
StudyBench MethodsBench(Study& study, const MethodsOptions& options);

struct DataSetOptions {
  std::vector<StudiedPreset> methods;  // without their budgets, at least one
  std::string data_set;                // its name, for the page
  double budget_s = 300.0;             // training time of every method, context included; 0: the settings' steps
  std::vector<int> seeds;              // of training, each once; empty: that of the settings
};
// Methods, each as one field, on a data set with a split of its own, scored over whole frames as published figures are.
StudyBench DataSetBench(Study& study, const DataSetOptions& options);

struct LightBenchOptions {
  double budget_s = 60.0;  // training time of every variant; 0: the settings' steps
};
// The changes to the settings for photos of one place under lights of several elevations.
std::vector<config::Override> SunLights();
// Photos of one simulated place under several elevations of the sun, and under several intensities: trains codes of every second light, mixes those
// of neighbours for the light between, and compares with photos of that light and with trainings of all lights; intensities also with what the
// brightness correction finds without codes. The second set is in FOLDER/intensity. Writes light.png into the study's folder. Source of the question:
// MatrixCity (Li et al. 2023), supplement, section 4.1.
StudyBench LightBench(Study& study, const LightBenchOptions& options);

struct StudiedPrior {
  std::string name;     // of its weight in section [priors]
  double weight = 0.0;  // with which it is studied
  std::string what;     // it makes true
};
const std::vector<StudiedPrior>& StudiedPriors();
// none, the priors one by one, all, default.
std::vector<std::string> PriorVariantNames();

struct PriorsOptions {
  std::vector<std::string> variants;  // among PriorVariantNames(); "none" is always trained; empty: all of them
  double budget_s = 90.0;             // training time of every variant
  std::vector<int> seeds;             // of training, each once; empty: that of the settings
};
// Compares training without priors, with each of them alone, with all at their studied weights and with the program's defaults: time, images, depth
// and normals by class of surface, depth at sparse points. When the study simulates its place, it is that of the first seed, and every other seed has
// a place of its own, simulated into FOLDER/seed_N. Writes priors.png into the study's folder.
StudyBench PriorsBench(Study& study, const PriorsOptions& options);

// truth, points, field, no_priors, priors, nadir.
std::vector<std::string> BuildingsVariantNames();

struct BuildingsBenchOptions {
  std::vector<std::string> variants;  // among BuildingsVariantNames(); empty: all of them
  double budget_s = 90.0;             // training time of every variant that is trained
  std::vector<int> seeds;             // of training, each once; empty: that of the settings
};
// Compares how well buildings are found and measured in surfaces from true depth, from sparse points alone, and from fields: trained by default,
// without priors, with all, without oblique photos. Seeds and simulated places as in PriorsBench. Throws base::UsageError for surveys without truth.
StudyBench BuildingsBench(Study& study, const BuildingsBenchOptions& options);

}  // namespace skyquilt::bench
