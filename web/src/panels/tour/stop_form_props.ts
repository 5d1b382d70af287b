// What the form of a stop and its parts get.
import type { Stop, Tour } from "../../tour/types.js";

export interface StopFormProps {
  readonly tour: Tour;
  readonly stop: Stop;
}
