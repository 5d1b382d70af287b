#include "odm/dataset.h"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/gis/boundary.h"
#include "prepare/input/list_files.h"
#include "prepare/video/find_videos.h"
#include "prepare/video/probe.h"

namespace skyquilt::odm {
namespace {

namespace fs = std::filesystem;

// The file that the option names, else `usual` where it is there, else nothing.
std::string FileOf(const Request& request, const std::string& option, const fs::path& usual) {
  if (request.Has(option)) {
    const fs::path file = fs::absolute(request.Text(option)).lexically_normal();
    if (!fs::is_regular_file(file)) throw base::InputError(file, "no such file", "Give an existing file as " + option + ", or leave the option out");
    return file.string();
  }
  return !usual.empty() && fs::is_regular_file(usual) ? usual.string() : std::string();
}

// Frames are taken later: a guess of their number.
bool CountFrames(const Request& request, Dataset* dataset) {
  const std::vector<fs::path> videos = prepare::video::FindVideos({dataset->images});
  if (videos.empty()) return false;
  // Drones on survey flights move by a quarter of the picture in about this time.
  constexpr double kBetweenFrames_s = 2.0;
  const double longest = request.Number("--video-resolution");
  double seconds = 0.0;
  for (const fs::path& video : videos) {
    const prepare::video::VideoInfo info = prepare::video::Probe(video);
    seconds += info.duration_s.value_or(0.0);
    const double scale = std::min(1.0, longest / std::max(info.width, info.height));
    dataset->megapixels = std::max(dataset->megapixels, 1e-6 * scale * scale * info.width * info.height);
  }
  dataset->photos = static_cast<int>(std::clamp(seconds / kBetweenFrames_s, 3.0, std::max(3.0, request.Number("--video-limit"))));
  return true;
}

void CountPhotos(const fs::path& project, base::ThreadPool& threads, Dataset* dataset) {
  double pixels = 0.0;
  int known = 0;
  // As 'skyquilt prepare' finds them.
  const fs::path inner = dataset->images / "images";
  const fs::path root = fs::is_directory(inner) ? inner : dataset->images;
  for (const prepare::input::InputFile& file : prepare::input::ListInput(root, {.skip = {project}, .masks = {}, .patterns = {}}, threads)) {
    if (!file.Taken()) continue;
    ++dataset->photos;
    if (file.width <= 0 || file.height <= 0) continue;
    pixels += static_cast<double>(file.width) * file.height;
    ++known;
  }
  if (known > 0) dataset->megapixels = 1e-6 * pixels / known;
}

// Puts quotes around the names and texts of JSON that has none.
class Quoter {
 public:
  explicit Quoter(const std::string& text) : text_(text) {}

  std::string Quoted() {
    std::string quoted;
    bool is_name = false;  // a name of an object's member comes next
    std::string open;      // brackets
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '{' || c == '[') open += c;
      if ((c == '}' || c == ']') && !open.empty()) open.pop_back();
      if (std::isspace(static_cast<unsigned char>(c)) != 0 || std::string("{}[]:,").find(c) != std::string::npos) {
        if (c == '{' || c == ',') is_name = !open.empty() && open.back() == '{';
        if (c == ':') is_name = false;
        quoted += c;
        ++at_;
      } else {
        quoted += Word(is_name ? ":" : ",]}");
      }
    }
    return quoted;
  }

 private:
  // A name or a value, up to one of these; a number or a literal keeps its form.
  std::string Word(const std::string& ends) {
    const size_t end = std::min(text_.find_first_of(ends, at_), text_.size());
    std::string word = text_.substr(at_, end - at_);
    while (!word.empty() && std::isspace(static_cast<unsigned char>(word.back())) != 0) word.pop_back();
    at_ = end;
    const nlohmann::json plain = base::TryParseJson(word);
    if (ends != ":" && !plain.is_discarded()) return word;
    return base::JsonText(nlohmann::json(word));
  }

  const std::string& text_;
  size_t at_ = 0;
};

}  // namespace

std::string RestoreQuotes(const std::string& text) {
  if (!base::TryParseJson(text).is_discarded()) return text;
  const std::string quoted = Quoter(text).Quoted();
  return base::TryParseJson(quoted).is_discarded() ? text : quoted;
}

Dataset FindDataset(const Request& request, base::ThreadPool& threads) {
  Dataset dataset;
  dataset.folder = request.Folder();
  dataset.images = dataset.folder / "images";
  dataset.project = dataset.folder / "skyquilt";
  if (!fs::is_directory(dataset.folder)) {
    throw base::InputError(dataset.folder, "no such folder", "Give its parent as --project-path and its name as the last word");
  }
  if (!fs::is_directory(dataset.images)) throw base::InputError(dataset.images, "no such folder", "Put the photos there");
  if (!request.Has("--use-exif")) dataset.gcp = FileOf(request, "--gcp", dataset.folder / "gcp_list.txt");
  dataset.geo = FileOf(request, "--geo", {});
  dataset.has_groups = fs::is_regular_file(dataset.folder / "image_groups.txt");
  if (!CountFrames(request, &dataset)) CountPhotos(dataset.project, threads, &dataset);
  return dataset;
}

std::string ProvideBoundary(const Request& request, const Dataset& dataset) {
  const std::string value = request.Text("--boundary");
  if (value.empty()) return "";
  std::string text;
  std::error_code ignored;  // JSON can be too long for a path
  if (fs::is_regular_file(value, ignored)) {
    text = base::ReadFile(value);
  } else {
    text = RestoreQuotes(value);
    if (!base::TryParseJson(text).is_object()) {
      throw base::InputError(value.substr(0, 80), "is neither a file nor GeoJSON", "Give a GeoJSON file or its text as --boundary");
    }
  }
  const fs::path file = dataset.project / "boundary.geojson";
  base::WriteFileAtomically(file, text);
  // A point or a line would stop the run only after the training. Where it lies is asked when the poses are known.
  gis::Boundary::Read(file, false, {});
  return file.string();
}

}  // namespace skyquilt::odm
