import { useEffect } from "preact/hooks";
import {
  begin, consent, end, isSpoken, level, mustConsent, setSpoken, talking, transcript,
} from "../state/speech";

const SIGNS = { off: "Hold to talk", listening: "Listening …", recognising: "Recognising …" };

/** The button to hold while one talks; the space bar does the same where nothing is typed. */
export function TalkBar() {
  useEffect(() => listenToKeys(), []);
  return (
    <div class="talk-bar" data-talking={talking.value}>
      <button
        type="button"
        class="microphone"
        aria-pressed={talking.value === "listening"}
        title="Hold the button or the space bar while you talk; Escape forgets it"
        onPointerDown={() => void begin()}
        onPointerUp={() => end()}
        onPointerLeave={() => end()}
      >
        <Microphone /> {SIGNS[talking.value]}
      </button>
      {talking.value === "listening" && (
        <meter min={0} max={1} value={level.value} aria-label="Loudness" />
      )}
      <label class="spoken">
        <input
          type="checkbox"
          checked={isSpoken.value}
          onChange={(event) => setSpoken(event.currentTarget.checked)}
        />
        Speak answers
      </label>
      <span class="transcript" role="status" aria-live="polite">{transcript.value}</span>
      {mustConsent.value && <Consent />}
    </div>
  );
}

function Microphone() {
  return (
    <svg class="sign" viewBox="0 0 16 16" aria-hidden="true">
      <path d="M8 1a2.5 2.5 0 0 0-2.5 2.5v4a2.5 2.5 0 0 0 5 0v-4A2.5 2.5 0 0 0 8 1Z" />
      <path d="M3.5 7.5a4.5 4.5 0 0 0 9 0M8 12v3" fill="none" stroke="currentColor" stroke-width="1.4" />
    </svg>
  );
}

function Consent() {
  return (
    <div class="consent" role="alertdialog" aria-label="Who may listen">
      <p>
        The service cannot hear: it has no recogniser. This browser has one, but it may send what you
        say to its maker. Let it listen?
      </p>
      <p class="chips">
        <button type="button" class="primary" onClick={() => consent(true)}>Let it listen</button>
        <button type="button" onClick={() => consent(false)}>Go on typing</button>
      </p>
    </div>
  );
}

function listenToKeys(): () => void {
  const isElsewhere = ({ target }: Event) =>
    target instanceof Element && target.closest("input, textarea, select, button:not(.microphone), a, summary, .yasgui, [role=log]");
  const down = (event: KeyboardEvent) => {
    if (event.key === "Escape") end(true);
    if (event.key !== " " || event.repeat || isElsewhere(event)) return;
    event.preventDefault();
    void begin();
  };
  const up = (event: KeyboardEvent) => {
    if (event.key === " " && !isElsewhere(event)) end();
  };
  document.addEventListener("keydown", down);
  document.addEventListener("keyup", up);
  return () => {
    document.removeEventListener("keydown", down);
    document.removeEventListener("keyup", up);
  };
}
