import type { Rule } from "../api/types";
import { chosenRule } from "../state/rules";
import { showTab } from "../state/view";
import { intervalText } from "./IntervalBar";

/** "pass: knife → blade", in short. */
export function ruleText({ object, part, affordance, context }: Rule): string {
  const about = `${object} → ${part ?? affordance ?? "?"}`;
  return context ? `${context}: ${about}` : about;
}

/** A rule to click on, which opens who said it. */
export function RuleChip({ rule }: { rule: Rule }) {
  return (
    <button type="button" class="chip rule-chip" onClick={() => showRule(rule.id)}>
      {ruleText(rule)} <small>{intervalText(rule)}</small>
    </button>
  );
}

export function showRule(id: string): void {
  chosenRule.value = id;
  showTab("rules");
}
