#include "viewer/server/host_list.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <memory>

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

namespace {

// Text of an interface's address; empty for other families and link-local addresses, which need a zone that browsers do not send.
std::string HostText(const sockaddr* address) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (address == nullptr) return "";
  if (address->sa_family == AF_INET) {
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(address)->sin_addr, text.data(), text.size());
    return text.data();
  }
  if (address->sa_family == AF_INET6) {
    const in6_addr& bytes = reinterpret_cast<const sockaddr_in6*>(address)->sin6_addr;
    if (IN6_IS_ADDR_LINKLOCAL(&bytes)) return "";
    inet_ntop(AF_INET6, &bytes, text.data(), text.size());
    return "[" + std::string(text.data()) + "]";
  }
  return "";
}

}  // namespace

std::vector<std::string> OwnHosts() {
  std::vector<std::string> hosts;
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) == 0 && name[0] != '\0') hosts.emplace_back(name.data());
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return hosts;
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(first, &freeifaddrs);
  for (const ifaddrs* one = first; one != nullptr; one = one->ifa_next) {
    const std::string host = HostText(one->ifa_addr);
    if (!host.empty() && std::find(hosts.begin(), hosts.end(), host) == hosts.end()) hosts.push_back(host);
  }
  return hosts;
}

}  // namespace skyquilt::viewer::server
