#include "prepare/models/read_model.h"

#include <algorithm>
#include <array>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_document.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "prepare/models/metashape_xml.h"
#include "prepare/models/opensfm_json.h"
#include "prepare/models/opf_json.h"
#include "prepare/models/poses_bounds.h"
#include "prepare/models/reduced_pictures.h"
#include "prepare/models/transforms_json.h"

namespace skyquilt::prepare::models {
namespace {

using base::JsonDocument;
using base::JsonValue;

namespace fs = std::filesystem;

constexpr const char* kFormats =
    "Give a COLMAP folder (cameras, images and points3D, usually sparse/0), a transforms.json, an OpenSfM or OpenDroneMap reconstruction.json, a "
    "Metashape cameras.xml, a Pix4D .opf or the poses_bounds.npy of LLFF";

constexpr const char* kTrainName = "transforms_train.json";

std::string ExtensionOf(const fs::path& file) {
  return base::LowerCase(file.extension().string());
}

bool IsColmapFolder(const fs::path& folder) {
  return fs::exists(folder / "cameras.bin") || fs::exists(folder / "cameras.txt");
}

// JSON is told apart by what it holds: names are changed by users.
ModelFormat FormatOfJson(const fs::path& file) {
  {
    // Reconstructions are large, and the only lists.
    const std::string text = base::ReadFile(file);
    const size_t first = text.find_first_not_of(" \t\r\n");
    if (first != std::string::npos && text[first] == '[') return ModelFormat::kOpensfm;
  }
  const JsonDocument document(file, kFormats);
  const JsonValue root = document.Root();
  if (!root.IsObject()) root.Fail("holds no cameras");
  if (root.Find("frames")) return ModelFormat::kTransforms;
  const std::optional<JsonValue> format = root.Find("format");
  if (format && format->Text() == "application/opf-project+json") return ModelFormat::kOpf;
  if (format && format->Text().starts_with("application/opf-"))
    format->Fail("is a part of an OPF project", "Give the project file, which ends in .opf");
  root.Fail("holds no cameras in a format that is known");
}

ModelFiles FindModelFile(const fs::path& file) {
  const std::string extension = ExtensionOf(file);
  if (extension == ".opf") return {ModelFormat::kOpf, file};
  if (extension == ".json") return {FormatOfJson(file), file};
  if (extension == ".npy") return {ModelFormat::kPosesBounds, file};
  if (extension == ".xml") {
    if (!LooksLikeMetashape(file)) throw base::InputError(file, "line 1: is not an XML file of Metashape's cameras", kFormats);
    return {ModelFormat::kMetashape, file};
  }
  const std::string stem = file.stem().string();
  if ((extension == ".bin" || extension == ".txt") && (stem == "cameras" || stem == "images" || stem == "points3D")) {
    return {ModelFormat::kColmap, file.parent_path()};
  }
  throw base::InputError(file, "is not a camera model that is known", kFormats);
}

// The file, or those of its folder's split.
std::vector<TransformsFile> FilesOfTransforms(const fs::path& path) {
  const bool is_folder = fs::is_directory(path);
  if (!is_folder && path.filename() != kTrainName) return {{path, TransformsPart::kWhole}};
  const fs::path folder = is_folder ? path : path.parent_path();
  std::vector<TransformsFile> files;
  for (const auto& [name, part] : std::array<std::pair<const char*, TransformsPart>, 3>{
           {{kTrainName, TransformsPart::kTrain}, {"transforms_val.json", TransformsPart::kVal}, {"transforms_test.json", TransformsPart::kTest}}}) {
    if (fs::exists(folder / name)) files.push_back({folder / name, part});
  }
  return files;
}

// Files with this extension, in name order.
std::vector<fs::path> FilesWith(const fs::path& folder, const std::string& extension) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && ExtensionOf(entry.path()) == extension) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

fs::path OnlyOne(const fs::path& folder, const std::vector<fs::path>& files) {
  if (files.size() == 1) return files.front();
  std::vector<std::string> names;
  for (const fs::path& file : files) names.push_back(file.filename().string());
  throw base::InputError(folder, "has several camera models: " + base::Join(names), "Give one of these files");
}

}  // namespace

ModelFiles FindModel(const fs::path& path) {
  if (!fs::exists(path)) throw base::InputError(path, "no such folder or file", kFormats);
  if (!fs::is_directory(path)) return FindModelFile(path);
  if (IsColmapFolder(path)) return {ModelFormat::kColmap, path};
  if (fs::exists(path / "transforms.json")) {
    if (fs::exists(path / kTrainName)) {
      throw base::InputError(path, std::string("has transforms.json and ") + kTrainName,
                             std::string("Give one of the files instead of the folder; with ") + kTrainName + " its split is used");
    }
    return {ModelFormat::kTransforms, path / "transforms.json"};
  }
  if (fs::exists(path / kTrainName)) return {ModelFormat::kTransforms, path};
  for (const char* name : {"transforms_val.json", "transforms_test.json"}) {
    if (fs::exists(path / name))
      throw base::InputError(path, std::string("has a ") + name + ", but no " + kTrainName, "Add it: it names the photos to train on");
  }
  if (IsColmapFolder(path / "sparse" / "0")) return {ModelFormat::kColmap, path / "sparse" / "0"};
  if (fs::exists(path / "poses_bounds.npy")) return {ModelFormat::kPosesBounds, path / "poses_bounds.npy"};
  for (const fs::path& file : {path / "reconstruction.json", path / "opensfm" / "reconstruction.json"}) {
    if (fs::exists(file)) return {ModelFormat::kOpensfm, file};
  }
  if (const std::vector<fs::path> projects = FilesWith(path, ".opf"); !projects.empty()) return {ModelFormat::kOpf, OnlyOne(path, projects)};
  std::vector<fs::path> documents = FilesWith(path, ".xml");
  std::erase_if(documents, [](const fs::path& file) { return !LooksLikeMetashape(file); });
  if (!documents.empty()) return {ModelFormat::kMetashape, OnlyOne(path, documents)};
  throw base::InputError(path, "has no camera model that is known", kFormats);
}

InputModel ReadModel(const fs::path& path, const ModelPhotos& photos) {
  const ModelFiles files = FindModel(path);
  base::LogInfo("the model is {}: {}", FormatName(files.format), files.path.string());
  switch (files.format) {
    case ModelFormat::kTransforms:
      return ReadTransforms(FilesOfTransforms(files.path), photos);
    case ModelFormat::kOpensfm:
      return ReadOpensfm(files.path, photos);
    case ModelFormat::kMetashape:
      return ReadMetashape(files.path, photos);
    case ModelFormat::kOpf:
      return ReadOpf(files.path, photos);
    case ModelFormat::kPosesBounds:
      return ReadPosesBounds(files.path, photos);
    case ModelFormat::kColmap:
      break;
  }
  InputModel model;
  model.sfm = survey::ReadColmapModel(files.path);
  UseReducedPictures(files.path, photos, model);
  return model;
}

}  // namespace skyquilt::prepare::models
