// The progress line of a training, for all ranks together: percent done, mean loss and PSNR, rays and samples per second of the fields in training.
#pragma once

#include <map>
#include <string>

#include "coordinator/scheduler/field_job.h"
#include "core/base/progress.h"

namespace skyquilt::coordinator {

class TrainProgress {
 public:
  // total_cost: sum over all fields, in the unit of Update's costs.
  TrainProgress(const std::string& label, double total_cost, int n_fields);

  void Update(const FieldJob& job, double cost, const worker::TrainStatus& status);
  // The field is finished, or failed after all tries.
  void FieldDone(const FieldJob& job, double cost);
  // The field starts again; its progress so far no longer counts.
  void FieldRestarted(const FieldJob& job) { active_.erase(job.name); }
  void Finish();

 private:
  struct Active {
    double cost = 0.0;
    worker::TrainStatus status;
  };
  void Show();

  base::Progress progress_;
  double total_cost_;
  int n_fields_;
  int n_done_ = 0;
  double done_cost_ = 0.0;
  std::map<std::string, Active> active_;
};

}  // namespace skyquilt::coordinator
