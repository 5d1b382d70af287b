// `bench seeding`: time, memory and errors of the poses by tags and matches (prepare/poses/seed/) for growing numbers of photos and for several
// numbers of threads. Flights of the simulator give cameras, tags and points; no picture is rendered and no feature is sought (seeding_tracks.h).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/bench_page.h"
#include "bench/poses/judge_poses.h"
#include "bench/study/seeding_tracks.h"
#include "simulate/simulate_options.h"

namespace skyquilt::bench {

struct SeedingRow {
  int photos = 0, threads = 0;
  size_t pairs = 0, matches = 0, wrong = 0;
  double features_per_photo = 0.0;
  size_t points = 0;  // of the model
  double seconds = 0.0;
  double input_bytes = 0.0;   // resident memory before: the input, and what the simulator has left
  double peak_bytes = 0.0;    // of the process meanwhile
  double median_error = 0.0;  // reprojection, pixels of a photo of 1600 pixels width
  PoseScore score;
  std::string failure;  // why there is no model
};

struct SeedingResult {
  std::string place;
  TrackErrors errors;
  std::vector<SeedingRow> rows;  // by number of photos, then of threads, ascending
};

struct SeedingOptions {
  std::vector<int> photos = {500, 1000, 2000, 5000};  // those around the middle of the flight
  std::vector<int> threads = {1, 2};
  simulate::SimulateOptions simulate;  // image_width: of the cameras
  double features_per_photo = 1000.0;  // about
  TrackErrors errors;
  // Called after every row with the rows so far.
  std::function<void(const SeedingResult&)> on_row = [](const SeedingResult&) {};
};

// Throws base::UsageError for repeated numbers and when the flight has too few photos, base::Interrupted.
SeedingResult RunSeedingBench(const SeedingOptions& options);

BenchPage SeedingPage(const SeedingResult& result, const std::string& command);
std::string SeedingJson(const SeedingResult& result, const std::string& command);

}  // namespace skyquilt::bench
