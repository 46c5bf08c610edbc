// Fetches an .ohlod file by HTTP range requests, in the order in which Hlod asks: header and tables, roots, then nodes.
// What is lost or stalls is asked for again, after a pause that grows while nothing comes; what has become needless is
// cancelled.
import { Hlod } from "../../occlod/hlod.js";

const firstBytes = 65536; // header, table of sections and, of most files, more
const openingTries = 6;
const shortestPauseMs = 200;
const longestPauseMs = 8000;

// An answer that no repetition will change.
class Refusal extends Error {}

const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
const pauseAfter = (failures) => Math.min(shortestPauseMs * 2 ** (failures - 1), longestPauseMs);

export class HlodStream {
  #url;
  #options;
  #hlod;
  #flights = new Map(); // id of a request: its AbortController
  #failures = 0; // in a row
  #paused;
  #closed = new AbortController();

  /** Bytes that have come, and requests that were made, lost or cancelled. */
  counts = { bytes: 0, requests: 0, lost: 0, cancelled: 0 };

  /** `onArrival` is called whenever something has come that the next select() can use. `ready`: of the WebAssembly. */
  constructor(url, { memory, ready, requests = 6, stallMs = 4000, fetchOptions = {}, onArrival = () => {} }) {
    this.#url = String(url);
    this.#options = { memory, ready, requests, stallMs, fetchOptions, onArrival };
  }

  get hlod() {
    return this.#hlod;
  }

  /** Whether something may still come without another select(). */
  get isWaiting() {
    return this.#flights.size > 0 || this.#paused !== undefined;
  }

  get name() {
    return decodeURIComponent(this.#url.replace(/[?#].*$/, "").replace(/^.*\//, "")) || this.#url;
  }

  /** Resolves with an open Hlod. */
  async open() {
    const [head] = await Promise.all([this.#insist(0, firstBytes), this.#options.ready]);
    this.#hlod = new Hlod(this.name, head.size);
    this.#hlod.put(0, head.bytes);
    for (let missing; (missing = this.#hlod.open({ memory: this.#options.memory })).length; ) {
      const parts = await Promise.all(missing.map(([begin, end]) => this.#insist(begin, end)));
      parts.forEach(({ bytes }, i) => this.#hlod.put(missing[i][0], bytes));
    }
    return this.#hlod;
  }

  /** Makes the requests that the last select() asks for; call it after each. */
  pump() {
    if (this.#closed.signal.aborted) return;
    for (const id of this.#hlod.takeCancelled()) {
      if (this.#flights.has(id)) ++this.counts.cancelled;
      this.#flights.get(id)?.abort();
      this.#flights.delete(id);
    }
    while (!this.#paused && this.#flights.size < this.#options.requests) {
      const request = this.#hlod.nextRequest();
      if (!request) return;
      this.#carryOut(request);
    }
  }

  close() {
    this.#closed.abort();
    for (const flight of this.#flights.values()) flight.abort();
    this.#flights.clear();
    clearTimeout(this.#paused);
    this.#hlod?.dispose();
  }

  async #carryOut({ id, begin, end, again }) {
    const flight = new AbortController();
    this.#flights.set(id, flight);
    const isOver = () => this.#flights.get(id) !== flight; // cancelled or closed
    try {
      const { bytes } = await this.#fetch(begin, end, flight, again);
      if (isOver()) return;
      this.#flights.delete(id);
      this.#failures = 0;
      this.#hlod.arrive(id, bytes);
      this.#options.onArrival();
    } catch (error) {
      if (isOver()) return;
      this.#flights.delete(id);
      if (error instanceof Refusal) {
        this.#hlod.fail(id, error.message);
        this.#options.onArrival();
      } else {
        ++this.counts.lost;
        this.#hlod.lose(id);
        // The first is repeated at once.
        if (++this.#failures > 1) this.#pause(pauseAfter(this.#failures - 1));
      }
    }
    this.pump();
  }

  #pause(ms) {
    this.#paused ??= setTimeout(() => {
      this.#paused = undefined;
      this.pump();
    }, ms);
  }

  // What is needed to open the file.
  async #insist(begin, end) {
    for (let tries = 1; ; ++tries)
      try {
        const flight = new AbortController();
        this.#closed.signal.addEventListener("abort", () => flight.abort(), { once: true });
        return await this.#fetch(begin, end, flight, false);
      } catch (error) {
        if (error instanceof Refusal || tries === openingTries || this.#closed.signal.aborted) throw error;
        ++this.counts.lost;
        await sleep(pauseAfter(tries));
      }
  }

  // Returns bytes and the size of the file. Throws Refusal for what will not change, other errors for what may.
  async #fetch(begin, end, flight, again) {
    let timer;
    const stalls = () => {
      clearTimeout(timer);
      timer = setTimeout(() => flight.abort(new Error(`${this.name}: the answer stalls`)), this.#options.stallMs);
    };
    ++this.counts.requests;
    try {
      stalls();
      const { headers, ...others } = this.#options.fetchOptions;
      const response = await fetch(this.#url, {
        cache: "no-store", // else Chrome lets requests for one address wait for each other
        ...others,
        headers: { ...headers, Range: `bytes=${begin}-${end - 1}` },
        signal: flight.signal,
        ...(again ? { cache: "reload" } : {}),
      });
      const size = this.#sizeOf(response);
      const bytes = new Uint8Array(Math.min(end, size) - begin);
      let have = 0;
      for (const reader = response.body.getReader(); ; stalls()) {
        const { done, value } = await reader.read();
        if (done) break;
        this.counts.bytes += value.length;
        if (have + value.length > bytes.length) throw new Error(`${this.name}: more has come than was asked for`);
        bytes.set(value, have);
        have += value.length;
      }
      if (have < bytes.length) throw new Error(`${this.name}: the answer ends early`);
      return { bytes, size };
    } finally {
      clearTimeout(timer);
    }
  }

  // The size of the file, from an answer that has a part of it.
  #sizeOf(response) {
    const { status } = response;
    if (status === 206) {
      const size = Number(/\/(\d+)$/.exec(response.headers.get("Content-Range") ?? "")?.[1]);
      if (size > 0) return size;
      throw new Refusal(`${this.name}: the server does not say how large it is; let it expose the header Content-Range`);
    }
    response.body?.cancel().catch(() => {});
    if (status === 200) throw new Refusal(`${this.name}: the server sends all of it at once; use one that answers range requests`);
    const text = `${this.name}: the server answers ${status} ${response.statusText}`;
    if (status >= 500 || status === 408 || status === 429) throw new Error(text);
    throw new Refusal(`${text}; check the address`);
  }
}
