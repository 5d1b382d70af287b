// `bench scale`: how time and memory of every stage grow with the number of photos. Surveys of the same place, height and overlap and of growing area
// are simulated with small pictures, and taken from photos to report with the simulator's poses.
//   FOLDER/scale_work/<photos>/        the survey and its project; removed when its figures are saved, unless they are kept
//   FOLDER/scale_work/<photos>.json    its figures: an interrupted bench continues with the next number
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "bench/bench_page.h"
#include "coordinator/project/settings.h"
#include "core/comm/communicator.h"

namespace skyquilt::bench {

// A stage of one survey.
struct GrowthStage {
  std::string name;
  double seconds = 0.0;
  double peak_bytes = 0.0;  // of rank 0 while it ran
};

struct GrowthRow {
  int photos = 0;
  int blocks = 0;  // without empty ones
  double area_m2 = 0.0;
  int64_t points = 0;
  std::vector<GrowthStage> stages;

  const GrowthStage* Find(const std::string& stage) const;  // null: it was not measured
  double PeakBytes() const;
};

struct GrowthResult {
  double memory_bytes = 0.0;  // limit of the run
  int ranks = 1;
  std::vector<GrowthRow> rows;  // by number of photos, ascending
};

// value = factor * photos^exponent, by least squares of logarithms over the larger half of the numbers of photos (at least two).
struct GrowthLaw {
  double factor = 0.0, exponent = 0.0;
  double At(double photos) const;
};
// Points: (photos, value), positive and finite. Throws base::UsageError for fewer than two different numbers of photos.
GrowthLaw FitGrowth(std::vector<std::pair<double, double>> points);

// The stage whose time is given and not measured.
inline constexpr const char* kBudgetedStage = "train";
// Time may grow so much from 500 to 5,000 photos: by a power of the photos of at most log10(13) = 1.11. Only of stages that take some time at all.
constexpr double kMostGrowth = 13.0, kGrowthPhotos = 10.0, kShortStage_s = 5.0;

struct GrowthOptions {
  std::filesystem::path folder;  // absolute
  std::vector<int> photos = {500, 1000, 2000, 5000};
  coordinator::Settings settings;  // simulate: of the place, flown so that it has enough photos
  bool keep = false;
  bool quiet = false, verbose = false;
  // Called after every survey with the rows so far.
  std::function<void(const GrowthResult&)> on_row = [](const GrowthResult&) {};
};

// Throws base::UsageError when the place has too few photos, and what the stages throw; base::Interrupted: the same call continues.
GrowthResult RunGrowthBench(comm::Communicator& comm, const GrowthOptions& options);

BenchPage GrowthPage(const GrowthResult& result, const std::string& command);
std::string GrowthJson(const GrowthResult& result, const std::string& command);
// Of one row, with an identity of everything that it depends on. ParseGrowthRow returns false for other text and for another identity.
std::string GrowthRowJson(const GrowthRow& row, const std::string& identity);
bool ParseGrowthRow(const std::string& text, const std::string& identity, GrowthRow* row);

}  // namespace skyquilt::bench
