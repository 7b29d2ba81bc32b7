/** The rule graph in cytoscape.js: what things are for on the left, things, and parts on the right. */

import cytoscape, { type Core, type ElementDefinition } from "cytoscape";
import type { Graph, GraphEdge, GraphNode } from "../api/types";
import { contextOf } from "../state/rules";

const COLUMN = 190; // pixels between columns
const ROW = 54;
const LARGEST = 1.2; // magnification of a small graph
const DOUBTFUL = 0.6; // a lower bound below which an edge is dashed
const UNLIKELY = 0.5; // an upper bound below which it speaks against
const COLUMNS: Record<string, number> = { affordance: -1, object: 0, property: 0, part: 1 };
/** Colours that the colour-blind can tell apart (Okabe and Ito). */
const PALETTE = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

export interface RuleGraph {
  show(graph: Graph, changed: ReadonlySet<string>, chosen: string | undefined): void;
  close(): void;
}

export const contextColour = (name: string, names: readonly string[]): string =>
  name === "anywhere" ? "#777777" : (PALETTE[names.indexOf(name) % PALETTE.length] ?? "#777777");

/** Draw graphs into a container from now on. */
export function openGraph(container: HTMLElement, onRule: (id: string) => void): RuleGraph {
  const core = cytoscape({ container, minZoom: 0.2, maxZoom: 2.5, autoungrabify: true });
  const resizes = new ResizeObserver(() => fit(core.resize()));
  resizes.observe(container);
  core.on("tap", "edge", (event) => onRule(event.target.id() as string));
  const rows = new Map<string, number>(); // of each node, as it first appeared
  return {
    show: (graph, changed, chosen) => show(core, graph, rows, changed, chosen),
    close: () => {
      resizes.disconnect();
      core.destroy();
    },
  };
}

function show(
  core: Core,
  graph: Graph,
  rows: Map<string, number>,
  changed: ReadonlySet<string>,
  chosen: string | undefined,
): void {
  const names = [...new Set(graph.edges.map(contextOf))].sort();
  graph.nodes.forEach((node) => placeNode(node, rows));
  const shown = new Set(core.nodes().map((node) => node.id()));
  core.elements().remove();
  core.add(graph.nodes.map((node) => nodeElement(node, rows)));
  core.add(graph.edges.map((edge) => edgeElement(edge, names, changed, chosen)));
  core.style(styleSheet(getComputedStyle(core.container() ?? document.body).color));
  const isSame = shown.size === graph.nodes.length && graph.nodes.every(({ id }) => shown.has(id));
  if (!isSame) fit(core);
}

/** Show all of it, a small graph not larger than life. */
function fit(core: Core): void {
  core.fit(undefined, 24);
  if (core.zoom() > LARGEST) core.zoom(LARGEST).center();
}

function column({ kind }: GraphNode): number {
  return COLUMNS[kind] ?? 1;
}

/** Give a new node the next row of its column; the others stay where they are. */
function placeNode(node: GraphNode, rows: Map<string, number>): void {
  if (rows.has(node.id)) return;
  const key = `column ${column(node)}`;
  const next = rows.get(key) ?? 0;
  rows.set(node.id, next);
  rows.set(key, next + 1);
}

function nodeElement(node: GraphNode, rows: Map<string, number>): ElementDefinition {
  const position = { x: column(node) * COLUMN, y: (rows.get(node.id) ?? 0) * ROW };
  return { group: "nodes", data: { id: node.id, name: node.name, kind: node.kind }, position };
}

function edgeElement(
  edge: GraphEdge,
  names: readonly string[],
  changed: ReadonlySet<string>,
  chosen: string | undefined,
): ElementDefinition {
  const data = {
    id: edge.rule,
    source: edge.from,
    target: edge.to,
    label: `${contextOf(edge)} ${edge.label}`,
    colour: contextColour(contextOf(edge), names),
    width: 1 + 4 * Math.max(edge.lower, 1 - edge.upper),
  };
  const classes = [
    edge.lower < DOUBTFUL && edge.upper > UNLIKELY ? "doubtful" : "",
    edge.upper <= UNLIKELY ? "against" : "",
    changed.has(edge.rule) ? "changed" : "",
    edge.rule === chosen ? "chosen" : "",
  ];
  return { group: "edges", data, classes: classes.filter(Boolean).join(" ") };
}

function styleSheet(ink: string): cytoscape.StylesheetJson {
  const shapes = { affordance: "diamond", object: "round-rectangle", part: "ellipse" };
  return [
    {
      selector: "node",
      style: {
        label: "data(name)", color: ink, "font-size": 13, "text-valign": "bottom",
        "text-margin-y": 4, width: 20, height: 20, "background-color": "#8a99a3",
      },
    },
    ...Object.entries(shapes).map(([kind, shape]) => ({
      selector: `node[kind = "${kind}"]`,
      style: { shape: shape as cytoscape.Css.NodeShape },
    })),
    {
      selector: "edge",
      style: {
        width: "data(width)", "line-color": "data(colour)", "target-arrow-color": "data(colour)",
        "target-arrow-shape": "triangle", "curve-style": "bezier", "arrow-scale": 0.9,
      },
    },
    { selector: ".doubtful", style: { "line-style": "dashed" } },
    { selector: ".against", style: { "target-arrow-shape": "tee", "line-style": "dotted" } },
    { selector: ".changed", style: { "underlay-color": "#f2b84b", "underlay-opacity": 0.5, "underlay-padding": 5 } },
    {
      selector: ".chosen",
      style: {
        "underlay-color": "#1aa0ff", "underlay-opacity": 0.45, "underlay-padding": 6,
        label: "data(label)", color: ink, "font-size": 12, "text-rotation": "autorotate",
        "text-margin-y": -12,
      },
    },
  ] as cytoscape.StylesheetJson;
}
