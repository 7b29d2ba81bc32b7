/** Plays poses by the world's clock, not by the times at which frames arrive. */

export const POSE = 7; // numbers of a node: x y z [m] and the quaternion x y z w
const HEAD = 8; // bytes
const KIND = 1;
const VERSION = 1;
const BUFFER = 0.15; // [s] of the world between the newest frame and what is shown
const PATIENCE = 150; // [ms] without a frame, after which the rest is played out
const HURRY = 0.6; // [s] behind from which it goes `FAST` times as fast
const FAST = 1.5;
const RUSH = 3; // [s] behind from which it goes `FASTER` times as fast
const FASTER = 2.5;
const JUMP = 8; // [s] behind from which it leaves out what is between; a passing takes less

export interface Frame {
  scene: number;
  time: number;
  poses: Float32Array;
}

/** Two frames, and how far between them the world is shown, in [0, 1]. */
export interface Moment {
  before: Frame;
  after: Frame;
  share: number;
}

/** A frame from its bytes; undefined for a kind or version that this page does not know. */
export function readFrame(bytes: ArrayBuffer): Frame | undefined {
  const head = new DataView(bytes);
  if (head.getUint8(0) !== KIND || head.getUint8(1) !== VERSION) return undefined;
  const poses = new Float32Array(bytes, HEAD);
  return { scene: head.getUint16(2, true), time: head.getFloat32(4, true), poses };
}

export class PosePlayer {
  private frames: Frame[] = [];
  private clock = 0; // [s]
  private arrival = 0; // [ms], of the newest frame
  private isWaiting = true;

  /** Take a frame that arrived at `now` [ms]; one of another scene or an earlier time starts anew. */
  push(frame: Frame, now: number): void {
    const newest = this.frames.at(-1);
    if (!newest || newest.scene !== frame.scene || frame.time < newest.time) {
      this.frames = [];
      this.clock = frame.time;
    }
    this.frames.push(frame);
    this.arrival = now;
  }

  /** The time of the world [s] that is shown. */
  get time(): number {
    return this.clock;
  }

  /** The time of the world [s] of the newest frame. */
  get newest(): number {
    return this.frames.at(-1)?.time ?? 0;
  }

  /** Whether everything that arrived is shown. */
  get isStill(): boolean {
    return this.clock >= this.newest;
  }

  /** Let `elapsed` [s] of ours pass until `now` [ms], and return what to show. */
  advance(elapsed: number, now: number): Moment | undefined {
    const newest = this.frames.at(-1);
    if (!newest) return undefined;
    const behind = newest.time - this.clock;
    if (behind > JUMP) this.clock = newest.time - BUFFER;
    if (behind >= BUFFER || now - this.arrival > PATIENCE) this.isWaiting = false;
    if (!this.isWaiting) {
      const speed = behind > RUSH ? FASTER : behind > HURRY ? FAST : 1;
      this.clock = Math.min(newest.time, this.clock + elapsed * speed);
    }
    if (this.isStill) this.isWaiting = true;
    while (this.frames[1] && this.frames[1].time <= this.clock) this.frames.shift();
    return this.moment();
  }

  private moment(): Moment | undefined {
    const [before, after] = this.frames;
    if (!before) return undefined;
    if (!after) return { before, after: before, share: 0 };
    return { before, after, share: (this.clock - before.time) / (after.time - before.time) };
  }
}
