// What this process runs on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace skyquilt::base {

// Cores this process may use (after ReleaseAffinity: of its cgroup), at least 1.
int UsableCores();
// mpirun pins ranks to single cores; a rank that starts threads lifts that for itself.
void ReleaseAffinity();
int64_t TotalMemoryBytes();
int64_t PeakRssBytes();
// From now on the peak is that of what follows, where the system can do that (Linux).
void ResetPeakRss();
// Asks for large pages behind this range, before it is first written. Only a hint.
void AdviseHugePages(void* begin, size_t bytes);
std::string HostName();
// "AMD EPYC, 2 cores, 24 GiB, Linux 6.1": for reports.
std::string MachineDescription();
// "2026-01-31T12:00:00Z"
std::string UtcTimestamp();

}  // namespace skyquilt::base
