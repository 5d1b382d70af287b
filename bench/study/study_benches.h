// The benches that train: every one a list of variants of one survey, and what is to be read from their results.
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
  std::string blocks = "3x3";  // of the divided variants
  double budget_s = 300.0;     // training time of every variant, context included
};
// One model of the whole area against one per block: equal time, and equal parameters. Couplings guided and independent; boxes as high as what
// stands in them against boxes that share the survey's height.
// Source of the question: MatrixCity (Li et al. 2023), supplement, table 2.
StudyBench SingleVsMulti(Study& study, const SingleVsMultiOptions& options);

struct BlocksBenchOptions {
  std::vector<int> per_side = {1, 2, 3, 4};
  std::vector<int> log2_table_sizes = {15, 17, 19};
  double budget_s = 180.0;
};
// Number of blocks against capacity of each. MatrixCity, supplement, table 3.
StudyBench BlocksBench(Study& study, const BlocksBenchOptions& options);

struct CapacityOptions {
  std::string blocks;                                      // empty: as partition chooses
  std::vector<int> log2_table_sizes = {17, 18};            // the same for all blocks
  std::vector<double> voxels_per_entry = {1.0, 2.0, 8.0};  // of partition
  double budget_s = 300.0;
};
// Tables (and blocks) sized by what each block's ground sampling distance and surface ask for, against the same size for all blocks, and against
// more and fewer surface voxels per entry and smaller blocks; what a scene leaves out of them, and what all of it costs in quality.
StudyBench CapacityBench(Study& study, const CapacityOptions& options);

struct EncodingsOptions {
  double budget_s = 180.0;
  int frequency_hidden = 128;  // networks of the encoding without tables
  int frequency_layers = 6;
  double frequency_learning_rate = 2e-3;
};
// Hash grid, dense voxels, planes and lines, sines and cosines: encodings of one and the same field.
StudyBench EncodingsBench(Study& study, const EncodingsOptions& options);

struct StudiedPreset {
  std::string name;
  std::vector<config::Override> overrides;  // what it sets differently from the defaults
  std::vector<double> budgets;              // times to train it for, as multiples of the middle budget: around what it is made for
};

struct TradeoffOptions {
  double middle_budget_s = 60.0;       // of the studies that vary one thing
  std::vector<StudiedPreset> presets;  // from the quickest to the best
  std::vector<int> log2_table_sizes = {14, 15, 16, 17, 18, 19};
  std::vector<double> steps_per_voxel = {1.0, 2.0, 4.0};  // marching step: how many samples a ray gets
  std::vector<int> keep_every = {1, 2, 4};                // of the training photos
};
// Presets against time budgets, and one thing at a time: storage precision, tables, samples per ray, their placing, photos.
StudyBench Tradeoff(Study& study, const TradeoffOptions& options);

}  // namespace skyquilt::bench
