#include "viewer/data/project_data.h"

#include <charconv>
#include <deque>
#include <functional>
#include <list>
#include <string_view>
#include <utility>

#include "core/base/errors.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "viewer/data/data_replies.h"
#include "viewer/data/describe_buildings.h"
#include "viewer/data/map_files.h"
#include "viewer/data/open_project.h"
#include "viewer/data/photo_pictures.h"
#include "viewer/data/saved_documents.h"
#include "viewer/data/tour_assets.h"

namespace skyquilt::viewer {
namespace {

namespace fs = std::filesystem;

constexpr size_t kCacheBytes = 64U << 20U;
constexpr size_t kPictures = 8;

// Files that were made on demand, the least recently used ones are dropped first.
class MadeFiles {
 public:
  // `make` is called when the file is not kept.
  std::shared_ptr<const std::string> Get(const std::string& name, const std::function<std::string()>& make) {
    for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
      if (entry->first != name) continue;
      entries_.splice(entries_.begin(), entries_, entry);
      return entry->second;
    }
    auto content = std::make_shared<const std::string>(make());
    entries_.emplace_front(name, content);
    bytes_ += content->size();
    while (bytes_ > kCacheBytes) {
      bytes_ -= entries_.back().second->size();
      entries_.pop_back();
    }
    return content;
  }
  void Clear() {
    entries_.clear();
    bytes_ = 0;
  }

 private:
  std::list<std::pair<std::string, std::shared_ptr<const std::string>>> entries_;
  size_t bytes_ = 0;
};

DataReply Bytes(const std::string& type, std::string body) {
  return {.status = 200, .content_type = type, .body = std::move(body), .file = {}};
}

DataReply Kept(const std::string& type, std::shared_ptr<const std::string> content) {
  return {.status = 200, .content_type = type, .body = "", .file = {}, .kept = std::move(content)};
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

// What is served: one reading of the files. Replaced as a whole when they have changed.
struct Served {
  OpenedProject main;
  std::optional<OpenedProject> before;
  uint32_t revision = 0;
  MadeFiles made;  // only for the thread that answers
};

void RefuseStrangers(Served* served) {
  if (!served->before || served->before->georeferenced == served->main.georeferenced) return;
  served->main.description["missing"].push_back(
      {{"what", "place of the earlier survey"},
       {"reason", "only one of the two surveys has a geo-reference, so they cannot be laid over each other"},
       {"advice", "Prepare both with GPS tags, or both without"}});
}

std::shared_ptr<Served> Open(const coordinator::Project& project, const std::optional<coordinator::Project>& before, const Served* earlier) {
  auto served = std::make_shared<Served>();
  served->main = OpenProject(project, earlier != nullptr ? &earlier->main : nullptr);
  if (before) served->before = OpenProject(*before, earlier != nullptr && earlier->before ? &*earlier->before : nullptr);
  served->revision = earlier != nullptr ? earlier->revision + 1 : 0;
  RefuseStrangers(served.get());
  return served;
}

std::string Description(const Served& served) {
  nlohmann::json json = served.main.description;
  json["revision"] = served.revision;
  json["before"] = nullptr;
  if (served.before) {
    nlohmann::json earlier = served.before->description;
    earlier["revision"] = served.revision;
    earlier["enu_from_before"] = EnuFromOther(served.main, *served.before);
    // Its URLs are relative to /data/ as well.
    for (const char* key : {"tiles", "terrain", "orthophoto", "points", "contours"}) {
      if (earlier[key].is_string()) earlier[key] = "before/" + earlier[key].get<std::string>();
    }
    if (earlier["buildings"].is_object()) {
      earlier["buildings"]["url"] = "before/" + earlier["buildings"]["url"].get<std::string>();
      for (nlohmann::json& file : earlier["buildings"]["files"]) file = "before/" + file.get<std::string>();
    }
    json["before"] = std::move(earlier);
  }
  return base::JsonText(json);
}

// The files that both projects have. `prefix`: of their names in the cache.
DataReply ProjectFile(MadeFiles* made, const OpenedProject& opened, const std::string& path, const std::string& prefix) {
  if (path.starts_with("tiles/")) {
    const std::string name = path.substr(6);
    if (!opened.tiles.contains(name)) return DataReply::NotFound("there is no such tile");
    if (name == "tileset.json") {
      return Kept("application/json", made->Get(prefix + path, [&] { return TilesetFile(opened.project.SurfaceFolder() / "tiles" / name); }));
    }
    return File("model/gltf-binary", opened.project.SurfaceFolder() / "tiles" / name);
  }
  if (path.starts_with("buildings/")) {
    const std::string name = path.substr(10);
    if (!opened.buildings.contains(name)) return DataReply::NotFound("there is no such file of buildings");
    return File(opening::BuildingFileType(name), opened.project.BuildingsFolder() / name);
  }
  const fs::path products = opened.project.ProductsFolder();
  const auto frame = [&] { return SurveyFrame(opened.origin, opened.georeferenced); };
  if (path == "terrain.bin" && opened.terrain) {
    return Kept("application/octet-stream", made->Get(prefix + path, [&] { return TerrainFile(products / "dsm.tif", frame()); }));
  }
  if (path == "orthophoto.jpg" && opened.orthophoto) {
    return Kept("image/jpeg", made->Get(prefix + path, [&] { return OrthophotoFile(products / "orthophoto.tif", products / "dsm.tif"); }));
  }
  if (path == "points.bin" && opened.survey != nullptr && !opened.survey->points.empty()) {
    return Kept("application/octet-stream", made->Get(prefix + path, [&] { return PointsFile(opened.survey->points); }));
  }
  if (path == "contours.json" && opened.contours) {
    return Kept("application/json",
                made->Get(prefix + path, [&] { return ContoursFile(opened.project.SurfaceFolder() / "contours.gpkg", frame()); }));
  }
  return DataReply::NotFound("there is nothing of this name");
}

DataReply Photo(Served* served, size_t index, std::string_view size) {
  const survey::Survey* survey = served->main.survey.get();
  if (survey == nullptr || index >= survey->photos.size()) return DataReply::NotFound("there is no such photo");
  const fs::path file = PhotoFile(*survey, survey->photos[index]);
  if (file.empty()) return DataReply::NotFound("this photo is not in the folder of the photos");
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return DataReply::NotFound(file.string() + " does not exist any more. Put the photo back there");
  const std::string key = "photo " + std::to_string(index) + " " + std::string(size);
  if (size == "thumbnail.jpg") return Kept("image/jpeg", served->made.Get(key, [&] { return PhotoPicture(file, 256); }));
  if (size == "photo.jpg") return Kept("image/jpeg", served->made.Get(key, [&] { return PhotoPicture(file, 2048); }));
  if (size == "full.jpg" && IsJpeg(file)) return File("image/jpeg", file);
  return DataReply::NotFound("only JPEG photos are sent in full size");
}

DataReply Answer(Served* served, const std::string& path) {
  if (path == "project.json") return Bytes("application/json", Description(*served));
  if (IsDocument(path)) return GetDocument(served->main, path);
  if (IsAssetPath(path)) return GetAsset(served->main.project.folder, path);
  if (const auto photo = PhotoPath(path)) return Photo(served, photo->first, photo->second);
  if (!path.starts_with("before/")) return ProjectFile(&served->made, served->main, path, "");
  if (!served->before) return DataReply::NotFound("there is no earlier project");
  return ProjectFile(&served->made, *served->before, path.substr(7), "before/");
}

}  // namespace

struct ProjectData::Impl {
  std::mutex answering;  // while a file is made, for which the engine must not wait
  SentBodies sent;       // guarded by answering
  mutable std::mutex mutex;
  std::shared_ptr<Served> served;
  std::deque<std::pair<std::string, std::shared_ptr<const std::string>>> pictures;
  size_t next_picture = 0;

