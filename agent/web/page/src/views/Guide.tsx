import { signal } from "@preact/signals";
import { say, turns } from "../state/conversation";

/** The running example of the paper. */
const SENTENCES = [
  "A knife is used for cutting.",
  "To pass a knife grab the knife by the blade.",
  "To pass a mug grab the mug by the handle.",
  "pass me something used for cutting",
];
const isClosed = signal(false);

const plain = (text: string) => text.toLowerCase().replace(/[^a-z ]/g, "");

/** The first minute on an empty base: three sentences to teach, and a command. */
export function Guide() {
  const said = new Set(turns.value.map((each) => plain(each.text)));
  const next = SENTENCES.findIndex((text) => !said.has(plain(text)));
  const isNew = turns.value.every(({ text }) => SENTENCES.some((s) => plain(s) === plain(text)));
  if (isClosed.value || !isNew || next < 0) return null;
  return (
    <section class="guide" aria-labelledby="guide-title">
      <h3 id="guide-title">Your first minute</h3>
      <button type="button" class="close" aria-label="Close the guide" onClick={() => (isClosed.value = true)}>
        ×
      </button>
      <ol>
        {SENTENCES.map((text, index) => (
          <li key={text} class={index < next ? "done" : index === next ? "next" : ""}>
            {index === next ? (
              <button type="button" class="primary" onClick={() => void say(text)}>{text}</button>
            ) : (
              <span>{text}{index < next && <span class="hidden"> (done)</span>}</span>
            )}
          </li>
        ))}
      </ol>
    </section>
  );
}
