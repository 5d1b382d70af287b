#include "coordinator/ranks/failure.h"

#include <exception>
#include <new>
#include <nlohmann/json.hpp>

#include "core/base/errors.h"

namespace skyquilt::coordinator {

Failure CurrentFailure() {
  try {
    throw;
  } catch (const base::Interrupted& error) {
    return {Failure::kInterrupted, error.what()};
  } catch (const base::InputError& error) {
    return {Failure::kInput, error.finding(), error.file().string()};
  } catch (const base::UsageError& error) {
    return {Failure::kUsage, error.what()};
  } catch (const std::bad_alloc&) {
    return {Failure::kBlock, "out of memory. Use smaller blocks, smaller tables or fewer ranks on this machine"};
  } catch (const std::exception& error) {
    return {Failure::kBlock, error.what()};
  }
}

void Throw(const Failure& failure, const std::string& who) {
  const std::string reason = who.empty() ? failure.reason : who + ": " + failure.reason;
  SKYQUILT_CHECK(failure.kind != Failure::kNone, "nothing failed");
  if (failure.kind == Failure::kInterrupted) throw base::Interrupted();
  if (failure.kind == Failure::kUsage) throw base::UsageError(reason);
  if (failure.file.empty()) throw base::InputError(who.empty() ? "training" : who, failure.reason, "");
  throw base::InputError(failure.file, reason, who.empty() ? "" : "All ranks must see the same project folder");
}

nlohmann::json ToJson(const Failure& failure) {
  return {{"kind", static_cast<int>(failure.kind)}, {"reason", failure.reason}, {"file", failure.file}};
}

Failure FailureFromJson(const nlohmann::json& json) {
  return {static_cast<Failure::Kind>(json.at("kind").get<int>()), json.at("reason").get<std::string>(), json.at("file").get<std::string>()};
}

}  // namespace skyquilt::coordinator
