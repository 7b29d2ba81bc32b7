import { useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import type { GraphEdge } from "../api/types";
import { intervalText } from "../parts/IntervalBar";
import type { RuleGraph } from "../scene/graph";
import { changed, chosenRule, contextOf, contexts, filter, graph, type Filter } from "../state/rules";
import { Provenance } from "./Provenance";
import { TimeSlider } from "./TimeSlider";

const FILTERS: Record<keyof Filter, string> = {
  object: "Object", part: "Part", context: "Action", affordance: "Used for",
};

/** The rules as a graph or as a table, now or as they were. */
export function RulesView() {
  const isTable = useSignal(false);
  return (
    <div class="rules">
      <Filters />
      <p class="switch" role="group" aria-label="Shown as">
        <button type="button" aria-pressed={!isTable.value} onClick={() => (isTable.value = false)}>Graph</button>
        <button type="button" aria-pressed={isTable.value} onClick={() => (isTable.value = true)}>Table</button>
      </p>
      {graph.value.edges.length === 0 ? (
        <p class="empty">No such rules.</p>
      ) : isTable.value ? <RuleTable /> : <GraphCanvas />}
      <TimeSlider />
      <Provenance />
    </div>
  );
}

function Filters() {
  const change = (name: keyof Filter, text: string) => {
    filter.value = { ...filter.value, [name]: text.trim().toLowerCase() };
  };
  return (
    <form class="filters" onSubmit={(event) => event.preventDefault()}>
      {(Object.keys(FILTERS) as (keyof Filter)[]).map((name) => (
        <label key={name}>
          <span>{FILTERS[name]}</span>
          <input
            value={filter.value[name] ?? ""}
            placeholder="any"
            onInput={(event) => change(name, event.currentTarget.value)}
          />
        </label>
      ))}
    </form>
  );
}

function GraphCanvas() {
  const container = useRef<HTMLDivElement>(null);
  const drawn = useSignal<RuleGraph | undefined>(undefined);
  useEffect(() => {
    const made = import("../scene/graph").then(({ openGraph }) =>
      container.current ? openGraph(container.current, (id) => (chosenRule.value = id)) : undefined,
    );
    void made.then((found) => (drawn.value = found));
    return () => void made.then((found) => found?.close());
  }, []);
  useEffect(() => {
    drawn.value?.show(graph.value, changed.value, chosenRule.value);
  }, [drawn.value, graph.value, changed.value, chosenRule.value]);
  return (
    <figure class="graph">
      <div ref={container} class="graph-canvas" role="img" aria-label={`${graph.value.edges.length} rules; the table lists them`} />
      <Legend />
    </figure>
  );
}

function Legend() {
  return (
    <figcaption>
      {contexts.value.map((name, index) => (
        <span key={name} class={`context context-${name === "anywhere" ? "none" : index % 6}`}>{name}</span>
      ))}
      <span>thick: sure · dashed: doubtful · barred: against</span>
    </figcaption>
  );
}

function RuleTable() {
  return (
    <table class="rule-table">
      <thead>
        <tr><th scope="col">Thing</th><th scope="col">Says</th><th scope="col">For</th><th scope="col">How sure</th></tr>
      </thead>
      <tbody>
        {graph.value.edges.map((edge) => (
          <Row key={edge.rule} edge={edge} />
        ))}
      </tbody>
    </table>
  );
}

const short = (id: string) => id.split(":").at(-1);

function Row({ edge }: { edge: GraphEdge }) {
  const isChosen = edge.rule === chosenRule.value;
  return (
    <tr class={`${changed.value.has(edge.rule) ? "changed" : ""} ${isChosen ? "chosen" : ""}`}>
      <td>
        <button type="button" class="link" aria-pressed={isChosen} onClick={() => (chosenRule.value = edge.rule)}>
          {short(edge.from)}
        </button>
      </td>
      <td>{edge.functor === "usedFor" ? "used for" : "by the"} {short(edge.to)}</td>
      <td>{contextOf(edge)}</td>
      <td>{intervalText(edge)}</td>
    </tr>
  );
}
