// The machine this process runs on: cores, memory, host name, time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace skyquilt::base {

// Cores this process may use, at least 1: limited by its CPU affinity and its cgroup.
int UsableCores();
// Removes the CPU affinity of this process: mpirun pins each rank to one core, which would keep its threads on that core.
void ReleaseAffinity();
// Memory of the machine, or of the cgroup when its limit is smaller.
int64_t TotalMemoryBytes();
// Largest resident memory of this process so far.
int64_t PeakRssBytes();
// Starts a new peak at the current resident memory (Linux; elsewhere nothing happens).
void ResetPeakRss();
// Asks the system for large pages in this range; call before it is first written. Only a hint.
void AdviseHugePages(void* begin, size_t bytes);
std::string HostName();
// "AMD EPYC, 2 cores, 24 GiB, Linux 6.1": for reports.
std::string MachineDescription();
// "2026-01-31T12:00:00Z"
std::string UtcTimestamp();

}  // namespace skyquilt::base
