// The loop, compiled to WebAssembly: physics and co-pilot run here, so that a key acts at the next tick whatever the
// network does. The functions and the JSON are those of crates/cohelm-page; `abi.rs` and `report.rs` explain them.

/** Where a movable part is, world units, y upwards. */
export interface Pose {
  x: number;
  y: number;
  angle_rad: number;
  strength: number;
}

export type Role = 'ground' | 'body' | 'limb' | 'thrust' | 'goal' | 'decor';

export type Shape =
  | { kind: 'polygon'; points: [number, number][] }
  | { kind: 'line'; points: [number, number][] }
  | { kind: 'disc'; center: [number, number]; radius: number };

export interface Part {
  role: Role;
  goal?: number;
  shapes: Shape[];
}

/** Everything to draw; fixed for an episode. */
export interface Scene {
  bounds: [number, number, number, number];
  fixed: Part[];
  movable: Part[];
  origin: [number, number];
  scale: [number, number];
}

export interface Rule {
  rule:
    | 'hic'
    | 'robot'
    | 'lasc'
    | 'line-graph'
    | 'threshold'
    | 'hindsight'
    | 'misc'
    | 'tolerance'
    | 'misc-r'
    | 'misc-h'
    | 'ida'
    | 'safe-nearest';
  alpha?: number;
  kappa?: number;
  release?: number;
  start?: number;
  full?: number;
  most?: number;
  confidence?: number;
  likeness?: number;
  hold?: number;
  horizon?: number;
}

export type Inference =
  'nearest' | 'known' | 'inverse-distance' | 'softmax' | 'calibrated' | 'bayesian' | 'calibrated-bayesian' | 'imagined';

/** Those that need a network for intent. */
export function needsNetwork(inference: Inference): boolean {
  return !['nearest', 'known', 'bayesian'].includes(inference);
}

/** Everything that fixes an episode but the keys. */
export interface Setup {
  task: { plant: string; options: Record<string, unknown> };
  plant_version: number;
  seed: number;
  rule: Rule;
  inference: Inference;
  silence?: 'best' | 'nothing';
  time_scale: number;
  values: string | null;
  intent: string | null;
  pilot: string;
}

export interface Goal {
  id: number;
  position: [number, number];
}

export interface Control {
  name: string;
  keys: string[];
}

export interface Opening {
  setup: Setup;
  ticks_per_second: number;
  ticks: number | null;
  controls: Control[];
  pilot_goal: number | null;
  goals: Goal[];
  scene: Scene;
  poses: Pose[];
}

export interface Named {
  label: string;
  command?: number;
  axes?: [number, number, number, number];
}

export type Ending = 'goal' | 'elsewhere' | 'crash' | 'out-of-bounds' | 'time-limit' | 'abandoned';

/** One tick, every stage of it. */
export interface Tick {
  tick: number;
  asked: Named | null;
  belief: { probabilities: number[]; goal: number; confidence: number; imagined?: [number, number] };
  candidates: { action: Named; value: number; above_worst: number; allowed: boolean }[];
  threshold: number | null;
  executed: Named | null;
  intervention: { effective: boolean; nominal: boolean; opposed: boolean } | null;
  reward: number;
  ending: Ending | null;
  differs: boolean;
  goals: Goal[];
  pilot_goal: number | null;
  poses: Pose[];
}

export interface Digests {
  ticks: number;
  plant: string;
  decisions: string;
}

export interface ReplayReport {
  identical: boolean;
  plant_identical: boolean;
  decisions_identical: boolean | null;
  requests_identical: boolean | null;
}

/** Who asks from a branch on. */
export type Hands =
  | { pilot: 'recorded' }
  | { pilot: 'nobody' }
  | { pilot: 'greedy' }
  | { pilot: 'person'; population: string; person: number };

/** How a record is to be flown on, and from which tick. */
export interface Wish {
  at: number;
  rule: Rule;
  inference: Inference;
  silence: 'best' | 'nothing';
  values: string | null;
  intent: string | null;
  pilot: Hands;
}

/** A set of actions that a plant can be flown with. */
export interface ActionSet {
  name: string;
  label: string;
  /** The plant's options that choose it. */
  options: Record<string, unknown>;
}

/** A plant that the loop knows. */
export interface PlantEntry {
  name: string;
  version: number;
  summary: string;
  /** The sets of actions to choose from, the usual one first; empty if there is only one. */
  actions: ActionSet[];
}

export interface About {
  source_hash: string;
  version: string;
  plants: PlantEntry[];
}

/** A model that the loop took in. */
export interface ModelReport {
  hash: string;
  name: string;
  kind: 'values' | 'intent';
}

export type KeyKind = 'down' | 'up' | 'release-all';

interface Exports {
  memory: WebAssembly.Memory;
  cohelm_input(length: number): number;
  cohelm_output(): number;
  cohelm_about(): number;
  cohelm_model(): number;
  cohelm_begin(): number;
  cohelm_key(kind: number, control: number, atMs: number): number;
  cohelm_stick(x: number, y: number, z: number, w: number, atMs: number): number;
  cohelm_tick(): number;
  cohelm_events(from: number): number;
  cohelm_digests(): number;
  cohelm_finish(): number;
  cohelm_watch(): number;
  cohelm_seek(ticks: number): number;
  cohelm_branch(): number;
  cohelm_pilots(): number;
  cohelm_replay(): number;
  cohelm_panic(): number;
}

