// Messages of bytes between ranks (MPI processes). A single process has the same interface without MPI, so that callers need not tell the two apart.
// Only core/comm includes mpi.h. Waiting polls with short sleeps, so that waiting ranks do not use a core that others need.
// Only the thread that called Connect may use a communicator. A large message is transferred only while both sides call Send, TryReceive or Flush.
// The destructor waits for all ranks and drops messages that were not received. A rank that fails must call Abort instead.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

namespace skyquilt::comm {

// The job ended because a rank stood still: run it again, it resumes (skyquilt-mpirun does).
inline constexpr int kStandstillStatus = 75;

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
  // Number of ranks on this node, including this one.
  virtual int local_size() const = 0;
  // The machine of a rank; empty where there is only one.
  virtual std::string HostOf(int /*rank*/) const { return ""; }
  // "rank 2 on node7", for messages.
  std::string NameOf(int rank) const;
  // On rank 0: for how long a rank may stand still before the job ends with kStandstillStatus (life_signs.h); 0: for ever.
  virtual void EndAfterStandstill(double /*seconds*/) {}
  // Messages of the same source and tag arrive in order. Does not wait for the receiver; a rank may send to itself. tag: 0 to 32767; at most 2 GiB.
  // Throws std::runtime_error when the connection fails.
  virtual void Send(int destination, int tag, const std::string& bytes) = 0;
  // The next message that has arrived from any rank; nothing if there is none.
  virtual std::optional<Message> TryReceive() = 0;
  // How long a loop that waits for a message should sleep between two calls of TryReceive; 0 while one is being received (takes many calls).
  virtual std::chrono::microseconds PollInterval() const { return std::chrono::milliseconds(1); }
  // Waits until everything sent so far is transferred; messages that arrive in the meantime are kept. Call before long work without other calls.
  virtual void WaitUntilSent() {}
  // Waits for a message. Throws base::Interrupted when cancelled and no message has arrived.
  Message Receive();
  // Collective calls: all ranks must make them, and they cannot be cancelled. Broadcast returns rank 0's bytes on every rank.
  virtual std::string Broadcast(const std::string& bytes_on_root) = 0;
  virtual void Barrier() = 0;
  virtual int64_t bytes_sent() const = 0;
  // Ends all ranks at once with this exit status.
  [[noreturn]] virtual void Abort(int exit_status) = 0;
};

// Of this process alone.
class SingleCommunicator : public Communicator {
 public:
  int rank() const override { return 0; }
  int size() const override { return 1; }
  int local_size() const override { return 1; }
  void Send(int destination, int tag, const std::string& bytes) override;
  std::optional<Message> TryReceive() override;
  std::string Broadcast(const std::string& bytes_on_root) override { return bytes_on_root; }
  void Barrier() override {}
  int64_t bytes_sent() const override { return bytes_sent_; }
  [[noreturn]] void Abort(int exit_status) override;

 private:
  std::deque<Message> inbox_;
  int64_t bytes_sent_ = 0;
};

// An MPI communicator when started by an MPI launcher (OMPI_COMM_WORLD_SIZE, PMI_SIZE or PMIX_RANK in the environment), otherwise one for a single
// process. Its destructor finalises MPI.
std::unique_ptr<Communicator> Connect();

}  // namespace skyquilt::comm
