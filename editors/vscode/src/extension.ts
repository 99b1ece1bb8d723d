// Starts the language server of rtc, and shows the live preview that it serves.

import { execFile } from "node:child_process";
import * as vscode from "vscode";
import { LanguageClient, type LanguageClientOptions, type ServerOptions, type ShowDocumentParams } from "vscode-languageclient/node";
import { Previews } from "./preview";

// What an editor holds: the old side of a comparison is no scene of its own, and has no folder to import from.
const scenes = ["file", "untitled"].map(scheme => ({ scheme, language: "rt" }));

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
    vscode.window.onDidChangeTextEditorSelection(moved),
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
    documentSelector: scenes,
    middleware: {
      window: {
        showDocument: async asked => ({ success: await show(asked) }),
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
    await vscode.commands.executeCommand("rtc.startPreview", { uri });
  } catch (error) {
    void vscode.window.showErrorMessage(`rtc: no preview: ${said(error)}`);
  }
}

/** Shows what the server asks for: the page of a preview, or the place of a text that was clicked on there. */
async function show({ uri, external, selection }: ShowDocumentParams): Promise<boolean> {
  const place = vscode.Uri.parse(uri);
  if (external) {
    const beside = setting<string>("preview.in", "beside") === "beside";
    // Where the editor is a page of a browser itself, the preview may not be in it.
    if (!beside || vscode.env.uiKind === vscode.UIKind.Web) return vscode.env.openExternal(place);
    await previews.show(place);
  } else {
    // The page has the focus, and is not to be covered by the text.
    const seen = vscode.window.visibleTextEditors.find(editor => editor.document.uri.toString() === place.toString());
    const viewColumn = seen?.viewColumn ?? vscode.ViewColumn.One;
    const range = client?.protocol2CodeConverter.asRange(selection);
    await vscode.window.showTextDocument(place, { viewColumn, ...(range && { selection: range }) });
  }
  return true;
}

/** Tells the server where the cursor is: the preview lights up what stands there. */
async function moved(change: vscode.TextEditorSelectionChangeEvent): Promise<void> {
  const { document, selection } = change.textEditor;
  if (!vscode.languages.match(scenes, document) || !client?.isRunning()) return;
  const at = client.code2ProtocolConverter.asTextDocumentPositionParams(document, selection.active);
  await client.sendNotification("rtc/cursor", at);
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
