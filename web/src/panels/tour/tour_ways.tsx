// Where a stop leads: the next stop and branches, each with its way.
import type { ReactElement } from "react";
import { add, scale } from "../../base/vec_math.js";
import { forward } from "../../geo/camera.js";
import { changeTour, setTourView } from "../../state/tour_changes.js";
import { addBranchTo, retargetBranch, setCentre, setWay } from "../../state/tour_ways.js";
import { changeBranch, removeBranch, setNext } from "../../tour/edit_stops.js";
import type { Path } from "../../tour/types.js";
import { useApp } from "../use_store.js";
import { Icon } from "../widgets/icons.js";
import { LineField } from "../widgets/line_field.js";
import { SelectField } from "../widgets/select_field.js";
import type { StopFormProps } from "./stop_form_props.js";
import { stopOptions, WAY_NAMES } from "./tour_names.js";

const IN_ORDER = "in order";
const THE_END = "the end";
/** No stop has these as its id, which has no spaces. */
const OWN = [
  [IN_ORDER, "The next in the list"],
  [THE_END, "Nothing: the tour ends"],
] as const;
/** Where nothing is in the middle of the view. */
const AHEAD_M = 20;

export function TourNext({ tour, stop }: StopFormProps): ReactElement {
  const { store } = useApp();
  const { id, next } = stop;
  const choose = (to: string): void => {
    changeTour(store, "change next stop", (old) =>
      setNext(
        old,
        id,
        to === THE_END ? null : { to: to === IN_ORDER ? null : to, path: next?.path ?? { kind: "direct" } },
      ),
    );
  };
  return (
    <>
      <SelectField<string>
        label="Then"
        value={next === null ? THE_END : (next.to ?? IN_ORDER)}
        options={[...OWN, ...stopOptions(tour, id)]}
        onChange={choose}
      />
      {next === null ? null : <WayField tour={tour} stop={stop} branch={null} path={next.path} />}
    </>
  );
}

interface WayFieldProps extends StopFormProps {
  readonly branch: number | null;
  readonly path: Path;
}

function WayField({ stop, branch, path }: WayFieldProps): ReactElement {
  const { store, scene } = useApp();
  const choose = (kind: Path["kind"]): void => {
    changeTour(store, "change way", (old) => {
      if (kind !== "orbit") return setWay(old, stop.id, branch, { kind });
      // What the person looks at, until another point is picked.
      const middle = scene.pickSurface([scene.canvas.clientWidth / 2, scene.canvas.clientHeight / 2]);
      const { eyeEnu, rotation } = stop.pose;
      return setCentre(old, stop.id, branch, middle?.enu ?? add(eyeEnu, scale(forward(rotation), AHEAD_M)));
    });
  };
  const pick = (): void => {
    setTourView(store, { placing: { kind: "centre", stop: stop.id, branch } });
    store.set({ tool: "thing" });
  };
  return (
    <>
      <SelectField label="Way" value={path.kind} options={WAY_NAMES} onChange={choose} />
      {path.kind === "orbit" ? (
        <div className="buttons">
          <button type="button" onClick={pick}>
            <Icon name="point" size={16} /> Pick the point
          </button>
        </div>
      ) : null}
    </>
  );
}

export function TourBranches({ tour, stop }: StopFormProps): ReactElement {
  const { store } = useApp();
  const { id } = stop;
  const options = stopOptions(tour, id);
  const first = options[0];
  return (
    <>
      {stop.branches.map((branch, i) => (
        // The place in the list is what a branch is known by.
        // biome-ignore lint/suspicious/noArrayIndexKey: see above
        <fieldset key={i} className="plain-set tour-branch">
          <legend className="hint">Branch {i + 1}</legend>
          <LineField
            label="Button"
            value={branch.label}
            onChange={(label) => changeTour(store, "rename branch", (old) => changeBranch(old, id, i, { label }))}
          />
          <SelectField<string>
            label="Leads to"
            value={branch.to}
            options={options}
            onChange={(to) => changeTour(store, "change branch", (old) => retargetBranch(old, id, i, to))}
          />
          <WayField tour={tour} stop={stop} branch={i} path={branch.path} />
          <button
            type="button"
            className="danger"
            onClick={() => changeTour(store, "delete branch", (old) => removeBranch(old, id, i))}
          >
            <Icon name="remove" size={16} /> Delete branch
          </button>
        </fieldset>
      ))}
      {first === undefined ? null : (
        <button
          type="button"
          className="link"
          onClick={() => changeTour(store, "add branch", (old) => addBranchTo(old, id, first[0]))}
        >
          Add a branch
        </button>
      )}
    </>
  );
}
