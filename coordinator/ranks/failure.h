// An error that happened on a rank, in a form that can be sent to rank 0. Used in training, in rendering and while ranks load their data.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace skyquilt::coordinator {

struct Failure {
  enum Kind {
    kNone,
    kBlock,        // only this block or request: diverged, out of memory, an exception
    kInput,        // base::InputError: ends the command
    kUsage,        // base::UsageError: ends the command
    kInterrupted,  // base::Interrupted: saved and stopped
  };
  Kind kind = kNone;
  std::string reason = {};  // what was found and how to fix it, without the file's name
  std::string file = {};    // the file of an input error; may be empty

  explicit operator bool() const { return kind != kNone; }
  // "file: reason", or the reason alone.
  std::string Text() const { return file.empty() ? reason : file + ": " + reason; }
};

// The exception that is being handled, as a failure. Call it only inside a catch block.
Failure CurrentFailure();
// Throws the failure as an exception: base::Interrupted, base::UsageError or base::InputError (also for kBlock). `who` is put in front of the
// reason. kNone is not allowed.
[[noreturn]] void Throw(const Failure& failure, const std::string& who = "");

nlohmann::json ToJson(const Failure& failure);
// Throws nlohmann::json::exception.
Failure FailureFromJson(const nlohmann::json& json);

}  // namespace skyquilt::coordinator
