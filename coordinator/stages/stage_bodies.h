// The work of each stage. Each function returns StageStamp::kDone or kFailed; training and evaluation store their results in the pipeline.
#pragma once

#include <optional>
#include <string>

#include "coordinator/project/stamp.h"
#include "coordinator/stages/pipeline.h"
#include "core/trust/trust.h"
#include "products/product_kinds.h"

namespace skyquilt::coordinator {

std::string SimulateBody(Pipeline& pipeline, const StageStamp& stamp);
std::string PrepareBody(Pipeline& pipeline, const StageStamp& stamp);
std::string MasksBody(Pipeline& pipeline, const StageStamp& stamp);
std::string PartitionBody(Pipeline& pipeline, const StageStamp& stamp);
std::string TrainBody(Pipeline& pipeline, const StageStamp& stamp);
std::string MergeBody(Pipeline& pipeline, const StageStamp& stamp);
std::string ProductsBody(Pipeline& pipeline, const StageStamp& stamp);
std::string SurfaceBody(Pipeline& pipeline, const StageStamp& stamp);
std::string BuildingsBody(Pipeline& pipeline, const StageStamp& stamp);
std::string TourBody(Pipeline& pipeline, const StageStamp& stamp);
std::string EvaluateBody(Pipeline& pipeline, const StageStamp& stamp);

// What was measured when the scene was merged; nothing, with a warning where that is a surprise, for a scene whose trust is not known.
std::optional<trust::Trust> TrustOfScene(const Project& project);

// What products.kinds gives for the pipeline's survey; photos look down where there is no survey.
products::ProductKinds KindsOf(const Pipeline& pipeline);

// Identity of a tour that a person made or changed; "" when there is none, so that a proposed one can be proposed again.
std::string EditedTourIdentity(const Project& project);

}  // namespace skyquilt::coordinator
