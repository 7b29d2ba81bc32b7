/** Talking instead of typing: press, speak, let go. Answers are spoken where that is wanted. */

import { signal } from "@preact/signals";
import { listen, Refusal, voiceAddress } from "../api/client";
import { BrowserHearing, hasRecogniser } from "../api/recogniser";
import { Recording } from "../api/sound";
import type { Heard } from "../api/types";
import { answered, say } from "./conversation";
import { notice } from "./notices";

const LONGEST_MS = 29_000;
const GLANCE_MS = 900; // between two looks at what was said so far
const LEVEL_MS = 60;
const NOT_INSTALLED = "urn:hilt:not-installed";

export type Talking = "off" | "listening" | "recognising";

export const talking = signal<Talking>("off");
export const level = signal(0); // how loud it is, in [0, 1]
export const transcript = signal(""); // what was said so far
export const mustConsent = signal(false); // to the browser's recogniser, for there is no other one
export const isSpoken = signal(localStorage.getItem("hilt.spoken") === "yes"); // the answers
let byBrowser = localStorage.getItem("hilt.browser-hears") === "yes";

const player = new Audio();
let ended: ((isCancelled: boolean) => void) | undefined;
answered.subscribe(({ text }) => void (text && speak(text)));

/** Begin to listen, and stop speaking; what is said is taken at the end. */
export async function begin(): Promise<void> {
  if (talking.value !== "off") return;
  hush();
  talking.value = "listening";
  transcript.value = "";
  const end = new Promise<boolean>((done) => {
    ended = done;
    setTimeout(() => done(false), LONGEST_MS);
  });
  try {
    const heard = await (byBrowser && hasRecogniser ? hearInBrowser(end) : hearInService(end));
    talking.value = "off";
    if (heard?.text) await say(heard.text, heard);
    else if (heard) notice.value = "There were no words in it.";
  } catch (error) {
    refuse(error);
  } finally {
    talking.value = "off";
    level.value = 0;
  }
}

/** End what is said: it is taken, or forgotten. */
export function end(isCancelled = false): void {
  ended?.(isCancelled);
}

/** Let answers be spoken from now on, or not. */
export function setSpoken(wanted: boolean): void {
  isSpoken.value = wanted;
  localStorage.setItem("hilt.spoken", wanted ? "yes" : "no");
  if (!wanted) hush();
}

/** Let the browser hear from now on, or go on typing. */
export function consent(agreed: boolean): void {
  byBrowser = agreed;
  mustConsent.value = false;
  if (agreed) localStorage.setItem("hilt.browser-hears", "yes");
}

async function hearInService(end: Promise<boolean>): Promise<Heard | undefined> {
  const recording = await Recording.begin();
  let isOver = false;
  const meter = setInterval(() => (level.value = recording.level), LEVEL_MS);
  const glances = glance(recording, () => isOver);
  const isCancelled = await end;
  isOver = true;
  clearInterval(meter);
  await recording.end();
  if (isCancelled) return undefined;
  talking.value = "recognising";
  await glances;
  const sound = recording.isSilent ? undefined : await recording.wav();
  return sound ? listen(sound) : { text: "", heard: 0, alternatives: [] };
}

/** Show what is said as long as it is said; a refusal ends only this. */
async function glance(recording: Recording, isOver: () => boolean): Promise<void> {
  for (;;) {
    await new Promise((done) => setTimeout(done, GLANCE_MS));
    if (isOver()) return;
    const sound = recording.isSilent ? undefined : await recording.wav();
    const heard = sound && (await listen(sound).catch(() => undefined));
    if (heard?.text) transcript.value = heard.text;
  }
}

async function hearInBrowser(end: Promise<boolean>): Promise<Heard | undefined> {
  const hearing = new BrowserHearing((text) => (transcript.value = text));
  if (!(await end)) return hearing.end();
  hearing.cancel();
  return undefined;
}

function refuse(error: unknown): void {
  if (error instanceof Refusal) {
    mustConsent.value = error.problem.type === NOT_INSTALLED && hasRecogniser;
    notice.value = error.message;
  } else if (error instanceof DOMException) {
    notice.value = `There is no microphone to listen to: ${error.message}`;
  } else throw error;
}

/** Say an answer, by a voice of this machine: the browser's, or that of the service. */
function speak(text: string): void {
  if (!isSpoken.value) return;
  hush();
  const isOwn = ({ lang, localService }: SpeechSynthesisVoice) => localService && lang.startsWith("en");
  const voice = speechSynthesis.getVoices().find(isOwn);
  if (!voice) {
    player.src = voiceAddress(text);
    player.play().catch(() => undefined); // the person may have begun to speak
    return;
  }
  const utterance = new SpeechSynthesisUtterance(text);
  utterance.voice = voice;
  speechSynthesis.speak(utterance);
}

/** Stop speaking. */
function hush(): void {
  speechSynthesis.cancel();
  player.pause();
}
