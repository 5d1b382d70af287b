// What a comparison of a project's photos found (worker/robust/find_movers.h), for people: how much of them blocks did not learn from, and pictures
// that show it. On disk: movers.json in the folder movers/ of the project, beside the pictures that it names.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace skyquilt::survey {

struct ComparedPhoto {
  std::string photo;      // its name
  std::string look = {};  // picture with what is rejected tinted, relative to the folder; empty: nothing is
  double rejected = 0.0;  // share of the photo, 0 to 1
};

// Shares from 0 to 1, as in worker::Movers.
struct ComparedPhotos {
  std::string movers = "off";  // as in worker::RobustOptions
  std::string prefer = "any";  // as there
  double compared = 0.0;
  double moved = 0.0;
  double replaced = 0.0;
  bool unclear = false;
  std::vector<ComparedPhoto> photos = {};  // training photos, in the order of the survey
};

// Creates the folder. Throws base::InputError when it cannot be written.
void SaveComparedPhotos(const ComparedPhotos& photos, const std::filesystem::path& folder);
// Nothing when there is no such file. Throws base::InputError when it is damaged.
std::optional<ComparedPhotos> LoadComparedPhotos(const std::filesystem::path& folder);

}  // namespace skyquilt::survey
