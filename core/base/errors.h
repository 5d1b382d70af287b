// Errors that end a command. Each type has its own exit status, so that scripts can tell them apart:
//   UsageError   2  wrong option or configuration
//   InputError   3  a file or its content cannot be used; the message names the file, what was found and how to fix it
//   BlockError   4  the training of a block failed after its retries
//   FailedCheck  5  a benchmark or check of the program itself found a wrong result
//   Interrupted 130 a signal asked to stop; the work is saved and can be resumed
// SKYQUILT_CHECK is for bugs in our own code: it throws std::logic_error, which is not meant for users.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace skyquilt::base {

class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class InputError : public std::runtime_error {
 public:
  InputError(const std::filesystem::path& file, const std::string& found, const std::string& fix);
  const std::filesystem::path& file() const { return file_; }
  // What was found and how to fix it: the message without the file's name.
  const std::string& finding() const { return finding_; }

 private:
  InputError(const std::filesystem::path& file, const std::string& finding);
  std::filesystem::path file_;
  std::string finding_;
};

class BlockError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class FailedCheck : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted; run the same command again to continue") {}
  using std::runtime_error::runtime_error;  // where the same command begins anew
};

[[noreturn]] void ThrowCheckFailure(const char* condition, const char* file, int line, const std::string& detail);

}  // namespace skyquilt::base

#define SKYQUILT_CHECK(condition, detail)                                                               \
  do {                                                                                                  \
    if (!(condition)) ::skyquilt::base::ThrowCheckFailure(#condition, __FILE_NAME__, __LINE__, detail); \
  } while (false)
