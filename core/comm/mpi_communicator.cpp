#include "core/comm/mpi_communicator.h"

#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <list>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/system.h"
#include "core/comm/life_signs.h"

namespace skyquilt::comm {
namespace {

void Check(int status, const char* what) {
  if (status == MPI_SUCCESS) return;
  char text[MPI_MAX_ERROR_STRING] = "";
  int length = 0;
  MPI_Error_string(status, text, &length);
  throw std::runtime_error(std::string("MPI: ") + what + " failed (" + text + ")");
}

void SleepShortly() {
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

int Count(size_t n_bytes) {
  SKYQUILT_CHECK(n_bytes <= INT_MAX, "a message of " + std::to_string(n_bytes) + " bytes; MPI allows at most " + std::to_string(INT_MAX));
  return static_cast<int>(n_bytes);
}

// The host of each rank.
std::vector<std::string> GatherHosts(MPI_Comm comm, int size) {
  constexpr size_t kLongest = 256;
  std::string own = base::HostName();
  own.resize(kLongest);
  own.back() = '\0';
  std::string all(kLongest * static_cast<size_t>(size), '\0');
  Check(MPI_Allgather(own.data(), kLongest, MPI_CHAR, all.data(), kLongest, MPI_CHAR, comm), "start");
  std::vector<std::string> hosts;
  for (size_t i = 0; i < static_cast<size_t>(size); ++i) hosts.emplace_back(all.c_str() + i * kLongest);
  return hosts;
}

// A message being sent or received; its buffer must keep its address until the request is done.
struct Transfer {
  MPI_Request request = MPI_REQUEST_NULL;
  Message message;
  bool done = false;

  bool Test() {
    if (!done) {
      int flag = 0;
      Check(MPI_Test(&request, &flag, MPI_STATUS_IGNORE), "transfer");
      done = flag != 0;
    }
    return done;
  }
};

// The signs of life have a thread of their own, so every call of MPI holds a lock; none waits.
class MpiCommunicator : public Communicator {
 public:
  MpiCommunicator() {
    int already = 0;
    MPI_Initialized(&already);
    SKYQUILT_CHECK(already == 0, "Connect may be called once per process");
    // Direct copies between processes need ptrace permission, which containers often lack; Open MPI then fails on large messages.
    setenv("OMPI_MCA_btl_vader_single_copy_mechanism", "none", 0);
    int provided = 0;
    Check(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided), "start");
    Check(MPI_Comm_dup(MPI_COMM_WORLD, &comm_), "start");
    Check(MPI_Comm_set_errhandler(comm_, MPI_ERRORS_RETURN), "start");
    Check(MPI_Comm_rank(comm_, &rank_), "start");
    Check(MPI_Comm_size(comm_, &size_), "start");
    MPI_Comm node = MPI_COMM_NULL;
    Check(MPI_Comm_split_type(comm_, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &node), "start");
    Check(MPI_Comm_size(node, &local_size_), "start");
    MPI_Comm_free(&node);
    hosts_ = GatherHosts(comm_, size_);
    Check(MPI_Comm_dup(comm_, &life_), "start");
    if (size_ > 1 && provided >= MPI_THREAD_SERIALIZED) signs_ = std::make_unique<LifeSigns>(mpi_, life_, hosts_);
  }

  ~MpiCommunicator() override {
    try {
      // Receive while waiting, because other ranks may still be sending to this one.
      while (!outgoing_.empty()) {
        Discard();
        SleepShortly();
      }
      Barrier();
      while (Discard(), !incoming_.empty()) SleepShortly();
      signs_.reset();
      MPI_Comm_free(&life_);
      MPI_Comm_free(&comm_);
      MPI_Finalize();
    } catch (const std::exception& error) {
      base::LogError("{}", error.what());
    }
  }

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  int local_size() const override { return local_size_; }
  std::string HostOf(int rank) const override { return hosts_.at(static_cast<size_t>(rank)); }
  void EndAfterStandstill(double seconds) override {
    if (signs_) signs_->SetLimit(seconds);
  }

  void Send(int destination, int tag, const std::string& bytes) override {
    SKYQUILT_CHECK(destination >= 0 && destination < size_, "rank " + std::to_string(destination) + " of " + std::to_string(size_));
    SKYQUILT_CHECK(tag >= 0 && tag <= 32767, "tag " + std::to_string(tag));
    const int count = Count(bytes.size());
    const std::lock_guard lock(mpi_);
    Transfer& transfer = outgoing_.emplace_back();
    transfer.message = {rank_, tag, bytes};
    Check(MPI_Isend(transfer.message.bytes.data(), count, MPI_BYTE, destination, tag, comm_, &transfer.request), "send");
    bytes_sent_ += count;
    Progress();
  }

  std::optional<Message> TryReceive() override {
    const std::lock_guard lock(mpi_);
    Progress();
    // A small message may be returned before a large one that arrived earlier, but not if both have the same source and tag.
    std::set<std::pair<int, int>> held_up;
    for (auto at = incoming_.begin(); at != incoming_.end(); ++at) {
      const std::pair<int, int> stream = {at->message.source, at->message.tag};
      if (!held_up.contains(stream) && at->Test()) {
        Message message = std::move(at->message);
        incoming_.erase(at);
        return message;
      }
      held_up.insert(stream);
    }
    return std::nullopt;
  }

  std::chrono::microseconds PollInterval() const override {
    if (!incoming_.empty()) return std::chrono::microseconds(0);
    return std::chrono::microseconds(outgoing_.empty() ? 1000 : 100);
  }

  void WaitUntilSent() override {
    while (LockedProgress(), !outgoing_.empty()) std::this_thread::sleep_for(std::min(PollInterval(), std::chrono::microseconds(20)));
  }

  std::string Broadcast(const std::string& bytes_on_root) override {
    uint64_t n_bytes = rank_ == 0 ? bytes_on_root.size() : 0;
    WaitFor([&](MPI_Request* request) { return MPI_Ibcast(&n_bytes, 1, MPI_UINT64_T, 0, comm_, request); }, "broadcast");
    const int count = Count(n_bytes);
    std::string bytes = rank_ == 0 ? bytes_on_root : std::string(n_bytes, '\0');
    WaitFor([&](MPI_Request* request) { return MPI_Ibcast(bytes.data(), count, MPI_BYTE, 0, comm_, request); }, "broadcast");
    if (rank_ == 0) bytes_sent_ += count * static_cast<int64_t>(size_ - 1);
    return bytes;
  }

  void Barrier() override {
    WaitFor([this](MPI_Request* request) { return MPI_Ibarrier(comm_, request); }, "barrier");
  }

  int64_t bytes_sent() const override { return bytes_sent_; }

  [[noreturn]] void Abort(int exit_status) override {
    base::FlushLog();
    std::fflush(nullptr);
    const std::lock_guard lock(mpi_);
    MPI_Abort(comm_, exit_status);
    std::_Exit(exit_status);
  }

 private:
  void LockedProgress() {
    const std::lock_guard lock(mpi_);
    Progress();
  }

  // With the lock held. Starts to receive all incoming messages and removes outgoing ones that are complete. Never waits for a message: its sender
  // may be busy computing.
  void Progress() {
    for (;;) {
      int found = 0;
      MPI_Message handle = MPI_MESSAGE_NULL;
      MPI_Status status;
      Check(MPI_Improbe(MPI_ANY_SOURCE, MPI_ANY_TAG, comm_, &found, &handle, &status), "probe");
      if (found == 0) break;
      int count = 0;
      Check(MPI_Get_count(&status, MPI_BYTE, &count), "probe");
      Transfer& transfer = incoming_.emplace_back();
      transfer.message = {status.MPI_SOURCE, status.MPI_TAG, std::string(static_cast<size_t>(count), '\0')};
      Check(MPI_Imrecv(transfer.message.bytes.data(), count, MPI_BYTE, &handle, &transfer.request), "receive");
    }
    outgoing_.remove_if([](Transfer& transfer) { return transfer.Test(); });
  }

  void Discard() {
    while (TryReceive()) {
    }
  }

  // Starts a collective call and waits for it; other messages are transferred in the meantime.
  template <class Start>
  void WaitFor(const Start& start, const char* what) {
    MPI_Request request = MPI_REQUEST_NULL;
    std::unique_lock lock(mpi_);
    for (Check(start(&request), what);; lock.lock()) {
      int done = 0;
      Check(MPI_Test(&request, &done, MPI_STATUS_IGNORE), what);
      if (done != 0) return;
      Progress();
      lock.unlock();
      SleepShortly();
    }
  }

  std::mutex mpi_;
  MPI_Comm comm_ = MPI_COMM_NULL;
  MPI_Comm life_ = MPI_COMM_NULL;
  std::vector<std::string> hosts_;
  int rank_ = 0;
  int size_ = 1;
  int local_size_ = 1;
  int64_t bytes_sent_ = 0;
  std::list<Transfer> outgoing_;
  std::list<Transfer> incoming_;
  std::unique_ptr<LifeSigns> signs_;  // none when this MPI does not allow calls from another thread
};

}  // namespace

std::unique_ptr<Communicator> ConnectMpi() {
  return std::make_unique<MpiCommunicator>();
}

}  // namespace skyquilt::comm
