#include "tour/pictures/make_pictures.h"

#include <chrono>
#include <map>
#include <set>
#include <string>
#include <system_error>

#include "core/base/amounts.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "tour/pictures/picture_file.h"

namespace skyquilt::tour {
namespace {

// Pictures, and what a killed process left of one: ".<name>.tmp.<number>".
bool IsOfPictures(const std::string& name) {
  constexpr std::string_view kEnding = ".picture";
  const size_t ending = name.find(kEnding);
  if (ending == std::string::npos) return false;
  return ending + kEnding.size() == name.size() || (name.front() == '.' && name.substr(ending + kEnding.size()).starts_with(".tmp."));
}

void RemoveOthers(const std::filesystem::path& folder, const std::set<std::string>& wanted) {
  std::error_code ignored;
  std::vector<std::filesystem::path> others;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (IsOfPictures(name) && !wanted.contains(name)) others.push_back(entry.path());
  }
  for (const std::filesystem::path& other : others) std::filesystem::remove(other, ignored);
}

}  // namespace

std::vector<PictureRequest> MissingPictures(std::span<const PictureRequest> requests, const PictureField& field,
                                            const std::filesystem::path& folder) {
  std::vector<PictureRequest> missing;
  std::set<std::string> seen;
  for (const PictureRequest& request : requests) {
    const std::string key = KeyOf(request, field.identity);
    if (seen.insert(key).second && !LoadPicture(folder / PictureFileName(key), key)) missing.push_back(request);
  }
  return missing;
}

PictureFiles MakePictures(std::span<const PictureRequest> requests, const PictureField& field, const std::filesystem::path& folder) {
  std::map<std::string, products::RayCaster> casters;
  for (const PictureRequest& request : requests) {
    if (!casters.contains(request.exposure)) casters[request.exposure] = field.caster(request.exposure);
  }
  base::RequireWritableFolder(folder);
  PictureFiles result;
  std::set<std::string> wanted;
  for (const PictureRequest& request : requests) {
    result.files.push_back(folder / PictureFileName(KeyOf(request, field.identity)));
    wanted.insert(result.files.back().filename().string());
  }
  const std::vector<PictureRequest> missing = MissingPictures(requests, field, folder);
  if (missing.size() < wanted.size()) {
    base::LogInfo("pictures of the tour: {} of {} are there from an earlier run", wanted.size() - missing.size(), wanted.size());
  }
  if (!missing.empty()) {
    int64_t rays = 0;
    for (const PictureRequest& request : missing) rays += request.Rays();
    base::Progress progress("pictures of the tour", static_cast<double>(rays), "rays");
    for (const PictureRequest& request : missing) {
      const auto start = std::chrono::steady_clock::now();
      const RenderedPicture picture =
          RenderPicture(request, field, casters.at(request.exposure), [&](int64_t count) { progress.Advance(static_cast<double>(count)); });
      result.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      result.rays += request.Rays();
      ++result.rendered;
      const std::string key = KeyOf(request, field.identity);
      SavePicture(Encode(picture), key, folder / PictureFileName(key));
      progress.Advance(0.0, std::to_string(result.rendered) + " of " + std::to_string(missing.size()) + " pictures");
    }
    progress.Finish();
    const double rate = result.seconds > 0.0 ? static_cast<double>(result.rays) / result.seconds : 0.0;
    base::LogInfo("pictures of the tour: {} rendered, {} rays/s", result.rendered, base::FormatCount(rate));
  }
  RemoveOthers(folder, wanted);
  return result;
}

}  // namespace skyquilt::tour
