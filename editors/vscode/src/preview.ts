// Editors that hold the page of the live preview, one a scene.

import * as vscode from "vscode";

export class Previews implements vscode.Disposable {
  private readonly panels = new Map<string, vscode.WebviewPanel>();

  /** Shows a page of this machine beside the text, in the panel of the scene if there is one. */
  async show(page: vscode.Uri, scene: string): Promise<void> {
    // Where the editor runs in a browser or on another machine, the port is forwarded.
    const address = await vscode.env.asExternalUri(page);
    let panel = this.panels.get(scene);
    if (panel) {
      panel.reveal(undefined, true);
    } else {
      const name = decodeURIComponent(scene.split("/").pop() ?? "scene");
      const column = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
      const options = { enableScripts: true, retainContextWhenHidden: true };
      panel = vscode.window.createWebviewPanel("rtc.preview", name, column, options);
      panel.onDidDispose(() => this.panels.delete(scene));
      this.panels.set(scene, panel);
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
