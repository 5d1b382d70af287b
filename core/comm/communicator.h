// Ranks that send bytes. One process alone has the same interface without MPI traffic. Only this room includes mpi.h.
// Waiting polls with short sleeps, so idle ranks leave their core to those that work.
// Only the thread that called Connect may use a communicator. A large message travels while both sides call Send or TryReceive now and then.
// Destroying it is the orderly end, which every rank must reach: what was sent and not yet received is thrown away. A rank that fails calls Abort.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace skyquilt::comm {

struct Message {
  int source = 0;
  int tag = 0;
  std::string bytes;
};

class Communicator {
 public:
  virtual ~Communicator() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;
  // Ranks that share this node, this one included.
  virtual int local_size() const = 0;
  // Reliable and ordered per (source, tag). Never blocks on the receiver; a rank may send to itself. tag: 0 to 32767; at most 2 GiB.
  // Throws std::runtime_error on a broken link.
  virtual void Send(int destination, int tag, const std::string& bytes) = 0;
  // The next message from anyone, if one has arrived.
  virtual std::optional<Message> TryReceive() = 0;
  // How long somebody who waits for a message may sleep between two looks: not at all while one is arriving, for it comes piece by piece.
  virtual std::chrono::microseconds Nap() const { return std::chrono::milliseconds(1); }
  // Waits until everything sent so far has left; what arrives meanwhile is kept. For a rank that will not look here for a while.
  virtual void Flush() {}
  // Waits for a message; throws base::Interrupted when a cancel is requested and nothing arrives.
  Message Receive();
  // Collective: everybody gets rank 0's bytes. Neither this nor Barrier heeds a cancel: all ranks must come.
  virtual std::string Broadcast(const std::string& bytes_on_root) = 0;
  virtual void Barrier() = 0;
  virtual int64_t bytes_sent() const = 0;
  // Ends all ranks with this status.
  [[noreturn]] virtual void Abort(int exit_status) = 0;
};

// Under an MPI launcher (OMPI_COMM_WORLD_SIZE, PMI_SIZE or PMIX_RANK in the environment) an MPI communicator, otherwise a one-process one.
// Finalises MPI when destroyed.
std::unique_ptr<Communicator> Connect();

}  // namespace skyquilt::comm
