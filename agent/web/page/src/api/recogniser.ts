/** The browser's own recogniser of speech, which may send the sound to its maker. */

import type { Heard } from "./types";

interface Result extends ArrayLike<{ transcript: string; confidence: number }> {
  isFinal: boolean;
}

interface Recogniser extends EventTarget {
  lang: string;
  interimResults: boolean;
  maxAlternatives: number;
  onresult: (event: { results: ArrayLike<Result> }) => void;
  onend: () => void;
  start(): void;
  stop(): void;
  abort(): void;
}

type Maker = new () => Recogniser;
const known = window as unknown as Record<string, Maker | undefined>;
const maker = known["SpeechRecognition"] ?? known["webkitSpeechRecognition"];

/** Whether this browser has one. */
export const hasRecogniser = maker !== undefined;
const MOST = 5; // alternatives
const UNSURE = 0.89; // the most that a single recogniser is trusted: what it hears is read back

/** An utterance that the browser hears; `onText` is told what it is so far. */
export class BrowserHearing {
  private readonly recogniser: Recogniser;
  private heard: Heard = { text: "", heard: 0, alternatives: [] };
  private readonly ended: Promise<unknown>;

  constructor(onText: (text: string) => void) {
    if (!maker) throw new Error("This browser has no recogniser.");
    const recogniser = new maker();
    recogniser.lang = "en-US";
    recogniser.interimResults = true;
    recogniser.maxAlternatives = MOST;
    recogniser.onresult = ({ results }) => {
      const last = results[results.length - 1];
      if (!last) return;
      const alternatives = Array.from(last, ({ transcript, confidence }) => ({
        text: transcript.trim(),
        score: Math.min(UNSURE, confidence),
      }));
      this.heard = {
        text: alternatives[0]?.text ?? "", heard: alternatives[0]?.score ?? 0, alternatives,
      };
      onText(this.heard.text);
    };
    this.ended = new Promise<void>((done) => (recogniser.onend = done));
    this.recogniser = recogniser;
    recogniser.start();
  }

  /** Stop, and return what was heard. */
  async end(): Promise<Heard> {
    this.recogniser.stop();
    await this.ended;
    return this.heard;
  }

  /** Stop, and forget it. */
  cancel(): void {
    this.recogniser.abort();
  }
}
