import { explain } from "../api/client";
import type { Candidate, Change, Decision, Proof, ProofStep } from "../api/types";
import { IntervalBar, intervalText } from "../parts/IntervalBar";
import { showRule } from "../parts/RuleChip";
import { command, decision, explanation, proofs } from "../state/execution";
import { attempt } from "../state/notices";

/** The proof of the decision, the candidates that lost, and what would change it. */
export function ProofView() {
  const found = decision.value;
  if (!found) return <p class="empty">A command is decided first; the reasons are shown here.</p>;
  const named = found.part ? `${found.object}, by the ${found.part}` : (found.object ?? "nothing");
  return (
    <>
      <p class="verdict">Chosen: <b>{named}</b></p>
      <h3>Candidates</h3>
      <ul class="candidates">
        {found.candidates.map((each) => (
          <CandidateView key={each.name + each.reason} candidate={each} decision={found} />
        ))}
      </ul>
      {proofs.value.map((proof) => (
        <ProofTree key={`${proof.node} ${proof.name}`} proof={proof} />
      ))}
      <WhatIf />
    </>
  );
}

function CandidateView({ candidate, decision }: { candidate: Candidate; decision: Decision }) {
  const { name, object, accepted, reason, lambda } = candidate;
  const verdict = !accepted ? "rejected" : object === decision.object ? "chosen" : "accepted";
  return (
    <li class={accepted ? "accepted" : "rejected"}>
      <p>
        <span aria-hidden="true">{accepted ? "✓" : "✕"}</span> <b>{name}</b>{" "}
        {verdict} <IntervalBar {...candidate} />
      </p>
      <p class="reason" title={`lambda ${lambda}, threshold ${decision.threshold}`}>{reason}</p>
    </li>
  );
}

function ProofTree({ proof }: { proof: Proof }) {
  return (
    <section class="proof">
      <h3>{proof.node}: {proof.name}{proof.accepted ? "" : " (rejected)"}</h3>
      <ul role="tree" aria-label={`Proof at ${proof.node}`}>
        <ProofNode step={proof.proof} />
      </ul>
    </section>
  );
}

function ProofNode({ step: { step, about, rule, inputs = [], ...bounds } }: { step: ProofStep }) {
  return (
    <li role="treeitem" aria-expanded={inputs.length ? true : undefined}>
      <p>
        <span class="step-kind">{step}</span> <IntervalBar {...bounds} />
        {about && <span class="about">{about}</span>}
        {rule && <button type="button" class="chip" onClick={() => showRule(rule)}>who said it</button>}
      </p>
      {inputs.length > 0 && (
        <ul role="group">
          {inputs.map((each, index) => (
            <ProofNode key={index} step={each} />
          ))}
        </ul>
      )}
    </li>
  );
}

function WhatIf() {
  const text = command.value?.text;
  const ask = async () => {
    if (text) explanation.value = await attempt(() => explain(text));
  };
  if (!explanation.value) {
    return <p><button type="button" onClick={() => void ask()}>What would change it?</button></p>;
  }
  return (
    <section>
      <h3>What would change it</h3>
      {explanation.value.changes.length === 0 && <p>No single piece of evidence would.</p>}
      <ul class="changes">
        {explanation.value.changes.map((change, index) => (
          <ChangeView key={index} change={change} />
        ))}
      </ul>
    </section>
  );
}

function ChangeView({ change: { about, before, after, chosen } }: { change: Change }) {
  const bounds = ([lower, upper]: [number, number]) => ({ lower, upper });
  return (
    <li>
      <p class="about">{about}</p>
      <p>
        {intervalText(bounds(before))} → <IntervalBar {...bounds(after)} /> then{" "}
        <b>{chosen ?? "nothing would be chosen"}</b>
      </p>
    </li>
  );
}
