// Tables, plots and images that all study benches share.
#pragma once

#include <string>
#include <vector>

#include "bench/bench_page.h"
#include "bench/study/study.h"

namespace skyquilt::bench {

// One row per variant: quality, time, memory, size. Columns without any number (depth without ground truth, LPIPS) are left out.
BenchTable QualityTable(const std::vector<VariantResult>& results, const std::string& name = "");
// Held-out PSNR: one row per block, one column per variant with several blocks.
BenchTable BlockTable(const std::vector<VariantResult>& results, const std::string& name);
// PSNR of the training batches over training time.
std::string TrainingChart(const std::vector<VariantResult>& results);
// One held-out photo and its rendering by every variant.
BenchSection PictureSection(const std::vector<VariantResult>& results);

// A number as part of a variant's name, without characters that are awkward in file names: "0.5" becomes "0_5".
std::string NumberInName(double number);

// "+1.20", "-0.35", and "0.00" for numbers that round to zero.
std::string Signed(double number, int decimals);

// Range of training seconds and samples over the blocks: "2 to 31 s and 5 to 87 M samples"; "nothing" without blocks.
std::string OfItsOwn(const VariantResult& result);

// The JSON of a study bench: name, verdicts, results (with those of each seed, when there are several), settings, command, machine and date.
std::string StudyJson(const BenchPage& page, const std::vector<VariantResult>& results, const std::string& settings_toml);

}  // namespace skyquilt::bench
