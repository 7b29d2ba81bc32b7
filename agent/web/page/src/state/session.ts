/** The connection to the service: what comes over it goes to the part of the state it is about. */

import { effect, signal } from "@preact/signals";
import { readHistory, readLastEpisode, Refusal, whoAmI } from "../api/client";
import { LiveClient } from "../api/live";
import type { Caller, Evaluation, Hello, LiveEvent, SceneModel } from "../api/types";
import { begin, take } from "./conversation";
import { recall, takeCommand, takeDecision, takeStep, touched } from "./execution";
import { takeFrame, untilShown } from "./frames";
import { attempt } from "./notices";
import { keepGraph, renew } from "./rules";

const UNKNOWN = 401;
const MOST_HISTORY = 500; // utterances that the page shows

/** What waits for the picture of it. */
const PACED: ReadonlySet<string> = new Set(["step", "decision", "touch", "said"]);

export type Connection = "connecting" | "open" | "lost" | "closing" | "stranger";

export const connection = signal<Connection>("connecting");
export const caller = signal<Caller | undefined>(undefined);
export const hello = signal<Hello | undefined>(undefined);
export const scene = signal<SceneModel | undefined>(undefined);
export const progress = signal<Evaluation | undefined>(undefined); // of what runs now
let walked: string | undefined; // the command of the last step

/** Open the page's session: who asks, what was said, and what happens from now on. */
export async function connect(): Promise<void> {
  effect(() => {
    document.documentElement.dataset["connection"] = connection.value;
  });
  try {
    caller.value = await whoAmI();
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    connection.value = error.problem.status === UNKNOWN ? "stranger" : "lost";
    return;
  }
  keepGraph();
  new LiveClient({
    onEvent: (event) => void takeInTime(event),
    onFrame: takeFrame,
    onState: (isOpen) => (connection.value = isOpen ? "open" : "lost"),
    onStranger: () => (connection.value = "stranger"),
  }).open();
}

/** Whether who asks has a role; an admin has all. */
export function may(role: string): boolean {
  return caller.value?.roles.some((each) => each === role || each === "admin") ?? false;
}

/** Whether a rule of a speaker may be taken back from here. */
export function mayForget(speaker: string): boolean {
  return may("admin") || (may("teacher") && speaker === caller.value?.speaker);
}

async function takeHello(event: Hello): Promise<void> {
  const isFirst = hello.value === undefined;
  hello.value = event;
  scene.value = event.scene;
  renew();
  if (isFirst) {
    const since = Math.max(0, event.sequence - MOST_HISTORY);
    begin((await attempt(() => readHistory(since))) ?? []);
    const [last] = (await attempt(readLastEpisode)) ?? [];
    if (last) recall(last);
  }
}

async function takeInTime(event: LiveEvent): Promise<void> {
  const isEnd = event.type === "command" && event.state === "done";
  if (isEnd || PACED.has(event.type)) await untilShown();
  takeEvent(event);
}

function takeEvent(event: LiveEvent): void {
  switch (event.type) {
    case "hello":
      void takeHello(event);
      break;
    case "said":
      take(event, event.reply);
      break;
    case "rules":
      renew();
      break;
    case "command":
      takeCommand(event);
      break;
    case "step":
      takeStep(event, event.command !== walked);
      walked = event.command;
      break;
    case "decision":
      takeDecision(event.decision, event.proofs);
      break;
    case "touch":
      touched.value = event.parts;
      break;
    case "scene":
      scene.value = event;
      break;
    case "progress":
      progress.value = event;
      break;
    case "closing":
      connection.value = "closing";
      break;
  }
}
