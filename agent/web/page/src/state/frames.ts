/** Frames of the live scene on their way to the picture, and what waits for the picture. */

import { PosePlayer, readFrame } from "../scene/player";

export const player = new PosePlayer();
let waiting: { frame: number; go: () => void }[] = [];
let isShown = false;

export function takeFrame(bytes: ArrayBuffer): void {
  const frame = readFrame(bytes);
  if (frame) player.push(frame, performance.now());
}

/** Say whether there is a picture that follows the frames. */
export function setShown(isNow: boolean): void {
  isShown = isNow;
  if (!isNow) release(Infinity);
}

/**
 * Wait until the picture shows what had arrived by now: the world may be faster than the clock,
 * and a step should light up when it is seen.
 */
export function untilShown(): Promise<void> {
  if (!isShown || document.hidden || player.isStill) return Promise.resolve();
  return new Promise((go) => waiting.push({ frame: player.newest, go }));
}

/** Let go on what waited for a time of the world [s], or for an earlier one. */
export function release(time: number): void {
  const due = waiting.filter((each) => each.frame <= time);
  waiting = waiting.filter((each) => each.frame > time);
  due.forEach((each) => each.go());
}

document.addEventListener("visibilitychange", () => document.hidden && release(Infinity));
