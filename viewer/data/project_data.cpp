#include "viewer/data/project_data.h"

#include <charconv>
#include <deque>
#include <functional>
#include <list>
#include <map>
#include <string_view>
#include <utility>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "viewer/data/map_files.h"
#include "viewer/data/open_project.h"
#include "viewer/data/photo_pictures.h"
#include "viewer/data/saved_documents.h"

namespace skyquilt::viewer {
namespace {

constexpr size_t kCacheBytes = 64U << 20U;
constexpr size_t kPictures = 8;

// Files that were made on demand, the least recently used ones are dropped first.
class MadeFiles {
 public:
  // `make` is called when the file is not kept.
  std::string Get(const std::string& name, const std::function<std::string()>& make) {
    for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
      if (entry->first != name) continue;
      entries_.splice(entries_.begin(), entries_, entry);
      return entry->second;
    }
    entries_.emplace_front(name, make());
    bytes_ += entries_.front().second.size();
    const std::string made = entries_.front().second;
    while (bytes_ > kCacheBytes) {
      bytes_ -= entries_.back().second.size();
      entries_.pop_back();
    }
    return made;
  }
  void Clear() {
    entries_.clear();
    bytes_ = 0;
  }

 private:
  std::list<std::pair<std::string, std::string>> entries_;
  size_t bytes_ = 0;
};

DataReply Bytes(const std::string& type, std::string body) {
  return {.status = 200, .content_type = type, .body = std::move(body), .file = {}};
}

DataReply File(const std::string& type, const std::filesystem::path& file) {
  return {.status = 200, .content_type = type, .body = "", .file = file};
}

// "photos/12/thumbnail.jpg" -> 12 and "thumbnail.jpg".
std::optional<std::pair<size_t, std::string_view>> PhotoPath(std::string_view path) {
  if (!path.starts_with("photos/")) return {};
  path.remove_prefix(7);
  size_t index = 0;
  const auto [end, error] = std::from_chars(path.data(), path.data() + path.size(), index);
  if (error != std::errc() || end == path.data() || end == path.data() + path.size() || *end != '/') return {};
  return std::pair(index, path.substr(static_cast<size_t>(end - path.data()) + 1));
}

}  // namespace

struct ProjectData::Impl {
  mutable std::mutex mutex;  // of what is not named below; held while a file is made
  OpenedProject main;
  std::optional<OpenedProject> before;
  uint32_t revision = 0;
  MadeFiles made;

  // For the engine, which must not wait while a file is made.
  mutable std::mutex engine_mutex;
  std::shared_ptr<const survey::Survey> survey;
  std::deque<std::pair<std::string, std::string>> pictures;
  size_t next_picture = 0;

  void SetSurvey() {
    const std::lock_guard lock(engine_mutex);
    survey = main.survey;
  }

  std::string Description() const {
    nlohmann::json json = main.description;
    json["revision"] = revision;
    json["before"] = nullptr;
    if (before) {
      nlohmann::json earlier = before->description;
      earlier["revision"] = revision;
      earlier["enu_from_before"] = EnuFromOther(main, *before);
      // Its URLs are relative to /data/ as well.
      for (const char* key : {"tiles", "terrain", "orthophoto", "points", "contours"}) {
        if (earlier[key].is_string()) earlier[key] = "before/" + earlier[key].get<std::string>();
      }
      json["before"] = std::move(earlier);
    }
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }

  // The files that both projects have. `prefix`: of their names in the cache.
  std::optional<DataReply> ProjectFile(const OpenedProject& opened, const std::string& path, const std::string& prefix) {
    if (path.starts_with("tiles/")) {
      const std::string name = path.substr(6);
      if (!opened.tiles.contains(name)) return DataReply::NotFound("there is no such tile");
      return File(name.ends_with(".json") ? "application/json" : "model/gltf-binary", opened.project.SurfaceFolder() / "tiles" / name);
    }
    const auto frame = [&] { return SurveyFrame(opened.origin, opened.georeferenced); };
    if (path == "terrain.bin" && opened.terrain) {
      return Bytes("application/octet-stream",
                   made.Get(prefix + path, [&] { return TerrainFile(opened.project.ProductsFolder() / "dsm.tif", frame()); }));
    }
    if (path == "orthophoto.jpg" && opened.orthophoto) {
      return Bytes("image/jpeg", made.Get(prefix + path, [&] { return OrthophotoFile(opened.project.ProductsFolder() / "orthophoto.tif"); }));
    }
    if (path == "points.bin" && opened.survey != nullptr) {
      return Bytes("application/octet-stream", made.Get(prefix + path, [&] { return PointsFile(opened.survey->points); }));
    }
    if (path == "contours.json" && opened.contours) {
      return Bytes("application/json",
                   made.Get(prefix + path, [&] { return ContoursFile(opened.project.SurfaceFolder() / "contours.gpkg", frame()); }));
    }
    return {};
  }

