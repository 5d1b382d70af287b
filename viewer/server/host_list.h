// The Host headers that are accepted. A page of another site can make its own name point to 127.0.0.1 (DNS rebinding); its requests then arrive here
// with that name as Host, and only this list tells them from our own.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace skyquilt::viewer::server {

// ASCII letters only.
std::string LowerCase(std::string_view text);

class HostList {
 public:
  // address: the numeric address that the server listens on. extra: names or addresses without port; IPv6 with or without brackets.
  HostList(const std::string& address, int port, const std::vector<std::string>& extra);

  // `host` is the Host header: name and port. Upper and lower case are the same.
  bool Allows(std::string_view host) const;

 private:
  void Add(const std::string& name, int port);
  std::set<std::string> hosts_;  // lower case, with the port
};

// The part of a link before the port: the address, or for a server on all addresses one under which others reach it.
std::string LinkHost(const std::string& address, const std::vector<std::string>& extra);

// Under which this machine may be reached, for a server that listens on all addresses: the host name and the addresses of all network interfaces;
// IPv6 addresses in brackets, without link-local ones.
std::vector<std::string> OwnHosts();

}  // namespace skyquilt::viewer::server
