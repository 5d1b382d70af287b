#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "bench/study/compare.h"
#include "bench/study/methods_parts.h"
#include "bench/study/study_tables.h"
#include "core/base/text.h"

namespace skyquilt::bench {
namespace {

const PublishedMethod* Published(const std::string& name) {
  const auto& scores = MatrixCityScores();
  const auto at = std::find_if(scores.begin(), scores.end(), [&name](const PublishedMethod& method) { return method.name == name; });
  return at == scores.end() ? nullptr : &*at;
}

// published_db: of the first over the second.
void Add(const Difference& here, double published_db, const std::string& entry, OrderCheck* check) {
  if (here.pairs == 0) return;
  if (!here.seen) {
    check->unseen.push_back(entry);
  } else {
    ((here.median > 0.0) == (published_db > 0.0) ? check->same : check->other).push_back(entry);
  }
}

// "as published for a, b; the other way for c; no difference seen for d"; empty when nothing was compared.
std::string Told(const OrderCheck& check) {
  std::vector<std::string> parts;
  if (!check.same.empty()) parts.push_back("as published for " + base::Join(check.same));
  if (!check.other.empty()) parts.push_back("the other way for " + base::Join(check.other));
  if (!check.unseen.empty()) parts.push_back("no difference seen for " + base::Join(check.unseen));
  return base::Join(parts, "; ");
}

// "nerf: blocks against one field +0.50 dB, 22.50 against 22.00 dB, SSIM +0.010; published +1.28 dB, SSIM +0.079."
std::string BlocksVerdict(const MethodPair& pair) {
  const std::vector<double> psnr_db = ComparablePsnr({&pair.blocks, &pair.one});
  std::string text = fmt::format("{}: blocks against one field {}, {:.2f} against {:.2f} dB, SSIM {}", pair.name,
                                 Shown(PsnrDifference(pair.blocks, pair.one)), psnr_db[0], psnr_db[1], Signed(pair.blocks.ssim - pair.one.ssim, 3));
  if (const PublishedMethod* published = Published(pair.name)) {
    text += fmt::format("; published {} dB, SSIM {}", Signed(published->several.psnr_db - published->one.psnr_db, 2),
                        Signed(published->several.ssim - published->one.ssim, 3));
  }
  return text + ".";
}

// How far a network came on the way that its paper goes; empty for others.
std::string StepsVerdict(const MethodPair& pair) {
  const auto& trainings = PublishedTrainings();
  const auto at = std::find_if(trainings.begin(), trainings.end(), [&pair](const PublishedTraining& t) { return t.name == pair.name; });
  const double steps = MeanSteps(pair.one);
  if (at == trainings.end() || !std::isfinite(steps)) return "";
  return fmt::format(
      "{}: one field made {:.0f} steps, {:.2g} % of the {} of its paper, so this is what it reaches in the time, not what it can reach.", pair.name,
      steps, 100.0 * steps / at->fewest_steps, BenchCell::Count(at->fewest_steps).shown);
}

}  // namespace

const std::vector<PublishedMethod>& MatrixCityScores() {
  static const std::vector<PublishedMethod> kScores = {
      {"nerf", {21.69, 0.510, 0.638}, {22.97, 0.589, 0.548}},
      {"mip-nerf-360", {24.41, 0.689, 0.469}, {25.73, 0.779, 0.360}},
      {"tensorf", {25.09, 0.752, 0.370}, {25.13, 0.762, 0.396}},
      {"instant-ngp", {25.46, 0.751, 0.402}, {25.69, 0.800, 0.326}},
  };
  return kScores;
}

const std::vector<PublishedTraining>& PublishedTrainings() {
  static const std::vector<PublishedTraining> kTrainings = {
      {"nerf", 200'000, 300'000, 4096, "Mildenhall et al. 2020"},
      {"mip-nerf", 1'000'000, 1'000'000, 4096, "Barron et al. 2021"},
      {"mip-nerf-360", 250'000, 250'000, 16'384, "Barron et al. 2022"},
  };
  return kTrainings;
}

OrderCheck CheckBlocksOrder(const std::vector<MethodPair>& pairs) {
  OrderCheck check;
  for (const MethodPair& pair : pairs) {
    const PublishedMethod* published = Published(pair.name);
    if (published != nullptr) Add(PsnrDifference(pair.blocks, pair.one), published->several.psnr_db - published->one.psnr_db, pair.name, &check);
  }
  return check;
}

OrderCheck CheckGridsOrder(const std::vector<MethodPair>& pairs, bool as_blocks) {
  OrderCheck check;
  for (const MethodPair& grid : pairs) {
    const PublishedMethod* grid_there = Published(grid.name);
    if (grid.network || grid_there == nullptr) continue;
    for (const MethodPair& network : pairs) {
      const PublishedMethod* network_there = Published(network.name);
      if (!network.network || network_there == nullptr) continue;
      const double published_db =
          as_blocks ? grid_there->several.psnr_db - network_there->several.psnr_db : grid_there->one.psnr_db - network_there->one.psnr_db;
      const std::string entry = published_db > 0.0 ? grid.name + " above " + network.name : network.name + " above " + grid.name;
      Add(as_blocks ? PsnrDifference(grid.blocks, network.blocks) : PsnrDifference(grid.one, network.one), published_db, entry, &check);
    }
  }
  return check;
}

std::vector<std::string> OrderVerdicts(const std::vector<MethodPair>& pairs) {
  std::vector<std::string> verdicts;
  const auto add = [&verdicts](const std::string& what, const OrderCheck& check) {
    const std::string told = Told(check);
    if (!told.empty()) verdicts.push_back(what + ": " + told + ".");
  };
  add("Order of MatrixCity, several models above one", CheckBlocksOrder(pairs));
  add("Order of MatrixCity, grids and networks as one field", CheckGridsOrder(pairs, false));
  add("Order of MatrixCity, grids and networks as blocks", CheckGridsOrder(pairs, true));
  return verdicts;
}

std::vector<std::string> MethodVerdicts(const std::vector<MethodPair>& pairs) {
  std::vector<std::string> verdicts = OrderVerdicts(pairs);
  for (const MethodPair& pair : pairs) {
    if (std::string told = StepsVerdict(pair); !told.empty()) verdicts.push_back(std::move(told));
  }
  for (const MethodPair& pair : pairs) {
    if (pair.one.failure.empty() && pair.blocks.failure.empty()) verdicts.push_back(BlocksVerdict(pair));
  }
  return verdicts;
}

}  // namespace skyquilt::bench
