#include "core/base/packed_bytes.h"

namespace skyquilt::base {

size_t ByteUnpacker::TakeCount(size_t bytes_each) {
  const auto n = Take<uint64_t>();
  if (n > bytes_.size() / bytes_each) Fail();
  return n;
}

void ByteUnpacker::End() const {
  if (!bytes_.empty()) Fail();
}

void ByteUnpacker::Fail() const {
  throw UnreadableBytes(message_);
}

std::string_view ByteUnpacker::Next(size_t n) {
  if (n > bytes_.size()) Fail();
  const std::string_view next = bytes_.substr(0, n);
  bytes_.remove_prefix(n);
  return next;
}

}  // namespace skyquilt::base
