// The parts of the comparison of published methods: what one field and blocks of each reach, and whether they stand in the order of a published
// comparison.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/bench_page.h"
#include "bench/study/study.h"
#include "bench/study/study_benches.h"

namespace skyquilt::bench {

// One method, trained as one field of the whole survey and as blocks.
struct MethodPair {
  std::string name;
  bool network = false;  // of NeRF's size: it has no tables, and the scene is in its weights
  VariantResult one, blocks;
};

// MatrixCity (Li et al., ICCV 2023), supplement, table 2: Small City from the air, one model against five.
struct PublishedScore {
  double psnr_db = 0.0, ssim = 0.0, lpips = 0.0;
};
struct PublishedMethod {
  std::string name;
  PublishedScore one, several;
};
const std::vector<PublishedMethod>& MatrixCityScores();

// How long a paper trains a network for one scene. Steps are a range where the paper gives one.
struct PublishedTraining {
  std::string name;
  double fewest_steps = 0.0, most_steps = 0.0, rays_per_step = 0.0;
  std::string source;
};
const std::vector<PublishedTraining>& PublishedTrainings();

// Which comparisons turned out as MatrixCity's, which the other way, and which show no difference here.
struct OrderCheck {
  std::vector<std::string> same, other, unseen;
};
// Of every method that both have: blocks against one field. Entries are names of methods.
OrderCheck CheckBlocksOrder(const std::vector<MethodPair>& pairs);
// Of every grid with every network that both have: the two as one field, or the two as blocks. Entries read "instant-ngp above nerf", as published.
OrderCheck CheckGridsOrder(const std::vector<MethodPair>& pairs, bool as_blocks);

// Sentences: whether the orders agree, how far the networks came, and each method's blocks against its one field.
std::vector<std::string> MethodVerdicts(const std::vector<MethodPair>& pairs);
// Only whether the orders agree. Nothing for an order without published methods.
std::vector<std::string> OrderVerdicts(const std::vector<MethodPair>& pairs);

// Mean over the fields without the context; NaN without any.
double MeanSteps(const VariantResult& result);
// How often all fields together have seen the pixels of the training photos, as so many of them; NaN when unknown.
double PhotoPasses(const VariantResult& result, double training_pixels);
// Pixels of all training photos at the width of training; 0: full size.
double TrainingPixels(const survey::Survey& survey, int image_width);

// A survey with another overlap and height of flight. The first one of a bench is in its folder, others are in folders of their own.
struct SurveyCondition {
  std::string suffix;                       // of names of variants and of the folder: "o60_a120"; empty: the settings' own
  std::string label;                        // "overlap 60 %, 120 m"
  std::vector<config::Override> overrides;  // of section [simulate]
};
// Each overlap with each altitude; one empty condition without either.
std::vector<SurveyCondition> SurveyConditions(const std::vector<double>& overlaps, const std::vector<double>& altitudes_m);

// One row per method: scores as one field and as blocks. Of networks, or of all others.
BenchTable MethodTable(const std::vector<MethodPair>& pairs, bool networks, const std::string& name);
// Networks: steps and passes over the photos, here and in the papers.
BenchTable NetworkStepsTable(const std::vector<MethodPair>& pairs, double training_pixels, const std::string& name);
// The methods of MatrixCity's table, theirs and ours.
BenchTable MatrixCityTable(const std::vector<MethodPair>& pairs, const std::string& name);
// One bar per method: blocks, with a mark for one field.
std::string MethodChart(const std::vector<MethodPair>& pairs);
// PSNR on the ground of each block: one row per method and block. psnr_db: one field and blocks of each pair in turn, [result][block].
BenchTable GroundTable(const std::vector<MethodPair>& pairs, const std::vector<std::string>& blocks, const std::vector<std::vector<double>>& psnr_db,
                       const std::string& name);

// Parts of two held-out photos, and the same parts of what the pictures of every method (scene_views.h) show. In simulated places the parts have the
// most roof and the most tree; else they are the middles of two photos. Writes FOLDER/methods.png and the parts into FOLDER/methods_images. Nothing
// when pictures are gone. Throws base::InputError.
std::vector<BenchSection> WriteMethodPictures(const std::vector<MethodPair>& pairs, const std::filesystem::path& folder);

}  // namespace skyquilt::bench
