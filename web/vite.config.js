// How the page is built: static files with relative addresses, and the licences of the packages in it.

import { readFileSync } from "node:fs";
import { defineConfig } from "vite";

/** Packages whose code is in the built page. */
const SHIPPED = ["three", "uplot"];

const PORT = 4173;
const ONLY_THIS_COMPUTER = "127.0.0.1";

/** three.js is the largest chunk. Vite warns of one that is larger. */
const THREE_KILOBYTES = 600;

/** Writes the licence of every shipped package to licences.txt. */
function licences() {
  return {
    name: "licences",
    apply: "build",
    generateBundle() {
      const parts = SHIPPED.map((name) => {
        const folder = new URL(`node_modules/${name}/`, import.meta.url);
        const { version } = JSON.parse(readFileSync(new URL("package.json", folder), "utf8"));
        return `${name} ${version}\n\n${readFileSync(new URL("LICENSE", folder), "utf8").trim()}\n`;
      });
      const own = "The page itself, the controller in it included: MIT or Apache 2.0.\n";
      this.emitFile({ type: "asset", fileName: "licences.txt", source: [own, ...parts].join("\n\n") });
    },
  };
}

/** The development server writes styles into the page, which the policy of the built page forbids. */
function policyWhileDeveloping() {
  return {
    name: "policy-while-developing",
    apply: "serve",
    transformIndexHtml: (html) => html.replace("style-src 'self'", "style-src 'self' 'unsafe-inline'"),
  };
}

export default defineConfig({
  base: "./",
  publicDir: false,
  plugins: [licences(), policyWhileDeveloping()],
  worker: { format: "es" },
  build: {
    target: "es2022",
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: THREE_KILOBYTES,
  },
  server: { host: ONLY_THIS_COMPUTER },
  preview: { host: ONLY_THIS_COMPUTER, port: PORT },
});
