#include "evaluate/ortho/ortho_json.h"

#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/json_text.h"
#include "evaluate/json_members.h"

namespace skyquilt::evaluate::ortho {
namespace {

constexpr std::array<std::pair<const char*, double OrthoScores::*>, 15> kOrthoNumbers = {
    {{"cell_m", &OrthoScores::cell_m},
     {"share_from_photos", &OrthoScores::share_photos},
     {"share_from_field", &OrthoScores::share_field},
     {"shift_east_m", &OrthoScores::shift_east_m},
     {"shift_north_m", &OrthoScores::shift_north_m},
     {"psnr_db", &OrthoScores::psnr_db},
     {"ssim", &OrthoScores::ssim},
     {"light_error_stops", &OrthoScores::light_error_stops},
     {"mtf50_cycles_per_cell", &OrthoScores::mtf50_per_cell},
     {"mtf50_cycles_per_metre", &OrthoScores::mtf50_per_m},
     {"photo_mtf50_cycles_per_pixel", &OrthoScores::photo_mtf50_per_px},
     {"photo_mtf50_cycles_per_metre", &OrthoScores::photo_mtf50_per_m},
     {"seam_levels", &OrthoScores::seam_levels},
     {"seam_levels_worst", &OrthoScores::seam_levels_worst},
     {"moving_car_share", &OrthoScores::moving_car_share}}};
constexpr std::array<std::pair<const char*, int64_t OrthoScores::*>, 6> kOrthoCounts = {{{"cells", &OrthoScores::cells},
                                                                                         {"photos_in_use", &OrthoScores::photos_in_use},
                                                                                         {"cells_compared", &OrthoScores::cells_compared},
                                                                                         {"edge_targets", &OrthoScores::edge_targets},
                                                                                         {"seams", &OrthoScores::seams},
                                                                                         {"moving_car_cells", &OrthoScores::moving_car_cells}}};

}  // namespace

nlohmann::ordered_json ToJson(const OrthoScores& scores) {
  nlohmann::ordered_json json;
  for (const auto& [key, member] : kOrthoNumbers) json[key] = base::NumberOrNull(scores.*member);
  for (const auto& [key, member] : kOrthoCounts)
    json[key] = scores.*member < 0 ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(scores.*member);
  return json;
}

OrthoScores OrthoScoresFromJson(const nlohmann::ordered_json& json) {
  OrthoScores scores;
  for (const auto& [key, member] : kOrthoNumbers) TakeValue(json, key, &(scores.*member));
  for (const auto& [key, member] : kOrthoCounts) TakeValue(json, key, &(scores.*member));
  return scores;
}

}  // namespace skyquilt::evaluate::ortho
