#include "core/base/system.h"

#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <vector>

namespace skyquilt::base {
namespace {

namespace fs = std::filesystem;

std::optional<std::string> FirstLine(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  if (!std::getline(in, line)) return std::nullopt;
  return line;
}

// The folders of this process's cgroup (version 2) and of its parents up to the root.
std::vector<fs::path> CgroupFolders() {
  const fs::path root = "/sys/fs/cgroup";
  std::vector<fs::path> folders;
  std::ifstream in("/proc/self/cgroup");
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("0::/")) continue;
    for (fs::path below = fs::path(line.substr(4)); !below.empty(); below = below.parent_path()) folders.push_back(root / below);
  }
  folders.push_back(root);
  return folders;
}

// The smallest limit in a file of the cgroup folders; `read` parses the file's first line.
template <typename Limit>
std::optional<Limit> TightestLimit(const char* file, std::optional<Limit> (*read)(std::istream& words)) {
  std::optional<Limit> tightest;
  for (const fs::path& folder : CgroupFolders()) {
    const std::optional<std::string> line = FirstLine(folder / file);
    if (!line) continue;
    std::istringstream words(*line);
    const std::optional<Limit> limit = read(words);
    if (limit) tightest = tightest ? std::min(*tightest, *limit) : *limit;
  }
  return tightest;
}

// Cores granted by cpu.max ("max 100000" or "150000 100000"), rounded up.
std::optional<int> CgroupCores() {
  return TightestLimit<int>("cpu.max", [](std::istream& words) -> std::optional<int> {
    double quota = 0.0;
    double period = 0.0;
    if (!(words >> quota >> period) || !(quota > 0.0) || !(period > 0.0)) return std::nullopt;
    return static_cast<int>(std::clamp(std::ceil(quota / period), 1.0, 65536.0));
  });
}

std::optional<int64_t> CgroupMemoryBytes() {
  return TightestLimit<int64_t>("memory.max", [](std::istream& words) -> std::optional<int64_t> {
    int64_t limit = 0;
    if (!(words >> limit) || limit <= 0) return std::nullopt;
    return limit;
  });
}

// A set of n processors; `set` is null when it could not be allocated.
struct CpuSet {
  int n_cpus;
  size_t bytes;
  cpu_set_t* set;
  explicit CpuSet(int n) : n_cpus(n), bytes(CPU_ALLOC_SIZE(n)), set(CPU_ALLOC(n)) {
    if (set != nullptr) CPU_ZERO_S(bytes, set);
  }
  ~CpuSet() {
    if (set != nullptr) CPU_FREE(set);
  }
  CpuSet(const CpuSet&) = delete;
  CpuSet& operator=(const CpuSet&) = delete;
};

int AffinityCores() {
  // The kernel refuses a set smaller than its own, which may exceed the processors present.
  for (int n = 1024; n <= (1 << 20); n *= 4) {
    CpuSet cpus(n);
    if (cpus.set == nullptr) break;
    if (sched_getaffinity(0, cpus.bytes, cpus.set) == 0) return CPU_COUNT_S(cpus.bytes, cpus.set);
  }
  return static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN));
}

// The value of "key : value" in a /proc file; empty when absent.
std::string ProcValue(const char* file, const std::string& key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(key)) continue;
    const size_t colon = line.find(':');
    if (colon == std::string::npos) continue;
    const size_t begin = line.find_first_not_of(" \t", colon + 1);
    if (begin != std::string::npos) return line.substr(begin);
  }
  return "";
}

}  // namespace

int UsableCores() {
  int cores = AffinityCores();
  if (const std::optional<int> granted = CgroupCores()) cores = std::min(cores, *granted);
  return std::max(cores, 1);
}

void ReleaseAffinity() {
  const int n = static_cast<int>(std::max(1024L, sysconf(_SC_NPROCESSORS_CONF)));
  CpuSet cpus(n);
  if (cpus.set == nullptr) return;
  for (int cpu = 0; cpu < n; ++cpu) CPU_SET_S(static_cast<size_t>(cpu), cpus.bytes, cpus.set);
  // The kernel drops cores that the cgroup does not allow. If the call fails, we only have fewer cores.
  (void)sched_setaffinity(0, cpus.bytes, cpus.set);
}

int64_t TotalMemoryBytes() {
  const int64_t physical = static_cast<int64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<int64_t>(sysconf(_SC_PAGESIZE));
  const std::optional<int64_t> limit = CgroupMemoryBytes();
  return limit ? std::min(physical, *limit) : physical;
}

void AdviseHugePages(void* begin, size_t bytes) {
  constexpr uintptr_t kPage = 4096;
  constexpr size_t kWorthwhile = size_t{4} << 20U;
  if (bytes < kWorthwhile) return;
  const auto first = (reinterpret_cast<uintptr_t>(begin) + kPage - 1) / kPage * kPage;
  const auto last = (reinterpret_cast<uintptr_t>(begin) + bytes) / kPage * kPage;
  madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
}

int64_t PeakRssBytes() {
  // ru_maxrss survives exec and may be the launcher's peak; VmHWM is this program's own.
  std::istringstream words(ProcValue("/proc/self/status", "VmHWM"));
  int64_t kib = 0;
  if (words >> kib) return kib * 1024;
  struct rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<int64_t>(usage.ru_maxrss) * 1024;
}

void ResetPeakRss() {
  std::ofstream("/proc/self/clear_refs") << "5";  // proc(5): sets the high-water mark to what is resident now
}

std::string HostName() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

std::string MachineDescription() {
  std::string processor = ProcValue("/proc/cpuinfo", "model name");
  struct utsname name = {};
  const bool named = uname(&name) == 0;
  if (processor.empty()) processor = named ? name.machine : "unknown processor";
  const int cores = UsableCores();
  std::ostringstream text;
  text << processor << ", " << cores << (cores == 1 ? " core, " : " cores, ")
       << std::llround(static_cast<double>(TotalMemoryBytes()) / (1024.0 * 1024.0 * 1024.0)) << " GiB";
  if (named) text << ", " << name.sysname << " " << name.release;
  return text.str();
}

std::string UtcTimestamp() {
  const std::time_t now = std::time(nullptr);
  std::tm utc = {};
  gmtime_r(&now, &utc);
  char text[32];
  const size_t n = std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return {text, n};
}

}  // namespace skyquilt::base
