#include "viewer/data/saved_documents.h"

#include <algorithm>
#include <system_error>
#include <vector>

#include "core/base/checked_json.h"
#include "core/base/errors.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "tour/format/read_tour.h"
#include "tour/format/write_tour.h"
#include "viewer/data/check_document.h"
#include "viewer/data/data_replies.h"
#include "viewer/data/gcp_json.h"
#include "viewer/data/gcp_list.h"

namespace skyquilt::viewer {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kMeasurements = "measurements.geojson";
constexpr const char* kControlPoints = "gcp.json";
constexpr const char* kCameraPath = "camera_path.json";
constexpr const char* kTour = "tour.json";

// content: of the document's file.
DataReply NoContent(const std::string& content) {
  return {.status = 204, .content_type = "", .body = "", .file = {}, .etag = base::HashHex(content)};
}

// tags: separated by spaces.
bool IsAmong(const std::string& tag, const std::string& tags) {
  return (" " + tags + " ").find(" " + tag + " ") != std::string::npos;
}

// Empty when there is no such file. Throws base::InputError when there is something of this name that cannot be read.
std::string ContentOf(const fs::path& file) {
  std::error_code error;
  const fs::file_type type = fs::status(file, error).type();
  if (type == fs::file_type::not_found) return "";
  if (error) base::ThrowFileError(file, "cannot read", error.value());
  if (type != fs::file_type::regular) throw base::InputError(file, "is not a file", "Move it away");
  return base::ReadFile(file);
}

std::string Indented(const Json& json) {
  return base::JsonText(json, 1) + "\n";
}

std::optional<geo::UtmZone> ZoneOf(const OpenedProject& opened) {
  return opened.georeferenced ? std::optional(opened.zone) : std::nullopt;
}

// gcp_list.txt of the project; else beside the photos, or where OpenDroneMap wants it: beside their folder "images".
Json ListFromElsewhere(const OpenedProject& opened, const MarkablePhotos& photos) {
  std::vector<fs::path> files = {opened.project.folder / "gcp_list.txt"};
  if (opened.survey != nullptr) {
    const fs::path& root = opened.survey->photo_root;
    files.push_back(root / "gcp_list.txt");
    if (root.filename() == "images") files.push_back(root.parent_path() / "gcp_list.txt");
  }
  for (const fs::path& file : files) {
    std::string text;
    try {
      text = ContentOf(file);
    } catch (const base::InputError& failure) {
      // Only the project's own list is ever replaced, so the others may be passed over.
      if (&file == &files.front()) throw;
      base::LogWarning("{}", failure.what());
    }
    if (text.empty()) continue;
    try {
      return ReadGcpList(file, text, ZoneOf(opened), photos);
    } catch (const base::InputError& failure) {
      base::LogWarning("not shown as control points: {}", failure.what());
      return nullptr;
    }
  }
  return nullptr;
}

// The control points that a browser gets now; null when there are none, or gcp.json, whose content is `text`, is damaged.
Json CurrentControlPoints(const OpenedProject& opened, const MarkablePhotos& photos, const std::string& text) {
  if (text.empty()) return ListFromElsewhere(opened, photos);
  try {
    return base::ParseDocument(text);
  } catch (const base::Refused&) {
    return nullptr;
  }
}

void WriteIfChanged(const fs::path& file, const std::string& content) {
  if (ContentOf(file) != content) base::WriteFileAtomically(file, content);
}

// Keeps a list of somebody else beside those that were kept before, unless one of them is the same.
void KeepOriginal(const fs::path& list, const std::string& content) {
  constexpr int kMostOriginals = 1000;
  for (int n = 1; n <= kMostOriginals; ++n) {
    fs::path original = list;
    original += n == 1 ? ".orig" : ".orig." + std::to_string(n);
    std::error_code error;
    if (fs::symlink_status(original, error).type() == fs::file_type::not_found) {
      base::WriteFileAtomically(original, content);
      return;
    }
    try {
      if (ContentOf(original) == content) return;
    } catch (const base::InputError&) {
      // Taken by something else.
    }
  }
  throw base::InputError(list, "is not ours, and there are too many older lists beside it", "Move the files gcp_list.txt.orig.* away");
}

// Returns what gcp.json contains now.
std::string SaveControlPoints(const OpenedProject& opened, const Json& gcp) {
  const fs::path& folder = opened.project.folder;
  const MarkablePhotos photos(opened.survey.get());
  const std::optional<std::string> crs = CrsNameOf(opened.georeferenced, opened.zone);
  const std::string before = ContentOf(folder / kControlPoints);
  const Json current = CurrentControlPoints(opened, photos, before);
  const std::set<std::string> unknown = UnknownMarks(current, photos);
  CheckControlPoints(gcp, crs, photos, unknown);

  const fs::path list = folder / "gcp_list.txt";
  const std::string present = ContentOf(list), wanted = GcpListText(gcp, photos);
  if (!present.empty() && present != wanted) {
    // Somebody's own list is kept; what we made from the control points so far is not.
    bool ours = false;
    try {
      CheckControlPoints(current, crs, photos, unknown);
      ours = !before.empty() && GcpListText(current, photos) == present;
    } catch (const base::Refused&) {
    }
    if (!ours) KeepOriginal(list, present);
  }
  std::string content = Indented(gcp);
  WriteIfChanged(folder / kControlPoints, content);
  WriteIfChanged(list, wanted);
  return content;
}

// Returns what the file contains now.
std::string SaveCameraPath(const OpenedProject& opened, const Json& json, const std::string& body) {
  const fs::path file = opened.project.folder / kCameraPath;
  if (!IsEmptyPath(json)) {
    CheckCameraPath(json, body, opened.origin, opened.georeferenced);
    std::string content = Indented(json);
    WriteIfChanged(file, content);
    return content;
  }
  std::error_code error;
  if (!fs::remove(file, error) && error) base::ThrowFileError(file, "cannot remove", error.value());
  return "";
}

}  // namespace

