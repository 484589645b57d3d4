// Compiles the crate `web` to WebAssembly and puts it where the page takes it from: vehicle.wasm beside this file.

import { execFileSync } from "node:child_process";
import { copyFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const TARGET = "wasm32-unknown-unknown";
const PROFILE = "web";
const ARGUMENTS = ["--profile", PROFILE, "-p", "web", "--locked"];

const here = dirname(fileURLToPath(import.meta.url));
const top = resolve(here, "..");
const targets = resolve(top, process.env.CARGO_TARGET_DIR ?? "target");

/** Whether rustup has the standard library of the target. */
function rustupHasTarget() {
  try {
    const installed = execFileSync("rustup", ["target", "list", "--installed"], { cwd: top, encoding: "utf8" });
    return installed.split("\n").includes(TARGET);
  } catch {
    return false;
  }
}

/** Compiles, and returns the folder that holds what was compiled. */
function compile() {
  const run = (program, ...given) => execFileSync(program, given, { cwd: top, stdio: "inherit" });
  if (rustupHasTarget()) {
    run("cargo", "build", "--target", TARGET, ...ARGUMENTS);
    return targets;
  }
  // With Debian's compiler, or a message that says what to install.
  run(join(top, ".ci", "wasm"), "build", ...ARGUMENTS);
  return join(targets, "debian");
}

try {
  copyFileSync(join(compile(), TARGET, PROFILE, "web.wasm"), join(here, "vehicle.wasm"));
} catch (failure) {
  // A compiler that ran has said itself what is wrong.
  const advice = failure.status === undefined ? `; "rustup target add ${TARGET}" installs a compiler` : "";
  console.error(`no WebAssembly: ${failure.message}${advice}`);
  process.exit(1);
}
