// Tables, charts and pictures that all studies share.
#pragma once

#include <string>
#include <vector>

#include "bench/bench_page.h"
#include "bench/study/study.h"

namespace skyquilt::bench {

// One row per variant: quality, time, memory, size. Columns that no variant has a number for (depth without truth, LPIPS) are left out.
BenchTable QualityTable(const std::vector<VariantResult>& results, const std::string& name = "");
// Held-out PSNR per block, one row per block, one column per variant that has it.
BenchTable BlockTable(const std::vector<VariantResult>& results, const std::string& name);
// PSNR of the training batches over training time.
std::string TrainingChart(const std::vector<VariantResult>& results);
// One held-out photo and what every variant makes of it.
BenchSection PictureSection(const std::vector<VariantResult>& results);

// A number as part of a variant's name, which names files: "0.5" becomes "0_5".
std::string NumberInName(double number);

// "+1.20", "-0.35", and "0.00" for what rounds to nothing.
std::string Signed(double number, int decimals);

// What every field but the context had to itself: "2 to 31 s and 5 to 87 M samples"; "nothing" without blocks.
std::string OfItsOwn(const VariantResult& result);

// The part of a bench's JSON that all studies share: bench, results, machine, date, command, and `settings`.
std::string StudyJson(const BenchPage& page, const std::vector<VariantResult>& results, const std::string& settings_toml);

}  // namespace skyquilt::bench
