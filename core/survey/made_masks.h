// Masks that stage "masks" made of a prepared survey: by a network that finds what moves, and of ground that is to be ignored. They are combined with
// the masks that were given and take their place in Photo::mask, so that all later stages use them. On disk: masks.json in the folder made_masks/ of
// the survey, beside the pictures that it names.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace skyquilt::survey {

// Of one photo. Pixels are those of the full photo; the counts of the parts may overlap.
struct MadeMask {
  std::string photo;      // its name
  std::string file = {};  // of the combined mask, relative to made_masks/; empty: the photo keeps the mask that it was given, or has none
  std::string look = {};  // picture of photo and mask for people, relative to made_masks/; empty: nothing is ignored
  int64_t pixels = 0;     // of the photo
  int64_t ignored = 0;    // by any mask
  int64_t given = 0;      // by the given mask
  int64_t network = 0;    // by the network
  int64_t ground = 0;     // on ignored ground
};

struct MadeMasks {
  std::string network = {};                                     // file name of the network; empty: none was used
  std::vector<std::string> classes = {};                        // names of the classes that it masks
  std::string ground = {};                                      // file name of the polygons; empty: none
  std::vector<std::vector<Eigen::Vector2d>> ground_rings = {};  // closed rings around ignored ground, x and y in ENU metres; even-odd rule
  std::vector<MadeMask> photos = {};                            // in the order of the survey
};

nlohmann::ordered_json ToJson(const MadeMask& mask);
// Throws nlohmann::json::exception for a value of another form, std::invalid_argument for counts that are impossible.
MadeMask MadeMaskFromJson(const nlohmann::json& value);

std::filesystem::path MadeMasksFolder(const std::filesystem::path& survey_folder);
std::filesystem::path MadeMasksFile(const std::filesystem::path& survey_folder);

// Throws base::InputError when the file cannot be written.
void SaveMadeMasks(const MadeMasks& masks, const std::filesystem::path& survey_folder);
// Nothing when there are none. Throws base::InputError when the file is damaged.
std::optional<MadeMasks> LoadMadeMasks(const std::filesystem::path& survey_folder);

}  // namespace skyquilt::survey
