// Runs a fuzz target with its seeds, with inputs that caused errors before (tests/fuzz/corpus/<target>), and with fixed mutations of both, within
// limits of memory and time.
//   fuzz_X CORPUS [MUTATIONS]     exit status 1 after an unexpected exception; a crash or a hang ends the process by signal
//   fuzz_X --seeds FOLDER         writes the seeds for libFuzzer to start from
#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "core/base/file.h"
#include "core/base/random.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/sanitizer.h"
#ifdef SKYQUILT_ADDRESS_SANITIZER
#include <sanitizer/common_interface_defs.h>
#endif

namespace {

namespace fs = std::filesystem;
using skyquilt::base::Random;

[[maybe_unused]] constexpr rlim_t kMemoryBytes = 3ULL << 30;  // not under sanitizers, which reserve far more
constexpr unsigned kSecondsPerInput = 20;

std::string current_input;
std::string finding_file;  // the current input is written here when it causes an error

// Also called from signal handlers, so only functions that are allowed there.
void KeepInput() {
  const int file = open(finding_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (file < 0) return;
  const bool kept = write(file, current_input.data(), current_input.size()) == static_cast<ssize_t>(current_input.size());
  close(file);
  for (const std::string_view text :
       {std::string_view(kept ? "input kept in " : "input partly kept in "), std::string_view(finding_file), std::string_view("\n")}) {
    if (write(STDERR_FILENO, text.data(), text.size()) < 0) return;
  }
}

void KeepInputAndDie(int signal) {
  KeepInput();
  std::signal(signal, SIG_DFL);
  raise(signal);
}

void KeepInputOfCrashes() {
  finding_file = (fs::temp_directory_path() / ("fuzz_finding_" + std::to_string(getpid()))).string();
#ifdef SKYQUILT_ADDRESS_SANITIZER
  __sanitizer_set_death_callback(KeepInput);  // for errors that the sanitizer finds
#else
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL}) std::signal(signal, KeepInputAndDie);
#endif
  for (const int signal : {SIGABRT, SIGALRM}) std::signal(signal, KeepInputAndDie);
}

std::string Mutated(std::string bytes, const std::vector<std::string>& pool, Random& random) {
  constexpr uint64_t kNumbers[] = {
      0, 1, 0x7F, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0xFFFFFFFF, 0x7FFFFFFFFFFFFFFF, 0xFFFFFFFFFFFFFFFF, 0x7FF8000000000000};
  const uint32_t times = 1 + random.Below(4);
  for (uint32_t i = 0; i < times; ++i) {
    const size_t at = random.Below(static_cast<uint32_t>(bytes.size() + 1));
    switch (random.Below(6)) {
      case 0:
        if (at < bytes.size()) bytes[at] = static_cast<char>(static_cast<unsigned char>(bytes[at]) ^ (1U << random.Below(8)));
        break;
      case 1:
        bytes.resize(at);
        break;
      case 2: {
        const uint64_t number = kNumbers[random.Below(std::size(kNumbers))];
        const size_t width = size_t{1} << random.Below(4);
        if (at + width <= bytes.size()) std::memcpy(bytes.data() + at, &number, width);
        break;
      }
      case 3:
        bytes.erase(at, random.Below(64));
        break;
      case 4:
        bytes.insert(at, bytes.substr(random.Below(static_cast<uint32_t>(bytes.size() + 1)), random.Below(64)));
        break;
      default: {
        const std::string& other = pool[random.Below(static_cast<uint32_t>(pool.size()))];
        bytes = bytes.substr(0, at) + other.substr(std::min(other.size(), at));
      }
    }
  }
  return bytes;
}

void WriteSeeds(const fs::path& folder) {
  fs::create_directories(folder);
  int n = 0;
  for (const std::string& seed : skyquilt::fuzz::Seeds()) {
    std::ofstream(folder / ("seed" + std::to_string(n++)), std::ios::binary) << seed;
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::string(argv[1]) == "--seeds") {
    WriteSeeds(argv[2]);
    return 0;
  }
  if (argc < 2) {
    std::cerr << "usage: " << argv[0] << " CORPUS [MUTATIONS] | --seeds FOLDER\n";
    return 2;
  }
  KeepInputOfCrashes();
#if !defined(SKYQUILT_ADDRESS_SANITIZER) && !defined(SKYQUILT_THREAD_SANITIZER)
  const rlimit memory = {kMemoryBytes, kMemoryBytes};
  setrlimit(RLIMIT_AS, &memory);
#endif
  std::vector<std::string> pool = skyquilt::fuzz::Seeds();
  if (fs::is_directory(argv[1])) {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(argv[1])) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) pool.push_back(skyquilt::base::ReadFile(file));
  }
  const size_t mutations = argc > 2 ? std::stoul(argv[2]) : 2000;
  Random random(7);
  try {
    for (size_t i = 0; i < pool.size() + mutations; ++i) {
      current_input = i < pool.size() ? pool[i] : Mutated(pool[random.Below(static_cast<uint32_t>(pool.size()))], pool, random);
      alarm(kSecondsPerInput);
      skyquilt::fuzz::Feed(current_input);
    }
  } catch (const std::exception& error) {
    KeepInput();
    std::cerr << "unexpected exception: " << error.what() << '\n';
    return 1;
  }
  std::cout << pool.size() << " inputs and " << mutations << " mutations: no crash, no hang, no unexpected exception\n";
}
