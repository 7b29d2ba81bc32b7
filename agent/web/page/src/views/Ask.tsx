import { useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { askQuestion, readQuestions } from "../api/client";
import type { Question, Results } from "../api/types";
import { Tabs } from "../parts/Tabs";
import { attempt } from "../state/notices";

/** Named questions, and SPARQL of one's own. */
export function Ask() {
  const chosen = useSignal("questions");
  const tabs = [{ name: "questions", label: "Questions" }, { name: "sparql", label: "SPARQL" }];
  return (
    <section class="pane ask" aria-labelledby="ask-title">
      <h2 id="ask-title">Ask the knowledge base</h2>
      <Tabs label="Ways to ask" tabs={tabs} chosen={chosen.value} choose={(name) => (chosen.value = name)}>
        {chosen.value === "questions" ? <Questions /> : <Sparql />}
      </Tabs>
    </section>
  );
}

function Questions() {
  const known = useSignal<Question[]>([]);
  const name = useSignal("counts");
  const results = useSignal<Results | undefined>(undefined);
  useEffect(() => void attempt(readQuestions).then((found) => (known.value = found ?? [])), []);
  const question = known.value.find((each) => each.name === name.value);
  const choose = (value: string) => {
    name.value = value;
    results.value = undefined;
  };
  return (
    <>
      <p class="which">
        <label for="question">Question</label>
        <select id="question" value={name.value} onChange={(event) => choose(event.currentTarget.value)}>
          {known.value.map((each) => (
            <option key={each.name} value={each.name}>{each.question}</option>
          ))}
        </select>
      </p>
      {question && <Parameters key={question.name} question={question} onResults={(found) => (results.value = found)} />}
      {results.value && <ResultTable results={results.value} />}
    </>
  );
}

interface ParametersProps {
  question: Question;
  onResults(found: Results | undefined): void;
}

function Parameters({ question, onResults }: ParametersProps) {
  const given = useRef<Record<string, string>>({});
  const send = (event: Event) => {
    event.preventDefault();
    const said = Object.entries(given.current).filter(([, value]) => value.trim() !== "");
    void attempt(() => askQuestion(question.name, Object.fromEntries(said))).then(onResults);
  };
  return (
    <form class="parameters" onSubmit={send}>
      {question.parameters.map(({ name, kind }) => (
        <label key={name}>
          <span>{name} <small>({kind})</small></span>
          <input onInput={(event) => (given.current[name] = event.currentTarget.value)} />
        </label>
      ))}
      <button type="submit" class="primary">Ask</button>
    </form>
  );
}

function ResultTable({ results }: { results: Results }) {
  if (results.boolean !== undefined) return <p class="verdict">{results.boolean ? "Yes" : "No"}</p>;
  const names = results.head.vars ?? [];
  const rows = results.results?.bindings ?? [];
  if (rows.length === 0) return <p class="empty">Nothing fits.</p>;
  return (
    <div class="results" role="region" aria-label="Results" tabIndex={0}>
      <table>
        <thead>
          <tr>{names.map((name) => <th key={name} scope="col">{name}</th>)}</tr>
        </thead>
        <tbody>
          {rows.map((row, index) => (
            <tr key={index}>{names.map((name) => <td key={name}>{shortened(row[name]?.value)}</td>)}</tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

const shortened = (value = "") => value.replace(/^https:\/\/w3id\.org\/hilt(\/|#)/, "");

function Sparql() {
  const container = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const made = import("../parts/yasgui").then(({ openYasgui }) =>
      container.current ? openYasgui(container.current) : undefined,
    );
    return () => void made.then((close) => close?.());
  }, []);
  return <div ref={container} class="yasgui-place" />;
}
