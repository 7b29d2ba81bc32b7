/** The WebSocket of live events and frames: it comes back by itself, with nothing lost. */

import type { LiveEvent } from "./types";

const FIRST_WAIT = 500; // [ms], doubled after each failure
const LONGEST_WAIT = 8000; // [ms]

const STRANGER = 4401; // the code of a socket that is closed because nobody knows who asks

export interface LiveReader {
  onEvent(event: LiveEvent): void;
  onFrame(frame: ArrayBuffer): void;
  onState(isOpen: boolean): void;
  onStranger(): void;
}

export class LiveClient {
  private wait = FIRST_WAIT;
  private last: number | undefined; // utterance number of the last durable event

  constructor(private readonly reader: LiveReader) {}

  /** Open it; after a lost connection, what was said meanwhile comes first. */
  open(): void {
    const socket = new WebSocket(this.address());
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }: MessageEvent<string | ArrayBuffer>) => this.take(data);
    socket.onopen = () => {
      this.wait = FIRST_WAIT;
      socket.send(JSON.stringify({ type: "hello", since: this.last }));
    };
    socket.onclose = ({ code }) => (code === STRANGER ? this.reader.onStranger() : this.reopen());
  }

  private address(): string {
    const address = new URL("api/v1/live", location.href);
    address.protocol = address.protocol.replace("http", "ws");
    address.hash = "";
    address.search = "";
    return address.href;
  }

  private take(data: string | ArrayBuffer): void {
    if (typeof data !== "string") return this.reader.onFrame(data);
    const event = JSON.parse(data) as LiveEvent;
    if (event.type === "hello") {
      this.last ??= event.sequence;
      this.reader.onState(true);
    }
    if (event.type === "said") this.last = Math.max(event.id, this.last ?? 0);
    this.reader.onEvent(event);
  }

  private reopen(): void {
    this.reader.onState(false);
    setTimeout(() => this.open(), this.wait);
    this.wait = Math.min(2 * this.wait, LONGEST_WAIT);
  }
}
