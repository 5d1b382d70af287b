#include "tour/format/tour_file.h"

#include <system_error>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tour/format/write_tour.h"

namespace skyquilt::tour {

namespace fs = std::filesystem;

fs::path TourFile(const fs::path& project_folder) {
  return project_folder / "tour.json";
}

fs::path AssetFolder(const fs::path& project_folder) {
  return project_folder / "tour" / "assets";
}

PlayableTour LoadTourToPlay(const fs::path& project_folder) {
  const fs::path file = TourFile(project_folder), assets = AssetFolder(project_folder);
  std::error_code error;
  if (fs::status(file, error).type() == fs::file_type::not_found) {
    throw base::InputError(file, "does not exist: this project has no tour", "Make one with skyquilt view " + project_folder.string() + " --edit");
  }
  const std::string text = base::ReadFile(file);
  try {
    return ReadTourToPlay(text, [&](const std::string& name, uint64_t bytes) {
      std::error_code ignored;
      return fs::is_regular_file(assets / name, ignored) && fs::file_size(assets / name, ignored) == bytes;
    });
  } catch (const base::Refused& refused) {
    throw base::InputError(file, std::string("is damaged: ") + refused.what(),
                           "Correct it as docs/tour_format.md says, or move it away and make the tour anew");
  }
}

void SaveTour(const Tour& tour, const fs::path& project_folder) {
  const fs::path file = TourFile(project_folder);
  const std::string text = FormatTour(tour);
  try {
    ParseTour(text);
  } catch (const base::Refused& refused) {
    throw base::InputError(file, std::string("cannot be saved: ") + refused.what(), "");
  }
  base::WriteFileAtomically(file, text);
}

}  // namespace skyquilt::tour
