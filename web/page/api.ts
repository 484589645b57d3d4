// What the page asks of the WebAssembly module and what it answers, as JSON. `web/src` is the other side.
// SI units, world z up, body x forward, y left, z up; quaternions scalar first.

/** A preset: a vehicle file as text. */
export interface Preset {
  id: string;
  /** For the menu. */
  name: string;
  /** One sentence: what the vehicle is and where its numbers come from. */
  about: string;
  /** The file's name, for messages and downloads. */
  file: string;
  text: string;
}

/** A file that the importers read, as a vehicle file of ours. */
export interface Imported {
  format: "toml" | "rotorpy" | "urdf" | "sdf" | "mujoco" | "px4";
  /** The vehicle file. */
  text: string;
  /** What the source does not say and a person must fill in; empty if the file is complete. */
  missing: string[];
}

/** A row of the certificate. */
export interface Row {
  /** As `host-sim certify` prints it. */
  name: string;
  /** In plain words; may be empty. */
  meaning: string;
  available: number;
  required: number;
  unit: string;
  /** (available - required) / available. */
  margin: number;
  holds: boolean;
}

/** A sampled loop, small motions about hover. */
export interface Loop {
  axis: string;
  radius: number;
  gain_down: number | null;
  gain_up: number | null;
  /** s. */
  delay: number | null;
  verdict: string;
  holds: boolean;
}

export interface Verdict {
  name: string;
  certified: boolean;
  /** One line: CERTIFIED, or NOT certified with the reason. */
  decision: string;
  law: "extended" | "paper";
  /** Sentences: commands (a proof), small motions (an analysis), large motions, remarks. */
  sentences: string[];
  rows: Row[];
  loops: Loop[];
  /** What limits the vehicle or what it fails in, and what to change. */
  advice: string[];
  /** What may be flown: acceleration, jerk, the fastest circle. */
  may_fly: string[];
  /** The whole report, as the terminal prints it. */
  report: string;
  /** Every constant that flies, as TOML. */
  constants: string;
  /** kg. */
  mass: number;
  /** m, body. */
  rotors: { position: [number, number, number]; clockwise: boolean }[];
  /** Hz. */
  rate: number;
}

export type Task = "upside_down" | "wind" | "circle" | "step" | "own";

export interface FlightRequest {
  task: Task;
  /** m/s along world x; it sets in at `wind_start` of the answer. */
  wind: number;
  /** The real mass, as a factor of the file's. */
  mass: number;
  /** Which rotor is weak, 1 to n; 0: none. */
  weak_rotor: number;
  /** The share of its command that it delivers, 0.3 to 1. */
  weak_share: number;
  /** With the task own: a trajectory file's text and name. */
  trajectory?: string;
  trajectory_file?: string;
  /** Which laws fly. */
  laws: ("ours" | "indi")[];
}

/** A flight of one law; arrays have one entry a tick. */
export interface Flown {
  law: "ours" | "indi";
  /** Said beside it: gains that were not tuned for this vehicle, say; may be empty. */
  note: string;
  /** Why it ended early; null if it did not. */
  ended: string | null;
  t: number[];
  /** Rows of x, y, z. */
  position: [number, number, number][];
  /** Rows of w, x, y, z. */
  attitude: [number, number, number, number][];
  position_error: number[];
  /** Degrees between the body's z and the vertical. */
  tilt: number[];
  thrust: number[];
  torque: [number, number, number][];
  /** Thrust of each rotor, N, one row a tick. */
  rotors: number[][];
  /** Whether a command was cut by a limit or a rotor's range. */
  cut: boolean[];
  figures: {
    /** m. */
    height_lost: number;
    /** Time until within 0.1 m for good, s; null: not within the flight. */
    settled: number | null;
    /** m, at the end. */
    end_error: number;
    /** Ticks at which a command was cut. */
    cut: number;
  };
}

export interface FlightAnswer {
  flights: Flown[];
  /** The way that the reference goes, rows of x, y, z, one a tick of the first flight. */
  reference: [number, number, number][];
  /** The limits of the file and what is proven of our law's commands. */
  bounds: {
    thrust_max: number;
    torque_max: [number, number, number];
    /** Least and greatest thrust of a rotor, N; null without rotors. */
    rotor: [number, number] | null;
    /** null where the vehicle is not certified. */
    proven: { thrust: [number, number]; torque: [number, number, number] } | null;
  };
  /** m/s, world, while it blows. */
  wind: [number, number, number];
  /** When it sets in, s. */
  wind_start: number;
}

/** The paper's flight, as one number. */
export interface Paper {
  hash: string;
  published: string;
  same: boolean;
}

/** One request at a time; a refusal is one line: file, field, reason and remedy. */
export type Answer<T> = { ok: T } | { error: string };

export interface Api {
  presets(): Promise<Answer<Preset[]>>;
  import(file: string, text: string): Promise<Answer<Imported>>;
  certify(file: string, text: string): Promise<Answer<Verdict>>;
  fly(file: string, text: string, request: FlightRequest): Promise<Answer<FlightAnswer>>;
  paper(): Promise<Answer<Paper>>;
}
