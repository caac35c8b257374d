// What the desk knows of the study: rows and counts, asked for anew when the server has news.

import type { Row, StudyReport } from './deskapi';
import * as api from './deskapi';

/** News come in bursts; the rows are asked for once a burst, ms. */
const BURST_MS = 250;
/** And not more often than this, ms: with hundreds in the air there is always news. */
const LEAST_MS = 1_000;
/** How often they are asked for without news, ms: what changes without an event, such as who is connected. */
const USUALLY_MS = 5_000;

export class Feed {
  study: StudyReport | null = null;
  rows: Row[] = [];
  /** Why nothing is known, or no more. */
  trouble: unknown = null;
  private readonly told = new Set<(changed: ReadonlySet<number>) => void>();
  private readonly changed = new Set<number>();
  private source: EventSource | null = null;
  private timer = 0;
  private askedAt = 0;
  private pulse = 0;
  private asking: Promise<void> | null = null;
  private next: Promise<void> | null = null;

  /** `letOut` is called when the server no longer believes the secret. */
  constructor(private readonly letOut: () => void) {}

  /** Asks for everything once, and from then on whenever there is news. */
  async open(): Promise<void> {
    await this.refresh();
    this.source = new EventSource('/api/desk/news');
    const news = (message: MessageEvent<string>) => this.heard(message.data);
    this.source.addEventListener('message', news);
    this.source.addEventListener('participant', news);
    this.pulse = window.setInterval(() => {
      if (document.visibilityState === 'visible') void this.refresh();
    }, USUALLY_MS);
  }

  close(): void {
    this.source?.close();
    clearInterval(this.pulse);
    clearTimeout(this.timer);
  }

  row(id: number): Row | undefined {
    return this.rows.find((row) => row.id === id);
  }

  /** Calls back after every change, with the participants of whom there was news; gives what ends that. */
  listen(told: (changed: ReadonlySet<number>) => void): () => void {
    this.told.add(told);
    return () => this.told.delete(told);
  }

  /** Asks now: something was done here. What is being asked already may be older than that, so it is asked again. */
  refresh(): Promise<void> {
    if (this.asking === null) return (this.asking = this.ask().finally(() => (this.asking = null)));
    this.next ??= this.asking.then(() => {
      this.next = null;
      return this.refresh();
    });
    return this.next;
  }

  private async ask(): Promise<void> {
    this.askedAt = performance.now();
    const changed = new Set(this.changed);
    this.changed.clear();
    try {
      [this.study, this.rows] = await Promise.all([api.study(), api.participants()]);
      this.trouble = null;
    } catch (error) {
      this.trouble = error;
      if (error instanceof api.NotLetIn) this.letOut();
    }
    this.told.forEach((told) => told(changed));
  }

  private heard(data: string): void {
    for (const id of idsIn(data)) this.changed.add(id);
    if (this.timer !== 0) return;
    const wait = Math.max(BURST_MS, this.askedAt + LEAST_MS - performance.now());
    this.timer = window.setTimeout(() => {
      this.timer = 0;
      void this.refresh();
    }, wait);
  }
}

/** The participants that news speak of: a number, a list of them, or an object that names one. */
export function idsIn(data: string): number[] {
  try {
    const said: unknown = JSON.parse(data);
    const named = typeof said === 'object' && said !== null && !Array.isArray(said) ? Object.values(said) : [said];
    return named.flat().filter((id): id is number => Number.isInteger(id));
  } catch {
    return [];
  }
}
