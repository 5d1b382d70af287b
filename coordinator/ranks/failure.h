// What went wrong on a rank, on its way to rank 0: one form for training, rendering and getting ready.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace skyquilt::coordinator {

struct Failure {
  enum Kind {
    kNone,
    kBlock,        // this piece of work only: diverged, out of memory, an exception
    kInput,        // base::InputError: ends the command
    kUsage,        // base::UsageError: ends the command
    kInterrupted,  // base::Interrupted: saved and stopped
  };
  Kind kind = kNone;
  std::string reason = {};  // for people: what was found and how to fix it, without the file's name
  std::string file = {};    // that an input error concerns

  explicit operator bool() const { return kind != kNone; }
  // Reason and, where there is one, file.
  std::string Text() const { return file.empty() ? reason : file + ": " + reason; }
};

// Of the exception that is being handled: only inside a catch block.
Failure CurrentFailure();
// Throws again what the failure was: base::Interrupted, base::UsageError or base::InputError (also for kBlock), with `who` in front of the reason.
// Not for kNone.
[[noreturn]] void Throw(const Failure& failure, const std::string& who = "");

nlohmann::json ToJson(const Failure& failure);
// Throws nlohmann::json::exception.
Failure FailureFromJson(const nlohmann::json& json);

}  // namespace skyquilt::coordinator
