// What people make in the viewer and keep in the project folder: measurements.geojson, gcp.json with gcp_list.txt, camera_path.json,
// tour.json.
#pragma once

#include <map>
#include <string>

#include "core/base/file.h"
#include "viewer/data/open_project.h"
#include "viewer/server/server.h"

namespace skyquilt::viewer {

// "measurements.geojson", "gcp.json", "camera_path.json" or "tour.json".
bool IsDocument(const std::string& name);

// 204 while there is none. Without gcp.json a gcp_list.txt of the project or beside its photos is converted. 500 with the reason as text when there
// is a file that cannot be read: a page that took it for none would replace it. The etag is the hash of the file's bytes, of "" when there is none.
DataReply GetDocument(const OpenedProject& opened, const std::string& name);

// Checks the document and replaces the file: at any moment it has its old or its new content. A camera path without views removes it. gcp.json is
// written before gcp_list.txt, which is made from it; lists that were not are kept as gcp_list.txt.orig, gcp_list.txt.orig.2, ... if_match: etags
// separated by spaces, one of which the file must have; empty: no check. 204 with the new etag, or with the reason as text: 400 (what is wrong), 412
// (the file has another etag), 409 (no permission to read or write), 507 (disk full), 500; then the file has its old content, unless only
// gcp_list.txt cannot be written.
DataReply PutDocument(const OpenedProject& opened, const std::string& name, const std::string& body, const std::string& if_match);

// 200 with the text of a gcp_list.txt as gcp.json, see ReadGcpList; 400 with the reason as text. Saves nothing.
DataReply ConvertGcpList(const OpenedProject& opened, const std::string& text);

// What a document was saved as last. A page that is left while it saves does not know the etag of what it has sent; it names the hash of that body.
class SentBodies {
 public:
  void Remember(const std::string& name, const std::string& body, const std::string& etag) { last_[name] = {base::HashHex(body), etag}; }
  // if_match with the hash of the body that was saved last replaced by the etag that the file got from it.
  std::string Resolved(const std::string& name, const std::string& if_match) const;

 private:
  struct Sent {
    std::string body, etag;
  };
  std::map<std::string, Sent> last_;
};

}  // namespace skyquilt::viewer
