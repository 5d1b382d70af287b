#include "coordinator/planning/run_ledger.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"

namespace skyquilt::coordinator {
namespace {

nlohmann::json RecordJson(const StageRecord& record) {
  nlohmann::json changes = nlohmann::json::array();
  for (const config::Override& change : record.changes) changes.push_back({change.key, change.value});
  const auto number = [](double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr); };
  return {{"stage", record.stage},
          {"planned_s", number(record.planned_s)},
          {"predicted_s", number(record.predicted_s)},
          {"took_s", record.took_s},
          {"decided", record.decided},
          {"begun", record.begun},
          {"done", record.done},
          {"changes", changes}};
}

StageRecord RecordFromJson(const nlohmann::json& json) {
  StageRecord record;
  record.stage = json.at("stage").get<std::string>();
  record.planned_s = base::NanIfNull(json.at("planned_s"));
  record.predicted_s = base::NanIfNull(json.at("predicted_s"));
  record.took_s = json.at("took_s").get<double>();
  record.decided = json.at("decided").get<bool>();
  record.begun = json.at("begun").get<bool>();
  record.done = json.at("done").get<bool>();
  for (const nlohmann::json& change : json.at("changes"))
    record.changes.push_back({change.at(0).get<std::string>(), change.at(1).get<std::string>()});
  return record;
}

}  // namespace

RunLedger::RunLedger(const Project& project, Clock clock, double save_every_s)
    : project_(project), clock_(std::move(clock)), save_every_s_(save_every_s) {
  const std::filesystem::path file = FileOf(project_);
  if (!std::filesystem::exists(file)) return;
  try {
    const nlohmann::json json = base::ParseJson(base::ReadFile(file));
    used_before_s_ = json.at("used_s").get<double>();
    for (const nlohmann::json& stage : json.at("stages")) stages_.push_back(RecordFromJson(stage));
    for (const nlohmann::json& one : json.at("given_up")) {
      given_up_.push_back({one.at("what").get<std::string>(), one.at("stage").get<std::string>(), one.at("text").get<std::string>()});
    }
  } catch (const nlohmann::json::exception& error) {
    // Results of stages that were made with less than the settings ask for are then refused, with the differences; --restart is the way out.
    base::LogWarning("{}: is damaged ({}). The time that earlier runs used is not known and does not count", file.string(), error.what());
    used_before_s_ = 0.0;
    stages_.clear();
    given_up_.clear();
  }
}

RunLedger::~RunLedger() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  wake_.notify_all();
  if (saver_.joinable()) saver_.join();
  if (!started_) return;
  try {
    const std::lock_guard lock(mutex_);
    Save();
  } catch (const std::exception& error) {
    base::LogWarning("the time that was used could not be saved: {}", error.what());
  }
}

double RunLedger::Now() const {
  return used_before_s_ + (started_ ? clock_() - start_s_ : 0.0);
}

void RunLedger::Start() {
  {
    const std::lock_guard lock(mutex_);
    if (started_) return;
    start_s_ = clock_();
    started_ = true;
    settled_s_ = Now();
  }
  if (save_every_s_ > 0.0) saver_ = std::thread([this] { KeepSaving(save_every_s_); });
}

void RunLedger::KeepSaving(double every_s) {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, std::chrono::duration<double>(every_s), [this] { return ends_; })) {
    try {
      Save();
    } catch (const base::InputError&) {
      // A full disk ends the stage that writes its results, with advice; here at most some seconds are not counted.
    }
  }
}

double RunLedger::UsedSeconds() const {
  const std::lock_guard lock(mutex_);
  return Now();
}

std::vector<StageRecord> RunLedger::Stages() const {
  const std::lock_guard lock(mutex_);
  return stages_;
}

StageRecord RunLedger::Of(const std::string& stage) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(stages_.begin(), stages_.end(), [&stage](const StageRecord& record) { return record.stage == stage; });
  return found == stages_.end() ? StageRecord{.stage = stage, .changes = {}} : *found;
}

std::vector<GivenUp> RunLedger::AllGivenUp() const {
  const std::lock_guard lock(mutex_);
  return given_up_;
}

StageRecord& RunLedger::Entry(const std::string& stage) {
  const auto found = std::find_if(stages_.begin(), stages_.end(), [&stage](const StageRecord& record) { return record.stage == stage; });
  if (found != stages_.end()) return *found;
  stages_.push_back({.stage = stage, .changes = {}});
  return stages_.back();
}

void RunLedger::SetPlanned(const std::string& stage, double seconds) {
  const std::lock_guard lock(mutex_);
  StageRecord& record = Entry(stage);
  if (!std::isfinite(record.planned_s)) record.planned_s = seconds;
}

void RunLedger::Settle() {
  const double now = Now();
  if (!running_.empty()) Entry(running_).took_s += now - settled_s_;
  settled_s_ = now;
}

void RunLedger::Decide(const std::string& stage, double predicted_s, const std::vector<config::Override>& changes) {
  const std::lock_guard lock(mutex_);
  StageRecord& record = Entry(stage);
  if (record.decided) return;
  record.predicted_s = predicted_s;
  record.changes = changes;
  record.decided = true;
  Save();
}

void RunLedger::Begin(const std::string& stage) {
  const std::lock_guard lock(mutex_);
  Settle();
  Entry(stage).begun = true;
  running_ = stage;
  Save();
}

void RunLedger::End(const std::string& stage) {
  const std::lock_guard lock(mutex_);
  Settle();
  running_.clear();
  Entry(stage).done = true;
  Save();
}

void RunLedger::SetGivenUp(const std::string& stage, const std::vector<GivenUp>& given_up) {
  const std::lock_guard lock(mutex_);
  std::erase_if(given_up_, [&stage](const GivenUp& one) { return one.stage == stage; });
  given_up_.insert(given_up_.end(), given_up.begin(), given_up.end());
}

void RunLedger::Forget() {
  const std::lock_guard lock(mutex_);
  stages_.clear();
  given_up_.clear();
  used_before_s_ = 0.0;
  std::filesystem::remove(FileOf(project_));
}

void RunLedger::Save() {
  Settle();
  nlohmann::json stages = nlohmann::json::array(), given_up = nlohmann::json::array();
  for (const StageRecord& record : stages_) stages.push_back(RecordJson(record));
  for (const GivenUp& one : given_up_) given_up.push_back({{"what", one.what}, {"stage", one.stage}, {"text", one.text}});
  const nlohmann::json json = {{"used_s", Now()}, {"stages", stages}, {"given_up", given_up}};
  std::filesystem::create_directories(project_.StateFolder());
  base::WriteFileAtomically(FileOf(project_), base::JsonText(json, 1) + "\n");
}

}  // namespace skyquilt::coordinator
