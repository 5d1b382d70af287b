// The names and addresses under which this machine may be reached, for the Host check of a server that listens on all addresses.
#pragma once

#include <string>
#include <vector>

namespace skyquilt::viewer {

// The host name and the addresses of all network interfaces; IPv6 addresses in brackets, without link-local ones.
std::vector<std::string> OwnHosts();

}  // namespace skyquilt::viewer
