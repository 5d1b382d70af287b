#include "viewer/assets.h"

#include "core/base/errors.h"
#include "core/base/file.h"

// Defined in front_end.S.
extern "C" {
extern const char kSkyquiltIndexHtmlBegin[], kSkyquiltIndexHtmlEnd[];
extern const char kSkyquiltAppJsBegin[], kSkyquiltAppJsEnd[];
extern const char kSkyquiltAppCssBegin[], kSkyquiltAppCssEnd[];
extern const char kSkyquiltLicencesTxtBegin[], kSkyquiltLicencesTxtEnd[];
extern const char kSkyquiltTourHtmlBegin[], kSkyquiltTourHtmlEnd[];
extern const char kSkyquiltTourJsBegin[], kSkyquiltTourJsEnd[];
extern const char kSkyquiltTourCssBegin[], kSkyquiltTourCssEnd[];
}

namespace skyquilt::viewer {
namespace {

struct AssetName {
  const char* path;
  const char* file;
  const char* content_type;
};

constexpr AssetName kAssetNames[] = {{"/", "index.html", "text/html; charset=utf-8"},
                                     {"/app.js", "app.js", "text/javascript; charset=utf-8"},
                                     {"/app.css", "app.css", "text/css; charset=utf-8"},
                                     {"/licences.txt", "licences.txt", "text/plain; charset=utf-8"}};

}  // namespace

std::vector<Asset> FrontEnd() {
  const std::string bodies[] = {{kSkyquiltIndexHtmlBegin, kSkyquiltIndexHtmlEnd},
                                {kSkyquiltAppJsBegin, kSkyquiltAppJsEnd},
                                {kSkyquiltAppCssBegin, kSkyquiltAppCssEnd},
                                {kSkyquiltLicencesTxtBegin, kSkyquiltLicencesTxtEnd}};
  if (bodies[0].empty() || bodies[1].empty()) return {};
  std::vector<Asset> assets;
  for (size_t i = 0; i < std::size(kAssetNames); ++i) assets.push_back({kAssetNames[i].path, kAssetNames[i].content_type, bodies[i]});
  return assets;
}

std::vector<Asset> FrontEndFrom(const std::filesystem::path& folder) {
  std::vector<Asset> assets;
  for (const AssetName& name : kAssetNames) assets.push_back({name.path, name.content_type, base::ReadFile(folder / name.file)});
  return assets;
}

std::vector<tour::PageFile> TourPage(const std::filesystem::path& folder) {
  if (!folder.empty()) {
    return {{"index.html", base::ReadFile(folder / "tour.html")},
            {"tour.js", base::ReadFile(folder / "tour.js")},
            {"tour.css", base::ReadFile(folder / "tour.css")},
            {"licences.txt", base::ReadFile(folder / "licences.txt")}};
  }
  std::vector<tour::PageFile> page = {{"index.html", {kSkyquiltTourHtmlBegin, kSkyquiltTourHtmlEnd}},
                                      {"tour.js", {kSkyquiltTourJsBegin, kSkyquiltTourJsEnd}},
                                      {"tour.css", {kSkyquiltTourCssBegin, kSkyquiltTourCssEnd}},
                                      {"licences.txt", {kSkyquiltLicencesTxtBegin, kSkyquiltLicencesTxtEnd}}};
  if (page[0].content.empty() || page[1].content.empty()) {
    throw base::UsageError(
        "this program was built without the page of tours, because Node.js or npm's packages were missing. "
        "Install the Debian packages nodejs and npm and build again while the network is up");
  }
  return page;
}

}  // namespace skyquilt::viewer
