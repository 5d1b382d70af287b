#include "bench/study/common_pixels.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "core/image/image.h"
#include "core/metrics/psnr.h"
#include "evaluate/photos/scored_pixels.h"

namespace skyquilt::bench {
namespace {

struct Training {
  VariantResult* result;
  std::filesystem::path covered;  // folder
};

// Photos by their paths in the folder, with sizes. Empty without a folder.
std::set<std::string> PhotosIn(const std::filesystem::path& folder, std::string* key) {
  std::set<std::string> photos;
  if (!std::filesystem::is_directory(folder)) return photos;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.path().extension() == ".png") photos.insert(entry.path().lexically_relative(folder).generic_string());
  }
  for (const std::string& photo : photos) {
    int width = 0, height = 0;
    image::ReadImageSize(folder / photo, &width, &height);
    *key += fmt::format("{} {} {}\n", photo, width, height);
  }
  return photos;
}

// Adds the squared errors of one photo over the pixels that all score.
std::vector<metrics::SquaredError> CommonErrors(const std::vector<image::Image8>& pictures) {
  std::array<double, 256> squared_error{};
  for (size_t value = 1; value < squared_error.size(); ++value) squared_error[value] = evaluate::photos::SquaredErrorOf(static_cast<uint8_t>(value));
  std::vector<metrics::SquaredError> errors(pictures.size());
  for (size_t i = 0; i < pictures.front().data.size(); ++i) {
    if (std::any_of(pictures.begin(), pictures.end(), [i](const image::Image8& picture) { return picture.data[i] == 0; })) continue;
    for (size_t k = 0; k < pictures.size(); ++k) errors[k] += {squared_error[pictures[k].data[i]], 1};
  }
  return errors;
}

void ScoreGroup(const std::set<std::string>& photos, const std::vector<Training>& group) {
  std::vector<std::vector<double>> psnr_db(group.size());
  for (const std::string& photo : photos) {
    std::vector<image::Image8> pictures;
    pictures.reserve(group.size());
    for (const Training& training : group) pictures.push_back(image::LoadLabels(training.covered / photo));
    const std::vector<metrics::SquaredError> errors = CommonErrors(pictures);
    for (size_t k = 0; k < group.size(); ++k) psnr_db[k].push_back(metrics::PsnrOf(errors[k]));
  }
  for (size_t k = 0; k < group.size(); ++k) {
    const double mean_db = evaluate::MeanOfMeasured(psnr_db[k]);
    if (std::isfinite(mean_db)) group[k].result->psnr_common_db = mean_db;
  }
}

}  // namespace

void ScoreCommonPixels(const std::filesystem::path& folder, const std::vector<VariantResult*>& results) {
  struct Group {
    std::set<std::string> photos;
    std::vector<Training> trainings;
  };
  std::map<std::string, Group> groups;
  const auto add = [&](VariantResult& result) {
    result.psnr_common_db = VariantResult::kNone;
    if (!result.failure.empty()) return;
    const std::filesystem::path covered = folder / "runs" / result.name / "covered";
    std::string key;
    std::set<std::string> photos = PhotosIn(covered, &key);
    if (photos.empty()) return;
    Group& group = groups[key];
    group.photos = std::move(photos);
    group.trainings.push_back({&result, covered});
  };
  for (VariantResult* result : results) {
    if (result->seeds.empty()) add(*result);
    for (VariantResult& seed : result->seeds) add(seed);
  }
  for (const auto& [key, group] : groups) {
    if (group.trainings.size() > 1) ScoreGroup(group.photos, group.trainings);
  }
  for (VariantResult* result : results) {
    if (result->seeds.empty()) continue;
    std::vector<double> psnr_db;
    for (const VariantResult& seed : result->seeds) psnr_db.push_back(seed.psnr_common_db);
    result->psnr_common_db = evaluate::MedianOfMeasured(std::move(psnr_db));
  }
}

}  // namespace skyquilt::bench
