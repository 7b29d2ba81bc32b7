/** What of the page is shown: the place, the pane of a narrow screen, the tab of the reasons. */

import { signal } from "@preact/signals";

export type Place = "robot" | "ask" | "evaluations";
export type Pane = "talk" | "scene" | "why";
export type WhyTab = "tree" | "proof" | "rules" | "history";

const PLACES: readonly Place[] = ["robot", "ask", "evaluations"];
const placeOf = (hash: string): Place =>
  PLACES.find((each) => hash === `#/${each}`) ?? "robot";

export const place = signal<Place>(placeOf(location.hash));
export const pane = signal<Pane>("talk");
export const tab = signal<WhyTab>("tree");

addEventListener("hashchange", () => {
  place.value = placeOf(location.hash);
});

/** Show a tab of the reasons, on a narrow screen too. */
export function showTab(name: WhyTab): void {
  tab.value = name;
  pane.value = "why";
}
