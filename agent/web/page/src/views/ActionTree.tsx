import type { Step } from "../api/types";
import { intervalText } from "../parts/IntervalBar";
import { command, steps, stepState, touched, type StepState } from "../state/execution";

const SIGNS: Record<StepState, string> = { reached: "◌", done: "●", "not done": "○", failed: "✕" };
const STATES: Record<StepState, string> = {
  reached: "at it", done: "done", "not done": "not carried out", failed: "failed",
};

/** The action tree, lighting up as it is walked. */
export function ActionTree() {
  if (steps.value.length === 0) {
    return <p class="empty">Give a command, and its steps appear here while they are carried out.</p>;
  }
  return (
    <>
      <p class="command">{command.value?.text}</p>
      <ol class="tree">
        {steps.value.map((step, index) => (
          <Node key={index} step={step} />
        ))}
      </ol>
      {touched.value.length > 0 && (
        <p class="touched">The hand touched: <b>{touched.value.join(", ")}</b></p>
      )}
    </>
  );
}

function Node({ step }: { step: Step }) {
  const state = stepState(step);
  const path = step.node.split("/");
  return (
    <li
      class={`node ${state.replace(" ", "-")}`}
      style={{ marginInlineStart: `${1.4 * (path.length - 1)}rem` }}
      data-node={step.node}
      data-state={state}
    >
      <p class="node-name">
        <span aria-hidden="true">{SIGNS[state]}</span> {path.at(-1)}
        <span class="node-state">{state === "failed" ? step.action.replaceAll("_", " ") : STATES[state]}</span>
      </p>
      <Found step={step} />
    </li>
  );
}

function Found({ step: { features, percepts, constraint } }: { step: Step }) {
  if (!features.length && !constraint) return null;
  return (
    <dl>
      {features.length > 0 && <><dt>Looked for</dt><dd>{features.join(", ")}</dd></>}
      {percepts.length > 0 && (
        <><dt>Saw</dt><dd>{percepts.map((p) => `${p.name} (${p.confidence.toFixed(2)})`).join(", ")}</dd></>
      )}
      {constraint && (
        <>
          <dt>Chose</dt>
          <dd>
            <b>{constraint.part ? `${constraint.object}, by the ${constraint.part}` : constraint.object}</b>{" "}
            {intervalText(constraint)}
          </dd>
        </>
      )}
    </dl>
  );
}
