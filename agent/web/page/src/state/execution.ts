/** The command that is carried out: its steps as they are reached and done, and its decision. */

import { computed, signal } from "@preact/signals";
import type { Command, Decision, Episode, Explanation, Proof, Step } from "../api/types";

const DONE = new Set(["walked", "executed"]);

export type StepState = "reached" | "done" | "not done" | "failed";

export const command = signal<Command | undefined>(undefined);
export const waiting = signal(0); // commands in the queue
export const steps = signal<readonly Step[]>([]);
export const decision = signal<Decision | undefined>(undefined);
export const proofs = signal<readonly Proof[]>([]);
export const explanation = signal<Explanation | undefined>(undefined);
export const touched = signal<readonly string[]>([]);
export const isBusy = computed(() => command.value?.state === "begun");

export function stepState({ action }: Step): StepState {
  if (action === "") return "reached";
  if (DONE.has(action)) return "done";
  return action === "not executed" ? "not done" : "failed";
}

/** The part that the walk is about: "knife/blade", or "knife". */
export const focus = computed(() => {
  const found = steps.value.findLast((each) => each.constraint)?.constraint;
  return found ? (found.part ? `${found.object}/${found.part}` : found.object) : undefined;
});

export function takeCommand(news: Command): void {
  const queued = waiting.value + (news.state === "queued" ? 1 : news.state === "begun" ? -1 : 0);
  waiting.value = Math.max(0, queued);
  if (news.state === "begun" || news.command === command.value?.command) command.value = news;
}

/** Take a step: the first of another command begins a new walk. */
export function takeStep(step: Step, isFirst: boolean): void {
  if (isFirst) {
    steps.value = [];
    decision.value = explanation.value = undefined;
    touched.value = proofs.value = [];
  }
  const place = steps.value.findLastIndex((each) => each.node === step.node && !each.action);
  const isNews = step.action !== "" && place >= 0;
  steps.value = isNews ? steps.value.with(place, step) : [...steps.value, step];
}

/** Show a command of the past, unless there is one of now. */
export function recall({ id, utterance: text, decision: found, steps: done, world }: Episode): void {
  if (steps.value.length) return;
  command.value = { command: id, state: "done", text, speaker: "" };
  steps.value = done;
  touched.value = world.touched ?? [];
  if (found) takeDecision(found, []);
}

export function takeDecision(found: Decision, why: readonly Proof[]): void {
  decision.value = found;
  proofs.value = why;
}
