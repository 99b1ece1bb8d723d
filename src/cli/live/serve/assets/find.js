// From a place of the text to the picture: the pixels of what stands there are lit up.

import { count, element, part, say } from "./element.js";

const HINT = "A line, or file:line:column. The pixels that show what stands there are lit up.";

/// The field. `on` has `ask(place)`, which gives a mask or an error, and `light(mask or null)`.
export class Finder {
  constructor(on) {
    this.on = on;
    this.at = null;
    this.asked = 0;
    this.files = [];
    const field = part("find");
    field.addEventListener("change", () => this.seek(field.value.trim()));
    field.addEventListener("input", () => field.value === "" && this.clear());
    field.addEventListener("keydown", (event) => event.key === "Escape" && this.clear());
    part("find-clear").addEventListener("click", () => this.clear());
    say(part("find-said"), HINT);
  }

  /// Takes the names of the files that there are, the scene's first.
  know(files) {
    if (String(files) === String(this.files)) return;
    this.files = files;
    part("files").replaceChildren(...files.map((file) => element("option", { value: `${file}:` })));
  }

  /// Looks for a place as it is written.
  seek(text) {
    if (text === "") return this.clear();
    part("find-clear").hidden = false;
    const [file, line, column] = understood(text);
    if (!line) return this.rest(`\`${text}\` is no place. ${HINT}`);
    const named = file === "" ? this.files[0] : this.files.find((known) => isNamed(known, file));
    if (!named) return this.rest(`The scene has no file \`${file}\`.`);
    this.at = { file: named, line, column };
    this.ask();
  }

  /// Looks again where the picture is of another text.
  refresh({ generation }) {
    if (generation === this.generation) return;
    this.generation = generation;
    if (this.at) this.ask();
  }

  async ask() {
    const asked = ++this.asked;
    const answer = await this.on.ask(this.at).catch((error) => {
      // Once there is an answer again, it is asked for again.
      this.generation = null;
      return { error: error.message };
    });
    // Another place has been looked for since.
    if (asked !== this.asked) return;
    if (answer.error) return this.show(null, sentence(answer.error));
    const lit = answer.bits.reduce((sum, byte) => sum + ONES[byte], 0);
    this.show(answer, `${count(lit)} ${lit === 1 ? "pixel shows" : "pixels show"} it.`);
  }

  /// Looks for nothing, and says why or how.
  rest(words) {
    this.asked++;
    this.at = null;
    this.show(null, words);
  }

  show(mask, words) {
    this.on.light(mask);
    say(part("find-said"), words);
  }

  clear() {
    part("find").value = "";
    part("find-clear").hidden = true;
    this.rest(HINT);
  }
}

function sentence(text) {
  return `${text[0].toUpperCase()}${text.slice(1)}.`;
}

/// How many bits of each byte are set.
const ONES = Uint8Array.from({ length: 256 }, (_, byte) => byte.toString(2).replaceAll("0", "").length);

/// File, line and column of a place; an empty name is the scene's, column 0 the first word of the line. No line where it is
/// none.
function understood(text) {
  const [, file, line, column] = /^()(\d{1,9})(?::(\d{1,9}))?$/.exec(text) ?? /^(.+?):(\d{1,9})(?::(\d{1,9}))?:?$/.exec(text) ?? [];
  return [file, Number(line ?? 0), Number(column ?? 0)];
}

/// Whether a file may be called so: by its whole name, or by the end of it.
function isNamed(known, name) {
  const [whole, end] = [known, name].map((path) => path.replaceAll("\\", "/"));
  return whole === end || whole.endsWith(`/${end}`);
}
