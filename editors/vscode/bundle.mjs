// Makes dist: the extension with what it needs, and the licences of it all.

import { build } from "esbuild";
import { copyFile, readFile, readdir, writeFile } from "node:fs/promises";

/** Those that deny.toml allows and that packages of npm have. */
const ALLOWED = ["MIT", "ISC", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "0BSD"];

const { metafile } = await build({
  entryPoints: ["src/extension.ts"],
  outfile: "dist/extension.js",
  bundle: true,
  minify: true,
  external: ["vscode"],
  format: "cjs",
  platform: "node",
  target: "node18",
  metafile: true,
});

const folders = Object.keys(metafile.inputs).flatMap(file => /^.*node_modules\/(?:@[^/]+\/)?[^/]+/.exec(file) ?? []);
const notices = await Promise.all([...new Set(folders)].sort().map(notice));
await writeFile("dist/NOTICES.txt", notices.join(`\n${"-".repeat(80)}\n\n`));
for (const name of ["LICENSE-APACHE", "LICENSE-MIT"]) await copyFile(`../../${name}`, `dist/${name}.txt`);

/** What a package says of itself, and its licence to the letter. */
async function notice(folder) {
  const { name, version, license } = JSON.parse(await readFile(`${folder}/package.json`, "utf8"));
  const file = (await readdir(folder)).find(file => /^licen[cs]e/i.test(file));
  if (!file || !ALLOWED.includes(license)) throw new Error(`${name} has the licence ${license}, in the file ${file}`);
  return `${name} ${version}, ${license}\n\n${await readFile(`${folder}/${file}`, "utf8")}`;
}
