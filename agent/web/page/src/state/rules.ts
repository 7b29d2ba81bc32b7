/** The rules as a graph: as they are now, or as they were at an utterance. */

import { computed, effect, signal } from "@preact/signals";
import { readGraph } from "../api/client";
import type { Graph, GraphEdge } from "../api/types";
import { lastSequence, utterances } from "./conversation";
import { attempt } from "./notices";

const PATIENCE = 150; // [ms] that a filter or the slider rests before the service is asked

export interface Filter {
  object?: string;
  part?: string;
  context?: string;
  affordance?: string;
}

export const graph = signal<Graph>({ nodes: [], edges: [] });
export const filter = signal<Filter>({});
export const moment = signal<number | undefined>(undefined); // an utterance; undefined for now
export const chosenRule = signal<string | undefined>(undefined);
export const changed = signal<ReadonlySet<string>>(new Set()); // rules, by the last change
export const contexts = computed(() => [...new Set(graph.value.edges.map(contextOf))].sort());
const version = signal(0);
let isOfNow = true; // what `graph` shows

export function contextOf(edge: GraphEdge): string {
  return edge.contexts.replaceAll("action:", "") || "anywhere";
}

/** Read the graph again, for something has changed. */
export function renew(): void {
  version.value += 1;
}

/** Keep the graph up to date with filter, moment and news, from now on. */
export function keepGraph(): void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  effect(() => {
    const query = { ...filter.value, at: moment.value };
    void version.value;
    clearTimeout(timer);
    timer = setTimeout(() => void attempt(() => load(query)), PATIENCE);
  });
}

async function load(query: Filter & { at: number | undefined }): Promise<void> {
  const found = await readGraph({ ...query });
  if (query.at !== moment.value) return; // the slider went on
  changed.value = query.at === undefined ? newRules(found) : saidAt(query.at);
  graph.value = found;
  isOfNow = query.at === undefined;
}

function newRules(found: Graph): ReadonlySet<string> {
  const known = new Set(graph.value.edges.map((edge) => edge.rule));
  const news = found.edges.map((edge) => edge.rule).filter((rule) => !known.has(rule));
  return new Set(isOfNow && known.size ? news : []);
}

function saidAt(sequence: number): ReadonlySet<string> {
  return new Set(utterances.value.find((each) => each.sequence === sequence)?.asserts);
}

/** Show the rules as they were at an utterance; now, when it is the last one. */
export function goTo(sequence: number): void {
  moment.value = sequence >= lastSequence.value ? undefined : sequence;
}
