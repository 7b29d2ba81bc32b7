/** Requests to the JSON API. Addresses are relative: the page may stand below any path. */

import type {
  Caller, Episode, Evaluation, Explanation, Graph, Heard, Problem, Question, Reply, Results, Rule, Utterance,
} from "./types";

const ROOT = "api/v1";
const MOST_ALTERNATIVES = 10;
const MOST_SPOKEN = 2_000; // characters

/** A refusal of the service, in its own words. */
export class Refusal extends Error {
  constructor(readonly problem: Problem) {
    super(problem.detail || problem.title);
  }
}

export type Query = Record<string, string | number | undefined>;

/** The answer to a request; a `Refusal` if there is none. */
export async function request<T>(method: string, path: string, body?: unknown): Promise<T> {
  const headers: Record<string, string> = { Accept: "application/json" };
  const init: RequestInit = { method, headers, credentials: "same-origin" };
  if (body instanceof Blob) {
    headers["Content-Type"] = body.type;
    init.body = body;
  } else if (body !== undefined) {
    headers["Content-Type"] = "application/json";
    init.body = JSON.stringify(body);
  }
  if (method === "POST") headers["Idempotency-Key"] = crypto.randomUUID();
  const response = await fetch(`${ROOT}/${path}`, init).catch(() => unreachable());
  if (!response.ok) throw new Refusal(await problemOf(response));
  return (response.status === 204 ? undefined : await response.json()) as T;
}

function unreachable(): never {
  throw new Refusal({ title: "No answer", status: 0, detail: "The service cannot be reached." });
}

async function problemOf(response: Response): Promise<Problem> {
  const plain = { title: response.statusText, status: response.status, detail: "" };
  return response.json().then((found: Problem) => ({ ...plain, ...found }), () => plain);
}

/** A path with the parameters that have a value. */
export function withQuery(path: string, query: Query): string {
  const given = Object.entries(query).filter(([, value]) => value !== undefined && value !== "");
  const text = new URLSearchParams(given.map(([name, value]) => [name, String(value)])).toString();
  return text ? `${path}?${text}` : path;
}

/** A rule with the utterance in which it was said; its status says whether it is held. */
export type ToldRule = Rule & { status: string; utterance: Utterance | null };

const rulePath = (id: string) => `rules/${id.replace(/^rule\//, "")}`;

/** Say something, perhaps about a place; where it was heard, with what may have been said instead. */
export function hear(text: string, heard?: Heard, at?: readonly number[]): Promise<Reply> {
  const likely = heard?.alternatives.slice(0, MOST_ALTERNATIVES);
  const alternatives = likely?.map(({ text: other, score }) => ({ text: other, heard: score }));
  return request("POST", "hear", { text, at, ...(heard && { heard: heard.heard, alternatives }) });
}

export const listen = (sound: Blob) => request<Heard>("POST", "listen", sound);
export const voiceAddress = (text: string) =>
  `${ROOT}/${withQuery("voice", { text: text.slice(0, MOST_SPOKEN) })}`;
export const confirm = (id: string, yes: boolean) => request<Reply>("POST", "confirm", { id, yes });
export const explain = (text: string) => request<Explanation>("POST", "explain", { text });
export const readHistory = (since: number) =>
  request<Utterance[]>("GET", withQuery("history", { since }));
export const readLastEpisode = () => request<Episode[]>("GET", "episodes?limit=1");
export const readGraph = (query: Query) => request<Graph>("GET", withQuery("graph", query));
export const readRule = (id: string) => request<ToldRule>("GET", rulePath(id));
export const forget = (id: string) => request<unknown>("DELETE", rulePath(id));
export const whoAmI = () => request<Caller>("GET", "session");
export const logIn = (key: string) => request<unknown>("POST", "session", { key });
export const readEvaluations = () => request<Evaluation[]>("GET", "evaluations");
export const evaluate = (what: string, sim: boolean, seed: number) =>
  request<Evaluation>("POST", "evaluations", { what, sim, seed });
export const stopEvaluation = (name: string) => request<unknown>("DELETE", `evaluations/${name}`);
export const readQuestions = () => request<Question[]>("GET", "questions");
export const askQuestion = (name: string, given: Record<string, string>) =>
  request<Results>("POST", `questions/${encodeURIComponent(name)}`, given);
export const stopRobot = () => request<unknown>("POST", "robot/stop");
export const setTable = (scene: string, seed: number) =>
  request<unknown>("POST", "scene", { scene, seed });