  std::shared_ptr<Served> Current() const {
    const std::lock_guard lock(mutex);
    return served;
  }
  DataReply Picture(const std::string& path) const {
    const std::lock_guard lock(mutex);
    for (const auto& [name, png] : pictures) {
      if (name == path) return Kept("image/png", png);
    }
    return DataReply::NotFound("this picture is not kept any more");
  }
};

ProjectData::ProjectData(const coordinator::Project& project, const std::optional<coordinator::Project>& before) : impl_(std::make_unique<Impl>()) {
  impl_->served = Open(project, before, nullptr);
}

ProjectData::~ProjectData() = default;

DataReply ProjectData::Get(const std::string& path, const std::string& query) {
  if (path.starts_with("pictures/")) return impl_->Picture(path);
  const std::lock_guard lock(impl_->answering);
  const std::shared_ptr<Served> served = impl_->Current();
  try {
    DataReply reply = Answer(served.get(), path);
    // A URL with a query names one revision of a file, as the digest in the name of an asset does; what can be saved, and the description, are always
    // asked for.
    reply.cache = reply.cache || (reply.status == 200 && !query.empty() && path != "project.json" && !IsDocument(path));
    return reply;
  } catch (const base::InputError& error) {
    base::LogWarning("{}", error.what());
    return DataReply::NotFound(error.what());
  }
}

DataReply ProjectData::Put(const std::string& path, const std::string& body, const std::string& if_match) {
  const bool converts = path == "gcp_list.txt";
  if (!IsDocument(path) && !IsAssetPath(path) && !converts) return TextReply(405, "only documents and the files of a tour can be saved");
  const std::lock_guard lock(impl_->answering);
  const std::shared_ptr<Served> served = impl_->Current();
  const OpenedProject& opened = served->main;
  if (converts) return ConvertGcpList(opened, body);
  if (!IsDocument(path)) return PutAsset(opened.project.folder, path, body);
  DataReply reply = PutDocument(opened, path, body, impl_->sent.Resolved(path, if_match));
  if (reply.status == 204) impl_->sent.Remember(path, body, reply.etag);
  return reply;
}

std::shared_ptr<const survey::Survey> ProjectData::survey() const {
  return impl_->Current()->main.survey;
}

void ProjectData::Reload() {
  const std::shared_ptr<Served> earlier = impl_->Current();
  const auto before = earlier->before ? std::optional(earlier->before->project) : std::nullopt;
  std::shared_ptr<Served> served = Open(earlier->main.project, before, earlier.get());
  const std::lock_guard lock(impl_->mutex);
  impl_->served = std::move(served);
}

std::string ProjectData::AddPicture(std::string png) {
  const std::lock_guard lock(impl_->mutex);
  std::string name = "pictures/" + std::to_string(impl_->next_picture++) + ".png";
  impl_->pictures.emplace_back(name, std::make_shared<const std::string>(std::move(png)));
  if (impl_->pictures.size() > kPictures) impl_->pictures.pop_front();
  return name;
}

}  // namespace skyquilt::viewer
