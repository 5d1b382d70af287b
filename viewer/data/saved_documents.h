// What people make in the viewer and keep in the project folder: measurements.geojson, gcp.json with gcp_list.txt, camera_path.json.
#pragma once

#include <string>

#include "viewer/data/open_project.h"
#include "viewer/server/server.h"

namespace skyquilt::viewer {

// "measurements.geojson", "gcp.json" or "camera_path.json".
bool IsDocument(const std::string& name);

// 204 while there is none. Without gcp.json a gcp_list.txt of the project or beside its photos is converted.
DataReply GetDocument(const OpenedProject& opened, const std::string& name);

// Checks the document and replaces the file: at any moment it has its old or its new content. gcp_list.txt is written after gcp.json; a list that was
// not made from it is kept once as gcp_list.txt.orig. 204, or 400 with what is wrong, 403 (read-only), 507 (disk full); then nothing has changed.
DataReply PutDocument(const OpenedProject& opened, const std::string& name, const std::string& body);

}  // namespace skyquilt::viewer
