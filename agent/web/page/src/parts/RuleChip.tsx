import type { GraphEdge, Rule } from "../api/types";
import { chosenRule, contextOf } from "../state/rules";
import { showTab } from "../state/view";
import { intervalText } from "./IntervalBar";

/** "pass: knife → blade", in short. */
export function ruleText({ object, part, affordance, context }: Rule): string {
  const about = `${object} → ${part ?? affordance ?? "?"}`;
  return context ? `${context}: ${about}` : about;
}

/** The same of an edge of the graph; one that is not in it is a rule of the past. */
export function edgeText(edge: GraphEdge | undefined): string {
  if (!edge) return "a rule of then";
  const [object, other] = [edge.from, edge.to].map((id) => id.slice(id.indexOf(":") + 1));
  const about = `${object} → ${other}`;
  return edge.contexts ? `${contextOf(edge)}: ${about}` : about;
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
