// What people make in the viewer and keep in the project folder: measurements.geojson, gcp.json with gcp_list.txt, camera_path.json,
// tour.json.
#pragma once

#include <string>

#include "viewer/data/open_project.h"
#include "viewer/server/server.h"

namespace skyquilt::viewer {

// "measurements.geojson", "gcp.json", "camera_path.json" or "tour.json".
bool IsDocument(const std::string& name);

// 204 while there is none. Without gcp.json a gcp_list.txt of the project or beside its photos is converted. 500 with the reason as text when there
// is a file that cannot be read: a page that took it for none would replace it. The etag is the hash of the file's bytes, of "" when there is none.
DataReply GetDocument(const OpenedProject& opened, const std::string& name);

// Checks the document and replaces the file: at any moment it has its old or its new content. A camera path without views removes it. gcp.json is
// written before gcp_list.txt, which is made from it; lists that were not are kept as gcp_list.txt.orig, gcp_list.txt.orig.2, ... if_match: the etag
// that the client knows, empty: no check. 204 with the new etag, or with the reason as text: 400 (what is wrong), 412 (the file has another etag),
// 409 (no permission to read or write), 507 (disk full), 500; then the file has its old content, unless only gcp_list.txt cannot be written.
DataReply PutDocument(const OpenedProject& opened, const std::string& name, const std::string& body, const std::string& if_match);

}  // namespace skyquilt::viewer
