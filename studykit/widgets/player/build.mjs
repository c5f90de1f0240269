// Bundles the sources of all widgets and three.js into one file that works without a network; and the player
// alone, with its styles, into another, for pages that have no notebook around them.
import { createHash } from "node:crypto";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { dirname, join, relative, sep } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const widgets = dirname(here);

function filesUnder(folder) {
  return readdirSync(folder, { withFileTypes: true }).flatMap((entry) =>
    entry.isDirectory() ? filesUnder(join(folder, entry.name)) : [join(folder, entry.name)],
  );
}

// The digest says which sources a bundle was built from: path, NUL, content, NUL, in the order of the paths.
const sources = readdirSync(widgets, { withFileTypes: true })
  .filter((entry) => entry.isDirectory())
  .map((entry) => join(widgets, entry.name, "src"))
  .flatMap((folder) => {
    try {
      return filesUnder(folder);
    } catch {
      return []; // a room without sources for the browser
    }
  })
  .concat(join(here, "package-lock.json"), join(here, "build.mjs"), join(widgets, "style.css"))
  .map((path) => [relative(widgets, path).split(sep).join("/"), readFileSync(path)])
  .sort(([first], [second]) => (first < second ? -1 : 1));
const digest = createHash("sha256");
for (const [path, content] of sources) digest.update(path).update("\0").update(content).update("\0");

const licence = readFileSync(join(here, "node_modules", "three", "LICENSE"), "utf8").trim();
const banner = `/* studykit widgets, built by "make widgets"; sources ${digest.digest("hex")}

Contains three.js (https://threejs.org):

${licence}
*/
`;

async function bundle(entry, format, target) {
  const made = await build({
    entryPoints: [join(here, "src", entry)],
    bundle: true,
    format,
    minify: true,
    target: "es2022",
    charset: "utf8",
    loader: { ".css": "text" },
    legalComments: "none", // the whole licence stands in the banner
    nodePaths: [join(here, "node_modules")], // for the sources in the other rooms
    write: false,
  });
  writeFileSync(target, banner + made.outputFiles[0].text);
}

await bundle("main.js", "esm", join(widgets, "bundle.js"));
await bundle("page.js", "iife", join(dirname(widgets), "reports", "player.js"));
