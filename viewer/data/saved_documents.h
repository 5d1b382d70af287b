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

// Checks the document and replaces the file: at any moment it has its old or its new content. A camera path without views removes it. gcp.json is
// written before gcp_list.txt, which is made from it; a list that was not is kept once as gcp_list.txt.orig. 204, or with the reason as text: 400
// (what is wrong), 409 (the folder cannot be written), 507 (disk full), 500; then the file has its old content.
DataReply PutDocument(const OpenedProject& opened, const std::string& name, const std::string& body);

}  // namespace skyquilt::viewer
