#include "viewer/server/router.h"

#include <optional>
#include <string_view>
#include <utility>

#include "viewer/server/request_target.h"

namespace skyquilt::viewer::server {
namespace {

constexpr std::string_view kDataPrefix = "/data/";
constexpr std::string_view kRights = "rights.json", kTour = "tour.json", kTourFolder = "tour/", kUploads = "tour/assets/";
constexpr size_t kMaxDataPath = 200, kMaxDataQuery = 100;

Answer WrongHost() {
  return PageAnswer(403, "Open the link as it is printed",
                    {"The viewer answers only under the address in the link that it printed in the terminal.",
                     "If you forward the port from another machine, use the same port number on both sides, for instance: "
                     "ssh -t -L 8000:127.0.0.1:8000 host skyquilt view out --port 8000"});
}

Answer NeedsLink() {
  return PageAnswer(403, "This viewer needs its link",
                    {"Copy the newest link from the terminal where skyquilt view runs, and open it in this browser. A link works once.",
                     "If you have just opened that link from another page, continue here:"},
                    "Open the viewer");
}

Answer UsedLink() {
  return PageAnswer(403, "This link does not work any more",
                    {"Each link works once, and only while its viewer runs. Copy the newest link from the terminal where skyquilt view runs."});
}

Answer TooManyGuesses() {
  Answer answer = PageAnswer(429, "Too many wrong links", {"Open the newest link from the terminal where skyquilt view runs."});
  answer.headers.emplace_back("Retry-After", "60");
  return answer;
}

Answer ToStart() {
  Answer answer = PlainAnswer(303, "see /");
  answer.headers.emplace_back("Location", "/");
  return answer;
}

Answer WrongMethod(const std::string& allowed) {
  Answer answer = PlainAnswer(405, "this method is not allowed here");
  answer.headers.emplace_back("Allow", allowed);
  return answer;
}

// For the page, so that it offers only what this session may do.
Answer RightsAnswer(Right right) {
  const bool tour = right == Right::kEdit, documents = tour || right == Right::kView;
  Answer answer =
      PlainAnswer(200, std::string(R"({"documents": )") + (documents ? "true" : "false") + R"(, "tour": )" + (tour ? "true" : "false") + "}");
  answer.content_type = "application/json";
  return answer;
}

// Why this session may not change this; null when it may.
const char* WhyNotChange(Right right, const std::string& path) {
  const bool of_tour = path == kTour || path.starts_with(kTourFolder);
  switch (right) {
    case Right::kEdit:
      return nullptr;
    case Right::kView:
      return of_tour ? "start the viewer with --edit to change the tour" : nullptr;
    case Right::kPlay:
      break;
  }
  return "this link is for looking and playing only: open the link for editing to change something";
}

// Browsers send with the Origin header which page makes a request; other pages' requests must not change anything or read the WebSocket.
bool IsOwnOrigin(const std::vector<std::string>& origins, const std::string& host) {
  return origins.size() == 1 && LowerCase(origins.front()) == "http://" + LowerCase(host);
}

}  // namespace

Router::Router(const std::vector<Asset>& assets, HostList hosts, Access& access, std::function<void(Right)> link_used)
    : hosts_(std::move(hosts)), access_(access), link_used_(std::move(link_used)) {
  for (const Asset& asset : assets) {
    assets_[asset.path] = {.status = 200, .content_type = asset.content_type, .body = std::make_shared<const std::string>(asset.body), .file = {}};
  }
}

Decision Router::Decide(const RequestHead& head, Access::Clock::time_point now) const {
  Decision decision;
  if (head.hosts.size() != 1 || !hosts_.Allows(head.hosts.front())) {
    decision.answer = WrongHost();
    return decision;
  }
  decision.host = LowerCase(head.hosts.front());
  if (head.target.size() > kMaxTargetBytes) {
    decision.answer = PlainAnswer(414, "the address is too long");
    return decision;
  }
  const auto target = ParseTarget(head.target);
  if (!target) {
    decision.answer = PlainAnswer(400, "this address is not allowed");
    return decision;
  }
  const std::optional<Right> right = access_.SessionRight(head.cookies);
  decision.trusted = right.has_value();
  const auto token = QueryValue(target->query, "token");
  if (token && head.method == Method::kGet && target->path == "/") {
    decision.answer = AnswerToken(*token, decision.trusted, now);
  } else if (!right) {
    decision.answer = NeedsLink();
  } else {
    DecideTrusted(head, *right, target->path, target->query, decision);
  }
  return decision;
}

Answer Router::AnswerToken(const std::string& token, bool trusted, Access::Clock::time_point now) const {
  Access::Grant grant;
  switch (access_.TryToken(token, trusted, now, grant)) {
    case Access::Exchange::kGranted: {
      Answer answer = ToStart();
      answer.headers.emplace_back("Set-Cookie", grant.set_cookie);
      link_used_(grant.right);
      return answer;
    }
    case Access::Exchange::kTooManyGuesses:
      return TooManyGuesses();
    case Access::Exchange::kWrong:
      break;
  }
  return trusted ? ToStart() : UsedLink();
}

void Router::DecideData(const RequestHead& head, Right right, const std::string& query, Decision& decision) const {
  const std::string& path = decision.path;
  if (path.empty() || path.size() > kMaxDataPath) {
    decision.answer = PlainAnswer(404, "there is no such file");
  } else if (query.size() > kMaxDataQuery) {
    decision.answer = PlainAnswer(414, "the address is too long");
  } else if (head.method != Method::kPut) {
    if (path == kRights) {
      decision.answer = RightsAnswer(right);
    } else {
      decision.action = Action::kGetData;
    }
  } else if (!IsOwnOrigin(head.origins, decision.host)) {
    decision.answer = PlainAnswer(403, "only the viewer's own page may change documents");
  } else if (const char* reason = WhyNotChange(right, path)) {
    decision.answer = PlainAnswer(403, reason);
  } else {
    decision.action = Action::kPutData;
    decision.upload = path.starts_with(kUploads);
  }
}

void Router::DecideTrusted(const RequestHead& head, Right right, const std::string& path, const std::string& query, Decision& decision) const {
  const bool reads = head.method == Method::kGet || head.method == Method::kHead;
  const bool is_data = path.starts_with(kDataPrefix);
  if (!reads && !(head.method == Method::kPut && is_data)) {
    decision.answer = WrongMethod(is_data ? "GET, HEAD, PUT" : "GET, HEAD");
  } else if (reads && head.has_body) {
    decision.answer = PlainAnswer(400, "a request that reads has no body");
  } else if (is_data) {
    decision.path = path.substr(kDataPrefix.size());
    decision.query = query;
    DecideData(head, right, query, decision);
  } else if (path == "/ws") {
    if (!IsOwnOrigin(head.origins, decision.host)) {
      decision.answer = PlainAnswer(403, "only the viewer's own page may connect");
    } else if (head.upgrade) {
      decision.action = Action::kOpenWebsocket;
    } else {
      decision.answer = PlainAnswer(426, "this address is for a WebSocket");
      decision.answer.headers.emplace_back("Upgrade", "websocket");
    }
  } else if (const auto asset = assets_.find(path); asset != assets_.end()) {
    decision.answer = asset->second;
  } else if (path == "/favicon.ico") {
    // Browsers ask for it on their own; 404 would be an error in their console.
    decision.answer.status = 204;
  } else {
    decision.answer = PlainAnswer(404, "there is no such file");
  }
}

}  // namespace skyquilt::viewer::server
