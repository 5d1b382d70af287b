#include <cstdint>
#include <string>

#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  skyquilt::fuzz::Feed(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
