// What the compiler says of a scene can be clicked on: here and in Sublime Text, by the expressions that are given to both.

import assert from "node:assert";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test from "node:test";

const read = path => JSON.parse(readFileSync(path, "utf8"));
const rtc = process.env.RTC ?? "rtc";

/** Runs a command, `rtc` and arguments, on a scene with a slip in its second line, and gives what it says. */
function said([program, ...given]) {
  assert.strictEqual(program, "rtc");
  const folder = mkdtempSync(join(tmpdir(), "rt-"));
  try {
    const scene = join(folder, "a b.rt");
    writeFileSync(scene, "// A ball.\nsphere { radius: 8deg }\n");
    const done = spawnSync(rtc, given.map(one => (one === "$file" ? scene : one)), { encoding: "utf8" });
    assert.strictEqual(done.status, 1, done.stderr ?? String(done.error));
    return { scene, lines: done.stderr.trim().split("\n") };
  } finally {
    rmSync(folder, { recursive: true });
  }
}

test("errors of Sublime Text's builds lead to their places", () => {
  const build = read("../sublime/rtc.sublime-build");
  for (const { cmd } of [build, ...build.variants]) {
    const { scene, lines } = said(cmd);
    const found = lines.map(line => line.match(build.file_regex)).filter(Boolean);
    assert.deepStrictEqual(found.map(([, ...groups]) => groups.slice(0, 3)), [[scene, "2", "18"]], lines.join("\n"));
  }
});

test("the problem matcher of a task finds what is wrong", () => {
  const [{ pattern }] = read("package.json").contributes.problemMatchers;
  const { scene, lines } = said(["rtc", "check", "--message-format", "short", "$file"]);
  const found = lines.map(line => line.match(pattern.regexp)).filter(Boolean);
  const parts = ["file", "line", "column", "severity", "code"].map(part => found[0]?.[pattern[part]]);
  assert.deepStrictEqual([found.length, ...parts], [1, scene, "2", "18", "error", "E0203"], lines.join("\n"));
});
