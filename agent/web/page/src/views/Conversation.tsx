import { useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { edgeText, RuleChip, showRule } from "../parts/RuleChip";
import { graph } from "../state/rules";
import { pane } from "../state/view";
import { answer, choose, isEmpty, recalled, say, turns, type Turn } from "../state/conversation";
import { Guide } from "./Guide";
import { TalkBar } from "./TalkBar";

const EXAMPLES: Record<string, string> = {
  Teach: "To pass a mug grab the mug by the handle.",
  Command: "pass me something used for cutting",
  Question: "What is a knife used for?",
  Forbid: "Never pass a knife to a child.",
};
const draft = { text: "" };

export function Conversation() {
  const end = useRef<HTMLDivElement>(null);
  useEffect(() => end.current?.scrollIntoView({ block: "end" }), [turns.value, pane.value]);
  return (
    <section class="pane talk" aria-labelledby="talk-title">
      <h2 id="talk-title">Conversation</h2>
      <div class="log" role="log" aria-live="polite" aria-label="What was said" tabIndex={0}>
        {isEmpty.value && turns.value.length === 0 && (
          <p class="empty">Nothing was said yet. Teach Hilt what things are for and how to hold them.</p>
        )}
        {turns.value.map((turn) => (
          <TurnView key={turn.key} turn={turn} />
        ))}
        <div ref={end} />
      </div>
      <Guide />
      <Composer />
      <TalkBar />
    </section>
  );
}

function TurnView({ turn }: { turn: Turn }) {
  const isWaiting = turn.answer === undefined;
  return (
    <article class="turn" data-sequence={turn.sequence} data-outcome={turn.outcome ?? "waiting"}>
      <div class="bubble person">
        {turn.speaker && <span class="who">{turn.speaker}</span>}
        <p>{turn.text}</p>
      </div>
      <div class={`bubble hilt ${turn.outcome ?? "waiting"}`} aria-busy={isWaiting}>
        {isWaiting ? <Dots /> : <p>{turn.answer}</p>}
        {turn.meaning && <MeaningLine text={turn.meaning} />}
        <RuleChips turn={turn} />
        {turn.confirm !== undefined && (turn.choices ? <Choices turn={turn} /> : <YesOrNo turn={turn} />)}
        {turn.error && <Nearest turn={turn} />}
      </div>
    </article>
  );
}

function Dots() {
  return <p class="dots" aria-label="Hilt is at it"><i /><i /><i /></p>;
}

function MeaningLine({ text }: { text: string }) {
  return (
    <details class="meaning">
      <summary>Understood</summary>
      <code>{text}</code>
    </details>
  );
}

function RuleChips({ turn: { rules, asserts } }: { turn: Turn }) {
  if (rules?.length) {
    return <p class="chips">{rules.map((rule) => <RuleChip key={rule.id} rule={rule} />)}</p>;
  }
  if (!asserts?.length) return null;
  return (
    <p class="chips">
      {asserts.map((id) => (
        <button key={id} type="button" class="chip rule-chip" onClick={() => showRule(id)}>
          {edgeText(graph.value.edges.find((edge) => edge.rule === id))}
        </button>
      ))}
    </p>
  );
}

function YesOrNo({ turn }: { turn: Turn }) {
  return (
    <p class="chips">
      <button type="button" class="primary" onClick={() => void answer(turn, true)}>Yes</button>
      <button type="button" onClick={() => void answer(turn, false)}>No</button>
    </p>
  );
}

function Choices({ turn }: { turn: Turn }) {
  const numbers = Array.from({ length: turn.choices ?? 0 }, (_, i) => i + 1);
  return (
    <p class="chips">
      {numbers.map((number) => (
        <button key={number} type="button" class="primary" onClick={() => void choose(turn, number)}>{number}</button>
      ))}
      <button type="button" onClick={() => void answer(turn, false)}>None of them</button>
    </p>
  );
}

function Nearest({ turn: { error } }: { turn: Turn }) {
  if (!error) return null;
  return (
    <div class="nearest">
      {error.where && <p>Understood so far: <q>{error.where}</q></p>}
      {error.expected.length > 0 && <p>Expected: {error.expected.join(", ")}</p>}
      {error.nearest.length > 0 && <p>You could say:</p>}
      <p class="chips">
        {error.nearest.map((text) => (
          <button key={text} type="button" class="chip" onClick={() => void say(text)}>{text}</button>
        ))}
      </p>
    </div>
  );
}

function Composer() {
  const text = useSignal(draft.text);
  const place = useRef(0); // how many sentences back
  const change = (value: string) => (draft.text = text.value = value);
  const send = (event: Event) => {
    event.preventDefault();
    const said = text.value.trim();
    if (!said) return;
    place.current = 0;
    change("");
    void say(said);
  };
  const recall = (event: KeyboardEvent) => {
    const step = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (!step) return;
    const found = recalled.value;
    place.current = Math.min(Math.max(place.current + step, 0), found.length);
    change(place.current ? (found.at(-place.current) ?? "") : "");
    event.preventDefault();
  };
  return (
    <form class="composer" onSubmit={send}>
      <details class="examples">
        <summary>Examples</summary>
        <p class="chips">
          {Object.entries(EXAMPLES).map(([kind, example]) => (
            <button key={kind} type="button" class="chip" onClick={() => change(example)}>
              <b>{kind}</b> {example}
            </button>
          ))}
        </p>
      </details>
      <label for="utterance" class="hidden">Say something to Hilt</label>
      <input
        id="utterance"
        autocomplete="off"
        maxLength={2000}
        placeholder="Teach, ask or command …"
        value={text.value}
        onInput={(event) => change(event.currentTarget.value)}
        onKeyDown={recall}
      />
      <button type="submit" class="primary" disabled={!text.value.trim()}>Say</button>
    </form>
  );
}
