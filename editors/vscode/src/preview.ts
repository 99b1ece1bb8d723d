// Editors that hold pages of live previews.

import * as vscode from "vscode";

export class Previews implements vscode.Disposable {
  private readonly panels = new Map<string, vscode.WebviewPanel>();

  /** Shows a page of this machine beside the text, in its panel if it has one: each preview has an address of its own. */
  async show(page: vscode.Uri): Promise<void> {
    // Where the editor runs in a browser or on another machine, the port is forwarded.
    const address = await vscode.env.asExternalUri(page);
    const key = page.toString();
    let panel = this.panels.get(key);
    if (panel) {
      panel.reveal(undefined, true);
    } else {
      const scene = vscode.window.activeTextEditor?.document.uri.path.split("/").pop();
      const column = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
      const options = { enableScripts: true, retainContextWhenHidden: true };
      panel = vscode.window.createWebviewPanel("rtc.preview", scene ? `Preview of ${scene}` : "Preview", column, options);
      panel.onDidDispose(() => this.panels.delete(key));
      this.panels.set(key, panel);
    }
    panel.webview.html = frame(address);
  }

  dispose(): void {
    for (const panel of this.panels.values()) panel.dispose();
  }
}

/** A page that is all frame. Nothing but the preview may be in it. */
function frame(address: vscode.Uri): string {
  const origin = `${address.scheme}://${address.authority}`;
  const source = address.toString(true).replace(/&/g, "&amp;").replace(/"/g, "&quot;");
  return `<!doctype html>
<html>
  <head>
    <meta http-equiv="Content-Security-Policy" content="default-src 'none'; frame-src ${origin}; style-src 'unsafe-inline'">
    <style>html, body, iframe { margin: 0; border: 0; padding: 0; width: 100%; height: 100%; display: block; }</style>
  </head>
  <body><iframe src="${source}" allow="clipboard-write; fullscreen"></iframe></body>
</html>`;
}
