#include <charconv>
#include <fstream>
#include <string_view>
#include <utility>

#include "core/base/errors.h"
#include "core/survey/colmap_files.h"

namespace skyquilt::survey {
namespace {

constexpr std::string_view kBlank = " \t\r";

// Reads a file line by line and word by word; keeps the line number for messages.
class Lines {
 public:
  explicit Lines(const std::filesystem::path& file) : file_(file), in_(file) {
    if (!in_) throw base::InputError(file, "cannot be read", "Give the folder that holds the whole model, or check permissions");
  }

  bool Next() {
    if (!std::getline(in_, line_)) return false;
    ++number_;
    rest_ = line_;
    return true;
  }
  // The next line that is neither empty nor a comment.
  bool NextRecord() {
    while (Next()) {
      const size_t first = rest_.find_first_not_of(kBlank);
      if (first != std::string_view::npos && rest_[first] != '#') return true;
    }
    return false;
  }

  bool AtEnd() { return rest_.find_first_not_of(kBlank) == std::string_view::npos; }

  std::string_view Word(const char* what) {
    const size_t first = rest_.find_first_not_of(kBlank);
    if (first == std::string_view::npos) Fail("ends before " + std::string(what));
    rest_.remove_prefix(first);
    const size_t length = std::min(rest_.find_first_of(kBlank), rest_.size());
    const std::string_view word = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return word;
  }

  // Takes the next word if it is `word`.
  bool TakeWord(std::string_view word) {
    const size_t first = rest_.find_first_not_of(kBlank);
    if (first == std::string_view::npos) return false;
    const std::string_view line = rest_.substr(first);
    if (line.substr(0, line.find_first_of(kBlank)) != word) return false;
    rest_ = line.substr(word.size());
    return true;
  }

  // Accepts "nan" and "inf": CheckImages refuses them later, with the photo's name.
  template <typename T>
  T Number(const char* what) {
    std::string_view word = Word(what);
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    T value{};
    const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
    if (result.ec != std::errc() || result.ptr != word.data() + word.size()) Fail("has '" + std::string(word) + "' where " + what + " is expected");
    return value;
  }

  // The rest of the line, because photo names may contain spaces.
  std::string Remainder(const char* what) {
    const size_t first = rest_.find_first_not_of(kBlank);
    if (first == std::string_view::npos) Fail("ends before " + std::string(what));
    const size_t last = rest_.find_last_not_of(kBlank);
    return std::string(rest_.substr(first, last - first + 1));
  }

  [[noreturn]] void Fail(const std::string& found) const {
    throw base::InputError(file_, "line " + std::to_string(number_) + " " + found,
                           "The file is truncated or not a COLMAP text model; export the model again");
  }
  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  std::ifstream in_;
  std::string line_;
  std::string_view rest_;
  int number_ = 0;
};

void ParseCameras(const std::filesystem::path& file, ColmapModel& model) {
  Lines in(file);
  while (in.NextRecord()) {
    const auto id = in.Number<uint32_t>("a camera id");
    const std::string name(in.Word("a camera model"));
    const auto camera_model = camera::ModelFromName(name);
    if (!camera_model) {
      throw base::InputError(file, "camera " + std::to_string(id) + " has the camera model '" + name + "', which is not supported",
                             "Use " + camera::ModelNames());
    }
    camera::Camera camera;
    camera.model = *camera_model;
    camera.width = in.Number<int>("a width");
    camera.height = in.Number<int>("a height");
    for (int p = 0; p < camera::ModelParamCount(*camera_model); ++p) camera.params.push_back(in.Number<double>("a camera parameter"));
    if (!model.cameras.emplace(id, std::move(camera)).second) in.Fail("has camera " + std::to_string(id) + " twice");
  }
}

// The rest of a line of observations: x, y and the id of a point, or -1.
std::vector<ColmapObservation> ParseObservations(Lines& in) {
  std::vector<ColmapObservation> observations;
  while (!in.AtEnd()) {
    ColmapObservation observation;
    for (int axis = 0; axis < 2; ++axis) observation.pixel[axis] = in.Number<double>("a pixel coordinate");
    if (in.TakeWord("-1")) continue;
    observation.point_id = in.Number<uint64_t>("the point id of an observation");
    if (observation.point_id != kNoPoint) observations.push_back(observation);
  }
  return observations;
}

// Skips the observations when `observations` is null.
void ParseImages(const std::filesystem::path& file, ColmapModel& model, ColmapObservations* observations) {
  Lines in(file);
  while (in.NextRecord()) {
    ColmapImage image;
    image.id = in.Number<uint32_t>("an image id");
    std::array<double, 7> pose{};
    for (double& value : pose) value = in.Number<double>("a pose");
    image.cam_from_world = PoseOf(pose);
    image.camera_id = in.Number<uint32_t>("a camera id");
    image.name = in.Remainder("a photo name");
    // The observations: always one line, empty when there are none; the last may be missing.
    const bool has_line = in.Next();
    if (observations != nullptr && !observations->emplace(image.id, has_line ? ParseObservations(in) : std::vector<ColmapObservation>()).second) {
      in.Fail("has image " + std::to_string(image.id) + " twice");
    }
    model.images.push_back(std::move(image));
  }
}

void ParsePoints(const std::filesystem::path& file, ColmapModel& model) {
  Lines in(file);
  while (in.NextRecord()) {
    ColmapPoint point;
    point.id = in.Number<uint64_t>("a point id");
    for (int axis = 0; axis < 3; ++axis) point.x_in_world[axis] = in.Number<double>("a coordinate");
    for (uint8_t& channel : point.rgb) channel = in.Number<uint8_t>("a colour");
    point.error_px = in.Number<double>("an error");
    while (!in.AtEnd()) {
      point.image_ids.push_back(in.Number<uint32_t>("an image id of the track"));
      in.Number<uint32_t>("an observation index of the track");
    }
    model.points.push_back(std::move(point));
  }
}

}  // namespace

ColmapModel ReadColmapTextFiles(const std::filesystem::path& folder) {
  ColmapModel model;
  ParseCameras(folder / "cameras.txt", model);
  ParseImages(folder / "images.txt", model, nullptr);
  ParsePoints(folder / "points3D.txt", model);
  return model;
}

ColmapObservations ReadObservationsText(const std::filesystem::path& folder) {
  ColmapModel model;
  ColmapObservations observations;
  ParseImages(folder / "images.txt", model, &observations);
  return observations;
}

}  // namespace skyquilt::survey
