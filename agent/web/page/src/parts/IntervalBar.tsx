import type { Bounds } from "../api/types";

const percent = (share: number) => `${(100 * share).toFixed(1)}%`;

/** "[0.90, 1.00]" */
export const intervalText = ({ lower, upper }: Bounds): string =>
  `[${lower.toFixed(2)}, ${upper.toFixed(2)}]`;

/** An interval as a bar from its lower to its upper bound: solid is sure, hatched is open. */
export function IntervalBar({ lower, upper }: Bounds) {
  return (
    <span class="interval" role="img" aria-label={`between ${lower.toFixed(2)} and ${upper.toFixed(2)}`}>
      <span class="interval-track">
        <span class="interval-sure" style={{ width: percent(lower) }} />
        <span class="interval-open" style={{ left: percent(lower), width: percent(upper - lower) }} />
      </span>
      <span class="interval-text">{intervalText({ lower, upper })}</span>
    </span>
  );
}
