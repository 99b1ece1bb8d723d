// What is one word for Visual Studio Code, which completes words, selects them and looks for them.

import assert from "node:assert";
import { readFileSync } from "node:fs";
import test from "node:test";

const { wordPattern, indentationRules } = JSON.parse(readFileSync("language-configuration.json", "utf8"));

test("names, numbers, units and colours are words", () => {
  const words = new RegExp(wordPattern.pattern, `g${wordPattern.flags}`);
  const found = "let größe_2 = 8.5mm + b.#d94f30".match(words);
  assert.deepStrictEqual(found, ["let", "größe_2", "8.5", "mm", "b", "#d94f30"]);
  assert.deepStrictEqual("#".match(words), ["#"]);
});

test("lines behind an open bracket are indented", () => {
  const opens = new RegExp(indentationRules.increaseIndentPattern);
  for (const line of ["sphere {", "  at: (", 'text { value: "{" , of: [ // three']) assert.match(line, opens);
  for (const line of ["sphere {}", "// {", 'let a = "{"']) assert.doesNotMatch(line, opens);
});
