// What the flights of a page share: the loop in WebAssembly, the models it was given, and the way to the server.

import { Core, type Setup } from '../../src/core';
import { Link } from '../../src/link';
import { fromHex } from '../../src/pending';
import { Keeper } from './keeper';

/** How a flight reached the server, or that it never will. */
export type Delivery = { episode: number } | { refused: string };

/** Where things are, if not at the root of the page's own address. */
export interface DeckOptions {
  /** Address of the server, without a slash at its end; the page's own if left out. */
  server?: string;
  /** Address of `cohelm_page.wasm`. */
  wasm?: string;
  /** Where finished flights outlive a reload in this browser; null if the experiment flies them again from a `Keeper`. */
  place?: string | null;
  /** Where the flight in the air is kept. */
  keeper?: Keeper;
  /** Names this tab to a server that lets one tab fly at a time. */
  tab?: string;
  /** The connection came or went. */
  connected?: (connected: boolean) => void;
  /** Another tab of the same participant took over. */
  takenOver?: () => void;
}

/** Where what became of one flight is waited for. */
interface Slot {
  delivered: Promise<Delivery>;
  deliver(delivery: Delivery): void;
}

/** Opened once a page. */
export class Deck {
  readonly link: Link;
  readonly keeper: Keeper;
  private readonly slots = new Map<string, Slot>();

  private constructor(
    readonly core: Core,
    private readonly options: DeckOptions,
  ) {
    this.keeper = options.keeper ?? new Keeper();
    const address = new URL(`${options.server ?? location.origin}/ws`);
    if (options.tab !== undefined) address.searchParams.set('tab', options.tab);
    address.protocol = address.protocol === 'https:' ? 'wss:' : 'ws:';
    this.link = new Link(
      address.href,
      {
        state: (connected) => options.connected?.(connected),
        trouble: (text) => console.warn(text),
        welcome: () => {},
        newModel: () => {},
        stored: (episode, key) => this.deliver(key, { episode }),
        refused: (reason, key) => this.deliver(key, { refused: reason }),
        takenOver: () => options.takenOver?.(),
      },
      ...(options.place === undefined ? [] : [options.place]),
    );
  }

  /** Loads the loop and connects. */
  static async open(options: DeckOptions = {}): Promise<Deck> {
    const wasm = options.wasm ?? `${options.server ?? ''}/cohelm_page.wasm`;
    return new Deck(await Core.load(fetch(wasm)), options);
  }

  /** Gives the loop the models of a setup. */
  async equip(setup: Setup): Promise<void> {
    for (const hash of [setup.values, setup.intent]) {
      if (hash === null || this.core.hasModel(hash)) continue;
      const response = await fetch(`${this.options.server ?? ''}/api/models/${hash}`);
      if (!response.ok) throw new Error(`the model ${hash.slice(0, 8)} could not be had: ${response.status}`);
      this.core.addModel(new Uint8Array(await response.arrayBuffer()));
    }
  }

  /** A flight begins, or goes on under the key that it was begun with. */
  begin(setup: Setup, key: string, begunAt: number): void {
    this.slots.delete(key);
    this.link.begin(setup, { key: fromHex(key), begunAt });
  }

  /** When the server has the flight with this key, or refused it. */
  delivered(key: string): Promise<Delivery> {
    return this.slot(key).delivered;
  }

  private deliver(key: string, delivery: Delivery): void {
    this.slot(key).deliver(delivery);
  }

  private slot(key: string): Slot {
    let slot = this.slots.get(key);
    if (slot === undefined) {
      let deliver: Slot['deliver'] = () => {};
      slot = { delivered: new Promise((resolve) => (deliver = resolve)), deliver: (delivery) => deliver(delivery) };
      this.slots.set(key, slot);
    }
    return slot;
  }
}
