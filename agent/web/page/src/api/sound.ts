/** Sound from the microphone: one utterance as a WAV file, and how loud it is now. */

const RATE = 16_000; // samples a second, as recognisers take them
const CHUNK_MS = 250;
const HEADER_BYTES = 44;
const BITS = 128_000; // a second, of what the browser packs
// Recognisers were made for sound as it is; what takes noise away takes words away, too.
const AS_IT_IS = { channelCount: 1, noiseSuppression: false, autoGainControl: false };
const SILENT = 0.03; // of the level

/** An utterance that is being recorded. */
export class Recording {
  private readonly chunks: Blob[] = [];
  private readonly recorder: MediaRecorder;
  private readonly context = new AudioContext();
  private readonly analyser = this.context.createAnalyser();
  private loudest = 0;

  private constructor(private readonly stream: MediaStream) {
    this.context.createMediaStreamSource(stream).connect(this.analyser);
    this.recorder = new MediaRecorder(stream, { audioBitsPerSecond: BITS });
    this.recorder.ondataavailable = ({ data }) => this.chunks.push(data);
    this.recorder.start(CHUNK_MS);
  }

  /** Begin to record, once the person has allowed it; a `DOMException` if there is no sound. */
  static async begin(): Promise<Recording> {
    const devices = navigator.mediaDevices as MediaDevices | undefined; // not without TLS elsewhere
    if (!devices) throw new DOMException("This page may not use a microphone.", "NotAllowedError");
    return new Recording(await devices.getUserMedia({ audio: AS_IT_IS }));
  }

  /** How loud it is now, in [0, 1]. */
  get level(): number {
    const samples = new Float32Array(this.analyser.fftSize);
    this.analyser.getFloatTimeDomainData(samples);
    const level = Math.min(1, 3 * Math.max(...samples.map(Math.abs)));
    this.loudest = Math.max(this.loudest, level);
    return level;
  }

  /** Whether it was only silence, as far as `level` was asked for. */
  get isSilent(): boolean {
    return this.loudest < SILENT;
  }

  /** What was recorded until now; nothing while that cannot be decoded. */
  async wav(): Promise<Blob | undefined> {
    const packed = await new Blob(this.chunks, { type: this.recorder.mimeType }).arrayBuffer();
    const decoder = new OfflineAudioContext(1, 1, RATE);
    const found = await decoder.decodeAudioData(packed).catch(() => undefined);
    return found && asWav(found.getChannelData(0));
  }

  /** Stop, and let the microphone go. */
  async end(): Promise<void> {
    const ended = new Promise((done) => (this.recorder.onstop = done));
    this.recorder.stop();
    await ended;
    for (const track of this.stream.getTracks()) track.stop();
    await this.context.close();
  }
}

function asWav(samples: Float32Array): Blob {
  const view = new DataView(new ArrayBuffer(HEADER_BYTES + 2 * samples.length));
  const text = (at: number, letters: string) =>
    [...letters].forEach((letter, i) => view.setUint8(at + i, letter.charCodeAt(0)));
  text(0, "RIFF");
  view.setUint32(4, view.byteLength - 8, true);
  text(8, "WAVEfmt ");
  view.setUint32(16, 16, true); // bytes of the format: whole numbers, mono, 16 bit
  view.setUint16(20, 1, true);
  view.setUint16(22, 1, true);
  view.setUint32(24, RATE, true);
  view.setUint32(28, 2 * RATE, true);
  view.setUint16(32, 2, true);
  view.setUint16(34, 16, true);
  text(36, "data");
  view.setUint32(40, 2 * samples.length, true);
  samples.forEach((sample, i) => {
    const clipped = Math.max(-1, Math.min(1, sample));
    view.setInt16(HEADER_BYTES + 2 * i, Math.round(32767 * clipped), true);
  });
  return new Blob([view], { type: "audio/wav" });
}
