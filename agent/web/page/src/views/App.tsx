import { useEffect } from "preact/hooks";
import { stopRobot } from "../api/client";
import { isBusy, waiting } from "../state/execution";
import { attempt, notice } from "../state/notices";
import { caller, connection, may, type Connection } from "../state/session";
import { pane, place, type Pane, type Place } from "../state/view";
import { Ask } from "./Ask";
import { Conversation } from "./Conversation";
import { Evaluations } from "./Evaluations";
import { LogIn } from "./LogIn";
import { ScenePane } from "./ScenePane";
import { WhyPane } from "./WhyPane";

const PLACES: Record<Place, string> = { robot: "Robot", ask: "Ask", evaluations: "Evaluations" };
const PANES: Record<Pane, string> = { talk: "Talk", scene: "Scene", why: "Why" };
const STATES: Record<Connection, string> = {
  connecting: "Connecting …",
  open: "Connected",
  lost: "Connection lost, trying again …",
  closing: "The service is stopping",
  stranger: "A key is needed",
};

export function App() {
  useEffect(() => {
    addEventListener("keydown", stopByEscape);
    return () => removeEventListener("keydown", stopByEscape);
  }, []);
  return (
    <>
      <a class="skip" href="#utterance">Skip to the conversation</a>
      <Header />
      <Notice />
      <main class={`place-${place.value}`} data-pane={pane.value}>
        {place.value === "robot" && <Robot />}
        {place.value === "ask" && <Ask />}
        {place.value === "evaluations" && <Evaluations />}
      </main>
      {place.value === "robot" && <PaneBar />}
    </>
  );
}

function stopByEscape(event: KeyboardEvent): void {
  if (event.key === "Escape" && isBusy.value) void attempt(stopRobot);
}

function Header() {
  return (
    <header class="top">
      <h1><img src="static/favicon.svg" alt="" width="24" height="24" /> Hilt</h1>
      <nav aria-label="Places">
        {(Object.keys(PLACES) as Place[]).map((name) => (
          <a key={name} href={`#/${name}`} aria-current={name === place.value ? "page" : undefined}>
            {PLACES[name]}
          </a>
        ))}
      </nav>
      <p class={`connection ${connection.value}`} role="status" title={caller.value && `You are ${caller.value.speaker} (${caller.value.roles.join(", ")})`}>
        <span class="dot" aria-hidden="true" />
        <span class="state-text">{STATES[connection.value]}</span>
      </p>
      <StopButton />
    </header>
  );
}

function StopButton() {
  if (!may("operator")) return null;
  const queue = waiting.value ? ` (${waiting.value} waiting)` : "";
  return (
    <button
      type="button"
      class={`stop ${isBusy.value ? "active" : ""}`}
      aria-keyshortcuts="Escape"
      onClick={() => void attempt(stopRobot)}
    >
      <span aria-hidden="true">■</span> Stop{queue}
    </button>
  );
}

function Notice() {
  if (notice.value === undefined) return null;
  return (
    <p class="notice" role="alert">
      {notice.value}
      <button type="button" aria-label="Close this notice" onClick={() => (notice.value = undefined)}>
        ×
      </button>
    </p>
  );
}

function Robot() {
  if (connection.value === "stranger") return <LogIn />;
  return (
    <>
      <Conversation />
      <ScenePane />
      <WhyPane />
    </>
  );
}

function PaneBar() {
  return (
    <nav class="panes" aria-label="Parts of the page">
      {(Object.keys(PANES) as Pane[]).map((name) => (
        <button
          key={name}
          type="button"
          aria-pressed={name === pane.value}
          onClick={() => (pane.value = name)}
        >
          {PANES[name]}
        </button>
      ))}
    </nav>
  );
}
