// Starts the language server of rtc, and shows the live preview that it serves.

import { execFile } from "node:child_process";
import * as vscode from "vscode";
import { LanguageClient, type LanguageClientOptions, type ServerOptions } from "vscode-languageclient/node";
import { Previews } from "./preview";

/** What the server does when asked by name; its code lenses ask so too. */
const START_PREVIEW = "rtc.startPreview";

let client: LanguageClient | undefined;
const previews = new Previews();

export async function activate(context: vscode.ExtensionContext): Promise<void> {
  context.subscriptions.push(
    previews,
    vscode.commands.registerCommand("rtc.preview", preview),
    vscode.commands.registerCommand("rtc.build", build),
    vscode.commands.registerCommand("rtc.restart", restart),
    vscode.workspace.onDidChangeConfiguration(change => {
      if (change.affectsConfiguration("rtc.path") || change.affectsConfiguration("rtc.arguments")) void restart();
    }),
    vscode.workspace.onDidGrantWorkspaceTrust(restart),
  );
  await start();
}

export async function deactivate(): Promise<void> {
  await client?.stop();
}

async function start(): Promise<void> {
  // A folder that is not trusted could name any program as `rtc`.
  if (!vscode.workspace.isTrusted) return;
  const server: ServerOptions = { command: program(), args: ["lsp", ...setting<string[]>("arguments", [])] };
  const options: LanguageClientOptions = {
    documentSelector: [{ language: "rt" }],
    middleware: {
      // A code lens asks by the name of the server's command: what it answers is the address of a page.
      executeCommand: async (command, given, next) => {
        const answer: unknown = await next(command, given);
        if (command === START_PREVIEW) await show(answer, given[0]?.uri);
        return answer;
      },
    },
  };
  client = new LanguageClient("rtc", "rtc", server, options);
  try {
    await client.start();
  } catch (error) {
    client = undefined;
    const path = "Set the path";
    const chosen = await vscode.window.showErrorMessage(`rtc: the language server does not start: ${said(error)}`, path);
    if (chosen === path) await vscode.commands.executeCommand("workbench.action.openSettings", "rtc.path");
  }
}

async function restart(): Promise<void> {
  const old = client;
  client = undefined;
  await old?.stop().catch(() => undefined);
  await start();
}

/** Has the server show the picture of the active editor's text, saved or not. */
async function preview(): Promise<void> {
  const uri = vscode.window.activeTextEditor?.document.uri.toString();
  if (!uri) return;
  if (!client) {
    void vscode.window.showErrorMessage("rtc: the language server is not running.");
    return;
  }
  try {
    // By the command that the server registers, and so by the middleware above.
    await vscode.commands.executeCommand(START_PREVIEW, { uri });
  } catch (error) {
    void vscode.window.showErrorMessage(`rtc: no preview: ${said(error)}`);
  }
}

async function show(answer: unknown, uri: unknown): Promise<void> {
  const found = typeof answer === "object" && answer !== null ? (answer as { url?: unknown }).url : answer;
  if (typeof found !== "string") return;
  const page = vscode.Uri.parse(found);
  if (setting<string>("preview.in", "beside") === "browser") {
    await vscode.env.openExternal(page);
  } else {
    await previews.show(page, typeof uri === "string" ? uri : found);
  }
}

/** Renders the active editor's file, and tells where the picture is. */
async function build(): Promise<void> {
  const document = vscode.window.activeTextEditor?.document;
  if (!document || !vscode.workspace.isTrusted || !(await document.save())) return;
  const title = `Rendering ${vscode.workspace.asRelativePath(document.uri)}`;
  await vscode.window.withProgress({ location: vscode.ProgressLocation.Notification, title, cancellable: true }, (_, stop) =>
    new Promise<void>(resolve => {
      const run = execFile(program(), ["build", document.uri.fsPath], (error, _, told) => {
        if (error && !run.killed) void vscode.window.showErrorMessage(`rtc: ${told.trim() || error.message}`);
        else if (!error) void vscode.window.showInformationMessage(`rtc: ${told.trim()}`);
        resolve();
      });
      stop.onCancellationRequested(() => run.kill("SIGINT"));
    }),
  );
}

function program(): string {
  return setting<string>("path", "rtc");
}

function setting<T>(name: string, otherwise: T): T {
  return vscode.workspace.getConfiguration("rtc").get<T>(name, otherwise);
}

function said(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
