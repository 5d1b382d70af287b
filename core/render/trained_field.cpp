#include "core/render/trained_field.h"

namespace skyquilt::render {

void TrainedField::BuildNetworks() {
  field = std::make_unique<field::HashField>(config);
  weights = field->Prepare(parameters.networks);
  blend_m = box.margin_m;
}

}  // namespace skyquilt::render
