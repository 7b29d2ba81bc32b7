import { useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { setTable } from "../api/client";
import { focus, isBusy, touched } from "../state/execution";
import { attempt, notice } from "../state/notices";
import { pointed, takePlace } from "../state/pointing";
import { may, scene } from "../state/session";
import type { CameraName, SceneViewer } from "../scene/viewer";

const CAMERAS: Record<CameraName, string> = {
  overview: "Overview", front: "Front", top: "Top", hand: "Close",
};
const HIGHEST_SEED = 100_000;

export function ScenePane() {
  const canvas = useRef<HTMLCanvasElement>(null);
  const viewer = useSignal<SceneViewer | undefined>(undefined);
  const hovered = useSignal<string | undefined>(undefined);
  const hasModel = scene.value?.url !== undefined;
  useEffect(() => {
    if (!canvas.current || !hasModel) return undefined;
    const made = openViewer(canvas.current, (name) => (hovered.value = name));
    void made.then((found) => (viewer.value = found));
    return () => {
      viewer.value = undefined;
      void made.then((found) => found.close());
    };
  }, [hasModel]);
  useEffect(() => void show(viewer.value), [viewer.value, scene.value?.url, scene.value?.number]);
  useEffect(() => viewer.value?.light(lit()), [viewer.value, focus.value, touched.value]);
  useEffect(() => viewer.value?.markPlace(pointed.value), [viewer.value, pointed.value]);
  return (
    <section class="pane scene" aria-labelledby="scene-title">
      <h2 id="scene-title">Scene</h2>
      <div class="stage">
        <canvas ref={canvas} role="img" aria-label={description()} />
        {!hasModel && <Absent />}
        {hovered.value && <p class="hovered">{hovered.value.replace("/", ": ")}</p>}
        {pointed.value && <Pointed />}
        {hasModel && focus.value && <p class="focus" role="status">{focus.value.replace("/", ": ")}</p>}
      </div>
      <div class="tools" role="group" aria-label="Camera">
        {(Object.keys(CAMERAS) as CameraName[]).map((name) => (
          <button key={name} type="button" disabled={!viewer.value} onClick={() => viewer.value?.look(name)}>
            {CAMERAS[name]}
          </button>
        ))}
        <NewTable />
      </div>
    </section>
  );
}

/** The names of nodes to light up: the part that the walk is about, and all of an object. */
function lit(): string[] {
  const about = focus.value;
  if (!about) return [];
  return (scene.value?.nodes ?? []).filter((node) => node === about || node.startsWith(`${about}/`));
}

function description(): string {
  const things = scene.value?.things.map(({ name }) => name) ?? [];
  return `The table, live, with ${things.join(", ") || "nothing on it"}`;
}

async function openViewer(canvas: HTMLCanvasElement, onHover: (name: string | undefined) => void) {
  const flags = document.documentElement.dataset;
  const { SceneViewer } = await import("../scene/viewer"); // three.js comes after the page
  return new SceneViewer(canvas, {
    onHover,
    onPoint: (x, y) => (pointed.value = [x, y]),
    onDrawn: () => (flags["scene"] = "drawn"),
    onMoving: (isMoving) => (flags["moving"] = String(isMoving)),
  });
}

async function show(viewer: SceneViewer | undefined): Promise<void> {
  const { number, url, nodes } = scene.value ?? {};
  if (!viewer || number === undefined || !url || !nodes) return;
  await viewer.load(number, url.replace(/^\//, ""), nodes).catch((error: unknown) => {
    notice.value = `The scene cannot be shown: ${String(error)}`;
  });
}

/** Says that the next sentence is about the place that was clicked. */
function Pointed() {
  return (
    <p class="pointed" role="status">
      Your next sentence is about this place.
      <button type="button" onClick={() => void takePlace()}>Do not point</button>
    </p>
  );
}

function Absent() {
  const text = scene.value?.moves === false
    ? "Hilt has no body here, and only says what it would do. It has one with the extra “sim” (pip install \"hilt[sim]\") and without --no-sim."
    : "The scene is being made …";
  return <p class="absent">{text}</p>;
}

function NewTable() {
  const lay = () => {
    const seed = Math.floor(Math.random() * HIGHEST_SEED);
    void attempt(() => setTable("all", seed));
  };
  if (!may("operator")) return null;
  return (
    <button type="button" class="new-table" disabled={isBusy.value || !scene.value} onClick={lay}>
      New table
    </button>
  );
}
