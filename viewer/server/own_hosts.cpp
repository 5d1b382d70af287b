#include "viewer/server/own_hosts.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <memory>

namespace skyquilt::viewer {
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

}  // namespace skyquilt::viewer
