// Decides what happens with a request, from its head alone.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "viewer/server/access.h"
#include "viewer/server/answer.h"
#include "viewer/server/host_list.h"
#include "viewer/server/server.h"

namespace skyquilt::viewer::server {

enum class Method { kGet, kHead, kPut, kOther };

// The head of a request. Headers that must be there once are lists, so that a second one is seen.
struct RequestHead {
  Method method = Method::kOther;
  std::string target;
  std::vector<std::string> hosts, origins, cookies;
  bool upgrade = false;   // asks for a WebSocket
  bool has_body = false;  // a body that is not empty follows
};

enum class Action { kAnswer, kGetData, kPutData, kOpenWebsocket };

constexpr size_t kMaxDocumentBytes = 1U << 20U;

struct Decision {
  Action action = Action::kAnswer;
  Answer answer;            // for kAnswer
  std::string path, query;  // for DataSource
  std::string host;         // the Host header, once it was found in the list
  bool trusted = false;     // has a valid cookie
  bool upload = false;      // kPutData with a body of up to kMaxUploadBytes, else kMaxDocumentBytes
};

class Router {
 public:
  // link_used is called after a token was exchanged.
  Router(const std::vector<Asset>& assets, HostList hosts, Access& access, std::function<void(Right)> link_used);

  Decision Decide(const RequestHead& head, Access::Clock::time_point now) const;

 private:
  // Fills in the answer to a request with a valid host and target; requests with a valid cookie only.
  void DecideTrusted(const RequestHead& head, Right right, const std::string& path, const std::string& query, Decision& decision) const;
  void DecideData(const RequestHead& head, Right right, const std::string& query, Decision& decision) const;
  Answer AnswerToken(const std::string& token, bool trusted, Access::Clock::time_point now) const;

  std::map<std::string, Answer> assets_;
  HostList hosts_;
  Access& access_;
  std::function<void(Right)> link_used_;
};

}  // namespace skyquilt::viewer::server
