import type { Utterance } from "../api/types";
import { utterances } from "../state/conversation";
import { goTo } from "../state/rules";
import { showTab } from "../state/view";

/** Everything that was said, the newest first. */
export function HistoryView() {
  if (utterances.value.length === 0) return <p class="empty">Nothing was said yet.</p>;
  return (
    <ol class="history" reversed>
      {utterances.value.toReversed().map((said) => (
        <Entry key={said.sequence} said={said} />
      ))}
    </ol>
  );
}

function effects({ asserts, retracts, supersedes }: Utterance): string {
  const counts: [string[], string][] = [[asserts, "learned"], [retracts, "retracted"], [supersedes, "superseded"]];
  return counts.flatMap(([ids, what]) => (ids.length ? [`${ids.length} ${what}`] : [])).join(", ");
}

function Entry({ said }: { said: Utterance }) {
  const show = () => {
    goTo(said.sequence);
    showTab("rules");
  };
  return (
    <li value={said.sequence} class={said.accepted ? "" : "rejected"}>
      <p class="said">{said.text}</p>
      <p class="answer">{said.answer}</p>
      <p class="meta">
        {said.speaker} · <time dateTime={said.time}>{new Date(said.time).toLocaleTimeString()}</time> · {said.kind}
        {effects(said) && ` · ${effects(said)}`}{" "}
        <button type="button" class="link" onClick={show}>rules then</button>
      </p>
    </li>
  );
}
