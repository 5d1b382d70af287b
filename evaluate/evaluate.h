// Stage evaluate: scores the merged scene on the held-out photos and writes report/metrics.json, report/brightness.json and report/index.html.
#pragma once

#include "core/base/thread_pool.h"
#include "evaluate/evaluate_input.h"
#include "evaluate/metrics/metrics.h"

namespace skyquilt::evaluate {

// Renders every held-out photo and compares it with the real one. The same result for any number of threads, and when it continues after an
// interruption (EvaluateInput::progress_file).
// Throws base::UsageError for options out of range, base::InputError for files that cannot be read or written, base::Interrupted.
metrics::Metrics Evaluate(const EvaluateInput& input, base::ThreadPool& threads);

}  // namespace skyquilt::evaluate
