// What the tools work with.
import type { Link } from "../protocol/link_api.js";
import type { SceneApi } from "../scene/scene_api.js";
import type { CommandTable } from "../state/commands.js";
import type { Project } from "../state/project.js";
import type { Store } from "../state/store.js";

export interface ToolContext {
  readonly project: Project;
  readonly store: Store;
  readonly scene: SceneApi;
  readonly link: Link;
  readonly commands: CommandTable;
}
