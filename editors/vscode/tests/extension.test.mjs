// What the extension does, in an editor that is pretended.

import assert from "node:assert";
import { createRequire } from "node:module";
import test from "node:test";
import { buildSync } from "esbuild";

const external = ["vscode", "vscode-languageclient/node"];
const bundle = buildSync({ entryPoints: ["src/extension.ts"], bundle: true, write: false, format: "cjs", platform: "node", external });

/** Starts the extension, and gives what it told its client, and what it listens to. */
async function started() {
  const heard = { sent: [] };
  const nothing = () => ({ dispose() {} });
  const matches = (filters, { uri, languageId }) =>
    filters.some(({ scheme, language }) => [undefined, uri.scheme].includes(scheme) && language === languageId) ? 10 : 0;
  const vscode = {
    commands: { registerCommand: nothing },
    languages: { match: matches },
    window: { onDidChangeTextEditorSelection: listener => ((heard.moved = listener), nothing()) },
    workspace: {
      isTrusted: true,
      getConfiguration: () => ({ get: (_, otherwise) => otherwise }),
      onDidChangeConfiguration: nothing,
      onDidGrantWorkspaceTrust: nothing,
    },
  };
  class LanguageClient {
    code2ProtocolConverter = { asTextDocumentPositionParams: ({ uri }) => uri.scheme };
    constructor(_id, _name, server, options) {
      Object.assign(heard, { server, options });
    }
    async start() {}
    isRunning = () => true;
    async sendNotification(method, about) {
      heard.sent.push([method, about]);
    }
  }
  const known = { vscode, "vscode-languageclient/node": { LanguageClient } };
  const require = createRequire(import.meta.url);
  const module = { exports: {} };
  new Function("require", "module", "exports", bundle.outputFiles[0].text)(name => known[name] ?? require(name), module, module.exports);
  await module.exports.activate({ subscriptions: [] });
  heard.takes = document => matches(heard.options.documentSelector, document) > 0;
  return heard;
}

const text = (scheme, languageId = "rt") => ({ uri: { scheme }, languageId });

test("the server is started by its name", async () => {
  const { server } = await started();
  assert.deepStrictEqual([server.command, server.args], ["rtc", ["lsp"]]);
});

test("the old side of a comparison is not the server's", async () => {
  const heard = await started();
  const shown = ["file", "untitled", "git", "vscode-local-history"].map(scheme => text(scheme));
  assert.deepStrictEqual(shown.map(heard.takes), [true, true, false, false]);
  assert.strictEqual(heard.takes(text("file", "rust")), false);
  for (const document of [...shown, text("file", "rust")]) await heard.moved({ textEditor: { document, selection: { active: {} } } });
  assert.deepStrictEqual(heard.sent, [["rtc/cursor", "file"], ["rtc/cursor", "untitled"]]);
});
