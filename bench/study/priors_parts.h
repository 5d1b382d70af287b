// The parts of the bench about priors, and what they share: variants, their figures as medians over seeds, and their change against no priors.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "bench/bench_page.h"
#include "bench/study/compare.h"
#include "bench/study/picture_sheet.h"
#include "bench/study/study.h"
#include "bench/study/study_benches.h"

namespace skyquilt::bench {

struct PriorVariant {
  std::string name;                         // none, one of StudiedPriors(), all, default
  std::string label;                        // "planar 0.03"
  std::vector<config::Override> overrides;  // of section [priors]; nothing for default
};
// The variants of these names in the order of PriorVariantNames(); "none" is always the first. Throws base::UsageError for other names.
std::vector<PriorVariant> PriorVariants(const std::vector<std::string>& names);

// All trainings of one variant, one per seed; the same seeds in the same order for all variants.
struct PriorResults {
  std::string name, label;
  std::vector<VariantResult> seeds;
};

// How the change of a figure against no priors is told.
enum class ChangeKind {
  kNone,        // not at all
  kPercent,     // of the figure without priors
  kDifference,  // in its unit
};
struct PriorFigure {
  std::string title, unit;
  int decimals = 0;
  ChangeKind change = ChangeKind::kNone;
  std::function<double(const VariantResult&)> value;  // NaN: not measured
};
// Cost, images, depth and normals by class of surface, flat roofs, kept sparse points.
const std::vector<PriorFigure>& PriorFigures();
// The title of the figure by which variants are compared: PSNR over common pixels where it was measured.
std::string ComparedPsnr(const std::vector<PriorResults>& results);
// Median over the seeds that have the figure; NaN when none has.
double MedianOverSeeds(const PriorResults& results, const PriorFigure& figure);

// Change of a figure from `before` to `after`, which have the same seeds. Only seeds that have the figure in both count.
struct PriorChange {
  // Over the changes of each seed. Percent of 0 do not count. Of single trainings only the noise of PSNR is known.
  Difference difference;
  double lowest = VariantResult::kNone, highest = VariantResult::kNone;
};
PriorChange ChangeOf(const PriorResults& before, const PriorResults& after, const PriorFigure& figure);

// One row per variant: medians over seeds. Columns without any number are left out, as in the other tables.
BenchTable PriorTable(const std::vector<PriorResults>& results, const std::string& name);
// Change against the first, with the range over seeds when there are several.
BenchTable PriorChangeTable(const std::vector<PriorResults>& results, const std::string& name);
// One row per training.
BenchTable PriorTrainingTable(const std::vector<PriorResults>& results, const std::string& name);
// NMAD of depth in percent of the first's: one chart per class of surface and one of kept points, as far as measured.
std::vector<std::string> PriorCharts(const std::vector<PriorResults>& results);
// One sentence per variant with its changes against the first, and what the seeds do not tell.
std::vector<std::string> PriorVerdicts(const std::vector<PriorResults>& results);

// Crops that show one kind of surface: the photo and what variants show there; below the true normals (the photo where they are unknown) and those
// of the variants.
struct PriorCrops {
  std::string id, title;  // "roofs", "Roofs"
  std::vector<CaptionedImage> colors, normals;
};
// From the pictures of the first seed (scene_views.h) of no priors, default and all; without these of the variants that there are. Simulated places:
// one entry for each of roofs, walls and trees that the photos show, chosen by the true classes; others: the middle of up to three photos. Nothing
// when pictures are gone. folder: of the study.
std::vector<PriorCrops> CropsOfPriors(const std::vector<PriorResults>& results, const std::filesystem::path& folder);
// Writes folder/priors.png and the crops into folder/priors_images. Nothing without crops. Throws base::InputError.
std::vector<BenchSection> WritePriorPictures(const std::vector<PriorCrops>& crops, const std::filesystem::path& folder);

}  // namespace skyquilt::bench
