#include "viewer/data/saved_documents.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>
#include <vector>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "viewer/data/check_document.h"
#include "viewer/data/control_points.h"
#include "viewer/data/gcp_list.h"

namespace skyquilt::viewer {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kMeasurements = "measurements.geojson";
constexpr const char* kControlPoints = "gcp.json";
constexpr const char* kCameraPath = "camera_path.json";

DataReply TextReply(int status, const std::string& text) {
  return {.status = status, .content_type = "text/plain; charset=utf-8", .body = text, .file = {}};
}

DataReply NoContent() {
  return {.status = 204, .content_type = "", .body = "", .file = {}};
}

// Nothing when the file does not exist or cannot be read.
std::string ContentOf(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return "";
  try {
    return base::ReadFile(file);
  } catch (const base::InputError&) {
    return "";
  }
}

std::string Indented(const Json& json) {
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::optional<geo::UtmZone> ZoneOf(const OpenedProject& opened) {
  return opened.georeferenced ? std::optional(opened.zone) : std::nullopt;
}

// What a failed write of a file of the project means for the user.
DataReply FailureReply(const base::InputError& failure) {
  struct Kind {
    int code, status;
    const char* advice;
  };
  static constexpr const char* kFree = "Free some space on this disk, then save again";
  static constexpr const char* kAllow = "Allow this user to write into the project folder, then save again";
  static constexpr std::array<Kind, 5> kKinds = {
      {{ENOSPC, 507, kFree}, {EDQUOT, 507, kFree}, {EACCES, 409, kAllow}, {EPERM, 409, kAllow}, {EROFS, 409, kAllow}}};
  spdlog::warn("{}", failure.what());
  const std::string file = failure.file().filename().string();
  for (const Kind& kind : kKinds) {
    const std::string message = std::generic_category().message(kind.code);
    if (failure.finding().find(message) == std::string::npos) continue;
    return TextReply(kind.status, file + " is not saved: " + message + ". " + kind.advice);
  }
  return TextReply(500, file + " is not saved: " + failure.finding());
}

// gcp_list.txt of the project; else beside the photos, or where OpenDroneMap wants it: beside their folder "images".
GcpList ListFromElsewhere(const OpenedProject& opened, const MarkablePhotos& photos) {
  std::vector<fs::path> files = {opened.project.folder / "gcp_list.txt"};
  if (opened.survey != nullptr) {
    const fs::path& root = opened.survey->photo_root;
    files.push_back(root / "gcp_list.txt");
    if (root.filename() == "images") files.push_back(root.parent_path() / "gcp_list.txt");
  }
  for (const fs::path& file : files) {
    const std::string text = ContentOf(file);
    if (text.empty()) continue;
    GcpList list = ReadGcpList(text, ZoneOf(opened), photos);
    if (!list.problem.empty()) spdlog::warn("{}: not shown as control points: {}", file.string(), list.problem);
    return list;
  }
  return {};
}

// The control points that a browser gets now; null when there are none, or gcp.json is damaged.
Json CurrentControlPoints(const OpenedProject& opened, const MarkablePhotos& photos) {
  const std::string text = ContentOf(opened.project.folder / kControlPoints);
  if (text.empty()) return ListFromElsewhere(opened, photos).gcp;
  try {
    return ParseDocument(text);
  } catch (const Refused&) {
    return nullptr;
  }
}

void WriteIfChanged(const fs::path& file, const std::string& content) {
  if (ContentOf(file) != content) base::WriteFileAtomically(file, content);
}

void SaveControlPoints(const OpenedProject& opened, const Json& gcp) {
  const fs::path& folder = opened.project.folder;
  const MarkablePhotos photos(opened.survey.get());
  const std::optional<std::string> crs = CrsNameOf(opened.georeferenced, opened.zone);
  const Json current = CurrentControlPoints(opened, photos);
  const std::set<std::string> unknown = UnknownMarks(current, photos);
  CheckControlPoints(gcp, crs, photos, unknown);

  const fs::path list = folder / "gcp_list.txt", original = folder / "gcp_list.txt.orig";
  const std::string present = ContentOf(list), wanted = GcpListText(gcp, photos);
  if (!present.empty() && present != wanted) {
    // Somebody's own list is kept; what we made from the control points so far is not.
    bool ours = false;
    try {
      CheckControlPoints(current, crs, photos, unknown);
      ours = fs::exists(folder / kControlPoints) && GcpListText(current, photos) == present;
    } catch (const Refused&) {
    }
    std::error_code error;
    if (!ours && !fs::exists(original, error)) base::WriteFileAtomically(original, present);
  }
  WriteIfChanged(folder / kControlPoints, Indented(gcp));
  WriteIfChanged(list, wanted);
}

void SaveCameraPath(const OpenedProject& opened, const Json& json, const std::string& body) {
  const fs::path file = opened.project.folder / kCameraPath;
  if (!IsEmptyPath(json)) {
    CheckCameraPath(json, body, opened.origin, opened.georeferenced);
    WriteIfChanged(file, Indented(json));
    return;
  }
  std::error_code error;
  if (!fs::remove(file, error) && error) base::ThrowFileError(file, "cannot remove", error.value());
}

}  // namespace

bool IsDocument(const std::string& name) {
  return name == kMeasurements || name == kControlPoints || name == kCameraPath;
}

DataReply GetDocument(const OpenedProject& opened, const std::string& name) {
  const char* type = name == kMeasurements ? "application/geo+json" : "application/json";
  const fs::path file = opened.project.folder / name;
  std::error_code error;
  if (fs::is_regular_file(file, error)) return {.status = 200, .content_type = type, .body = base::ReadFile(file), .file = {}};
  if (name == kControlPoints) {
    const GcpList list = ListFromElsewhere(opened, MarkablePhotos(opened.survey.get()));
    if (!list.gcp.is_null()) return {.status = 200, .content_type = type, .body = Indented(list.gcp), .file = {}};
  }
  return NoContent();
}

DataReply PutDocument(const OpenedProject& opened, const std::string& name, const std::string& body) {
  try {
    const Json json = ParseDocument(body);
    if (name == kMeasurements) {
      CheckMeasurements(json);
      WriteIfChanged(opened.project.folder / name, Indented(json));
    } else if (name == kControlPoints) {
      SaveControlPoints(opened, json);
    } else {
      SaveCameraPath(opened, json, body);
    }
    return NoContent();
  } catch (const Refused& refused) {
    return TextReply(400, name + " is not saved: " + refused.what());
  } catch (const base::InputError& failure) {
    return FailureReply(failure);
  }
}

}  // namespace skyquilt::viewer
