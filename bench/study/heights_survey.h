// A simulated survey of one place from several heights, to compare what photos of each height teach and how scenes look from each. Brightness is the
// same in all photos, tags are exact and nothing moves, so that height is the only difference. Laid out as by `skyquilt simulate`, and besides:
//   images/h060_IMG_0001.jpg ...   the prefix is the height above take-off in metres
//   holdout.txt                    names of the held-out photos, for prepare.holdout = list:FILE; all of them have a true depth image
//   heights.json                   the plan, the names of each height and a hash of everything that the survey depends on
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "simulate/simulate_options.h"

namespace skyquilt::bench {

// Heights are whole metres above take-off, 1 to 999, each of them once.
struct HeightsPlan {
  std::vector<int> flights_m = {60, 120};  // whole flights: photos to train with
  std::vector<int> views_m = {30, 240};    // a few held-out photos each, which look straight down
  int views = 10;                          // photos per height of views_m, at least 1
  int test_every = 8;                      // of each whole flight, every n-th photo is held out, from the first; at least 2
};

// Simulates the survey into `folder` and returns the absolute path of holdout.txt. A complete survey of the same options and plan is kept, an
// incomplete or another one is replaced.
//
// Whole flights have the same number of photos, above the same points: those of the place's own flight (of options.altitudes, if given), so that
// only their overlap grows with their height. Where one would pass closer than 8 m to a building, the others lose photos as well. Held-out views are
// spread over the area so that they see as little as possible beyond it; no sparse points are sought in them, so that the survey's area does not
// depend on them.
//
// Not used from `options`: gps_noise_m, exposure_drift_stops, exposure_jumps_stops, exposure_error_stops, color_drift_stops, moving_cars, single_line
// and test_every. Throws base::UsageError for an impossible plan, and as simulate::Simulate does.
std::filesystem::path SimulateHeights(const simulate::SimulateOptions& options, const HeightsPlan& plan, const std::filesystem::path& folder,
                                      base::ThreadPool& threads);

// "h060_"
std::string HeightPrefix(int height_m);
// 60 for "h060_IMG_0001.jpg"; -1 for a name without such a prefix.
int HeightOfPhoto(const std::string& name);

// As many names as the largest height has, an equal share of each height and evenly spread over it; with two equally large heights half of each.
// `training`: names of training photos in any order. In name order.
std::vector<std::string> HalfOfEach(std::vector<std::string> training);

}  // namespace skyquilt::bench
