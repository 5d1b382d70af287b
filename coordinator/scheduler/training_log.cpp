#include "coordinator/scheduler/training_log.h"

#include <cstdlib>
#include <sstream>
#include <string>

#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::coordinator {
namespace {

constexpr const char* kHeader = "step,seconds,loss,psnr,rays_per_s,samples_per_s,samples_per_ray\n";

}  // namespace

TrainingLog::~TrainingLog() {
  if (!last_written_ && stream_.is_open()) Write(last_);
}

void TrainingLog::Open(int64_t first_step) {
  std::string kept = kHeader;
  if (std::filesystem::exists(file_)) {
    std::istringstream old(base::ReadFile(file_));
    std::string line;
    std::getline(old, line);
    while (std::getline(old, line)) {
      if (!line.empty() && std::strtoll(line.c_str(), nullptr, 10) < first_step) kept += line + "\n";
    }
  }
  std::filesystem::create_directories(file_.parent_path());
  base::WriteFileAtomically(file_, kept);
  stream_.open(file_, std::ios::app);
  if (!stream_) throw base::InputError(file_, "cannot be written", "Check permissions and free space");
}

void TrainingLog::Write(const worker::TrainStatus& status) {
  stream_ << status.step << ',' << status.seconds << ',' << status.loss << ',' << status.psnr_db << ',' << status.rays_per_second << ','
          << status.samples_per_second << ',' << status.samples_per_ray << '\n';
  stream_.flush();
  written_at_ = std::chrono::steady_clock::now();
  last_written_ = true;
}

void TrainingLog::Add(const worker::TrainStatus& status) {
  const bool first = !stream_.is_open();
  if (first) Open(status.step);
  last_ = status;
  last_written_ = false;
  const double since = std::chrono::duration<double>(std::chrono::steady_clock::now() - written_at_).count();
  if (first || since >= every_s_) Write(status);
}

}  // namespace skyquilt::coordinator
