/** What is said, by everybody: from the history, from events, and from this page at once. */

import { computed, signal } from "@preact/signals";
import { confirm, hear, Refusal } from "../api/client";
import { untilShown } from "./frames";
import { takePlace } from "./pointing";
import type { Heard, Misunderstanding, Reply, Rule, Utterance } from "../api/types";

const MOST_TURNS = 200; // on the page; the history has all
const MOST_RECALLED = 50;
const ORDINALS = ["first", "second", "third", "fourth", "fifth"];

/** One utterance and its answer; it has no number yet while it waits. */
export interface Turn {
  key: string;
  sequence?: number | undefined;
  speaker: string;
  text: string;
  answer?: string;
  outcome?: string;
  meaning?: string | null;
  rules?: Rule[];
  asserts?: string[];
  confirm?: string | undefined;
  choices?: number | undefined; // from which one is to be taken
  error?: Misunderstanding | undefined;
}

export const turns = signal<readonly Turn[]>([]);
export const utterances = signal<readonly Utterance[]>([]);
export const recalled = signal<readonly string[]>([]);
export const answered = signal({ text: "" }); // the last answer to what was said on this page
export const isEmpty = computed(() => utterances.value.length === 0);
export const lastSequence = computed(() => utterances.value.at(-1)?.sequence ?? 0);
let count = 0;

function append(turn: Turn): void {
  turns.value = [...turns.value, turn].slice(-MOST_TURNS);
}

function change(key: string, news: Partial<Turn>): void {
  turns.value = turns.value.map((each) => (each.key === key ? { ...each, ...news } : each));
}

/** Begin with what was said before; what is said since has come in the meantime. */
export function begin(history: readonly Utterance[]): void {
  const last = history.at(-1)?.sequence ?? 0;
  utterances.value = [...history, ...utterances.value.filter(({ sequence }) => sequence > last)];
  const since = turns.value.filter(({ sequence = Infinity }) => sequence > last);
  turns.value = [...history.map(turnOf), ...since].slice(-MOST_TURNS);
}

function turnOf(said: Utterance): Turn {
  return {
    key: `u${said.sequence}`,
    sequence: said.sequence,
    speaker: said.speaker,
    text: said.text,
    answer: said.answer,
    outcome: said.kind === "error" ? "not_understood" : said.accepted ? "done" : "failed",
    meaning: said.predicate,
    asserts: said.asserts,
  };
}

/** Take what was said by anybody; it may be what this page has said itself. */
export function take(said: Utterance, reply?: Reply): void {
  if (utterances.value.some((each) => each.sequence === said.sequence)) return;
  utterances.value = [...utterances.value, said];
  const own = turns.value.find((each) => each.sequence === undefined && each.text === said.text);
  const news: Partial<Turn> = { ...(reply ? ofReply(reply) : {}), ...sequenceOf(said) };
  if (own) change(own.key, news);
  else append({ ...turnOf(said), ...news });
}

function sequenceOf({ sequence, speaker, predicate, asserts }: Utterance): Partial<Turn> {
  return { sequence, speaker, meaning: predicate, asserts };
}

function ofReply(reply: Reply): Partial<Turn> {
  const { said: answer, outcome, rules, confirm: question, choices, error } = reply;
  return { answer, outcome, rules: rules ?? [], confirm: question, choices, error };
}

/** Say something, and wait for the answer; a refusal is shown as one. */
export async function say(text: string, heard?: Heard): Promise<void> {
  const key = `p${(count += 1)}`;
  recalled.value = [...recalled.value.filter((each) => each !== text), text].slice(-MOST_RECALLED);
  append({ key, speaker: "", text });
  await fill(key, hear(text, heard, takePlace()));
}

/** Take one of several choices, by its number from 1 on. */
export async function choose(turn: Turn, number: number): Promise<void> {
  change(turn.key, { confirm: undefined });
  await say(`the ${ORDINALS[number - 1] ?? "last"} one`);
}

/** Answer a question of Hilt by a button. */
export async function answer(turn: Turn, yes: boolean): Promise<void> {
  if (turn.confirm === undefined) return;
  const question = turn.confirm;
  change(turn.key, { confirm: undefined });
  const key = `p${(count += 1)}`;
  append({ key, speaker: "", text: yes ? "yes" : "no" });
  await fill(key, confirm(question, yes));
}

async function fill(key: string, asked: Promise<Reply>): Promise<void> {
  try {
    const reply = await asked;
    await untilShown();
    change(key, ofReply(reply));
    answered.value = { text: reply.said };
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    change(key, { answer: error.message, outcome: "refused" });
  }
}
