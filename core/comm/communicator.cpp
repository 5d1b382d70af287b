#include "core/comm/communicator.h"

#include <cstdio>
#include <cstdlib>
#include <thread>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/comm/mpi_communicator.h"

namespace skyquilt::comm {
namespace {

bool UnderMpiLauncher() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"}) {
    if (std::getenv(name) != nullptr) return true;
  }
  return false;
}

}  // namespace

void SingleCommunicator::Send(int destination, int tag, const std::string& bytes) {
  SKYQUILT_CHECK(destination == 0, "rank " + std::to_string(destination) + " of 1");
  inbox_.push_back({0, tag, bytes});
  bytes_sent_ += static_cast<int64_t>(bytes.size());
}

std::optional<Message> SingleCommunicator::TryReceive() {
  if (inbox_.empty()) return std::nullopt;
  Message message = std::move(inbox_.front());
  inbox_.pop_front();
  return message;
}

void SingleCommunicator::Abort(int exit_status) {
  base::FlushLog();
  std::fflush(nullptr);
  std::_Exit(exit_status);
}

Message Communicator::Receive() {
  for (;;) {
    if (std::optional<Message> message = TryReceive()) return std::move(*message);
    base::ThrowIfCancelled();
    std::this_thread::sleep_for(PollInterval());
  }
}

std::string Communicator::NameOf(int rank) const {
  const std::string host = HostOf(rank);
  return "rank " + std::to_string(rank) + (host.empty() ? "" : " on " + host);
}

std::unique_ptr<Communicator> Connect() {
  if (UnderMpiLauncher()) return ConnectMpi();
  return std::make_unique<SingleCommunicator>();
}

}  // namespace skyquilt::comm
