// One reader that takes files from strangers. Linked with replay_main.cpp (a test: seeds and many fixed mutations of them) or, built with clang and
// SKYQUILT_FUZZ=ON, with libFuzzer (scripts/fuzz.sh).
#pragma once

#include <string>
#include <vector>

namespace skyquilt::fuzz {

// Whole inputs to start from.
std::vector<std::string> Seeds();
// Reads the bytes as if they came from a file. Only base::InputError and base::UsageError, which say what is wrong, may be caught inside;
// whatever else happens is a finding.
void Feed(const std::string& bytes);

}  // namespace skyquilt::fuzz
