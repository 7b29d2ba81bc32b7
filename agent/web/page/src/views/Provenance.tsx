import { useSignal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { forget, readRule, type ToldRule } from "../api/client";
import { IntervalBar } from "../parts/IntervalBar";
import { ruleText } from "../parts/RuleChip";
import { attempt } from "../state/notices";
import { chosenRule, renew } from "../state/rules";
import { mayForget } from "../state/session";

/** Who said a rule, when and in which words; and how to take it back. */
export function Provenance() {
  const rule = useSignal<ToldRule | undefined>(undefined);
  useEffect(() => {
    rule.value = undefined;
    const id = chosenRule.value;
    if (id) void attempt(() => readRule(id)).then((found) => (rule.value = found));
  }, [chosenRule.value]);
  if (!rule.value) return null;
  return <Details rule={rule.value} />;
}

function Details({ rule }: { rule: ToldRule }) {
  const said = rule.utterance;
  return (
    <section class="provenance" aria-labelledby="provenance-title" data-rule={rule.id}>
      <h3 id="provenance-title">{ruleText(rule)}</h3>
      <button type="button" class="close" aria-label="Close" onClick={() => (chosenRule.value = undefined)}>×</button>
      <p><IntervalBar {...rule} /></p>
      {said ? (
        <blockquote>
          <p>{said.text}</p>
          <footer>
            {said.speaker}, <time dateTime={said.time}>{new Date(said.time).toLocaleString()}</time>, utterance{" "}
            {said.sequence}
          </footer>
        </blockquote>
      ) : <p>Said by {rule.speaker}.</p>}
      {rule.status !== "active" && <p>It is {rule.status}.</p>}
      {rule.status === "active" && mayForget(rule.speaker) && <Forget rule={rule} />}
    </section>
  );
}

function Forget({ rule }: { rule: ToldRule }) {
  const isSure = useSignal(false);
  const act = async () => {
    if (!isSure.value) {
      isSure.value = true;
      return;
    }
    await attempt(() => forget(rule.id));
    chosenRule.value = undefined;
    renew();
  };
  return (
    <p>
      <button type="button" class={isSure.value ? "danger" : ""} onClick={() => void act()}>
        {isSure.value ? "Really forget it" : "Forget"}
      </button>
      {isSure.value && <small> It is retracted; the history keeps it.</small>}
    </p>
  );
}