  DataReply Photo(size_t index, std::string_view size) {
    if (main.survey == nullptr || index >= main.survey->photos.size()) return DataReply::NotFound("there is no such photo");
    const std::filesystem::path file = main.survey->photo_root / main.survey->photos[index].name;
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) {
      return DataReply::NotFound(file.string() + " does not exist any more. Put the photo back there");
    }
    const std::string key = "photo " + std::to_string(index) + " " + std::string(size);
    if (size == "thumbnail.jpg") return Bytes("image/jpeg", made.Get(key, [&] { return PhotoPicture(file, 256); }));
    if (size == "photo.jpg") return Bytes("image/jpeg", made.Get(key, [&] { return PhotoPicture(file, 2048); }));
    if (size == "full.jpg" && IsJpeg(file)) return File("image/jpeg", file);
    return DataReply::NotFound("only JPEG photos are sent in full size");
  }

  DataReply Answer(const std::string& path) {
    if (path == "project.json") return Bytes("application/json", Description());
    if (IsDocument(path)) return GetDocument(main, path);
    if (const auto photo = PhotoPath(path)) return Photo(photo->first, photo->second);
    if (path.starts_with("pictures/")) {
      const std::lock_guard lock(engine_mutex);
      for (const auto& [name, png] : pictures) {
        if (name == path) return Bytes("image/png", png);
      }
      return DataReply::NotFound("this picture is not kept any more");
    }
    if (path.starts_with("before/") && before) {
      if (auto reply = ProjectFile(*before, path.substr(7), "before/")) return *std::move(reply);
    }
    if (auto reply = ProjectFile(main, path, "")) return *std::move(reply);
    return DataReply::NotFound("there is nothing of this name");
  }
};

ProjectData::ProjectData(const coordinator::Project& project, const std::optional<coordinator::Project>& before) : impl_(std::make_unique<Impl>()) {
  impl_->main = OpenProject(project);
  impl_->SetSurvey();
  if (before) {
    impl_->before = OpenProject(*before);
    if (impl_->before->georeferenced != impl_->main.georeferenced) {
      impl_->main.description["missing"].push_back(
          {{"what", "place of the earlier survey"},
           {"reason", "only one of the two surveys has a geo-reference, so they cannot be laid over each other"},
           {"advice", "Prepare both with GPS tags, or both without"}});
    }
  }
}

ProjectData::~ProjectData() = default;

DataReply ProjectData::Get(const std::string& path, const std::string& query) {
  const std::lock_guard lock(impl_->mutex);
  try {
    DataReply reply = impl_->Answer(path);
    // A URL with a query names one revision of the file.
    reply.cache = reply.status == 200 && !query.empty();
    return reply;
  } catch (const base::InputError& error) {
    spdlog::warn("{}", error.what());
    return {.status = 404, .content_type = "text/plain; charset=utf-8", .body = error.what(), .file = {}};
  }
}

DataReply ProjectData::Put(const std::string& path, const std::string& body) {
  const std::lock_guard lock(impl_->mutex);
  if (!IsDocument(path)) return {.status = 405, .content_type = "text/plain; charset=utf-8", .body = "only documents can be saved", .file = {}};
  return PutDocument(impl_->main, path, body);
}

std::shared_ptr<const survey::Survey> ProjectData::survey() const {
  const std::lock_guard lock(impl_->engine_mutex);
  return impl_->survey;
}

void ProjectData::Reload() {
  OpenedProject main = OpenProject(impl_->main.project);
  std::optional<OpenedProject> before;
  if (impl_->before) before = OpenProject(impl_->before->project);
  const std::lock_guard lock(impl_->mutex);
  impl_->main = std::move(main);
  impl_->before = std::move(before);
  impl_->SetSurvey();
  impl_->made.Clear();
  ++impl_->revision;
}

std::string ProjectData::AddPicture(std::string png) {
  const std::lock_guard lock(impl_->engine_mutex);
  std::string name = "pictures/" + std::to_string(impl_->next_picture++) + ".png";
  impl_->pictures.emplace_back(name, std::move(png));
  if (impl_->pictures.size() > kPictures) impl_->pictures.pop_front();
  return name;
}

}  // namespace skyquilt::viewer
