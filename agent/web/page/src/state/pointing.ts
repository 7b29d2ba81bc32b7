/** Where on the table the person points: x and y [m]; the next sentence is about what is there. */

import { signal } from "@preact/signals";

export type Place = [number, number];

export const pointed = signal<Place | undefined>(undefined);

/** The place, which counts for one sentence. */
export function takePlace(): Place | undefined {
  const found = pointed.value;
  pointed.value = undefined;
  return found;
}
