// The interface of a fuzz target: one reader of files from outside. It is linked with replay_main.cpp (a test with seeds and many fixed mutations of
// them) or, with clang and SKYQUILT_FUZZ=ON, with libFuzzer (scripts/fuzz.sh).
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/base/errors.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::fuzz {

// Valid inputs, from which mutations start.
std::vector<std::string> Seeds();
// Reads the bytes as if they came from a file. Only base::InputError and base::UsageError, which say what is wrong, may be caught inside;
// anything else is an error that the fuzzer reports.
void Feed(const std::string& bytes);

// Writes the bytes to a file of this name and calls the reader with it.
template <typename Reader>
void FeedFile(const std::string& name, const std::string& bytes, const Reader& read) {
  static const TemporaryFolder folder;
  const std::filesystem::path file = folder / name;
  std::ofstream(file, std::ios::binary) << bytes;
  try {
    read(file);
  } catch (const base::InputError&) {
  }
}

}  // namespace skyquilt::fuzz