/** Names of the functions that answer with a length. */
type Call = Exclude<keyof Exports, 'memory' | 'cohelm_input' | 'cohelm_output'>;

/** The loop refused something, in its own words. */
export class CoreError extends Error {}

/** The loop stopped by a bug of its own: this instance is of no more use, `revive` loads another. */
export class CoreStopped extends Error {}

/** One instance of the loop: it flies one flight, shows one record, or flies one on, at a time. */
export class Core {
  private readonly models = new Map<string, Uint8Array>();

  private constructor(
    private readonly module: WebAssembly.Module,
    private wasm: Exports,
  ) {}

  static async load(source: BufferSource | Response | Promise<Response>): Promise<Core> {
    const module =
      source instanceof ArrayBuffer || ArrayBuffer.isView(source)
        ? await WebAssembly.compile(source as BufferSource)
        : await WebAssembly.compileStreaming(source as Response);
    return new Core(module, await instance(module));
  }

  /** A second loop beside this one, with the same models. */
  async another(): Promise<Core> {
    const made = new Core(this.module, await instance(this.module));
    for (const bytes of this.models.values()) made.addModel(bytes);
    return made;
  }

  /** Takes a fresh instance in place of one that stopped; models stay, what was flown is gone. */
  async revive(): Promise<void> {
    this.wasm = await instance(this.module);
    const models = [...this.models.values()];
    for (const bytes of models) this.addModel(bytes);
  }

  about(): About {
    return this.json(this.call('cohelm_about')) as About;
  }

  hasModel(hash: string): boolean {
    return this.models.has(hash);
  }

  addModel(bytes: Uint8Array): ModelReport {
    this.put(bytes);
    const report = this.json(this.call('cohelm_model')) as ModelReport;
    this.models.set(report.hash, bytes);
    return report;
  }

  begin(setup: Setup): Opening {
    this.put(new TextEncoder().encode(JSON.stringify(setup)));
    return this.json(this.call('cohelm_begin')) as Opening;
  }

  key(kind: KeyKind, control: number, atMs: number): void {
    this.call('cohelm_key', { down: 0, up: 1, 'release-all': 2 }[kind], control, atMs);
  }

  /** The stick moved: each axis in −32767 to 32767. */
  stick([x, y, z, w]: readonly [number, number, number, number], atMs: number): void {
    this.call('cohelm_stick', x, y, z, w, atMs);
  }

  /** Flies one tick; null once the episode has ended. */
  tick(): Tick | null {
    return this.json(this.call('cohelm_tick')) as Tick | null;
  }

  eventsFrom(index: number): Uint8Array {
    return this.call('cohelm_events', index);
  }

  digests(): Digests {
    return this.json(this.call('cohelm_digests')) as Digests;
  }

  finish(): Uint8Array {
    return this.call('cohelm_finish');
  }

  watch(record: Uint8Array): Opening {
    this.put(record);
    return this.json(this.call('cohelm_watch')) as Opening;
  }

  seek(ticks: number): Tick | null {
    return this.json(this.call('cohelm_seek', ticks)) as Tick | null;
  }

  /** Flies the record that is watched on as wished; `tick` flies the branch, and another may follow it. */
  branch(wish: Wish): Opening {
    this.put(new TextEncoder().encode(JSON.stringify(wish)));
    return this.json(this.call('cohelm_branch')) as Opening;
  }

  /** Who can take over the record that is watched. */
  pilots(): Hands[] {
    return this.json(this.call('cohelm_pilots')) as Hands[];
  }

  replay(record: Uint8Array): ReplayReport {
    this.put(record);
    return this.json(this.call('cohelm_replay')) as ReplayReport;
  }

  private put(bytes: Uint8Array): void {
    const at = this.wasm.cohelm_input(bytes.length);
    if (at === 0) throw new CoreError(`${bytes.length} bytes are more than the page takes in at once`);
    new Uint8Array(this.wasm.memory.buffer, at, bytes.length).set(bytes);
  }

  /** Calls a function and copies its answer; a negative length is an error whose words lie in its place. */
  private call(name: Call, ...numbers: number[]): Uint8Array {
    let length: number;
    try {
      length = (this.wasm[name] as (...numbers: number[]) => number)(...numbers);
    } catch (trap) {
      throw new CoreStopped(this.lastWords() || String(trap), { cause: trap });
    }
    const bytes = this.output(Math.abs(length));
    if (length < 0) throw new CoreError(new TextDecoder().decode(bytes));
    return bytes;
  }

  private lastWords(): string {
    try {
      return new TextDecoder().decode(this.output(this.wasm.cohelm_panic()));
    } catch {
      return '';
    }
  }

  private output(length: number): Uint8Array {
    return new Uint8Array(this.wasm.memory.buffer, this.wasm.cohelm_output(), length).slice();
  }

  private json(bytes: Uint8Array): unknown {
    return bytes.length === 0 ? null : JSON.parse(new TextDecoder().decode(bytes));
  }
}

async function instance(module: WebAssembly.Module): Promise<Exports> {
  return (await WebAssembly.instantiate(module, {})).exports as unknown as Exports;
}
