#include "viewer/server/host_list.h"

#include <algorithm>

namespace skyquilt::viewer::server {
namespace {

std::string InBrackets(const std::string& name) {
  return name.find(':') != std::string::npos && name.front() != '[' ? "[" + name + "]" : name;
}

}  // namespace

std::string LowerCase(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

HostList::HostList(const std::string& address, int port, const std::vector<std::string>& extra) {
  Add("127.0.0.1", port);
  Add("localhost", port);
  if (address == "::" || address == "::1") Add("::1", port);
  Add(address, port);
  for (const std::string& name : extra) Add(name, port);
}

void HostList::Add(const std::string& name, int port) {
  if (name.empty()) return;
  const std::string lower = LowerCase(InBrackets(name));
  hosts_.insert(lower + ":" + std::to_string(port));
  // Browsers leave the default port out.
  if (port == 80) hosts_.insert(lower);
}

bool HostList::Allows(std::string_view host) const {
  return hosts_.contains(LowerCase(host));
}

std::string LinkHost(const std::string& address, const std::vector<std::string>& extra) {
  if (address != "0.0.0.0" && address != "::") return InBrackets(address);
  // An IPv4 address is more likely than the name to be known to other machines.
  const auto is_outside_ipv4 = [](const std::string& name) {
    return name.find_first_not_of("0123456789.") == std::string::npos && name.find('.') != std::string::npos && !name.starts_with("127.");
  };
  const auto found = std::find_if(extra.begin(), extra.end(), is_outside_ipv4);
  if (found != extra.end()) return *found;
  return extra.empty() || extra.front().empty() ? "127.0.0.1" : InBrackets(extra.front());
}

}  // namespace skyquilt::viewer::server