bool IsDocument(const std::string& name) {
  return name == kMeasurements || name == kControlPoints || name == kCameraPath || name == kTour;
}

DataReply GetDocument(const OpenedProject& opened, const std::string& name) {
  const char* type = name == kMeasurements ? "application/geo+json" : "application/json";
  const auto found = [type](std::string body, std::string etag) -> DataReply {
    return {.status = 200, .content_type = type, .body = std::move(body), .file = {}, .etag = std::move(etag)};
  };
  try {
    std::string content = ContentOf(opened.project.folder / name);
    std::string etag = base::HashHex(content);
    if (!content.empty()) return found(std::move(content), std::move(etag));
    if (name == kControlPoints) {
      const Json gcp = ListFromElsewhere(opened, MarkablePhotos(opened.survey.get()));
      if (!gcp.is_null()) return found(Indented(gcp), std::move(etag));
    }
    return NoContent("");
  } catch (const base::InputError& failure) {
    base::LogWarning("{}", failure.what());
    return TextReply(500, failure.file().filename().string() + ": " + failure.finding());
  }
}

DataReply PutDocument(const OpenedProject& opened, const std::string& name, const std::string& body, const std::string& if_match) {
  const fs::path file = opened.project.folder / name;
  try {
    if (!if_match.empty() && !IsAmong(base::HashHex(ContentOf(file)), if_match)) {
      return TextReply(412, name + " was changed in another window. Reload the page to see it");
    }
    if (name == kTour) {
      const std::string content = tour::FormatTour(tour::ParseTour(body));
      if (content.size() > tour::kMaxTourBytes) throw base::Refused("it is longer than 1 MiB: shorten its texts or delete stops");
      WriteIfChanged(file, content);
      return NoContent(content);
    }
    const Json json = base::ParseDocument(body);
    if (name == kControlPoints) return NoContent(SaveControlPoints(opened, json));
    if (name == kCameraPath) return NoContent(SaveCameraPath(opened, json, body));
    CheckMeasurements(json);
    const std::string content = Indented(json);
    WriteIfChanged(file, content);
    return NoContent(content);
  } catch (const base::Refused& refused) {
    return TextReply(400, name + " is not saved: " + refused.what());
  } catch (const base::InputError& failure) {
    return FailureReply(failure, failure.file().filename().string());
  }
}

DataReply ConvertGcpList(const OpenedProject& opened, const std::string& text) {
  try {
    const Json gcp = ReadGcpList("gcp_list.txt", text, ZoneOf(opened), MarkablePhotos(opened.survey.get()));
    return {.status = 200, .content_type = "application/json", .body = Indented(gcp), .file = {}};
  } catch (const base::InputError& failure) {
    return TextReply(400, failure.finding());
  }
}

std::string SentBodies::Resolved(const std::string& name, const std::string& if_match) const {
  const auto sent = last_.find(name);
  if (sent == last_.end() || !IsAmong(sent->second.body, if_match)) return if_match;
  return if_match + " " + sent->second.etag;
}

}  // namespace skyquilt::viewer
