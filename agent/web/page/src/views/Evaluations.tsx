import { useSignal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { evaluate, readEvaluations, stopEvaluation } from "../api/client";
import type { Evaluation } from "../api/types";
import { attempt } from "../state/notices";
import { may, progress } from "../state/session";

const EXPERIMENTS: Record<string, string> = {
  paper: "The experiment of the paper",
  situations: "All situations of the paper",
  grasps: "Grasps",
  "all-scenarios": "All scenarios of learning",
  random: "Random scenes",
  noise: "Noise of perception",
};
const STATES = { running: "runs", done: "done", ended: "ended early" };
const FIGURES = ["runs", "right", "unique", "ties", "none", "grasps", "right_part"];

/** Experiments: begun, watched, and read as reports, two beside each other to compare. */
export function Evaluations() {
  const all = useSignal<readonly Evaluation[]>([]);
  const shown = useSignal<readonly string[]>([]);
  const state = progress.value?.state;
  useEffect(() => void attempt(readEvaluations).then((found) => (all.value = found ?? [])), [state]);
  const current = (each: Evaluation) =>
    progress.value?.evaluation === each.evaluation && each.state === "running" ? progress.value : each;
  const toggle = (name: string) => {
    const others = shown.value.filter((each) => each !== name);
    shown.value = others.length < shown.value.length ? others : [...others, name].slice(-2);
  };
  return (
    <section class="pane evaluations" aria-labelledby="evaluations-title">
      <h2 id="evaluations-title">Evaluations</h2>
      {may("operator") && <Begin onBegin={(begun) => (all.value = [...all.value, begun])} />}
      {all.value.length === 0 && <p class="empty">No evaluation was run from here yet.</p>}
      <ul class="evaluation-list">
        {all.value.toReversed().map((each) => (
          <Entry key={each.evaluation} found={current(each)} isShown={shown.value.includes(each.evaluation)} toggle={toggle} />
        ))}
      </ul>
      <div class="reports">
        {shown.value.map((name) => (
          <iframe key={name} title={`Report of evaluation ${name}`} sandbox="" src={`api/v1/evaluations/${name}/report`} />
        ))}
      </div>
    </section>
  );
}

function Begin({ onBegin }: { onBegin(begun: Evaluation): void }) {
  const what = useSignal("paper");
  const sim = useSignal(false);
  const seed = useSignal(0);
  const send = async (event: Event) => {
    event.preventDefault();
    const begun = await attempt(() => evaluate(what.value, sim.value, seed.value));
    if (begun) onBegin((progress.value = begun));
  };
  return (
    <form class="begin" onSubmit={(event) => void send(event)}>
      <label>
        <span>Experiment</span>
        <select value={what.value} onChange={(event) => (what.value = event.currentTarget.value)}>
          {Object.entries(EXPERIMENTS).map(([name, text]) => (
            <option key={name} value={name}>{text}</option>
          ))}
        </select>
      </label>
      <label>
        <span>Seed</span>
        <input type="number" min={0} value={seed.value} onInput={(event) => (seed.value = event.currentTarget.valueAsNumber || 0)} />
      </label>
      <label class="check">
        <input type="checkbox" checked={sim.value} onChange={(event) => (sim.value = event.currentTarget.checked)} />
        <span>with the simulated robot</span>
      </label>
      <button type="submit" class="primary" disabled={progress.value?.state === "running"}>Begin</button>
    </form>
  );
}

interface EntryProps {
  found: Evaluation;
  isShown: boolean;
  toggle(name: string): void;
}

function Entry({ found, isShown, toggle }: EntryProps) {
  const { evaluation: name, state, done, of, result } = found;
  const figures = FIGURES.filter((each) => typeof result?.[each] === "number");
  return (
    <li data-evaluation={name} data-state={state}>
      <p><b>{name}</b> {STATES[state]}</p>
      {state === "running" ? (
        <progress max={of || 1} value={done} aria-label={`${done} of ${of}`} />
      ) : (
        <p class="meta">{figures.map((each) => `${each.replace("_", " ")} ${String(result?.[each])}`).join(" · ")}</p>
      )}
      {state === "done" && (
        <button type="button" aria-pressed={isShown} onClick={() => toggle(name)}>Report</button>
      )}
      {state === "running" && may("operator") && (
        <button type="button" onClick={() => void attempt(() => stopEvaluation(name))}>Stop</button>
      )}
    </li>
  );
}
