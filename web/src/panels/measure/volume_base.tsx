// The surface that a volume is measured against: for the next one, and for one that is finished, which is then measured again.
import { type ReactElement, useEffect, useRef, useState } from "react";
import { levelAtOutlineM, outlineOffsetM, projectOffsetM } from "../../geo/heights.js";
import type { VolumeBase, VolumeMeasurement } from "../../state/app_state.js";
import { addErrorNotice } from "../../state/notices.js";
import type { Project } from "../../state/project.js";
import { BASE_LABELS, remeasureVolume } from "../../state/volumes.js";
import type { AppContext } from "../context.js";
import { useStore } from "../use_store.js";
import { NumberField } from "../widgets/number_field.js";

const BASES = ["plane", "lowest", "height", "before"] as const;

interface BaseFieldsProps {
  readonly project: Project;
  readonly base: VolumeBase;
  /** z of ENU. */
  readonly heightM: number;
  /** Added for the height that is shown. */
  readonly offsetM: number;
  readonly disabled: boolean;
  readonly onChange: (base: VolumeBase, heightM: number) => void;
}

function BaseFields({ project, base, heightM, offsetM, disabled, onChange }: BaseFieldsProps): ReactElement {
  return (
    <>
      <label className="field">
        <span className="field-label">Base</span>
        <span className="field-input">
          <select
            value={base}
            disabled={disabled}
            onChange={(event) => {
              const next = BASES.find((one) => one === event.currentTarget.value);
              if (next !== undefined) onChange(next, heightM);
            }}
          >
            {BASES.map((one) => (
              <option key={one} value={one} disabled={one === "before" && project.before === null}>
                {BASE_LABELS[one]}
              </option>
            ))}
          </select>
        </span>
      </label>
      {base === "height" ? (
        <NumberField
          label="Height"
          value={heightM + offsetM}
          digits={2}
          unit="m"
          onChange={(value) => onChange(base, value - offsetM)}
        />
      ) : null}
    </>
  );
}

/** Shown while the volume tool is taken. */
export function NextVolumeBase({ context }: { readonly context: AppContext }): ReactElement | null {
  const { store, project } = context;
  const tool = useStore((state) => state.tool);
  const base = useStore((state) => state.volumeBase);
  const heightM = useStore((state) => state.volumeBaseHeightM);
  if (tool !== "volume") return null;
  return (
    <BaseFields
      project={project}
      base={base}
      heightM={heightM}
      offsetM={projectOffsetM(project)}
      disabled={false}
      onChange={(volumeBase, volumeBaseHeightM) => store.set({ volumeBase, volumeBaseHeightM })}
    />
  );
}

export function FinishedVolumeBase(props: {
  readonly context: AppContext;
  readonly volume: VolumeMeasurement;
}): ReactElement {
  const { store, link, project } = props.context;
  const { id, base, baseHeightM, points } = props.volume;
  const [asking, setAsking] = useState(false);
  const here = useRef(true);
  useEffect(() => {
    here.current = true;
    return () => {
      here.current = false;
    };
  }, []);
  const nextHeightM = useStore((state) => state.volumeBaseHeightM);
  const change = async (next: VolumeBase, heightM: number): Promise<void> => {
    setAsking(true);
    try {
      await remeasureVolume(store, link, project, id, next, heightM);
    } catch (error) {
      addErrorNotice(store, "The volume could not be measured again", error);
    } finally {
      // The list may have been closed meanwhile.
      if (here.current) setAsking(false);
    }
  };
  return (
    <>
      <BaseFields
        project={project}
        base={base}
        heightM={baseHeightM ?? levelAtOutlineM(project, points, nextHeightM)}
        offsetM={outlineOffsetM(project, points)}
        disabled={asking}
        onChange={(next, heightM) => void change(next, heightM)}
      />
      {asking ? (
        <p className="hint" role="status">
          The engine measures again …
        </p>
      ) : null}
    </>
  );
}
