#include "worker/train_diagnostics.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"

namespace skyquilt::worker {

void TrainDiagnostics::Before(const std::vector<float>& networks) {
  if (!file_.empty()) before_ = networks;
}

void TrainDiagnostics::After(int64_t step, const StepResult& result, const std::vector<float>& networks, double rate_factor) {
  if (file_.empty()) return;
  if (!stream_.is_open()) {
    std::error_code none;
    const bool begins = step <= 1 || std::filesystem::file_size(file_, none) == 0 || none;
    std::filesystem::create_directories(file_.parent_path());
    stream_.open(file_, begins ? std::ios::trunc : std::ios::app);
    if (begins) {
      stream_ << "step,loss,batch_psnr,rays,samples,live_samples,gradient_norm,clipped,update_norm,largest_weight,saturated_colors,"
                 "saturated_densities,rate_factor,finite\n";
    }
  }
  double squares = 0.0;
  float largest = 0.0F;
  for (size_t i = 0; i < networks.size(); ++i) {
    const double change = static_cast<double>(networks[i]) - static_cast<double>(before_[i]);
    squares += change * change;
    largest = std::max(largest, std::abs(networks[i]));
  }
  const double live = static_cast<double>(std::max<int64_t>(1, result.n_live));
  stream_ << step << ',' << result.loss << ',' << -10.0 * std::log10(std::max(1e-10, result.squared_error)) << ',' << result.n_rays << ','
          << result.n_samples << ',' << result.n_live << ',' << result.gradient_norm << ',' << (result.clipped ? 1 : 0) << ',' << std::sqrt(squares)
          << ',' << largest << ',' << static_cast<double>(result.saturated.colors) / (3.0 * live) << ','
          << static_cast<double>(result.saturated.densities) / live << ',' << rate_factor << ',' << (result.finite ? 1 : 0) << '\n';
  if (!stream_) throw base::InputError(file_, "cannot be written", "Check permissions and free space, or set train.diagnostics = false");
}

}  // namespace skyquilt::worker
