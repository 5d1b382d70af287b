// The blocks of the field with the quality of their held-out photos.
import type { ReactElement } from "react";
import type { Block } from "../../state/project.js";
import { useApp } from "../use_store.js";
import { Psnr } from "../widgets/psnr.js";

export function BlockList({ blocks }: { readonly blocks: readonly Block[] }): ReactElement {
  const { scene } = useApp();
  return (
    <details className="fold">
      <summary>Blocks and their PSNR</summary>
      <table className="numbers">
        <thead>
          <tr>
            <th scope="col">Block</th>
            <th scope="col">Photos</th>
            <th scope="col">PSNR</th>
          </tr>
        </thead>
        <tbody>
          {blocks.map((block) => (
            <tr key={block.name}>
              <th scope="row">
                <button
                  type="button"
                  className="link"
                  disabled={block.empty}
                  onClick={() => void scene.frameBox(block.min, block.max)}
                >
                  {block.name}
                </button>
              </th>
              <td>{block.empty ? "empty" : block.photos}</td>
              <td>
                <Psnr valueDb={block.psnrDb} />
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </details>
  );
}
