// The files of a project's tour: tour.json and tour/assets/.
#pragma once

#include <filesystem>

#include "tour/format/read_tour.h"
#include "tour/format/tour.h"

namespace skyquilt::tour {

std::filesystem::path TourFile(const std::filesystem::path& project_folder);
std::filesystem::path AssetFolder(const std::filesystem::path& project_folder);

// As ReadTourToPlay, with the assets of the folder. Throws base::InputError when there is no tour or it is damaged.
PlayableTour LoadTourToPlay(const std::filesystem::path& project_folder);

// Replaces tour.json: at any moment it has its old or its new content. Throws base::InputError, also for a tour that ParseTour would refuse.
void SaveTour(const Tour& tour, const std::filesystem::path& project_folder);

}  // namespace skyquilt::tour
