// Sends messages between ranks in every way the program does. Ends with a status other than 0 at the first mismatch.
//   traffic <n>     all exchanges, for n ranks
//   traffic abort   the last rank aborts with status 4 while the others wait for a message
//   traffic stop N  rank N stops itself (SIGSTOP), the others compute: the job must end with kStandstillStatus
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <thread>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/comm/communicator.h"

namespace {

using skyquilt::comm::Communicator;
using skyquilt::comm::Message;

constexpr size_t kLarge = 20'000'000;

void Require(bool condition, const Communicator& ranks, const std::string& what) {
  if (condition) return;
  throw std::runtime_error("rank " + std::to_string(ranks.rank()) + " of " + std::to_string(ranks.size()) + ": " + what);
}

// Bytes that depend on sender and serial number.
std::string Payload(int source, int serial, size_t n_bytes) {
  std::string bytes(n_bytes, '\0');
  uint32_t state = static_cast<uint32_t>(source * 1000 + serial) * 2654435761U + 1U;
  for (char& byte : bytes) {
    state = state * 1664525U + 1013904223U;
    byte = static_cast<char>(state >> 24U);
  }
  return bytes;
}

void CheckOrderOfManySmallMessages(Communicator& ranks) {
  constexpr int kMessages = 200;
  const int next = (ranks.rank() + 1) % ranks.size();
  const int before = (ranks.rank() + ranks.size() - 1) % ranks.size();
  for (int i = 0; i < kMessages; ++i) {
    for (const int tag : {1, 2}) ranks.Send(next, tag, Payload(ranks.rank(), i * tag, static_cast<size_t>(i)));
  }
  std::map<int, int> received;
  for (int i = 0; i < 2 * kMessages; ++i) {
    const Message message = ranks.Receive();
    Require(message.source == before, ranks, "message from rank " + std::to_string(message.source));
    const int serial = received[message.tag]++;
    Require(message.bytes == Payload(before, serial * message.tag, static_cast<size_t>(serial)), ranks, "message out of order or changed");
  }
  Require(received[1] == kMessages && received[2] == kMessages, ranks, "messages lost");
}

// Every rank sends to every rank, itself included, before any rank receives: this works only when Send does not wait for the receiver.
void CheckLargeMessagesCross(Communicator& ranks) {
  const int64_t sent_before = ranks.bytes_sent();
  for (int other = 0; other < ranks.size(); ++other) {
    for (int serial = 0; serial < 2; ++serial) ranks.Send(other, 3, Payload(ranks.rank(), serial, kLarge + static_cast<size_t>(serial)));
    ranks.Send(other, 4, "small");
  }
  ranks.Barrier();
  std::map<int, int> large;
  std::map<int, int> small;
  for (int i = 0; i < 3 * ranks.size(); ++i) {
    const Message message = ranks.Receive();
    if (message.tag == 4) {
      Require(message.bytes == "small" && ++small[message.source] == 1, ranks, "small message");
    } else {
      const int serial = large[message.source]++;
      Require(message.bytes == Payload(message.source, serial, kLarge + static_cast<size_t>(serial)), ranks, "large message out of order or changed");
    }
  }
  Require(static_cast<int>(large.size()) == ranks.size() && static_cast<int>(small.size()) == ranks.size(), ranks, "messages lost");
  Require(ranks.bytes_sent() - sent_before == static_cast<int64_t>((2 * kLarge + 6) * static_cast<size_t>(ranks.size())), ranks,
          "count of bytes sent");
}

void CheckBroadcast(Communicator& ranks) {
  for (const size_t n : {size_t{0}, size_t{1}, size_t{100}, kLarge}) {
    const std::string own = ranks.rank() == 0 ? Payload(0, 9, n) : "only the root's bytes count";
    Require(ranks.Broadcast(own) == Payload(0, 9, n), ranks, "broadcast of " + std::to_string(n) + " bytes");
  }
}

void CheckBarrier(Communicator& ranks) {
  namespace fs = std::filesystem;
  const fs::path folder = ranks.Broadcast((fs::temp_directory_path() / ("skyquilt_traffic_" + std::to_string(getpid()))).string());
  for (int round = 0; round < 20; ++round) {
    fs::create_directories(folder);
    std::ofstream(folder / (std::to_string(round) + "_" + std::to_string(ranks.rank()))) << "here";
    ranks.Barrier();
    for (int other = 0; other < ranks.size(); ++other) {
      Require(fs::exists(folder / (std::to_string(round) + "_" + std::to_string(other))), ranks,
              "left the barrier before rank " + std::to_string(other) + " reached it");
    }
  }
  ranks.Barrier();
  if (ranks.rank() == 0) fs::remove_all(folder);
}

void CheckCancel(Communicator& ranks) {
  ranks.Barrier();
  skyquilt::base::RequestCancel();
  bool interrupted = false;
  try {
    ranks.Receive();
  } catch (const skyquilt::base::Interrupted&) {
    interrupted = true;
  }
  skyquilt::base::ClearCancel();
  Require(interrupted, ranks, "continued to wait although a cancel was requested");
}

// Messages that no rank receives must not keep a rank from ending.
void LeaveMessagesBehind(Communicator& ranks) {
  for (int other = 0; other < ranks.size(); ++other) ranks.Send(other, 7, Payload(ranks.rank(), 7, 5'000'000));
}

}  // namespace

int main(int argc, char** argv) {
  const auto ranks = skyquilt::comm::Connect();
  try {
    if (argc > 1 && std::string(argv[1]) == "abort") {
      if (ranks->rank() == ranks->size() - 1) ranks->Abort(4);
      ranks->Receive();
      return 1;
    }
    if (argc > 2 && std::string(argv[1]) == "stop") {
      ranks->EndAfterStandstill(4.0);
      // Every rank has heard of the limit.
      std::this_thread::sleep_for(std::chrono::seconds(3));
      if (ranks->rank() == std::stoi(argv[2])) raise(SIGSTOP);
      std::this_thread::sleep_for(std::chrono::seconds(30));
      ranks->Abort(1);
    }
    const int expected = argc > 1 ? std::stoi(argv[1]) : 1;
    Require(ranks->size() == expected, *ranks, "expected " + std::to_string(expected) + " ranks");
    Require(ranks->local_size() == expected, *ranks, "all ranks of this test share a node");
    CheckOrderOfManySmallMessages(*ranks);
    ranks->Barrier();
    CheckLargeMessagesCross(*ranks);
    CheckBroadcast(*ranks);
    CheckBarrier(*ranks);
    CheckCancel(*ranks);
    LeaveMessagesBehind(*ranks);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    ranks->Abort(1);
  }
  return 0;
}
