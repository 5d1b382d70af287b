#include "core/comm/life_signs.h"

#include <chrono>
#include <cstdio>

#include "core/base/log.h"
#include "core/comm/communicator.h"

namespace skyquilt::comm {
namespace {

constexpr int kSignTag = 1;

double Now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

LifeSigns::LifeSigns(std::mutex& mpi, MPI_Comm comm, std::vector<std::string> hosts)
    : mpi_(mpi), comm_(comm), hosts_(std::move(hosts)), watch_(static_cast<int>(hosts_.size())) {
  MPI_Comm_rank(comm_, &rank_);
  thread_ = std::thread([this] { Run(); });
}

LifeSigns::~LifeSigns() {
  {
    const std::lock_guard lock(ending_);
    ended_ = true;
  }
  wake_.notify_all();
  thread_.join();
  // Signs of which the receiver has already ended are nobody's loss.
  for (Sign& sign : sent_) MPI_Request_free(&sign.request);
}

void LifeSigns::Run() {
  std::unique_lock lock(ending_);
  while (!wake_.wait_for(lock, std::chrono::seconds(1), [this] { return ended_; })) {
    lock.unlock();
    {
      const std::lock_guard mpi(mpi_);
      Exchange();
    }
    Judge(Now_s());
    lock.lock();
  }
}

void LifeSigns::Exchange() {
  const int ranks = static_cast<int>(hosts_.size());
  const int first = rank_ == 0 ? 1 : 0, end = rank_ == 0 ? ranks : 1;
  for (int to = first; to < end; ++to) {
    Sign& sign = sent_.emplace_back();
    sign.limit_s = limit_s_;
    if (MPI_Isend(&sign.limit_s, 1, MPI_DOUBLE, to, kSignTag, comm_, &sign.request) != MPI_SUCCESS) sent_.pop_back();
  }
  sent_.remove_if([](Sign& sign) {
    int done = 0;
    return MPI_Test(&sign.request, &done, MPI_STATUS_IGNORE) == MPI_SUCCESS && done != 0;
  });
  for (;;) {
    int found = 0;
    MPI_Message handle = MPI_MESSAGE_NULL;
    MPI_Status status;
    if (MPI_Improbe(MPI_ANY_SOURCE, kSignTag, comm_, &found, &handle, &status) != MPI_SUCCESS || found == 0) return;
    double limit_s = 0.0;
    MPI_Mrecv(&limit_s, 1, MPI_DOUBLE, &handle, MPI_STATUS_IGNORE);
    if (rank_ != 0) limit_s_ = limit_s;
    watch_.Heard(status.MPI_SOURCE, Now_s());
  }
}

void LifeSigns::Judge(double now_s) {
  for (int rank = 0; rank < static_cast<int>(hosts_.size()); ++rank) {
    if ((rank_ == 0) == (rank == 0)) watch_.Heard(rank, now_s);  // itself, and those from which it expects nothing
  }
  const double limit_s = limit_s_;
  for (const SilenceWatch::Finding& finding : watch_.Check(now_s, limit_s)) {
    const std::string who = "rank " + std::to_string(finding.rank) + " on " + hosts_[static_cast<size_t>(finding.rank)];
    switch (finding.what) {
      case SilenceWatch::What::kSilent:
        base::LogWarning("{} gives no sign of life since {:.0f} s. After {:.0f} s (run.rank_timeout_s) the job ends", who, finding.silent_s, limit_s);
        break;
      case SilenceWatch::What::kBack:
        base::LogInfo("{} gives signs of life again", who);
        break;
      case SilenceWatch::What::kLost: {
        base::LogError(
            "{} stood still for {:.0f} s, so the job ends; what was saved is kept. skyquilt-mpirun starts it again by itself; without it, run the "
            "same "
            "command again to resume. Look at that machine's memory, disk and network, or raise run.rank_timeout_s",
            who, finding.silent_s);
        base::FlushLog();
        std::fflush(nullptr);
        const std::lock_guard mpi(mpi_);
        MPI_Abort(comm_, kStandstillStatus);
        std::_Exit(kStandstillStatus);
      }
    }
  }
}

}  // namespace skyquilt::comm
