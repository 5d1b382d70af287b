// One field's training curve as CSV, for the report and for people who follow a training.
// Columns: step,seconds,loss,psnr,rays_per_s,samples_per_s,samples_per_ray (psnr in dB).
// A line is added about once a second. After a resume, lines from steps after the checkpoint are removed first.
#pragma once

#include <chrono>
#include <filesystem>
#include <fstream>

#include "worker/trainer.h"

namespace skyquilt::coordinator {

class TrainingLog {
 public:
  // The file is opened at the first Add. every_s: shortest time between two lines; 0 writes every status.
  explicit TrainingLog(std::filesystem::path file, double every_s = 1.0) : file_(std::move(file)), every_s_(every_s) {}
  ~TrainingLog();
  TrainingLog(const TrainingLog&) = delete;
  TrainingLog& operator=(const TrainingLog&) = delete;

  // Throws base::InputError when the file cannot be written.
  void Add(const worker::TrainStatus& status);

 private:
  void Open(int64_t first_step);
  void Write(const worker::TrainStatus& status);

  std::filesystem::path file_;
  double every_s_;
  std::ofstream stream_;
  worker::TrainStatus last_;
  bool last_written_ = true;
  std::chrono::steady_clock::time_point written_at_{};
};

}  // namespace skyquilt::coordinator
