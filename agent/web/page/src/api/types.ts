/** The documents of the API: those that the commands print with --json, and the live events. */

export interface Bounds {
  lower: number;
  upper: number;
}

export interface Rule extends Bounds {
  id: string;
  kind: string;
  object: string;
  affordance: string | null;
  context: string | null;
  part: string | null;
  speaker: string;
}

/** What was heard, with a text for each meaning that it may have, surest first. */
export interface Heard {
  text: string;
  heard: number;
  alternatives: { text: string; score: number }[];
}

/** What one utterance of the history did. */
export interface Utterance {
  sequence: number;
  text: string;
  predicate: string | null;
  speaker: string;
  time: string;
  kind: string;
  accepted: boolean;
  answer: string;
  asserts: string[];
  retracts: string[];
  supersedes: string[];
}

export interface GraphNode {
  id: string;
  kind: string;
  name: string;
}

export interface GraphEdge extends Bounds {
  from: string;
  to: string;
  rule: string;
  label: string;
  functor: string;
  contexts: string;
  speaker: string;
  status: string;
  time: string;
}

export interface Graph {
  nodes: GraphNode[];
  edges: GraphEdge[];
}

export interface Candidate {
  object: string;
  name: string;
  lower: number;
  upper: number;
  lambda: number;
  accepted: boolean;
  reason: string;
}

export interface Decision {
  object: string | null;
  part: string | null;
  lower: number | null;
  upper: number | null;
  lambda: number | null;
  threshold: number;
  candidates: Candidate[];
  ties: string[];
  rules: string[];
  patient?: string;
}

export interface Constraint extends Bounds {
  object: string;
  part: string | null;
}

/** One node of an action tree: reached while `action` is empty, and then what became of it. */
export interface Step {
  node: string;
  features: string[];
  percepts: { name: string; confidence: number }[];
  constraint: Constraint | null;
  action: string;
}

export interface ProofStep extends Bounds {
  step: string;
  about?: string;
  rule?: string;
  inputs?: ProofStep[];
}

export interface Proof extends Candidate {
  node: string;
  proof: ProofStep;
}

/** A change of one piece of evidence that would change the decision. */
export interface Change {
  about: string;
  before: [number, number];
  after: [number, number];
  chosen: string | null;
}

export interface Explanation {
  said: string;
  outcome: string;
  proofs: Proof[];
  changes: Change[];
}

/** A command of the past, with what was decided and done. */
export interface Episode {
  id: string;
  utterance: string;
  outcome: string;
  decision: Decision | null;
  steps: Step[];
  world: { touched?: string[] };
}

/** What was not understood: the words that were, what was expected, and what could be said. */
export interface Misunderstanding {
  message: string;
  where: string;
  expected: string[];
  nearest: string[];
}

export interface Reply {
  utterance: string;
  kind: string;
  outcome: string;
  said: string;
  goal?: string;
  rules?: Rule[];
  decision?: Decision | null;
  steps?: Step[];
  error?: Misunderstanding;
  confirm?: string; // the name of a question that waits for yes or no
  choices?: number; // between which it asks
}

export interface Problem {
  type?: string;
  title: string;
  status: number;
  detail: string;
}

/** What stands on the table; with a body, its model and the names of the model's nodes. */
export interface SceneModel {
  scene: string;
  seed: number;
  things: { name: string; object: string }[];
  moves: boolean; // whether there is a body, or will be one soon
  number?: number;
  url?: string;
  nodes?: string[];
}

/** For whom the page speaks, and what that one may do. */
export interface Caller {
  id: string;
  speaker: string;
  roles: string[];
}

export interface Question {
  name: string;
  question: string;
  parameters: { name: string; kind: string; required?: boolean }[];
}

/** One evaluation, and how far it is. */
export interface Evaluation {
  evaluation: string;
  state: "running" | "done" | "ended";
  done: number;
  of: number;
  result: Record<string, unknown> | null;
}

/** SPARQL 1.1 Query Results JSON. */
export interface Results {
  head: { vars?: string[] };
  boolean?: boolean;
  results?: { bindings: Record<string, { type: string; value: string }>[] };
}

export interface Hello {
  type: "hello";
  version: number;
  sequence: number;
  scene: SceneModel;
}

export interface Command {
  command: string;
  state: "queued" | "begun" | "done";
  text: string;
  speaker: string;
}

/** What happens, as the service tells it; `id` is the utterance number of what is durable. */
export type LiveEvent =
  | Hello
  | ({ type: "said"; id: number; reply?: Reply } & Utterance)
  | { type: "rules"; utterance: number; told: Rule[]; retracted: Rule[]; superseded: Rule[] }
  | ({ type: "command" } & Command)
  | ({ type: "step"; command: string } & Step)
  | { type: "decision"; command: string; decision: Decision; proofs: Proof[] }
  | { type: "touch"; command: string; parts: string[] }
  | ({ type: "scene" } & SceneModel)
  | ({ type: "progress" } & Evaluation)
  | { type: "closing" };
