#include "coordinator/scheduler/train_progress.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "core/base/amounts.h"

namespace skyquilt::coordinator {

TrainProgress::TrainProgress(const std::string& label, double total_cost, int n_fields)
    : progress_(label, 100.0, "%"), total_cost_(std::max(total_cost, 1e-30)), n_fields_(n_fields) {}

void TrainProgress::Update(const FieldJob& job, double cost, const worker::TrainStatus& status) {
  active_[job.name] = {cost, status};
  Show();
}

void TrainProgress::FieldDone(const FieldJob& job, double cost) {
  active_.erase(job.name);
  done_cost_ += cost;
  ++n_done_;
  Show();
}

void TrainProgress::Finish() {
  progress_.Finish();
}

void TrainProgress::Show() {
  double done = done_cost_;
  double loss = 0.0;
  double psnr = 0.0;
  double rays = 0.0;
  double samples = 0.0;
  for (const auto& [name, active] : active_) {
    done += active.cost * std::clamp(active.status.fraction, 0.0, 1.0);
    loss += active.status.loss;
    psnr += active.status.psnr_db;
    rays += active.status.rays_per_second;
    samples += active.status.samples_per_second;
  }
  const double n = std::max<double>(1.0, static_cast<double>(active_.size()));
  std::array<char, 160> text{};
  const std::string fields = n_fields_ > 1 ? std::to_string(n_done_) + "/" + std::to_string(n_fields_) + " blocks  " : "";
  if (active_.empty()) {
    progress_.Update(100.0 * done / total_cost_, fields);
    return;
  }
  std::snprintf(text.data(), text.size(), "%sloss %.4f  PSNR %.1f dB  %s rays/s  %s samples/s", fields.c_str(), loss / n, psnr / n,
                base::FormatCount(rays).c_str(), base::FormatCount(samples).c_str());
  progress_.Update(100.0 * done / total_cost_, text.data());
}

}  // namespace skyquilt::coordinator
